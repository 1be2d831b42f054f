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

(defun doubt-values-of-commands (body)
  "Warn of each place in BODY, that of a WITH-SIMULATION, that uses the value of a command."
  (map-calls (lambda (form)
               (let ((call (find-if (lambda (used)
                                      (and (typep used '(cons symbol))
                                           (get (first used) 'command-shape)))
                                    (values-used-in form))))
                 (when call
                   (doubt-definition "~(~A~) returns nothing: it only begins the command. What ~
                                      comes of that is told to its continuation, when ticks have ~
                                      passed." (first call)))))
             body))

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
