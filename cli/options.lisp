;;;; options.lisp -- the arguments of ./cli/ars-magna.

(in-package :ars-magna.cli)

;;; What the options do is said in usage.txt, which the shell script prints.

(define-condition usage-error (ars-magna-error)
  ((text :initarg :text :reader usage-error-text))
  (:report (lambda (condition stream) (write-string (usage-error-text condition) stream)))
  (:documentation "An argument of ./cli/ars-magna makes no sense."))

(defun reject-usage (control &rest arguments)
  (error 'usage-error :text (format nil "~? Try --help." control arguments)))

(defun parse-seed (text)
  (handler-case (parse-integer text)
    (error () (reject-usage "--seed takes an integer, not ~A." text))))

(defun parse-pace (text)
  (handler-case (parse-rate text)
    (bad-line ()
      (reject-usage "--rate takes a number of ticks per second, or free, not ~A." text))))

(defparameter *options*
  '(("--world" :world identity) ("--robot" :robot identity) ("--seed" :seed parse-seed)
    ("--rate" :rate parse-pace) ("--load" :load identity) ("--plan" :plan identity)
    ("--batch" :batch nil) ("--list" :list nil))
  "Lists (option key parser); PARSER is NIL for an option without a value.")

(defun find-option (name)
  (or (find name *options* :key #'first :test #'string=)
      (reject-usage "~A is no option.~@[ Did you mean ~A?~]" name
                    (nearest-name name (mapcar #'first *options*)))))

(defun split-option (argument)
  "Return the name of the option in ARGUMENT, and its value if that follows a =."
  (let ((equals (position #\= argument)))
    (if (and equals (starts-with-subseq "--" argument))
        (values (subseq argument 0 equals) (subseq argument (1+ equals)))
        (values argument nil))))

(defun parse-options (arguments)
  "Return a list of (key value) for ARGUMENTS, a list of strings. Signals USAGE-ERROR."
  (loop while arguments
        collect (multiple-value-bind (name value) (split-option (pop arguments))
                  (destructuring-bind (name key parser) (find-option name)
                    (cond ((and (null parser) value) (reject-usage "~A takes no value." name))
                          ((null parser) (list key t))
                          (value (list key (funcall parser value)))
                          ((null arguments) (reject-usage "~A takes a value." name))
                          (t (list key (funcall parser (pop arguments)))))))))

(defun option-value (key options &optional default)
  "Return the last value that OPTIONS give for KEY."
  (let ((entry (find key options :key #'first :from-end t)))
    (if entry (second entry) default)))

(defun option-values (key options)
  "Return all values that OPTIONS give for KEY, in order."
  (loop for (other value) in options when (eq key other) collect value))
