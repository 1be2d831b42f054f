;;;; condition.lisp -- under which conditions an experiment's trials run.

(in-package :ars-magna.experiment)

;;; What varies is a factor: a parameter, a variable of the experiment's forms, the thinking mode,
;;; or the robots, and with them the world. A condition gives each factor a value. Conditions are
;;; all combinations of the factors' values, or a list of named cases, or each case with each
;;; combination. What a design samples varies together: its factors are one axis. An axis is a list
;;; (names choices): the names of factors that vary together, and lists of settings (name value).

(define-record (trial-condition (:conc-name condition-) (:constructor %make-condition))
  "What the trials of one condition have in common."
  (name "" string "what the condition is called, a string" :writable :export)
  (texts '() list "how its values stand in a table" :writable)
  (settings '() list "lists (factor-name value)" :writable)
  (robots '() list :writable)
  (thinking :free t :writable)
  (parameters #() simple-vector "the values of all parameters" :writable)
  (arguments '() list "the values of the variables of the experiment's forms, in order" :writable)
  (fingerprint nil (or null string)
               "what decides its trials, as far as that has been looked up" :writable)
  (variables '() list "lists (symbol value): users' special variables that its trials can reach, and
their values" :writable)
  (weak-parts (make-hash-table :test 'equal) hash-table "parts, as of a fingerprint, for what these
hold weakly: the keys of a table" :writable))

(defmethod print-object ((condition trial-condition) stream)
  (print-unreadable-object (condition stream)
    (format stream "condition ~A" (condition-name condition))))

(defun combinations (axes)
  "Return all lists of settings of AXES, the last one varying fastest."
  (if (null axes)
      (list '())
      (loop with rest = (combinations (rest axes))
            for choice in (second (first axes))
            append (loop for others in rest collect (append choice others)))))

(defun setting-text (setting)
  (format nil "~(~A~)=~A" (first setting) (value-text (second setting))))

(defun name-for (case-name settings)
  "Return what the condition of CASE-NAME, or NIL, with the other SETTINGS is called."
  (let ((words (append (and case-name (list (string-downcase case-name)))
                       (mapcar #'setting-text settings))))
    (if words (format nil "~{~A~^ ~}" words) "all")))

;;; What a setting does.

(defun parameter-called (name)
  "Return the parameter whose variable is the symbol NAME, or NIL."
  (let ((parameter (find-parameter name nil)))
    (and parameter (eq name (parameter-symbol parameter)) parameter)))

(defun parameters-with (settings clean)
  "Return the values of all parameters, in a vector: as SETTINGS, lists (name value), say, the last
one first, or as in a noiseless world if CLEAN is true, or else the manual's."
  (cl:map 'simple-vector
          (lambda (parameter)
            (let ((setting (find (parameter-symbol parameter) settings
                                 :key #'first :from-end t)))
              (cond (setting (second setting))
                    ((and clean (eq :noise (parameter-kind parameter)))
                     (parameter-clean parameter))
                    (t (parameter-default parameter)))))
          (all-parameters)))
