;;;; forms.lisp -- a form of Lisp that goes on over lines is read while its lines come.

(in-package :ars-magna.cli)

;;; Each character is read once or twice, however many lines there are, and what is evaluated while
;;; it is read, after #., is so as often.

(defun read-more (session text)
  (or (read-input session +going-on+ text)
      (reject-line "The form is not complete: ~A" (one-line text))))

(defun read-growing (session text start)
  "Return what READ-FORM does, of a form that goes on after TEXT."
  (let* ((stream (text-stream text start (lambda (text) (read-more session text))))
         (form (skipping-rest (session (grown-text stream) start)
                 (read-preserving-whitespace stream))))
    (values form
            (min (grown-position stream) (length (grown-text stream)))
            (grown-text stream))))

(defun left-out-p (text start)
  "True if TEXT has from START on no form but one that Lisp leaves out, as after #-sbcl."
  (let ((start (position-if-not #'blank-p text :start start)))
    (and start
         (< (1+ start) (length text))
         (char= #\# (char text start))
         (find (char text (1+ start)) "+-")
         ;; Then what is put behind it is what is read.
         (eql 0 (ignore-errors (read-from-string (format nil "~A~%0" text) t nil :start start))))))

(defun read-form (session text &optional (start 0))
  "Return the form in TEXT at START, reading on in SESSION while it is incomplete; where it ends;
and TEXT with what was read. Where Lisp leaves out what is there, the form is one without values.
One that cannot be read is read over to its end."
  (handler-case (skipping-rest (session text start)
                  (read-from-string text t nil :start start))
    (end-of-file ()
      (if (left-out-p text start)
          (values '(values) (length text) text)
          (read-growing session text start)))
    (:no-error (form end) (values form end text))))
