;;;; places-in-text.lisp -- the line of a form that the compiler reports, among similar forms.

(in-package :ars-magna.definitions)

(export '(reading-location compiling-location))

;;; The compiler knows the path of elements that leads to a form: see LOCATION-IN-TEXT. The path is
;;; followed in the text as far as possible: a quoted form, for example, is no list there. The form
;;; is then searched for in what has been reached.

(defun skip-blanks (text i)
  "Return the position of the first character in TEXT, from I on, outside blanks and comments."
  (loop while (< i (length text))
        do (cond ((blank-character-p (char text i)) (incf i))
                 ((skip-comment text i) (setf i (skip-comment text i)))
                 (t (return))))
  i)

(defvar *element-bounds-cache* '("" 0 0 nil)
  "A cache, because callers request elements in order: the arguments of the last call of
ELEMENT-BOUNDS, and the start that it returned. The list is replaced, never modified.")

(defun element-bounds (text start number)
  "Return the start and end in TEXT of element NUMBER of the list at START; NIL if unreadable."
  (with-form-reader (text)
    (destructuring-bind (last-text last-start last-number last-begin) *element-bounds-cache*
      (let ((known-p (and last-begin (eq text last-text) (= start last-start)
                          (<= last-number number))))
        (flet ((end-of-form (position)
                 (let ((end (nth-value 1 (read-words position))))
                   (if (integerp end) end (return-from element-bounds nil)))))
          (when (starts-at-p "(" text start)
            (let* ((begin (if known-p last-begin (skip-blanks text (1+ start))))
                   (end (end-of-form begin)))
              (loop repeat (if known-p (- number last-number) number)
                    do (setf begin (skip-blanks text end)
                             end (end-of-form begin)))
              (setf *element-bounds-cache* (list text start number begin))
              (values begin end))))))))

(defun bounds-of-location (text location)
  "Return the start and end in TEXT of the form at LOCATION, a value of LOCATION-IN-TEXT. If that
form cannot be found, return the start and end of the smallest form around it."
  (destructuring-bind (position . numbers) location
    (let ((start (skip-blanks text position)) (end (length text)))
      (dolist (number numbers (values start end))
        (multiple-value-bind (inner-start inner-end) (element-bounds text start number)
          (unless inner-start (return (values start end)))
          (setf start inner-start end inner-end))))))

(defun form-line-in-file (file form location)
  "Return the line of FORM in FILE. If FORM is NIL or not found, return the line of LOCATION, a
value of LOCATION-IN-TEXT. Return NIL if both fail."
  (and location
       (ignore-errors
         (let ((text (cached-file-text file)))
           (multiple-value-bind (start end) (bounds-of-location text location)
             (line-number text (or (and form
                                        (car (find form (forms-in text start end)
                                                   :key #'cdr :test #'same-printed-form-p)))
                                   start)))))))

(defun line-of-form-being-read (stream)
  "Return the number of the first line of the form that LOAD is reading from STREAM."
  (let ((text (file-text (pathname stream))))
    (line-number text (skip-blanks text (min (form-start stream) (length text))))))

(defun reading-location (condition)
  "If LOAD signalled CONDITION because it could not read a form, return the native name of the file,
and the line where the reader stopped; if the form does not end, the line where it begins. Return
NIL for other conditions. Works only while the file is open."
  (let ((stream (and (typep condition 'reader-error) (stream-error-stream condition))))
    (when (and stream (open-stream-p stream) (form-start stream))
      (let ((cause (cause-of-reading-error condition)))
        (values (native-name (pathname stream))
                (cond ((typep cause 'end-of-file) (line-of-form-being-read stream))
                      ((format-of-decoding-error cause) (line-of-next-character stream))
                      (t (line-of-last-character stream))))))))

(defun compiling-location ()
  "Return the native name of the file that COMPILE-FILE is compiling, and the line of the current
form, or NIL if the line is unknown. Return NIL if no file is being compiled."
  (multiple-value-bind (path location) (compiler-location)
    (when path
      (let ((file (native-name path)))
        (values file (form-line-in-file file nil location))))))
