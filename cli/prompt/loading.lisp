;;;; loading.lisp -- loading a user's file form by form, to tell on which line something is wrong.

(in-package :ars-magna.cli)

(defun form-start (text start)
  "Return where, from START, the next form in TEXT begins; its length if there is none."
  (loop for position = (or (position-if-not #'blank-p text :start start) (length text))
        for end = (and (< position (length text)) (skip-comment text position))
        while end
        do (setf start end)
        finally (return position)))

(defun call-watched-at (place function)
  "Call FUNCTION, while PLACE, a function, says to whoever watches where in a file that is."
  (let ((calls *user-calls*))
    (if calls
        (let ((outer (shiftf (user-calls-place calls) place)))
          (unwind-protect (funcall function)
            (setf (user-calls-place calls) outer)))
        (funcall function))))

(defun call-on-line (function file text position)
  "Call FUNCTION, which deals with the form of FILE's TEXT at POSITION."
  (flet ((line () (1+ (count #\Newline text :end position))))
    (handler-bind ((error (lambda (condition)
                            (unless (placed-p condition)
                              (error 'file-trouble :file file :cause condition :line (line))))))
      (call-watched-at (lambda () (format nil "~A, line ~D" file (line))) function))))

(defun load-forms (path)
  "Do as LOAD does with the Lisp file at PATH. Signals FILE-TROUBLE."
  ;; Whoever is told why a file has been left needs no word of the compiler's that it has been.
  (let ((*error-output* (make-broadcast-stream)))
    (call-telling-undefined (lambda ()
                              (call-telling-doubts (lambda () (load-each-form path))))
                            (native-name path))))

(defun load-each-form (path)
  (let* ((text (file-text path))
         (file (native-name path))
         (*package* *package*) (*readtable* *readtable*)
         (*load-pathname* path) (*load-truename* (truename path)))
    (loop with start = 0
          for position = (form-start text start)
          while (< position (length text))
          do (call-on-line (lambda ()
                             (multiple-value-bind (form end)
                                 (read-from-string text t nil :start position)
                               (setf start end)
                               (check-form-of-file form path)
                               (call-as-from-file (lambda () (eval-quietly form)) path)))
                           file text position))))
