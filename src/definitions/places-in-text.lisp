;;;; places-in-text.lisp -- the line of a form that the compiler has met, also if others are alike.

(in-package :ars-magna.definitions)

(export '(reading-place compiling-place))

;;; The compiler knows which element of which form a form is: see PLACE-IN-TEXT. The text is
;;; followed down to that as far as it can be: a quoted form, for one, is no list in the text. In
;;; what has been reached, the form is looked for.

(defun skip-blanks (text i)
  "Return where in TEXT, at I or after it, something begins that is neither blank nor a comment."
  (loop while (< i (length text))
        do (cond ((blank-p (char text i)) (incf i))
                 ((skip-comment text i) (setf i (skip-comment text i)))
                 (t (return))))
  i)

(defvar *last-element* '("" 0 0 nil)
  "A list of text, start and number of which ELEMENT-BOUNDS was asked last, and where that began:
elements of long lists are asked for one after the other. Replaced, never altered.")

(defun element-bounds (text start number)
  "Return where in TEXT the element NUMBER, from 0, of the list that begins at START begins and
ends; NIL if there is no list, or it cannot be read."
  (with-words (text)
    (destructuring-bind (last-text last-start last-number last-begin) *last-element*
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
              (setf *last-element* (list text start number begin))
              (values begin end))))))))

(defun bounds-of-place (text place)
  "Return where what stands at PLACE, see PLACE-IN-TEXT, or what is around it, begins and ends."
  (destructuring-bind (position . numbers) place
    (let ((start (skip-blanks text position)) (end (length text)))
      (dolist (number numbers (values start end))
        (multiple-value-bind (inner-start inner-end) (element-bounds text start number)
          (unless inner-start (return (values start end)))
          (setf start inner-start end inner-end))))))

(defun line-in-text (file form place)
  "Return the line in FILE on which FORM stands, which is at PLACE, see PLACE-IN-TEXT; NIL if PLACE
is NIL or FILE cannot be read. If FORM is NIL, PLACE alone counts."
  (and place
       (ignore-errors
         (let ((text (text-of-file file)))
           (multiple-value-bind (start end) (bounds-of-place text place)
             (line-number text (or (and form
                                        (car (find form (forms-in text start end)
                                                   :key #'cdr :test #'same-words-p)))
                                   start)))))))

(defun line-of-form-being-read (stream)
  "Return on which line of its file the form begins that LOAD reads from STREAM."
  (let ((text (file-text (pathname stream))))
    (line-number text (skip-blanks text (min (form-start stream) (length text))))))

(defun reading-place (condition)
  "Return which file LOAD was reading when CONDITION came up, as the system calls it, and on which
line the reader gave up, or that on which the form begins if it does not end; NIL if CONDITION says
something else. Only while that file is still open."
  (let ((stream (and (typep condition 'reader-error) (stream-error-stream condition))))
    (when (and stream (open-stream-p stream) (form-start stream))
      (let ((cause (cause-of-reading-trouble condition)))
        (values (native-name (pathname stream))
                (cond ((typep cause 'end-of-file) (line-of-form-being-read stream))
                      ((undecodable-format cause) (line-of-next stream))
                      (t (line-reached stream))))))))

(defun compiling-place ()
  "Return which file COMPILE-FILE compiles, as the system calls it, and on which line the form
begins that it is at, or NIL if that is not known. Return NIL if no file is being compiled."
  (multiple-value-bind (path place) (compiler-place)
    (when path
      (let ((file (native-name path)))
        (values file (line-in-text file nil place))))))
