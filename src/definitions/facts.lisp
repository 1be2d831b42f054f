;;;; facts.lisp -- what DESCRIBE and inspectors show of an object or a name.

(in-package :ars-magna.definitions)

(export '(facts known-facts define-facts comma-separated fact-text))

;;; FACTS returns labels and texts. DESCRIBE and editors' inspectors show them. For a symbol,
;;; DESCRIBE also shows users' definitions of that name: maps, kickers and the like.

(defgeneric facts (object)
  (:documentation "Return the properties of OBJECT that DESCRIBE and inspectors show: a list of
lists (label text), in order.")
  (:method (object) (declare (ignore object)) '()))

(defun known-facts (&rest labels-and-texts)
  "Return a list (label text) for each pair in LABELS-AND-TEXTS whose text is not NIL. Objects that
are not strings are converted by FACT-TEXT."
  (loop for (label fact) on labels-and-texts by #'cddr
        when fact collect (list label (if (stringp fact) fact (fact-text fact)))))

(defun fact-text (fact)
  "Return the text that shows the object FACT: one line in lower case, without package prefixes."
  (let ((*print-case* :downcase) (*read-default-float-format* 'double-float))
    (one-line (safe-text fact :length 400))))

(defun comma-separated (objects)
  "Return a text with at most 12 of OBJECTS, such as names, separated by commas; NIL if none."
  (and objects
       (format nil "~{~A~^, ~}"
               (names-to-show (loop for object in objects
                                    collect (if (typep object '(or symbol string))
                                                object
                                                (fact-text object)))))))

(defun write-fact-lines (facts stream)
  (loop for (label text) in facts
        do (format stream "~&  ~A: ~A~%" label text)))

(defun write-facts (object stream)
  (format stream "~&~S~%" object)
  (write-fact-lines (append (facts object) (facts-of-definition (entry-of-object object))) stream))

(defmacro define-facts ((class variable) &rest labels-and-forms)
  "Make DESCRIBE and inspectors show labels and the values of forms for objects of CLASS. In
LABELS-AND-FORMS, each label is followed by a form, in which VARIABLE is bound to the object."
  `(progn
     (defmethod facts ((,variable ,class)) (known-facts ,@labels-and-forms))
     ,@(unless (kind-named class)
         `((defmethod describe-object ((,variable ,class) stream)
             (write-facts ,variable stream))))))

(defun describe-by-kind (object stream)
  (write-facts object stream)
  (loop for (title . slots) in (slots-to-show object)
        do (format stream "~& ~A:~%" title)
           (loop for (name value text) in slots
                 do (format stream "  ~(~22A~) ~A  (~A)~%" name (cut (fact-text value) 200)
                            text))))

;;; Parameters.

(define-facts (parameter parameter)
  "What it is" (parameter-sentence parameter)
  "Value" (fact-text (parameter-value parameter))
  "Default" (fact-text (parameter-default parameter))
  "Can be" (describe-type (parameter-type parameter))
  "Unit" (parameter-unit parameter)
  "In a clean simulation" (and (eq :noise (parameter-kind parameter))
                               (fact-text (parameter-clean parameter))))

;;; Definitions.

(defun entry-of-object (object)
  (loop for registry in *registries*
          thereis (find object (registry-entries registry) :key #'entry-object :test #'eq)))

(defun facts-of-definition (entry)
  (when entry
    (let ((file (source-file (entry-source entry))) (head (entry-head entry)))
      (known-facts "Documentation" (entry-documentation entry)
                   "Defined in" (and file
                                     (format nil "~A~@[, line ~D~]" file
                                             (and head (clause-line-in-file file head nil))))))))

;; Lisp itself describes our definitions, such as commands, unless they have another name there.
(defun describe-entry-p (entry registry symbol)
  (or (not (registry-fixed-p registry))
      (and (not (eq symbol (entry-name entry)))
           (facts (entry-object entry)))))

(defmethod describe-object :after ((symbol symbol) stream)
  (dolist (registry (and symbol *registries*))
    (let ((entry (lookup-entry symbol registry)))
      (when (and entry (describe-entry-p entry registry symbol))
        (format stream "~&~%~A names ~:[a~;an~] ~A:~%" symbol
                (find (char (registry-text registry) 0) "aeiou") (registry-text registry))
        (write-fact-lines (append (facts (entry-object entry)) (facts-of-definition entry))
                          stream)))))

;;; Documentation, of kinds of definition.

(defmethod documentation ((name symbol) (kind symbol))
  (let ((registry (registry-named kind (users-registries))))
    (if registry
        (let ((entry (lookup-entry name registry)))
          (and entry (entry-documentation entry)))
        (call-next-method))))

;;; Source locations for editors.

(defun definition-sources (name)
  "Return a list (file position operator) for each definition of the symbol NAME as a map, a robot
and so on. Lisp itself knows where variables and functions are defined."
  (loop for registry in (users-registries)
        for entry = (lookup-entry name registry)
        for file = (and entry (not (entry-variable entry)) (source-file (entry-source entry)))
        for place = (and file (entry-head entry) (not (same-name-p 'procedure
                                                                   (registry-kind registry)))
                         (ignore-errors
                           (first (definition-positions (file-text (native-path file))
                                                        (entry-head entry)))))
        when place
          collect (list file (first place) (first (entry-head entry)))))

(add-definition-sources #'definition-sources)
