;;;; map-clauses.lisp -- DEFINE-MAP-CLAUSE: the kinds of clauses that a map can have (manual 5.1).

(in-package :ars-magna.world)

(export '(*map-clauses* all-clause-kinds))

;;; A definition says everything about a kind of clause: how it is written, which arguments are
;;; valid, and what it expands to. Our own kinds draw walls or make things; users' kinds expand to
;;; other clauses. So a map stores only clauses of our kinds, and its cache depends on nothing else.

(define-record (clause-kind (:constructor make-clause-kind (name usage derived-p function)))
  "A kind of clause that DEFMAP accepts."
  (name nil symbol "the symbol that clauses of the kind begin with" :export)
  (usage "" string "how clauses of the kind are written, a string" :export)
  (derived-p nil boolean "the clauses expand to other clauses")
  (function nil function "the function of an option, a map and a clause that returns the value of
the form for the option"))

(define-registry map-clause "kind of map clause" :sealed t :internal t
  :finder find-clause-kind :lister all-clause-kinds)

(defun map-title (map) (definition-title "defmap" (map-name map)))

(defun clause-value (option map clause &optional (kind (find-clause-kind (first clause))))
  "KIND, the kind of CLAUSE, may have a form for OPTION. Return the value of the form for CLAUSE of
MAP; NIL if there is no such form."
  (funcall (clause-kind-function kind) option map clause))

(defun kind-of-clause (map clause)
  (let ((kind (and (typep clause '(cons symbol)) (find-clause-kind (first clause) nil))))
    (cond ((null kind)
           (let ((names (defined-names *map-clauses*)))
             (reject-clause (map-title map) clause
                            (if (typep clause '(cons (eql quote)))
                                "a clause without a quote, as it is not evaluated"
                                (format nil "a clause: ~{~(~A~)~#[~; or ~:;, ~]~}~@[; did you mean ~
                                             ~(~A~)?~]"
                                        names
                                        (and (typep clause '(cons symbol))
                                             (nearest-name (first clause) names)))))))
          ((proper-list-p clause) kind)
          (t (reject-clause (map-title map) clause
                            "a clause without a dot before its last element")))))

(defun check-clause (map clause kind)
  (unless (handler-case (clause-value :check map clause kind)
            (malformed-definition (condition) (error condition))
            (error () nil))
    (reject-clause (map-title map) clause
                   (format nil "~A~:[~;. Write it without quotes: it is not evaluated~]"
                           (clause-kind-usage kind) (has-quote-p clause)))))

;;; Expansion. The parts of a map are walls, rects and circles, and recipes of things.

(defun wrong-derivation-text (kind condition)
  "CONDITION rejects the expansion of a clause of KIND. Return a text on what to write instead."
  (let ((*print-pretty* nil))
    (format nil "~A; the clause expands to ~(~S~), where there should be ~
                 ~A" (clause-kind-usage kind)
            (abridged (malformed-definition-clause condition))
            (malformed-definition-expected condition))))

(defun derived-parts (map clause kind depth)
  "Return the parts that CLAUSE of MAP, a clause of KIND, expands to. Mistakes in the parts are
reported as mistakes of CLAUSE."
  (when (< 50 depth)
    (reject-clause (map-title map) clause "a clause whose expansion ends within 50 steps"))
  (pushnew (clause-kind-name kind) (map-clause-kinds map))
  (handler-case (call-clause-code
                 (lambda ()
                   (loop for other in (clause-value :clauses map clause kind)
                         append (parts-of-clause map other (1+ depth))))
                 (map-title map) clause (clause-kind-usage kind))
    (malformed-definition (condition)
      (if (or (plusp depth) (eq clause (malformed-definition-clause condition)))
          (error condition)
          (reject-clause (map-title map) clause (wrong-derivation-text kind condition))))))

(defun parts-of-clause (map clause &optional (depth 0))
  "Return the parts that CLAUSE of MAP expands to. Signals MALFORMED-DEFINITION."
  (let ((kind (kind-of-clause map clause)))
    (check-clause map clause kind)
    (cond ((clause-kind-derived-p kind) (derived-parts map clause kind depth))
          ((clause-value :things map clause kind))
          (t (list clause)))))

(defun code-in-clause (map clause)
  "Return the code in CLAUSE of MAP, as CODE-IN-THING does. Return () for a clause of a user's kind
and, with a warning in a compiled file, for an invalid clause."
  (let ((code '()))
    (flet ((look ()
             (let ((kind (kind-of-clause map clause)))
               (unless (clause-kind-derived-p kind)
                 (check-clause map clause kind)
                 (setf code (clause-value :code map clause kind)))
               '())))
      (forms-or-rejection #'look t))
    code))

;;; Defining kinds.

(defun check-clause-definition (definition name lambda-list usage options)
  (check-name definition name "kind of clause")
  (unless (typep lambda-list '(cons (and symbol (not null))))
    (reject-clause definition lambda-list
                   "(map argument...), variables for the map and the rest of a clause"))
  (unless (stringp usage)
    (reject-clause definition usage "a string that shows a clause, as \"(door (x y) width)\""))
  (check-options definition options
                 `(:check :clauses
                   ,@(and *loading-simulator-p* '(:corners :substance :cells :things :code))))
  (let ((old (find-clause-kind name nil)))
    (unless (or *loading-simulator-p*
                (and (getf options :clauses) (or (null old) (clause-kind-derived-p old))))
      (reject-clause definition name
                     "a name that no built-in clause has, and :clauses with a form"))))

(defun clause-function-form (lambda-list options)
  (destructuring-bind (map . parameters) lambda-list
    (multiple-value-bind (whole parameters) (variable-after-key '&whole parameters)
      (with-gensyms (option clause kind)
        `(lambda (,option ,map ,clause)
           (declare (ignorable ,map))
           (destructuring-bind (,@(and whole `(&whole ,whole)) ,kind ,@parameters) ,clause
             (declare (ignore ,kind))
             (case ,option
               ,@(loop for (key form) on options by #'cddr collect `(,key ,form))
               ,@(unless (getf options :check) '((:check t))))))))))

(addition define-map-clause)
(define-user-macro define-map-clause (&whole form name lambda-list &optional usage
                                      &body options &environment environment)
  "Define clauses (NAME argument...) of DEFMAP. LAMBDA-LIST is a variable for the map, of which only
the name and size are known, and a macro lambda list for the arguments. The string USAGE shows a
clause, and is quoted in error messages. Options are forms:
  :clauses form -- the list of clauses, such as walls and things, that the clause expands to
  :check form -- true if the arguments are valid; by default the lambda list alone decides
Existing maps do not change. Return the name. Signals MALFORMED-DEFINITION."
  `(eval-when (:compile-toplevel :load-toplevel :execute)
     ,(expand-definition
       form environment
       (lambda ()
         (check-clause-definition (definition-title "define-map-clause" name) name lambda-list usage
                                  options)
         `((register *map-clauses* ',name
                     (make-clause-kind ',name ,(one-line usage) ,(and (getf options :clauses) t)
                                       ,(clause-function-form lambda-list options))))))))
