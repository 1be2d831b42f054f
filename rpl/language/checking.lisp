;;;; checking.lisp -- whether what a plan calls exists, and takes the arguments given.

(in-package :ars-magna.rpl.language)

(export '(style-warn-of-form style-warn-of-plan-text advice-on-call find-call fail-p may-return-p
          endless-whenever-p))

;;; Plans and functions may be defined in any order, and in several files. So calls are looked at
;;; when all has been read that is compiled or loaded together, as Lisp does with its functions.
;;; Calls in Lisp code are checked by Lisp.

(defun warn-at-form (warn form control arguments)
  (call-at-source-location form
                 (lambda ()
                   (funcall warn "~A~@[ (~A)~]: ~A" (text-title) (clause-location form)
                            (let ((*print-case* :downcase) (*print-pretty* nil))
                              (apply #'format nil control arguments))))))

(defun warn-of-form (form control &rest arguments)
  (warn-at-form #'warn-of-definition form control arguments))

(defun style-warn-of-form (form control &rest arguments)
  "Warn of FORM as WARN-OF-STYLE does."
  (warn-at-form #'warn-of-style form control arguments))

(defun style-warn-of-plan-text (form control &rest arguments)
  "If FORM belongs to the text of the plan itself, warn as STYLE-WARN-OF-FORM does."
  (when (plan-text-p form)
    (warn-at-form #'warn-of-style form control arguments)))

(defun known-operators (&optional (package *package*))
  "Return operator names, longer than one letter, that a misspelt call in PACKAGE could mean."
  (let ((names (declared-names)))
    (do-symbols (symbol package names)
      (when (and (known-function-p symbol nil)
                 (not (lisp-symbol-p symbol))
                 (< 1 (length (symbol-name symbol))))
        (push symbol names)))))

(defun nearest-operator (name)
  (let ((nearest (and (< 1 (length (symbol-name name)))
                      (nearest-name name (known-operators)))))
    (and nearest (plain-name nearest))))

(defun check-arguments-fit (form lambda-list)
  (let ((trouble (arguments-misfit-text (lambda-list-shape lambda-list) (rest form))))
    (when trouble
      (warn-of-form form "~(~A~) takes ~A, not ~A."
                    (first form) (lambda-list-text lambda-list) trouble))))

(defun nisp-namesake (name)
  "Return the construct or function of NISP that has the same name as NAME, another symbol; or NIL."
  (multiple-value-bind (symbol status)
      ;; To packages with local nicknames NISP may mean another.
      (let ((*package* (find-package "KEYWORD"))) (find-symbol (symbol-name name) "NISP"))
    (and (eq :external status) (not (eq symbol name)) (fboundp symbol) symbol)))

(defun warn-of-namesake (form)
  "Warn if FORM, a form that the author wrote, uses a macro of the Lisp system with the name of a
construct of NISP. In packages that do not use NISP, WAIT-FOR is such a macro."
  (let ((name (first form)))
    (when (and *definition*
               (lisp-symbol-p name)
               (not (eq (find-package "COMMON-LISP") (symbol-package name)))
               (nisp-namesake name))
      (style-warn-of-form form "~(~A~) is not the construct of plans, which belongs to NISP. Write ~
                                (in-package :ars-user), or nisp:~:*~(~A~)." (symbol-name name)))))

(defgeneric advice-on-call (name)
  (:documentation "Return sentences about why the symbol NAME is not the name of a plan procedure or
function, and what to write instead; or NIL. Other layers add methods for the names they know.")
  (:method (name) (declare (ignore name)) nil))

(defun unknown-call-remedy (name)
  "NAME is no plan procedure or function. Return NAME and what to write instead, as text; or NIL."
  (let ((namesake (find-procedure name nil)) (advice (advice-on-call name)))
    (cond (namesake
           (format nil "~(~S~). If you mean the plan in another package, write ~(~S~)."
                   name (procedure-name namesake)))
          (advice (format nil "~(~A~): ~A" name advice))
          ((known-fluent-variable-p name)
           (format nil "~(~A~). It is a fluent: leave out the parentheses." name))
          ((nisp-namesake name)
           (format nil "~(~S~); the package NISP has one. Write (in-package :ars-user), or let ~
                        your package use NISP." name)))))

(defun warn-of-unknown-call (form)
  (let* ((name (first form)) (remedy (unknown-call-remedy name)))
    (cond (remedy (style-warn-of-form form "there is no plan procedure or function ~A" remedy))
          ((same-name-p name "TAG")
           (style-warn-of-form form "a tag has a colon: (:tag name form...)."))
          (t
           (style-warn-of-form form "there is no plan procedure or function ~(~A~).~@[ Did you ~
                                     mean ~A?~]"
                               name (nearest-operator name))))))

(defun check-known-call (form)
  "Warn if the call FORM is wrong by the definitions known now."
  (let ((name (first form)))
    (cond ((procedure-name-p name) (check-arguments-fit form (known-lambda-list name)))
          ((macro-function name)
           (warn-of-form form "~(~A~) is a macro that is defined only after this call." name))
          ((known-function-p name nil)
           (multiple-value-bind (arguments known) (function-argument-types name)
             (when known (check-arguments-fit form arguments))))
          (t (warn-of-unknown-call form)))))

(defun check-later (check form)
  "At the end of the compilation unit, call CHECK with FORM in the present file and package."
  (let ((definition *definition*) (package *package*) (file *compile-file-truename*)
        (loaded *load-truename*))
    (at-end-of-unit form
                    (lambda ()
                      (when (package-name package) ; which may have been deleted
                        (let ((*definition* definition) (*package* package)
                              (*compile-file-truename* file) (*load-truename* loaded))
                          (funcall check form)))))))

(defun check-call (form scope)
  "Warn if FORM, a call of a plan or of an unknown function in SCOPE, is wrong. Calls of global
names are checked at the end of the compilation unit."
  (let ((local (assoc (first form) (scope-procedures scope))))
    (if local
        (check-arguments-fit form (fourth local))
        (check-later #'check-known-call form))))

(defun check-lisp-call (form)
  "Warn if FORM, a call inside a Lisp form in which plans cannot wait, turns out to call a plan."
  (when (procedure-name-p (first form))
    (warn-of-form form "~(~A~) is a plan procedure that is defined only later. A plan procedure ~
                        cannot be called inside a lambda, or another form that only Lisp runs."
                  (first form))))

(defun missing-list-text (part expected)
  "Return a text which says that PART, a name, must be a list of the shape EXPECTED; or NIL."
  (let ((name (if (typep part '(cons (eql quote) (cons symbol null))) (second part) part)))
    (and name
         (typep name '(or symbol real))
         (not (member (first expected) lambda-list-keywords))
         (format nil "~(~S~): write (~(~A~))" part name))))

(defun missing-keyword-text (shape rest)
  "Return a text which says that a keyword of SHAPE is missing before the forms REST; or NIL."
  (let ((value (first rest)))
    (and (oddp (length rest))
         (not (keywordp value))
         (format nil "~(~S: write ~{~A~^ or ~}~)" value
                 (loop for key in (shape-keys shape) collect (format nil "~S ~S" key value))))))

(defun argument-mistake-text (form lambda-list)
  "Return a text about a mistake in the arguments of FORM or in a list of options in FORM; or NIL.
FORM calls a construct with LAMBDA-LIST. A mistake is a keyword that LAMBDA-LIST does not have, or
another form in the place of a keyword or a list of options."
  (let ((shape (lambda-list-shape lambda-list)))
    (and (proper-list-p form)
         (or (and (consp (shape-keys shape))
                  (let ((rest (nthcdr (shape-fixed shape) (rest form))))
                    (or (unknown-keyword-text shape rest) (missing-keyword-text shape rest))))
             (loop for part in (rest form)
                   for expected in lambda-list
                   until (member expected lambda-list-keywords)
                   thereis (and (consp expected)
                                (or (missing-list-text part expected)
                                    (argument-mistake-text (cons (first form) part) expected))))))))

(defun find-call (test forms)
  "Return the first call in FORMS for which TEST is true, or NIL. Do not search code that is called
later, nor inside a call for which TEST returns :NOWHERE."
  (loop for tail = forms then (rest tail)
        while (consp tail)
        thereis (let* ((form (first tail)) (answer (and (consp form) (funcall test form))))
                  (cond ((or (atom form) (eq :nowhere answer)) nil)
                        (answer form)
                        ((not (member (first form) '(quote function lambda)))
                         (find-call test form))))))

(defun fail-p (form)
  "True if FORM is a call of FAIL."
  (operator-in-p form '("FAIL")))

;;; Forms after a form that never ends.

(defun may-return-p (form)
  "True if FORM leaves a block, or is a macro call that may expand to such a form."
  (or (operator-in-p form '("RETURN" "RETURN-FROM" "GO"))
      (let ((operator (first form)))
        (and (symbolp operator)
             (symbol-package operator)
             (macro-function operator)
             (let ((home (package-name (symbol-package operator))))
               (not (or (string= "COMMON-LISP" home)
                        (and (starts-with-subseq "ARS-MAGNA." home)
                             (eq :external (nth-value 1 (find-symbol (string operator)
                                                                     home)))))))))))

(defun endless-whenever-p (form)
  "True if FORM is a WHENEVER that only a failure or a form around it can end."
  (and (consp form)
       (operator-in-p form '("WHENEVER"))
       (null (find-call #'may-return-p (rest form)))))

(defun check-after-whenever (forms)
  "Warn if one of FORMS, a list of steps, is a WHENEVER that never ends and is not the last step."
  (let ((form (find-if #'endless-whenever-p (butlast forms))))
    (when (and form *definition*)
      (style-warn-of-form form
                          "the forms after whenever never run, because whenever goes on until a ~
                           form in it calls (return). Put whenever and these forms into (par ...), ~
                           or use (with-policy (whenever ...) body...)."))))

;;; Variables.

(defun warn-of-unused-bindings (variables where form)
  "Warn about each of VARIABLES, bound by FORM, that the list of forms WHERE does not mention."
  (when (has-source-location-p form)
    (dolist (variable variables)
      (when (and (symbol-package variable) (not (mentions-p variable where)))
        (style-warn-of-form form "the variable ~(~A~) is never used. If this is intended, write ~
                                  (declare (ignore ~:*~(~A~)))." variable)))))

(defun check-distinct-variables (variables form)
  (let ((twice (loop for (variable . more) on variables
                     when (member variable more) return variable)))
    (when twice
      (reject-clause (text-title) form
                     (format nil "each variable once: ~(~A~) is bound twice" twice)))))
