;;;; clauses.lisp -- checks that all our defining forms share.

(in-package :ars-magna.world)

(export '(number-pair-p check-options check-name call-clause-code))

(defun check-options (definition options known)
  "Signal MALFORMED-DEFINITION unless OPTIONS is a plist with keys among KNOWN, each once."
  (unless (and (proper-list-p options) (evenp (length options)))
    (reject-clause definition options
                   (format nil "pairs of an option and its value; options: ~(~{~S~^ ~}~)" known)))
  (loop for (key value) on options by #'cddr
        for seen = '() then (cons last seen) for last = key
        do (unless (member key known)
             (reject-clause definition (if (keywordp key) (list key value) options)
                            (format nil "one of the options ~(~{~S~^ ~}~)~@[; did you mean ~
                                         ~(~S~)?~]"
                                    known (and (symbolp key) (nearest-name key known)))))
           (when (member key seen)
             (reject-clause definition (list key value) "each option only once"))))

(defun checked-probability (definition option value)
  "Return VALUE of OPTION, a probability, as a double-float. Signals MALFORMED-DEFINITION."
  (unless (probability-p value)
    (reject-clause definition (list option value) (argument-type-text 'probability)))
  (double value))

(defun number-pair-p (form)
  "True if FORM is a list of two numbers from -1e15 to 1e15, such as a point or a range."
  (and (proper-list-p form) (= 2 (length form)) (every #'bounded-number-p form)))

(defun check-name (definition name what)
  "Signal MALFORMED-DEFINITION unless NAME can be the name of a WHAT, such as \"map\"."
  (unless (and name (symbolp name) (not (eq name t)) (not (keywordp name)))
    (reject-clause definition name
                   (format nil "a symbol, but no keyword, as the name of the ~A" what))))

(defun call-clause-code (function definition clause expected)
  "Return the value of FUNCTION, which runs code of CLAUSE. If the code signals an error, signal
MALFORMED-DEFINITION about DEFINITION, with the text EXPECTED."
  (handler-case (funcall function)
    (malformed-definition (condition) (error condition))
    (error (condition)
      (reject-clause definition clause
                     (format nil "~A (~A~@[; there is ~A~])" expected
                             (string-right-trim "." (text-of-condition condition))
                             (exported-variable-named (undefined-name-of condition)))))))

(defun exported-variable-named (name)
  "Return the text PACKAGE:NAME of a variable named NAME that some package exports, or NIL."
  (dolist (symbol (and (symbolp name) name (find-all-symbols name)))
    (let ((package (symbol-package symbol)))
      (when (and package (boundp symbol) (not (keywordp symbol))
                 (eq :external (nth-value 1 (find-symbol (symbol-name symbol) package))))
        (return (format nil "~A:~A" (package-name package) symbol))))))

;;; Clauses one by one.

(defvar *clause-path* '()
  "A list of positions, the path from the current definition to the current clause.")

(defun call-with-clause (function clause path)
  "Call FUNCTION with CLAUSE, which is at PATH in the current definition. Restarts leave the clause
out and return NIL, read the clause again from its file, or use a typed clause. A typed definition
replaces the whole current definition."
  (restart-case (let ((*clause-path* path)) (funcall function clause))
    (skip-clause ()
      :report (lambda (stream) (format stream "Leave the clause ~S out." clause))
      nil)
    (read-again ()
      :test definition-in-file-p
      :report "Read the clause again from its file."
      (call-with-clause function (reduce (lambda (form position) (nth position form)) path
                                         :initial-value (reread-definition *definition*))
                        path))
    (use-value (other)
      :report "Use another clause."
      :interactive (lambda () (ask-for-form "A clause to use"))
      (if (replacing-form-p other)
          (use-value other)
          (call-with-clause function other path)))))

(defun append-clause-results (function clauses first)
  "Append the lists that FUNCTION returns for CLAUSES, or for the clauses that replace them. CLAUSES
are the elements of the current definition from the position FIRST on."
  (loop for clause in clauses
        for position from first
        append (call-with-clause function clause (append *clause-path* (list position)))))
