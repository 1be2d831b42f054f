;;;; options.lisp -- parsing the arguments of ./cli/ars-magna; texts beside the sources.

(in-package :ars-magna.cli)

;;; usage.txt and the other usage files describe the options. The shell script prints them.

(define-condition usage-error (ars-magna-error)
  ((text :initarg :text :reader usage-error-text))
  (:report (lambda (condition stream) (write-string (usage-error-text condition) stream)))
  (:documentation "An argument of ./cli/ars-magna makes no sense."))

(defun reject-usage (control &rest arguments)
  (error 'usage-error :text (format nil "~? Try --help." control arguments)))

;;; Values of options.

(defvar *option-name* "" "The name of the option whose value is parsed.")

(defun parse-seed (text)
  (handler-case (parse-integer text)
    (error () (reject-usage "--seed takes an integer, not ~A." text))))

(defun parse-rate-option (text)
  (handler-case (parse-rate text)
    (bad-line ()
      (reject-usage "--rate takes a number of ticks per second, or free, not ~A." text))))

(defun parse-seconds (text)
  (let ((seconds (ignore-errors (read-data-from-string text 0))))
    (if (and (realp seconds) (< 0 seconds 1000000000))
        seconds
        (reject-usage "--time-limit takes a number of seconds, more than 0, not ~A." text))))

(defun parse-color (text)
  (if (member text +color-settings+ :test #'string-equal)
      (make-keyword (string-upcase text))
      (reject-usage "--color takes ~{~A~#[~; or ~:;, ~]~}, not ~A." +color-settings+ text)))

(defparameter *options*
  '(("--world" :world identity) ("--robot" :robot identity) ("--seed" :seed parse-seed)
    ("--rate" :rate parse-rate-option) ("--load" :load identity)
    ("--window" :window nil) ("--plan" :plan identity)
    ("--batch" :batch nil) ("--json" :json nil) ("--stop" :stop nil)
    ("--time-limit" :time-limit parse-seconds)
    ("--color" :color parse-color) ("--list" :list nil))
  "Lists (option key parser [:optional]). PARSER is NIL for an option without a value. If the value
is optional, an empty value counts as none.")

;;; Taking them apart.

(defun option-p (argument)
  (starts-with-subseq "--" argument))

(defun split-option (argument)
  "Return the name of the option in ARGUMENT, and the value after the character =, or NIL."
  (let ((equals (position #\= argument)))
    (if (and equals (option-p argument))
        (values (subseq argument 0 equals) (subseq argument (1+ equals)))
        (values argument nil))))

(defun read-option-value (option arguments table)
  "Return the value of OPTION, an element of TABLE. ARGUMENTS follow it; also return their rest."
  (destructuring-bind (name key parser &optional optional) option
    (declare (ignore key))
    (cond ((null parser) (values nil arguments))
          ((and optional (or (null arguments)
                             (find (split-option (first arguments)) table
                                   :key #'first :test #'string=)))
           (values "" arguments))
          ((null arguments) (reject-usage "~A takes a value." name))
          (t (values (first arguments) (rest arguments))))))

(defun read-option (argument arguments table)
  "Return (key value) for the option ARGUMENT. ARGUMENTS follow it; also return their rest."
  (multiple-value-bind (name value) (split-option argument)
    (let ((option (or (find name table :key #'first :test #'string=)
                      (reject-usage "~A is not an option.~@[ Did you mean ~A?~]" name
                                    (nearest-name name (mapcar #'first table))))))
      (destructuring-bind (name key parser &rest optional) option
        (declare (ignore optional))
        (when (and value (null parser)) (reject-usage "~A takes no value." name))
        (multiple-value-bind (text left)
            (if value (values value arguments) (read-option-value option arguments table))
          (let ((*option-name* name))
            (values (list key (if parser (funcall parser text) t)) left)))))))

(defun parse-options (arguments &key (table *options*) others)
  "Parse ARGUMENTS, a list of strings, by the options of TABLE. Return a list of (key value). If
OTHERS is true, an argument that is not an option becomes (:other argument). Signals USAGE-ERROR."
  (loop while arguments
        collect (let ((argument (pop arguments)))
                  (if (and others (not (option-p argument)))
                      (list :other argument)
                      (multiple-value-bind (entry left) (read-option argument arguments table)
                        (setf arguments left)
                        entry)))))

(defun option-value (key options &optional default)
  (let ((entry (find key options :key #'first :from-end t)))
    (if entry (second entry) default)))

(defun option-values (key options)
  (loop for (other value) in options when (eq key other) collect value))

;;;; Texts

;;; They are read when this file is loaded, so that a saved program has them with it.

(defparameter *shell-texts*
  (loop for name in '("usage.txt" "usage-experiment.txt" "usage-merge.txt" "usage-compare.txt"
                      "usage-testbed.txt"
                      "spread-parallel.sh" "spread-slurm.sh")
        collect (list name (file-text (asdf:system-relative-pathname
                                       "ars-magna" (format nil "cli/shell/~A" name)))))
  "Lists (name text): files of this folder, as saved in the program.")

(defparameter *version* (asdf:component-version (asdf:find-system "ars-magna")))

(defun shell-text (name)
  (second (assoc name *shell-texts* :test #'string=)))

(defun insert-settings (text settings)
  "Return a script's TEXT with @SETTINGS@ replaced by SETTINGS, lists (variable value comment)."
  (let ((mark "@SETTINGS@"))
    (with-output-to-string (out)
      (write-string text out :end (search mark text))
      (format out "~:{~A=~A~40T# ~A~:^~%~}"
              (loop for (variable value comment) in settings
                    collect (list variable (uiop:escape-sh-token (princ-to-string value))
                                  comment)))
      (write-string text out :start (+ (search mark text) (length mark))))))
