;;;; slips.lisp -- suggestions for undefined functions and variables; tests that are never true.

(in-package :ars-magna.definitions)

(export '(note-error-code similar-variable variable-elsewhere-text note-dispatch-character
          value-to-pass-text function-of-command public-function-named doubtful-test-text
          map-calls map-comparisons compared-words test-forms value-forms-in wrong-error-code-text))

(defun public-function-named (name)
  "Return two values if ARS or NISP exports a function named NAME, a string or symbol: the symbol of
this function, and the name of that package. Else return NIL."
  ;; A user's package may have local nicknames.
  (let ((*package* (find-package "KEYWORD")))
    (dolist (package '("ARS" "NISP"))
      (multiple-value-bind (symbol status)
          (and (find-package package) (find-symbol (string name) package))
        (when (and (eq :external status) (fboundp symbol)) (return (values symbol package)))))))

;;; Names in other packages.

(defun user-packages ()
  "Return a list of the packages that use ARS, except the simulator's own. ARS-USER is first."
  (let ((ours (find-package "ARS-USER")))
    (cons ours
          (remove-if (lambda (package)
                       (or (eq ours package)
                           (starts-with-subseq "ARS-MAGNA" (package-name package))))
                     (and (find-package "ARS") (package-used-by-list "ARS"))))))

(defun other-package-text (name predicate)
  "Look in other users' packages for a symbol with the name of NAME that fulfils PREDICATE. Return a
sentence that says how to use this symbol; or NIL if there is no such symbol."
  (dolist (package (user-packages))
    (multiple-value-bind (symbol status) (find-symbol (symbol-name name) package)
      (when (and symbol (not (eq symbol name)) (funcall predicate symbol))
        (return
          (if (and (eq :external status) (eq package (symbol-package symbol)))
              (format nil "There is ~(~A:~A~)." (package-name package) symbol)
              (format nil "The package ~A has it: type (in-package :~(~:*~A~)) first."
                      (package-name package))))))))

(defun accessible-symbols (package test)
  "Return a sorted list of the symbols accessible in PACKAGE that pass TEST, except Common Lisp's."
  (let ((symbols '()) (lisp (find-package "COMMON-LISP")))
    (do-symbols (symbol package)
      (when (and (not (eq lisp (symbol-package symbol))) (funcall test symbol))
        (pushnew symbol symbols)))
    (sort symbols #'string<)))

;;; Functions.

(defgeneric function-of-command (name)
  (:documentation "If NAME, a symbol without a function, is a command at the prompt, return the name
of the function that it calls; else NIL. The layer that defines commands has a method.")
  (:method (name) (declare (ignore name)) nil))

(defun undefined-function-text (name)
  (when (and (symbolp name) (symbol-package name))
    (multiple-value-bind (ours package)
        (public-function-named (or (function-of-command name) name))
      (if ours
          (if (eq ours (find-symbol (symbol-name ours) (symbol-package name)))
              (format nil "In Lisp, the function is ~(~A~)." ours)
              (format nil "The package ~A has it: write ~(~:*~A:~A~), or type (in-package ~
                           :ars-user) first."
                      package ours))
          (similar-function-text name)))))

(defun similar-function-text (name)
  (flet ((like-p (symbol)
           (and (fboundp symbol) (misspelling-p name symbol))))
    (or (other-package-text name #'fboundp)
        (let ((like (nearest-name name (accessible-symbols (symbol-package name) #'like-p))))
          (and like (format nil "Did you mean ~(~A~)?" (unqualified-text like)))))))

;;; Variables.

(defun run-variables-p (registry)
  (same-name-p 'run-variable (registry-kind registry)))

(defun definition-name-hint (name)
  "If the unbound symbol NAME names a definition, return a sentence that says so; else NIL."
  (loop for registry in (users-registries)
        for entry = (lookup-entry name registry)
        when (and entry (not (entry-variable entry)))
          return (if (run-variables-p registry)
                     "Define a run variable before the code that uses it, and compile that again."
                     (format nil "It is the name of ~:[a~;an~] ~A: write '~(~A~)."
                             (find (char (registry-usual-name registry) 0) "aeiou")
                             (registry-usual-name registry) (unqualified-text name)))))

(defun variable-elsewhere-text (name)
  "Return a sentence on a variable with the name of the symbol NAME in another package of users, or
NIL."
  (other-package-text name (lambda (symbol)
                             (or (boundp symbol) (nth-value 1 (macroexpand-1 symbol))))))

(defun similar-variable (name)
  "Return the name, in lower case, of a variable that the unbound symbol NAME may misspell; or NIL."
  (let ((meant (and (symbol-package name)
                    (first (accessible-symbols (symbol-package name)
                                               (lambda (symbol)
                                                 (and (misspelling-p name symbol)
                                                      (member (variable-kind symbol)
                                                              '(:special :symbol-macro))
                                                      (not (constantp symbol)))))))))
    (and meant (string-downcase (unqualified-text meant)))))

(define-global *error-codes* '() "The error codes of commands, keywords.")

(defun note-error-code (code)
  "Register CODE, a keyword, as an error code of commands."
  (pushnew code *error-codes*))

(defun unbound-variable-text (name)
  (when (and (symbolp name) (symbol-package name))
    (let ((code (find name *error-codes* :test #'string=)))
      (or (and code (format nil "Did you mean ~(~S~)?" code))
          (variable-elsewhere-text name)
          (definition-name-hint name)
          (let ((like (similar-variable name)))
            (and like (format nil "Did you mean ~A?" like)))))))

;;; Syntax.

(defvar *dispatch-remedies* '() "Lists (character remedy) for # characters of other readtables.")

(defun note-dispatch-character (character remedy)
  "Register the sentence REMEDY for the error that Lisp cannot read # followed by CHARACTER."
  (pushnew (list character remedy) *dispatch-remedies* :test #'equal))

(defun unreadable-syntax-text (condition)
  "If CONDITION is about unreadable syntax, return a sentence on how to make it readable; or NIL."
  (let ((character (and (typep condition 'simple-condition)
                        (starts-with-subseq "no dispatch function"
                                            (simple-condition-format-control condition))
                        (first (simple-condition-format-arguments condition)))))
    (and character (second (assoc character *dispatch-remedies* :test #'char-equal)))))

;;; A run variable is a symbol macro, of which DEFVAR and DEFPARAMETER cannot make a variable.

(defun proclaimed-run-variable-text (condition)
  "If CONDITION is that a run variable cannot become a special variable, return a remedy; or NIL."
  (when (starts-with-subseq "Cannot proclaim" (simple-condition-format-control condition))
    (loop with run-variables = (find-if #'run-variables-p (users-registries))
          for name in (simple-condition-format-arguments condition)
          when (and name (symbolp name) (lookup-entry name run-variables))
            return (format nil "~(~A~) is a run variable, which has a separate value in each run: ~
                                ~:*remove its DEFVAR or DEFPARAMETER, or first evaluate (undefine ~
                                'run-variable '~(~A~))."
                           name))))

;;; Types.

(defgeneric value-to-pass-text (datum)
  (:documentation "If DATUM is an argument of the wrong type, return a sentence that says which
value to pass in its place; or NIL.")
  (:method (datum)
    (declare (ignore datum))
    nil))

(defun returning-function-known-p (type)
  "True if the description of TYPE, an argument type, says which function returns such an object."
  (and (simulator-symbol-p (argument-type-name type))
       (search " returns" (argument-type-words type))))

(defun type-remedy (datum type)
  "Return a sentence that says why DATUM is no argument of TYPE, or which value to give; or NIL."
  (let ((type (and (symbolp type) (find-argument-type type nil))))
    (when (and type (or (argument-trouble-text datum type) (returning-function-known-p type)))
      (add-full-stop (format nil "Give ~A" (argument-type-text type datum))))))

(defun error-hint (condition)
  "Return a sentence on what the user meant or should do, after the Lisp error CONDITION; or NIL."
  (typecase condition
    (undefined-function (undefined-function-text (cell-error-name condition)))
    (unbound-variable (unbound-variable-text (cell-error-name condition)))
    (reader-error (unreadable-syntax-text condition))
    (simple-error (proclaimed-run-variable-text condition))
    (type-error (or (type-remedy (type-error-datum condition)
                                 (type-error-expected-type condition))
                    (value-to-pass-text (type-error-datum condition))))))

(setf *report-addition* #'error-hint)

;;;; Tests that are never true, or always

(defgeneric doubtful-test-text (form)
  (:documentation "Return a sentence that says why FORM, a test in Lisp code, is probably a mistake;
or NIL. The layer that defines fluents has methods.")
  (:method (form) (declare (ignore form)) nil))

;;; Words that something is compared with: keywords, and what may be meant for one.

(defun word-constant-p (object)
  "True if OBJECT, a constant, may be meant as a word such as an error code."
  (or (stringp object) (and (symbolp object) (not (member object '(nil t otherwise))))))

(defun word-constants-in (object)
  (if (consp object)
      (remove-if-not #'word-constant-p (ldiff object (cdr (last object))))
      (and (word-constant-p object) (list object))))

(defun constant-word (form)
  (cond ((typep form '(cons (eql quote) (cons symbol null))) (second form))
        ((or (keywordp form) (stringp form)) form)))

(defun compared-words (form)
  "If FORM compares a subform with constant words, return a list of them and the subform; else NIL."
  (let ((arguments (rest form)))
    (flet ((is (count &rest names)
             (and (member (first form) names)
                  (proper-list-p arguments)
                  (= count (length arguments)))))
      (cond ((and (is 2 'eq 'eql 'equal) (constant-word (second arguments)))
             (values (word-constants-in (constant-word (second arguments))) (first arguments)))
            ((is 2 'eq 'eql 'equal)
             (values (word-constants-in (constant-word (first arguments))) (second arguments)))
            ((and (is 2 'member) (typep (second arguments) '(cons (eql quote) (cons t null))))
             (values (word-constants-in (second (second arguments))) (first arguments)))
            ((and (member (first form) '(case ecase ccase)) (proper-list-p arguments))
             (values (loop for clause in (rest arguments)
                           when (consp clause) append (word-constants-in (first clause)))
                     (first arguments)))))))

(defun map-calls (function form)
  "Call FUNCTION with each list in the code FORM that may be a call. Skip quoted lists."
  (when (and (consp form) (not (eq 'quote (first form))))
    (funcall function form)
    (loop for rest = form then (cdr rest)
          while (consp rest) do (map-calls function (car rest)))))

(defun map-comparisons (function form)
  "Call FUNCTION for each comparison with a constant symbol or string, a word, in the code FORM. Its
arguments are the compared form, the word, and the form that compares them."
  (map-calls (lambda (call)
               (multiple-value-bind (words subject) (compared-words call)
                 (dolist (word words) (funcall function subject word call))))
             form))

;;; Where values are used.

(defun lisp-call-p (form &rest names)
  "True if FORM, a proper list, calls an operator of Lisp or the simulator named by one of NAMES."
  (and (typep form '(cons symbol))
       (proper-list-p form)
       (not (users-symbol-p (first form)))
       (member (first form) names :test #'string=)
       t))

(defun test-forms (form)
  "Return a list of the tests in FORM, if FORM is a conditional such as IF or COND."
  (cond ((lisp-call-p form "IF" "WHEN" "UNLESS") (list (second form)))
        ((lisp-call-p form "COND") (mapcar #'first (remove-if #'atom (rest form))))))

(defun value-forms-in (form)
  "Return a list of the forms whose values the form FORM binds, stores or tests."
  (cond ((lisp-call-p form "LET" "LET*")
         (loop for binding in (and (proper-list-p (second form)) (second form))
               when (typep binding '(cons t (cons t null))) collect (second binding)))
        ((lisp-call-p form "SETQ" "SETF") (loop for (nil value) on (rest form) by #'cddr
                                             collect value))
        ((lisp-call-p form "DOLIST") (and (typep (second form) '(cons t (cons t)))
                                       (list (second (second form)))))
        ((lisp-call-p form "CASE" "ECASE") (list (second form)))
        (t (test-forms form))))

;;; Error codes of commands.

(define-constant +words-of-success+ '(:done :ok :okay :success :succeeded :none :no-error)
  :test #'equal
  :documentation "Words that users mistake for the error code of a command that has succeeded.")

(defun similar-error-code (word)
  "Return the error code that the user perhaps meant by WORD, which is no error code; or NIL."
  (or (nearest-name word *error-codes*)
      (find-if (lambda (code)
                 (let ((code (symbol-name code)) (word (symbol-name word)))
                   (or (ends-with-subseq (format nil "-~A" word) code)
                       (starts-with-subseq (format nil "~A-" word) code))))
               *error-codes*)))

(defun wrong-error-code-text (word)
  "If no command ends with the error code WORD, return a sentence that says why; else NIL."
  (let ((code (find word *error-codes* :test #'string-equal)))
    (cond ((not (keywordp word))
           (and code
                (format nil "~(~S~) is no error code, because error codes are ~
                             keywords. Write ~(~S~)."
                        word code)))
          (code nil)
          ((member word +words-of-success+)
           (format nil "no command ends with ~(~S~): the error code of a command that ~
                        succeeds is NIL."
                   word))
          (t (let ((like (similar-error-code word)))
               (and like
                    (format nil "no command ends with ~(~S~). Did you mean ~(~S~)?" word like)))))))
