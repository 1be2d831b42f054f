;;;; definitions.lisp -- what all defining forms share: places in files, errors and restarts.

(in-package :ars-magna.definitions)

(export '(current-source *definition* reread-definition make-defining reject-clause
          call-with-definition expand-definition forms-or-rejection definition-title
          check-function-name
          replacing-form-p definition-in-file-p undefined-name-of ask-for-form clause-location
          current-form-digest endless-p has-quote-p))

;;; A defining form is checked when it is expanded, and performed when its expansion is evaluated.
;;; During both, *DEFINITION* holds it, so that an error names file and line, and restarts can leave
;;; the definition out, read it again from its file, or replace it.

(define-record (defining-form (:conc-name defining-) (:constructor make-defining (source form)))
  "A definition that is being expanded or evaluated: its FORM, from the file of SOURCE."
  (source '() list)
  (form '() list "the form that is being expanded or evaluated" :export)
  (ordinal nil t "the number of the form, from 0, among the forms of the same operator and name in
its file; NIL until it is looked up" :writable)
  (clause nil t "the part of the form that was rejected last" :writable))

(defvar *definition* nil
  "The definition that is being expanded or evaluated, or NIL.")

(defun current-source ()
  "Return the source of the current definition, else of the form being loaded; NIL for typed forms."
  (if *definition*
      (defining-source *definition*)
      (source-of-current-form)))

(defun current-form-digest ()
  "Return the digest of the current definition's form, or NIL."
  (and *definition* (form-digest (defining-form *definition*))))

(defun current-operator-and-name ()
  (and *definition* (operator-and-name (defining-form *definition*))))

(defun current-docstring ()
  "Return the docstring of the current definition: the value of :documentation, or else the first
string after the name; or NIL."
  (let* ((parts (and *definition* (cddr (defining-form *definition*))))
         (text (or (second (member :documentation parts)) (find-if #'stringp parts))))
    (and (stringp text) text)))

(defun definition-title (operator name)
  "Return the text by which messages name OPERATOR's definition of NAME, such as \"defmap yard\"."
  (let ((name (abridged name)))
    (format nil "~(~A ~A~)" operator (if (keywordp name) (prin1-to-string name) name))))

(defun title-of-definition (definition)
  (let ((form (defining-form definition)))
    (definition-title (first form) (second form))))

(defun clause-location (clause)
  "Return the place of CLAUSE in the current definition, such as \"yard.lisp, line 7\", or NIL."
  (let ((source (if *definition* (current-source) (source-of-current-form))))
    (when source
      (multiple-value-bind (line ordinal)
          (clause-line-in-file (source-file source)
                               (and *definition* (defining-form *definition*)) clause)
        (when *definition* (setf (defining-ordinal *definition*) ordinal))
        (format nil "~A~@[, line ~D~]" (source-file source)
                (or (form-line-in-file (source-file source) clause (location-in-text clause))
                    line))))))

(defun reject-clause (definition clause expected &optional (place (clause-location clause)))
  "Signal MALFORMED-DEFINITION about CLAUSE. DEFINITION is a string such as \"defmap watson\". PLACE
is the file and line of CLAUSE. EXPECTED describes a valid clause."
  (when *definition* (setf (defining-clause *definition*) clause))
  (error 'malformed-definition :definition definition :clause clause :expected expected
                               :place place))

(defun check-function-name (definition name)
  "Signal MALFORMED-DEFINITION about DEFINITION if NAME cannot name a function, or belongs to a
package in which users cannot define functions."
  (unless (or (symbolp name) (and (consp name) (eq 'setf (first name))))
    (reject-clause definition name "a symbol as the name"))
  (let ((package (and (symbolp name) (symbol-package name))))
    (when (and package (package-locked-p package) (not (eq package *package*)))
      (reject-clause definition name
                     (format nil "a name that is free; ~A belongs to ~A. Name it my-~(~A~), or ~
                                  shadow the symbol in your package: (:shadow #:~(~A~))"
                             name (package-name package) name name)))))

;;; Restarts.

(addition skip-definition skip-clause read-again)
(document-restarts
 'skip-definition "Leave out the definition with the mistake. An earlier one of its name remains."
 'skip-clause "Leave out the clause of a map that has the mistake, and continue with the next."
 'read-again "Read the definition or clause again from its file, after you have corrected it."
 'use-value "Use the value that you type instead: another clause, definition, name or value.")

(defun ask-for-form (what)
  "Ask the user for a form, which the text WHAT describes. Return a list of the form."
  (format *query-io* "~&~A: " what)
  (finish-output *query-io*)
  (list (read *query-io*)))

(defun definition-in-file-p (condition)
  "True if the current definition can be read again from its file, regardless of CONDITION."
  (declare (ignore condition))
  (and (current-source) t))

(defun reread-definition (definition)
  "Read the form of DEFINITION again from its file, and return it."
  (read-definition-again (source-file (defining-source definition))
                         (defining-form definition) (defining-ordinal definition)))

(defun replacing-form-p (value &optional (definition *definition*))
  "True if VALUE is a complete form with the operator of DEFINITION."
  (and (consp value)
       (symbolp (first value))
       (same-name-p (first value) (first (defining-form definition)))))

(defun replace-clause (definition value)
  "Return VALUE if it is a complete form that can replace DEFINITION; else the form of DEFINITION
with VALUE in place of the rejected clause."
  (let* ((form (defining-form definition))
         (clause (defining-clause definition))
         (new (subst value clause form :test #'equal)))
    (cond ((replacing-form-p value definition) value)
          ((and clause (not (equal new form))) new)
          (t (reject-use "~S cannot replace a part of ~A. Give a complete form."
                         value (title-of-definition definition))))))

(defun call-with-definition-restarts (function replace)
  "Call FUNCTION, with restarts for an error in the current definition. SKIP-DEFINITION skips the
definition. READ-AGAIN calls REPLACE with the form now in its file; USE-VALUE calls REPLACE with a
form that has another clause. The new form has these restarts, too."
  (let ((definition *definition*))
    (flet ((instead (choose)
             (call-with-definition-restarts
              (lambda () (funcall replace (funcall choose definition))) replace)))
      (restart-case (funcall function)
        (skip-definition ()
          :report (lambda (stream) (format stream "Leave ~A out." (title-of-definition definition)))
          nil)
        (read-again ()
          :test definition-in-file-p
          :report (lambda (stream)
                    (format stream "Read ~A again from its file." (title-of-definition definition)))
          (instead #'reread-definition))
        (use-value (value)
          :report (lambda (stream)
                    (format stream "Replace the clause of ~A, or its whole form."
                            (title-of-definition definition)))
          :interactive (lambda () (ask-for-form "A clause to use, or a whole form"))
          (instead (lambda (definition) (replace-clause definition value))))))))

;;; Mistakes that Lisp finds.

(defun undefined-name-of (condition)
  "If CONDITION reports an undefined variable or function, return its name; else NIL."
  (and (typep condition '(or unbound-variable undefined-function))
       (cell-error-name condition)))

(defun operator-and-name (form)
  (subseq form 0 (min 2 (length form))))

(defun reject-failing-form (condition)
  "Signal MALFORMED-DEFINITION because of CONDITION, an error in a form of the current definition."
  (let ((name (undefined-name-of condition)))
    (reject-clause (title-of-definition *definition*)
                   (or name (append (operator-and-name (defining-form *definition*)) (list +more+)))
                   (format nil "forms that can be evaluated~:[~;, with a quote before names~] (~A)"
                           name (string-right-trim "." (text-of-condition condition))))))

(defun call-reporting-mistakes (function blame)
  "Call FUNCTION. For each error other than an ARS-MAGNA-ERROR, call BLAME with the error."
  (handler-bind ((error (lambda (condition)
                          (unless (typep condition 'ars-magna-error)
                            (funcall blame condition)))))
    (funcall function)))

(defun call-as-definition (source form function)
  (let ((*definition* (make-defining source form)))
    (call-with-definition-restarts
     (lambda () (call-reporting-mistakes function #'reject-failing-form)) #'eval)))

(defun find-part (test form)
  "Return the first part of FORM, a tree of conses, for which TEST returns true, or NIL."
  (let ((stack (list form)))
    (loop while stack
          do (let ((part (pop stack)))
               (when (funcall test part) (return part))
               (when (consp part)
                 (push (cdr part) stack)
                 (push (car part) stack))))))

(defun endless-p (form)
  "True if FORM has more conses than a written form can have, for example because it is circular."
  (let ((left 10000000))
    (and (find-part (lambda (part) (and (consp part) (minusp (decf left)))) form) t)))

(defun has-quote-p (form)
  "True if a part of FORM is quoted. Where nothing is evaluated, that is a mistake."
  (and (find-part (lambda (part) (typep part '(cons (eql quote)))) form) t))

(defun rejection-form (condition)
  "Return a form whose evaluation signals CONDITION, a MALFORMED-DEFINITION, again."
  (when *compile-file-truename*
    (call-at-source-location (malformed-definition-clause condition)
                             (lambda () (warn-of-definition "~A" condition))))
  `(reject-clause ',(malformed-definition-definition condition)
                  ',(malformed-definition-clause condition)
                  ,(malformed-definition-expected condition)
                  ,(malformed-definition-place condition)))

(defun forms-or-rejection (function nested)
  "Call FUNCTION, which expands a form, and return its value. If FUNCTION signals
MALFORMED-DEFINITION, and the form is NESTED in another form or is in a file that is compiled,
return a list with a form that signals the error later. (The compiler would change an error now.)"
  (if (or nested *compile-file-truename*)
      (handler-case (funcall function)
        (malformed-definition (condition) (list (rejection-form condition))))
      (funcall function)))

(defun call-with-definition (form function)
  "Call FUNCTION, which expands the definition FORM, and return its values."
  (let ((*definition* (make-defining (source-of-current-form) form)))
    (call-with-definition-restarts function #'identity)))

(defun expand-definition (form environment function)
  "Expand the definition FORM, (operator name ...), in ENVIRONMENT. FUNCTION returns two lists:
forms that perform the definition, and forms to evaluate before it. The expansion returns the name."
  (call-with-definition
   form
   (lambda ()
     (multiple-value-bind (forms before)
         (forms-or-rejection function (nested-form-p environment))
       `(progn
          ,@before
          (call-as-definition ',(current-source) ',form (lambda () ,@forms))
          ',(second form))))))
