;;;; run-variable-lists.lisp -- listing, digesting and checking the run variables of a run.

(in-package :ars-magna.run)

(export '(run-variables-used shown-run-variables))

(defun entries-by-name (entries)
  (sort (copy-list entries) #'string< :key (lambda (entry) (qualified-name (first entry)))))

(defun run-variables-used (world &rest uses)
  "Return the entries of the run variables in WORLD with one of USES, sorted by qualified name."
  (entries-by-name (remove-if-not (lambda (entry) (member (third entry) uses))
                                  (world-run-variables world))))

(addition run-variables)
(defun run-variables (&optional (simulation (current-simulation)))
  "Return a list (symbol value) for each run variable that SIMULATION has read or set, sorted by
qualified name. Signals WRONG-ARGUMENT."
  (let ((world (simulation-world (resolve-simulation simulation 'run-variables))))
    (loop for (name value) in (run-variables-used world :read :set)
          collect (list name (copied-value value)))))

;; Digests of runs without run variables are as they were before there were such variables.
(defmethod digest-state :after ((world world) digest)
  (loop for (name value) in (run-variables-used world :set)
        do (digest-add digest (list (qualified-name name) value))))

(defun shown-value (value)
  "Return VALUE with its things and robots replaced by strings."
  (typecase value
    (cons (mapcar #'shown-value value))
    (simple-vector (cl:map 'simple-vector #'shown-value value))
    ((or number symbol character string) value)
    (t (princ-to-string value))))

(defun shown-run-variables (simulation)
  "Return a list of property lists, :NAME and :VALUE, plain data, for SIMULATION's run variables."
  (let* ((variables (run-variables simulation)) (names (mapcar #'first variables)))
    (loop for (name value) in variables
          collect (list :name (string-downcase (name-label name names))
                        :value (shown-value value)))))

(define-facts (simulation simulation)
  "Run variables" (let ((variables (shown-run-variables simulation)))
                    (and variables
                         (format nil "~{~A~^; ~}"
                                 (loop for variable in variables
                                       collect (destructuring-bind (&key name value) variable
                                                 (format nil "~A ~A" name (fact-text value))))))))

(define-facts (variable-definition definition)
  "Value in the current run" (let ((entry (and *simulation*
                                               (assoc (variable-definition-name definition)
                                                      (run-variables *simulation*)))))
                               (and entry (fact-text (second entry)))))

(defun stored-value-p (value world)
  "True if VALUE can be a stored value in WORLD. UPDATE-RUN-VARIABLE can make lists that are longer
than those that users set."
  (or (run-variable-value-p value world)
      (proper-list-of-p (lambda (element) (run-variable-value-p element world)) value)))

;; Unused variables of the Lisp that saved the run need not be defined here.
(defun check-run-variables (world)
  "Signal an error unless the run variables of WORLD, read from a file, are valid and defined."
  (let ((entries (world-run-variables world)))
    (must-hold (proper-list-of-p (lambda (entry)
                                   (and (proper-list-p entry)
                                        (= 3 (length entry))
                                        (first entry)
                                        (symbolp (first entry))
                                        (stored-value-p (second entry) world)
                                        (member (third entry) '(nil :read :set))))
                                 entries)
               "the run variables are invalid")
    (must-hold (= (length entries) (length (remove-duplicates entries :key #'first)))
               "a run variable has two values")
    (loop for (name nil use) in entries when use do (definition-of-variable name))
    (setf (world-run-variables world)
          (remove-if-not (lambda (entry) (get (first entry) 'run-variable)) entries))))
