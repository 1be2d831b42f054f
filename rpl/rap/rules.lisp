;;;; rules.lisp -- definitions of rules of the memory.

(in-package :ars-rap)

;;; A rule that uses itself through NOT, perhaps by way of other rules, has no clear meaning: it is
;;; refused when the circle is closed. The graph of rules is that of their patterns: a rule uses
;;; another one if a pattern in its query may match the head of the other.

(defun used-patterns (query &optional negated-p)
  "Return lists (pattern negated-p) of the patterns in QUERY. NEGATED-P is true inside of NOT."
  (case (query-operator query)
    ((nil) (list (list query negated-p)))
    ((and or) (loop for part in (rest query) append (used-patterns part negated-p)))
    (not (used-patterns (second query) t))
    (within (list (list (third query) negated-p)))))

(defun rules-used (rule rules &optional only-negated-p)
  "Return those of RULES that RULE uses; if ONLY-NEGATED-P is true, those that it uses in a NOT."
  (let ((patterns (used-patterns (memory-rule-query rule))))
    (remove-if-not (lambda (other)
                     (loop for (pattern negated-p) in patterns
                           thereis (and (or negated-p (not only-negated-p))
                                        (not (eq :fail (bind-head (memory-rule-head other)
                                                                  pattern '()))))))
                   rules)))

(defun rule-path (from to rules &optional (seen (list from)))
  "Return a list of rules by which FROM uses TO, both included, or NIL."
  (if (eq from to)
      (list to)
      (loop for next in (rules-used from rules)
            for path = (if (eq next to)
                           (list to)
                           (and (not (member next seen))
                                (progn (push next seen) (rule-path next to rules seen))))
            when path return (cons from path))))

(defun check-negation (rules)
  "Signal MISUSE if one of RULES uses itself through a NOT."
  (dolist (rule rules)
    (dolist (other (rules-used rule rules t))
      (let ((path (rule-path other rule rules)))
        (when path
          (reject-use "The memory rule ~(~A~) uses itself through NOT~@[, by way of ~{~(~A~)~^, ~
                       ~}~]. Then it is unclear what follows. Use NOT only with facts, and with ~
                       rules that do not use this one."
                      (memory-rule-name rule)
                      (mapcar #'memory-rule-name (butlast path))))))))

(defun install-memory-rule (rule)
  "Define RULE in place of a rule of the same name. Return its name. Signals MISUSE if a rule would
use itself through a NOT."
  (check-negation (cons rule (remove (memory-rule-name rule) (all-memory-rules)
                                     :key #'memory-rule-name)))
  (register *memory-rules* (memory-rule-name rule) rule)
  (memory-rule-name rule))

(defmacro define-memory-rule (name head query &optional documentation)
  "Define the rule NAME: facts that match HEAD, a pattern, follow whenever QUERY holds; see
MEMORY-QUERY. Rules may use themselves and each other in any way, but not in circles through NOT.
Return NAME. Signals MALFORMED-DEFINITION, and MISUSE at such a circle."
  (let ((definition (definition-title "define-memory-rule" name)))
    (unless (and name (symbolp name) (not (keywordp name)))
      (reject-clause definition name "a symbol as the name"))
    (unless (pattern-valid-p head)
      (reject-clause definition head "a pattern of facts, such as (near ?a ?b)"))
    (unless (query-valid-p query)
      (reject-clause definition query *query-syntax*))
    (unless (typep documentation '(or null string))
      (reject-clause definition documentation "a string"))
    `(install-memory-rule (make-memory-rule ',name ',head ',query ,documentation))))
