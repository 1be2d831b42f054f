;;;; headless-forms.lisp -- what is said of a WITH-SIMULATION that is not written as it should be.

(in-package :ars-magna.run)

(defun unquoted (form)
  "Return FORM without the quote that people put before names elsewhere."
  (if (and (consp form) (eq 'quote (first form))) (second form) form))

(defun robots-form-p (form environment)
  "True if FORM, for the robots of WITH-SIMULATION, is an expression that returns them, and no name
or list of names."
  (typecase form
    (symbol (and form (known-variable-p form environment) (not (find-blueprint form nil))))
    (cons (let ((head (first form)))
            (and (symbolp head)
                 (not (eq 'quote head))
                 (not (find-blueprint head nil))
                 (or (some #'consp (rest form))
                     (known-function-p head environment)))))))

(defun unquoted-settings-p (form)
  "True if FORM, for a list of settings, is such a list itself, or a setting: neither is a call."
  (and (consp form)
       (let ((head (first form)))
         (if (consp head)
             (not (eq 'lambda (first head)))
             (and (symbolp head) (not (fboundp head)) (find-parameter head nil))))))

(defun settings-form (form)
  "Return FORM, that of the list :parameters. Signals MALFORMED-DEFINITION if a quote is missing."
  (when (unquoted-settings-p form)
    (reject-clause "with-simulation" (list :parameters form)
                   (let ((*print-case* :downcase))
                     (format nil "a quote: :parameters '~S"
                             (abridged (if (consp (first form)) form (list form)))))))
  form)
