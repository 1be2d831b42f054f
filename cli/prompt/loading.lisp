;;;; loading.lisp -- loading a user's file form by form, to tell on which line something is wrong.

(in-package :ars-magna.cli)

(defun call-watched-at (place function)
  "Call FUNCTION, while PLACE, a function, says to whoever watches where in a file that is."
  (let ((calls *user-calls*))
    (if calls
        (let ((outer (shiftf (user-calls-place calls) place)))
          (unwind-protect (funcall function)
            (setf (user-calls-place calls) outer)))
        (funcall function))))

(defun line-at (text position)
  (1+ (count #\Newline text :end position)))

(defun call-on-line (function file line)
  "Call FUNCTION, which deals with what FILE has on the line that the function LINE returns of a
condition, or of NIL."
  (handler-bind ((error (lambda (condition)
                          (unless (placed-p condition)
                            (error 'file-trouble :file file :cause condition
                                                 :line (funcall line condition))))))
    (call-watched-at (lambda () (format nil "~A, line ~D" file (funcall line nil))) function)))

(defun line-of-stumble (condition stream start)
  "Return on which line the reader gave up in STREAM, for which CONDITION came up; that of START,
where the form begins, if it does not end."
  (line-at (grown-text stream)
           (if (typep condition 'end-of-file)
               start
               (max start (1- (grown-position stream))))))

(defun read-placing (stream file)
  "Return the next form of STREAM, the text of FILE. Signals FILE-TROUBLE if it cannot be read."
  (let ((start (grown-position stream)))
    (call-on-line (lambda () (read-preserving-whitespace stream)) file
                  (lambda (condition) (line-of-stumble condition stream start)))))

(defun load-forms (path)
  "Do as LOAD does with the Lisp file at PATH. Signals FILE-TROUBLE."
  ;; Whoever is told why a file has been left needs no word of the compiler's that it has been.
  (let ((*error-output* (make-broadcast-stream)))
    (call-telling-undefined (lambda ()
                              (call-telling-doubts (lambda () (load-each-form path))))
                            (native-name path))))

(defun load-each-form (path)
  (let* ((text (file-text path))
         (stream (text-stream text 0 (constantly nil)))
         (file (native-name path))
         (*package* *package*) (*readtable* *readtable*)
         (*load-pathname* path) (*load-truename* (truename path)))
    (loop for position = (start-of-form text (min (grown-position stream) (length text)))
          while (< position (length text))
          do (setf (grown-position stream) position)
             (let ((form (read-placing stream file)))
               (call-on-line (lambda ()
                               (check-form-of-file form path)
                               (call-as-from-file (lambda () (eval-quietly form)) path))
                             file
                             (lambda (condition)
                               (declare (ignore condition))
                               (line-at text position)))))))
