;;;; loading.lisp -- the file that a name means; loading a Lisp file form by form.

(in-package :ars-magna.cli)

(defun existing-lisp-file (name)
  "Return the path of the Lisp file NAME, with or without type; NIL if there is no such file."
  (let ((path (path-of-name name)))
    (and (pathname-name path)
         (or (existing-path path)
             (existing-path (make-pathname :type "lisp" :defaults path))))))

(defun find-lisp-file (name)
  "Return the path of the Lisp file NAME, with or without type. Signals BAD-LINE if there is none."
  (or (existing-lisp-file name) (reject-line "There is no file ~A." name)))

(defun foreign-file-text (path)
  "Return a sentence that says what the file PATH contains and which program or command reads it;
NIL if it contains Lisp or lines of the prompt."
  (let ((advice (advice-on-file path :lisp)))
    (and advice (format nil "~A: ~A." (native-name path) advice))))

(defun check-lisp-file (path)
  (let ((text (foreign-file-text path)))
    (when text (reject-line "~A" text))))

(defun check-form-of-file (form path)
  "Signal BAD-LINE if FORM, read while loading the file PATH, is the name of a line command."
  (when (and (symbolp form) (not (boundp form)) (line-command-named (symbol-name form)))
    (reject-line "~A is a command of the prompt. The file looks like a script. Run it by: ~
                  ars-magna ~A."
                 form (native-name path))))

(defun start-of-form (text start)
  "Return the start of the next form in TEXT from START on; the length of TEXT if there is none."
  (loop for position = (or (position-if-not #'blank-character-p text :start start) (length text))
        for end = (and (< position (length text)) (skip-comment text position))
        while end
        do (setf start end)
        finally (return position)))

(defun file-only-defines-p (path)
  (ignore-errors
   (let ((text (file-text path)) (robot-p nil) (*read-eval* nil))
     (loop for (form end) = (multiple-value-list
                             (read-from-string text nil text :start (or end 0)))
           until (eq form text)
           do (when (same-name-p (first form) 'defrobot) (setf robot-p t))
           always (or (starts-with-subseq "DEF" (symbol-name (first form)))
                      (starts-with-subseq "IN-" (symbol-name (first form))))
           finally (return robot-p)))))

(defun check-typed-load (form)
  "Signal BAD-LINE if FORM, as typed, loads a file that cannot be Lisp."
  (when (typep form '(cons (eql load) (cons string)))
    (when (wildcard-name-p (second form))
      (reject-line "~A cannot be loaded: ~A." (second form) (unusable-file-text (second form))))
    (let ((path (existing-lisp-file (second form))))
      (when path
        (check-lisp-file path)
        (check-form-of-file (ignore-errors
                             (let ((text (file-text path)) (*read-eval* nil))
                               (values (read-from-string text t nil
                                                         :start (start-of-form text 0)))))
                            path)))))

;;;; Loading

(defun call-recording-location (place function)
  "Call FUNCTION. Error reports get the file and line being loaded from the function PLACE."
  (let ((calls *user-calls*))
    (if calls
        (let ((outer (shiftf (user-calls-place calls) place)))
          (unwind-protect (funcall function)
            (setf (user-calls-place calls) outer)))
        (funcall function))))

(defun line-number-at (text position)
  (1+ (count #\Newline text :end position)))

(defun call-locating-errors (function file line)
  "Call FUNCTION. Signal errors in FUNCTION as FILE-TROUBLE with FILE and the line number that the
function LINE returns for the condition. For NIL, LINE returns the number of the line being loaded."
  (handler-bind ((error (lambda (condition)
                          (unless (condition-has-location-p condition)
                            (error 'file-trouble :file file :cause condition
                                                 :line (funcall line condition))))))
    (call-recording-location (lambda () (format nil "~A, line ~D" file (funcall line nil)))
                             function)))

(defun line-of-read-error (condition stream start)
  "Return the number of the line in STREAM on which the reader failed with CONDITION. If the form
does not end, return the number of the line of START, where the form begins."
  (line-number-at (grown-text stream)
                  (if (typep condition 'end-of-file)
                      start
                      (max start (1- (grown-position stream))))))

(defun read-form-in-file (stream file)
  "Return the next form of STREAM, the text of FILE. Signals FILE-TROUBLE if reading fails."
  (let ((start (grown-position stream)))
    (call-locating-errors (lambda () (read-preserving-whitespace stream)) file
                          (lambda (condition) (line-of-read-error condition stream start)))))

(defun load-forms (path)
  "Load the Lisp file at PATH as LOAD does. Signals FILE-TROUBLE."
  ;; The message says why a file has been left; the compiler's own is not needed.
  (let ((*error-output* (make-broadcast-stream)))
    (call-reporting-undefined (lambda ()
                                (call-reporting-warnings (lambda () (load-each-form path))))
                              (native-name path))))

(defun load-each-form (path)
  (let* ((text (file-text path))
         (stream (make-growing-text-stream text 0 (constantly nil)))
         (file (native-name path))
         (*package* *package*) (*readtable* *readtable*)
         (*load-pathname* path) (*load-truename* (truename path)))
    (loop for position = (start-of-form text (min (grown-position stream) (length text)))
          while (< position (length text))
          do (setf (grown-position stream) position)
             (let ((form (read-form-in-file stream file)))
               (call-locating-errors (lambda ()
                                       (check-form-of-file form path)
                                       (call-recording-file (lambda () (eval-quietly form)) path))
                                     file
                                     (lambda (condition)
                                       (declare (ignore condition))
                                       (line-number-at text position)))))))
