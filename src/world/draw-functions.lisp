;;;; draw-functions.lisp -- what may draw a thing: the values of :draw-function (manual B).

(in-package :ars-magna.world)

(export '(resolve-draw-function descriptor-form))

;;; A value is a function, or a symbol that names one, which can be redefined. It must come from
;;; code: a definition, or a program that sets the attribute. Only names from code are called, so a
;;; data file, such as a journal, cannot have any function called. Manual B, reading 211.

(define-constant +draw-arguments+ "(window thing x y width height)" :test #'string=
  :documentation "The lambda list of a :draw-function, for messages.")

(defvar *attribute-values-from-code-p* t
  "True where values of attributes come from code; false where they are data, as in a journal.")

(defun call-with-values-as-data (function &rest arguments)
  (let ((*attribute-values-from-code-p* nil)) (apply function arguments)))

(defun names-function-p (value)
  (and value (symbolp value) (fboundp value)
       (not (macro-function value)) (not (special-operator-p value))))

(defun draw-function-p (value)
  (typecase value
    (null t)
    (function (callable-with-count-p value 6))
    (symbol (or (not *attribute-values-from-code-p*)
                (and (names-function-p value) (callable-with-count-p (fdefinition value) 6))))))

(defun draw-function-advice (value)
  "Return a text that says what to write instead of VALUE, an invalid value of :draw-function."
  (format nil "a function of ~A, or the name of a function that is defined already: (defun ~(~A~) ~
               ~A ...)~:[~;; a list is data, which is not executed~]"
          +draw-arguments+
          (if (and value (symbolp value) (not (keywordp value))) value "draw-it")
          +draw-arguments+ (consp value)))

(defun stored-draw-function (value)
  "Return the value to store for VALUE of :draw-function. A name from code is marked as callable."
  ;; A name is kept rather than its function: it follows redefinitions, and can be saved.
  (let* ((name (and (functionp value) (nth-value 2 (function-lambda-expression value))))
         (value (if (and (names-function-p name) (eq value (fdefinition name))) name value)))
    (when (and value (symbolp value) *attribute-values-from-code-p*)
      (setf (get value 'from-code-p) t))
    value))

(defun resolve-draw-function (value)
  "Return the function that VALUE of :draw-function stands for now, or NIL. If VALUE is a name
without a function, the second value is a text with the reason and the remedy."
  (cond ((null value) nil)
        ((functionp value) value)
        ((not (get value 'from-code-p))
         (values nil (format nil "the name ~(~A~) is from a data file, which cannot have code ~
                                  executed; if you trust the name, evaluate (set-attribute thing ~
                                  :draw-function '~:*~(~A~))"
                             value)))
        ((names-function-p value) (fdefinition value))
        (t (values nil (format nil "there is no function ~(~A~) any more; define it: ~
                                    (defun ~:*~(~A~) ~A ...)"
                               value +draw-arguments+)))))

;;; In definitions a descriptor is not evaluated, except (lambda ...), #'name and name here.

(defun call-named-p (name form)
  (and (proper-list-p form) (symbolp (first form)) (same-name-p (first form) name)))

(defun name-for-lambda (thing-name form)
  (intern (format nil "DRAW-~A-~36R" thing-name
                  (ldb (byte 32 0) (digest-value (digest-add (make-digest) form))))
          *package*))

(defun with-ignorable-arguments (form)
  "Return FORM, (lambda (window thing ...) ...), with its arguments declared as ignorable."
  (destructuring-bind (operator &optional arguments &rest body) form
    (if (and (proper-list-p arguments)
             (every #'symbolp arguments)
             (null (intersection arguments lambda-list-keywords)))
        `(,operator ,arguments (declare (ignorable ,@arguments)) ,@body)
        form)))

(defun define-draw-function-name (name function)
  "Define NAME as FUNCTION; return NAME, or FUNCTION if it is a closure or no draw function."
  (cond ((or (closure-p function) (not (draw-function-p function))) function)
        (t (setf (fdefinition name) function)
           name)))

(defun draw-function-form (thing-name value)
  (let ((meant (if (and (call-named-p 'function value) (= 2 (length value))) (second value) value)))
    (cond ((call-named-p 'lambda meant)
           `(define-draw-function-name ',(name-for-lambda thing-name meant)
                                 (function ,(with-ignorable-arguments meant))))
          ((symbolp meant) `',meant)
          (t `',value))))

(defun contains-code-p (key value)
  (and (consp value) (same-name-p key :draw-function)))

(defun descriptor-form (thing-name descriptor)
  "Return a form whose value is DESCRIPTOR, an object descriptor that may contain code, of a thing
with THING-NAME."
  `(list ,@(loop for (key value) in descriptor
                 collect `(list ',key ,(if (contains-code-p key value)
                                           (draw-function-form thing-name value)
                                           `',value)))))
