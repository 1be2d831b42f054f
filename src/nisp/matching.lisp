;;;; matching.lisp -- matchvars and MATCHQ (manual 5.1.1, 5.5.1).

(in-package :ars-magna.nisp)

(export '(matchvar matchvar-p matchvar-name make-matchvar))

;;; ?x is read as a matchvar, an object that means itself. There is one for each name, so that
;;; patterns with the same matchvars are EQUAL, also after a trip through a compiled file.

(defstruct (matchvar (:constructor %make-matchvar (name)) (:copier nil))
  "A place in a pattern that matches anything: ?x, and ?() with no name (manual 5.5.1)."
  (name nil :type symbol :read-only t))
(setf (documentation 'matchvar-name 'function)
      "Return the symbol that a matchvar is called, NIL for the anonymous one."
      (documentation 'matchvar-p 'function)
      "True of a matchvar: ?x, or the anonymous ?().")

(defun make-matchvar (name)
  "Return the matchvar called NAME, a symbol; NIL names the anonymous one."
  (check-argument make-matchvar name (symbolp name) "a symbol")
  (or (get name 'matchvar)
      (setf (get name 'matchvar) (%make-matchvar name))))

(defmethod print-object ((matchvar matchvar) stream)
  (let ((name (matchvar-name matchvar)))
    (format stream "?~:[()~;~:*~S~]" name)))

(defmethod make-load-form ((matchvar matchvar) &optional environment)
  (declare (ignore environment))
  `(make-matchvar ',(matchvar-name matchvar)))

;;; A pattern compiles to nested tests. TEMPORARIES is an alist from the names met so far, in the
;;; order of the tests, to the variables that hold what they matched.

(defun matchvar-test (name datum temporaries)
  (let ((known (assoc name temporaries)))
    (cond ((null name) (values t temporaries))
          (known (values `(value-equal ,(cdr known) ,datum) temporaries))
          (t (let ((temporary (gensym (symbol-name name))))
               (values `(progn (setq ,temporary ,datum) t)
                       (acons name temporary temporaries)))))))

(defun cons-test (pattern datum temporaries)
  (with-gensyms (first rest)
    (multiple-value-bind (first-test temporaries) (pattern-test (car pattern) first temporaries)
      (multiple-value-bind (rest-test temporaries) (pattern-test (cdr pattern) rest temporaries)
        (values `(and (consp ,datum)
                      (cl:let ((,first (car ,datum)) (,rest (cdr ,datum)))
                        (declare (ignorable ,first ,rest))
                        (and ,first-test ,rest-test)))
                temporaries)))))

(defun pattern-test (pattern datum temporaries)
  "Return a form that is true if PATTERN matches the value of the variable DATUM, and the
TEMPORARIES with those that it sets."
  (cond ((matchvar-p pattern) (matchvar-test (matchvar-name pattern) datum temporaries))
        ((consp pattern) (cons-test pattern datum temporaries))
        ((null pattern) (values `(null ,datum) temporaries))
        ((eq pattern t) (values `(eq ,datum t) temporaries))
        (t (values `(value-equal ',pattern ,datum) temporaries))))

(public matchq)
(defmacro matchq (pattern datum)
  "True if PATTERN, which is not evaluated, matches the value of DATUM. ?x matches anything, a
second ?x only the same again; when all matches, each variable x is set to what its ?x matched.
?() matches anything, other atoms what is called or counts the same (manual 5.1.1; reading 34)."
  (with-gensyms (value)
    (multiple-value-bind (test temporaries) (pattern-test pattern value '())
      `(cl:let ((,value ,datum) ,@(mapcar #'cdr temporaries))
         (declare (ignorable ,value))
         (when ,test
           (setq ,@(loop for (name . temporary) in (reverse temporaries)
                         append (list name temporary)))
           t)))))
