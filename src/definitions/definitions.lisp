;;;; definitions.lisp -- what all defining forms share: places in files, errors and restarts.

(in-package :ars-magna.definitions)

(export '(current-source *definition* definition-again make-defining reject-clause
          call-with-definition expand-definition forms-or-rejection title check-function-name
          other-definition-p in-file-p missing-name read-value clause-place current-form-digest
          endless-p has-quote-p))

;;; A defining form is checked when it is expanded, and performed when its expansion is evaluated.
;;; During both, *DEFINITION* holds it, so that an error names file and line, and restarts can leave
;;; the definition out, read it again from its file, or replace it.

(define-record (defining-form (:conc-name defining-) (:constructor make-defining (source form)))
  "The definition FORM, from SOURCE, that is being expanded or performed."
  (source '() list)
  (form '() list "the form that is being expanded or carried out" :export)
  (ordinal nil t "which of the forms of that operator and name in its file it is, from 0, once
looked up" :writable)
  (clause nil t "the part of it that was rejected last" :writable))

(defvar *definition* nil
  "The definition that is being expanded or performed, or NIL.")

(defun current-source ()
  "Return the source of the current definition, or else of the form being loaded; NIL if it was
typed."
  (if *definition*
      (defining-source *definition*)
      (source-here)))

(defun current-form-digest ()
  "Return the digest of the current definition's form, or NIL."
  (and *definition* (form-digest (defining-form *definition*))))

(defun current-operator-and-name ()
  (and *definition* (head (defining-form *definition*))))

(defun current-docstring ()
  "Return :documentation of the current definition, or the first string after its name, or NIL."
  (let* ((parts (and *definition* (cddr (defining-form *definition*))))
         (text (or (second (member :documentation parts)) (find-if #'stringp parts))))
    (and (stringp text) text)))

(defun title (operator name)
  "Return the title of the definition of NAME by OPERATOR for messages, such as \"defmap yard\"."
  (let ((name (abridged name)))
    (format nil "~(~A ~A~)" operator (if (keywordp name) (prin1-to-string name) name))))

(defun definition-text (definition)
  (let ((form (defining-form definition)))
    (title (first form) (second form))))

(defun clause-place (clause)
  "Return the place of CLAUSE of the current definition, such as \"yard.lisp, line 7\", or NIL."
  (let ((source (if *definition* (current-source) (source-here))))
    (when source
      (multiple-value-bind (line ordinal)
          (clause-line (source-file source)
                       (and *definition* (defining-form *definition*)) clause)
        (when *definition* (setf (defining-ordinal *definition*) ordinal))
        (format nil "~A~@[, line ~D~]" (source-file source)
                (or (line-in-text (source-file source) clause (place-in-text clause)) line))))))

(defun reject-clause (definition clause expected &optional (place (clause-place clause)))
  "Signal MALFORMED-DEFINITION about CLAUSE, at PLACE, of DEFINITION, a string such as \"defmap
watson\"."
  (when *definition* (setf (defining-clause *definition*) clause))
  (error 'malformed-definition :definition definition :clause clause :expected expected
                               :place place))

(defun check-function-name (definition name)
  "Signal MALFORMED-DEFINITION if NAME, of DEFINITION, is no name of a function, or is in a package
whose names users cannot define as functions."
  (unless (or (symbolp name) (and (consp name) (eq 'setf (first name))))
    (reject-clause definition name "a symbol as the name"))
  (let ((package (and (symbolp name) (symbol-package name))))
    (when (and package (package-locked-p package) (not (eq package *package*)))
      (reject-clause definition name
                     (format nil "a name that is free; ~A belongs to ~A. Call it my-~(~A~), or ~
                                  shadow the symbol in your package: (:shadow #:~(~A~))"
                             name (package-name package) name name)))))

;;; Restarts.

(addition skip-definition skip-clause read-again)
(document-restarts
 'skip-definition "Leave out the definition with the mistake. An earlier definition of that name
stays."
 'skip-clause "Leave out the clause of a map that has the mistake, and continue with the next."
 'read-again "Read the definition, or the clause, again from its file, after you have corrected it
there."
 'use-value "Use the value that you type instead: another clause, definition, name or value.")

(defun read-value (what)
  "Ask the user for WHAT, a form; return a list of it."
  (format *query-io* "~&~A: " what)
  (finish-output *query-io*)
  (list (read *query-io*)))

(defun in-file-p (condition)
  "True if what CONDITION is about was read from a file and can be read again."
  (declare (ignore condition))
  (and (current-source) t))

(defun definition-again (definition)
  "Return the form of DEFINITION as it is in its file now."
  (read-definition-again (source-file (defining-source definition))
                         (defining-form definition) (defining-ordinal definition)))

(defun other-definition-p (value &optional (definition *definition*))
  "True if VALUE is a whole form that can replace DEFINITION."
  (and (consp value)
       (symbolp (first value))
       (same-name-p (first value) (first (defining-form definition)))))

(defun definition-with (definition value)
  "Return DEFINITION's form with VALUE for the rejected clause, or VALUE if it is a whole form."
  (let* ((form (defining-form definition))
         (clause (defining-clause definition))
         (new (subst value clause form :test #'equal)))
    (cond ((other-definition-p value definition) value)
          ((and clause (not (equal new form))) new)
          (t (reject-use "~S cannot replace a part of ~A. Give a whole form for it."
                         value (definition-text definition))))))

(defun call-with-definition-restarts (function replace)
  "Call FUNCTION, with restarts that leave out the current definition, or call REPLACE with another
form for it, also repeatedly: read again from its file, or with another clause."
  (let ((definition *definition*))
    (flet ((instead (choose)
             (call-with-definition-restarts
              (lambda () (funcall replace (funcall choose definition))) replace)))
      (restart-case (funcall function)
        (skip-definition ()
          :report (lambda (stream) (format stream "Leave ~A out." (definition-text definition)))
          nil)
        (read-again ()
          :test in-file-p
          :report (lambda (stream)
                    (format stream "Read ~A again from its file." (definition-text definition)))
          (instead #'definition-again))
        (use-value (value)
          :report (lambda (stream)
                    (format stream "Use another clause of ~A, or another form for it."
                            (definition-text definition)))
          :interactive (lambda () (read-value "A clause to use, or a whole form"))
          (instead (lambda (definition) (definition-with definition value))))))))

;;; Mistakes that Lisp finds.

(defun missing-name (condition)
  "Return the name of the variable or function that CONDITION reports as undefined, or NIL."
  (and (typep condition '(or unbound-variable undefined-function))
       (cell-error-name condition)))

(defun head (form)
  (subseq form 0 (min 2 (length form))))

(defun reject-value (condition)
  "Signal MALFORMED-DEFINITION because of CONDITION, an error in a form of an author."
  (let ((name (missing-name condition)))
    (reject-clause (definition-text *definition*)
                   (or name (append (head (defining-form *definition*)) (list +more+)))
                   (format nil "forms that have values~:[~;, with a quote before names~] (~A)"
                           name (string-right-trim "." (text-of-condition condition))))))

(defun call-blaming (function blame)
  "Call FUNCTION, and BLAME with each error that is not ours: a mistake in an author's form."
  (handler-bind ((error (lambda (condition)
                          (unless (typep condition 'ars-magna-error)
                            (funcall blame condition)))))
    (funcall function)))

(defun call-as-definition (source form function)
  (let ((*definition* (make-defining source form)))
    (call-with-definition-restarts (lambda () (call-blaming function #'reject-value)) #'eval)))

(defun find-part (test form)
  "Return the first part of FORM, a tree of conses, of which TEST is true, or NIL."
  (let ((stack (list form)))
    (loop while stack
          do (let ((part (pop stack)))
               (when (funcall test part) (return part))
               (when (consp part)
                 (push (cdr part) stack)
                 (push (car part) stack))))))

(defun endless-p (form)
  "True if FORM has more conses than a written form can have, as circular lists do."
  (let ((left 10000000))
    (and (find-part (lambda (part) (and (consp part) (minusp (decf left)))) form) t)))

(defun has-quote-p (form)
  "True if a part of FORM is quoted, as a mistake where nothing is evaluated."
  (and (find-part (lambda (part) (typep part '(cons (eql quote)))) form) t))

(defun rejected-form (condition)
  "Return a form that signals CONDITION again when it is evaluated."
  (when *compile-file-truename*
    (call-at-place (malformed-definition-clause condition)
                   (lambda () (warn-of-definition "~A" condition))))
  `(reject-clause ',(malformed-definition-definition condition)
                  ',(malformed-definition-clause condition)
                  ,(malformed-definition-expected condition)
                  ,(malformed-definition-place condition)))

(defun forms-or-rejection (function nested)
  "Return the value of FUNCTION. If it signals MALFORMED-DEFINITION and the form is NESTED in others
or in a file that is compiled, where the compiler would turn it into another error, return a form
that signals it later."
  (if (or nested *compile-file-truename*)
      (handler-case (funcall function)
        (malformed-definition (condition) (list (rejected-form condition))))
      (funcall function)))

(defun call-with-definition (form function)
  "Call FUNCTION, which expands the definition FORM, and return its values."
  (let ((*definition* (make-defining (source-here) form)))
    (call-with-definition-restarts function #'identity)))

(defun expand-definition (form environment function)
  "Return the expansion of FORM, (operator name ...), in ENVIRONMENT: the forms that FUNCTION
returns to perform it, preceded by the forms of its second value. The expansion returns the name."
  (call-with-definition
   form
   (lambda ()
     (multiple-value-bind (forms before)
         (forms-or-rejection function (nested-p environment))
       `(progn
          ,@before
          (call-as-definition ',(current-source) ',form (lambda () ,@forms))
          ',(second form))))))
