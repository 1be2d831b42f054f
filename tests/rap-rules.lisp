;;;; rap-rules.lisp -- rules of the memory give what a model of them gives.

(in-package :ars-magna.tests.rap)

(in-suite ars-magna.tests::rap)

;;; The model works forwards: it adds what follows to a list of facts until nothing new follows.
;;; Queries of its rules are lists of patterns, comparisons and (not pattern). Rules of the relation
;;; s may use NOT with r, which has no rules, and with p, q and t, whose rules do not use s.

(defun model-bindings (pattern fact bindings)
  "Return the extension of BINDINGS by which PATTERN matches FACT, or :FAIL."
  (loop for part in pattern
        for value in fact
        for binding = (assoc part bindings)
        do (cond ((not (member part '(?x ?y ?z))) (unless (eql part value) (return :fail)))
                 ((null binding) (push (cons part value) bindings))
                 ((not (eql value (cdr binding))) (return :fail)))
        finally (return bindings)))

(defun model-solutions (queries facts bindings)
  (if (null queries)
      (list bindings)
      (destructuring-bind (query . more) queries
        (flet ((go-on (bindings) (model-solutions more facts bindings)))
          (case (first query)
            (not (if (model-solutions (rest query) facts bindings) '() (go-on bindings)))
            ((< /=) (if (apply (first query) (model-instance (rest query) bindings))
                        (go-on bindings)
                        '()))
            (t (loop for fact in facts
                     for extended = (model-bindings query fact bindings)
                     unless (eq :fail extended) append (go-on extended))))))))

(defun model-closure (rules facts)
  "Return FACTS with all that follows by RULES, lists (head query...)."
  (loop
    (let ((new (set-difference
                (remove-duplicates
                 (loop for (head . queries) in rules
                       append (loop for bindings in (model-solutions queries facts '())
                                    collect (model-instance head bindings)))
                 :test #'equal)
                facts :test #'equal)))
      (unless new (return facts))
      (setf facts (append new facts)))))

(defun random-rule (relations used)
  "Return a rule (head query...) for one of RELATIONS, by patterns of the relations USED."
  (let ((places (pick '(((?x ?y)) ((?x ?y)) ((?y ?x)) ((?x ?z) (?z ?y)) ((?x ?z) (?z ?y))
                        ((?z ?x) (?z ?y)) ((?x ?y) (?y ?z) (?z ?x)) ((?x 1) (?y 2))))))
    (append (list (list (pick relations) '?x '?y))
            (loop for place in places collect (cons (pick used) place))
            (when (and (member 's relations) (zerop (random 2)))
              `((not (,(pick '(p q r t)) ,(pick '(?x ?y 1)) ?y))))
            (when (zerop (random 6)) `((,(pick '(< /=)) ,(pick '(?x 3)) ?y))))))

(defun random-rules ()
  "Return a list of rules for p, q and t, and a list of rules for s."
  (list (loop repeat (+ 2 (random 5)) collect (random-rule '(p q t) '(p q t r r)))
        (loop repeat (random 3) collect (random-rule '(s) '(p q t r s)))))

(defun call-with-rules (function rules)
  "Define RULES, lists (head query...), call FUNCTION, and remove them."
  (let ((names (loop for nil in rules
                     for number from 1
                     collect (intern (format nil "RANDOM-RULE-~D" number)
                                     :ars-magna.tests.rap))))
    (unwind-protect
         (progn (loop for (head . queries) in rules
                      for name in names
                      do (eval `(define-memory-rule ,name ,head (and ,@queries))))
                (funcall function))
      (dolist (name names)
        (handler-case (undefine 'memory-rule name) (unknown-name () nil))))))

(defun wrong-answers (rules)
  "Return a list (pattern answers expected) for random facts under RULES, or NIL."
  (let* ((facts (remove-duplicates
                 (loop repeat (random 10)
                       collect (list (pick '(p r r r)) (1+ (random 6)) (1+ (random 6))))
                 :test #'equal))
         (all (model-closure (second rules) (model-closure (first rules) facts))))
    (in-rap-run
      (mapc #'memory-add facts)
      (loop for relation in '(p q r s t)
            append (loop for (a b) in '((?x ?y) (1 ?y) (?x 2) (3 3) (?x ?x))
                         for pattern = (list relation a b)
                         for right = (remove-if (lambda (fact)
                                                  (eq :fail (model-bindings pattern fact '())))
                                                all)
                         for answers = (memory-query pattern pattern)
                         when (set-exclusive-or right answers :test #'equal)
                           collect (list pattern answers right))))))

(test rap-rules.random-rules-give-what-their-model-gives
  (let ((*random-state* (sb-ext:seed-random-state 11)) (wrong '()) (more 0))
    (dotimes (i 150)
      (let ((rules (random-rules)))
        (call-with-rules (lambda ()
                           (let ((found (wrong-answers rules)))
                             (when found (push (list rules found) wrong))))
                         (apply #'append rules))
        (when (rest (first rules)) (incf more))))
    (is (null wrong) "~S" (first wrong))
    (is (< 50 more))))

(define-memory-rule rap-left (left ?a ?b) (or (road ?a ?b) (and (left ?a ?c) (road ?c ?b))))
(define-memory-rule rap-both (both ?a ?b) (or (road ?a ?b) (and (both ?a ?c) (both ?c ?b))))
(define-memory-rule rap-longer (longer (box ?a)) (longer ?a))

(test rap-rules.rules-may-begin-with-themselves-and-use-themselves-twice
  (in-rap-run
    (loop for i from 9 downto 0 do (memory-add (list 'road i (1+ i))))
    (is (equal '(1 2 3 4 5 6 7 8 9 10) (memory-query '?x '(left 0 ?x))))
    (is (equal '(0 1 2 3 4 5 6 7 8 9) (sort (memory-query '?x '(both ?x 10)) #'<)))
    (memory-add '(road 10 0))
    (is (= 121 (length (memory-query '(?x ?y) '(both ?x ?y)))))
    (is (equal '(10) (memory-query '?x '(and (left 3 ?x) (road ?x 0)))))))

(test rap-rules.rules-without-end-are-refused
  (in-rap-run
    (is (null (memory-query '?x '(longer ?x))))
    (memory-add '(longer cup))
    (signals misuse (memory-query '?x '(longer ?x)))))

(test rap-rules.circles-through-not-are-refused
  (flet ((refusal (rules)
           (handler-case (call-with-rules (lambda () nil) rules)
             (misuse (condition) (princ-to-string condition)))))
    (is (search "random-rule-1 uses itself through NOT"
                (refusal '(((p ?x) (q ?x) (not (p ?x)))))))
    (is (search "by way of random-rule-2"
                (refusal '(((p ?x) (q ?x) (not (s ?x))) ((s ?x) (q ?x) (p ?x))))))
    (is (null (refusal '(((state ?x on) (lamp ?x) (not (state ?x off))) ((p ?x) (p ?x))))))))

;; Each round finds one more.
(define-memory-rule rap-odd (odd-step ?x) (even-step ?x))
(define-memory-rule rap-start (odd-step ?x) (start ?x))
(define-memory-rule rap-even (even-step ?y) (and (odd-step ?x) (road ?x ?y)))

(test rap-rules.rounds-go-on-until-nothing-new-follows
  (in-rap-run
    (memory-add '(start 0))
    (dotimes (i 8) (memory-add (list 'road i (1+ i))))
    (is (equal '(0 1 2 3 4 5 6 7 8) (sort (memory-query '?x '(odd-step ?x)) #'<)))))

(define-rap (index (rap-weigh ?limit))
  (method (context (and (weight ?thing ?w) (value ?twice (* 2 ?w)) (< ?twice ?limit)
                        (value ?twice (+ ?w ?w))))
          (primitive (note-rap (list thing twice)))))

(test rap-rules.values-of-forms-are-given-to-variables
  (is (equal '((0 (cup 6)))
             (rap-notes (memory-add '(weight pan 9))
                        (memory-add '(weight cup 3))
                        (memory-add '(weight pot 7))
                        (run-plan 'rap-weigh 10))))
  (in-rap-run (signals wrong-argument (memory-query '?x '(value ?x (+ 1 2)))))
  (is (search "(value ?x form)"
              (rap-mistake '(define-rap (index (foo)) (succeed (value 3 (+ 1 2)))
                             (method (primitive 1)))))))
