;;;; map-things.lisp -- the obj clause of a map: what lies in it.

(in-package :ars-magna.world)

;;; A clause is data. Its author's code in it, prototypes and the lambdas of draw functions, is
;;; compiled beside it: in a list of (key function), each once. A key is (name form), with the name
;;; of a thing that is drawn. A clause that the user chose instead, or that another stands for, has
;;; none there.

(defvar *code* '() "The compiled code of the map that is being defined.")

(defun code-form (code)
  "Return a form that makes the list of CODE, lists (key form)."
  `(list ,@(loop for (key form) in (remove-duplicates code :key #'first :test #'equal)
                 collect `(list ',key (lambda () ,form)))))

(defun code-value (name source form)
  "Return the value of SOURCE, code of the thing called NAME or NIL, which FORM, evaluated, has."
  (let ((compiled (second (find (list name source) *code* :key #'first :test #'equal))))
    (if compiled (funcall compiled) (eval form))))

(defun descriptor-value (name descriptor)
  "Return DESCRIPTOR, of the thing called NAME, with the values of the code in it."
  (loop for (key value) in descriptor
        collect (list key (if (code-p key value)
                              (code-value name value (draw-function-form name value))
                              value))))

;;; Checking.

(defun check-head (definition clause head)
  "Signal unless HEAD is a name or (name [:prototype form] [:kickers (name...)])."
  (let ((head (if (consp head) head (list head))))
    (unless (and (proper-list-p head) (first head) (symbolp (first head)))
      (reject-clause definition clause "a name, or (name :prototype thing)"))
    (check-options definition (rest head) '(:prototype :kickers))
    (unless (and (proper-list-p (getf (rest head) :kickers))
                 (every #'symbolp (getf (rest head) :kickers)))
      (reject-clause definition clause ":kickers (name ...), names in a list"))))

(defun check-thing-clause (definition clause head descriptor)
  "Return true. Signals MALFORMED-DEFINITION unless HEAD and DESCRIPTOR, of CLAUSE, are right."
  (check-head definition clause head)
  (or (descriptor-p descriptor)
      (reject-clause definition clause
                     "an object descriptor ((attribute value) ...), each attribute once")))

(defun check-content (definition clause)
  (when (keywordp (if (consp clause) (first clause) clause))
    (reject-clause definition clause
                   (format nil "contents: (name descriptor contents...); options stand beside ~
                                the name, as in (obj (ball :kickers (sway)) ...)")))
  (unless (and (proper-list-p clause) (<= 2 (length clause)))
    (reject-clause definition clause "contents: (name descriptor contents...)"))
  (check-thing-clause definition clause (first clause) (second clause)))

(defun check-position (map clause position)
  (unless (and (number-pair-p position) (apply #'map-index map position))
    (reject-clause (map-title map) clause
                   (format nil "a position (x y) in the map, from 0 to below ~D and ~D"
                           (map-width map) (map-height map)))))

(defun code-in-thing (definition head descriptor contents)
  "Return a list of (key form) for the code in the parts of a thing's clause. Signals
MALFORMED-DEFINITION if contents are wrong."
  (destructuring-bind (name &key prototype &allow-other-keys) (ensure-list head)
    (append (and prototype (list (list (list nil prototype) prototype)))
            (loop for (key value) in descriptor
                  when (code-p key value)
                    collect (list (list name value) (draw-function-form name value)))
            (loop for inside in contents
                  do (check-content definition inside)
                  append (destructuring-bind (head descriptor . contents) inside
                           (code-in-thing definition head descriptor contents))))))

;;; Recipes.

(defun clause-recipe (definition clause name descriptor &rest options)
  (warn-of-slips definition name descriptor :clause clause)
  (handler-case (apply #'write-recipe 'defmap name descriptor options)
    ((or wrong-argument unknown-name) (condition)
      (reject-clause definition clause
                     (format nil "a thing that can be made (~A)"
                             (string-right-trim "." (princ-to-string condition)))))))

(defun recipe-of-thing (definition clause head descriptor contents &optional x y)
  "Return the recipe of the thing in CLAUSE, which has been checked and ends in CONTENTS."
  (destructuring-bind (name &key prototype kickers) (ensure-list head)
    (flet ((value () (code-value nil prototype prototype))
           (inside (content)
             (check-content definition content)
             (list (recipe-of-thing definition content (first content) (second content)
                                    (cddr content)))))
      (clause-recipe definition clause name (descriptor-value name descriptor)
                     :prototype (and prototype
                                     (call-for-value #'value definition clause
                                                     "a prototype: a form whose value is a thing"))
                     :kickers kickers :x x :y y
                     :contents (parts-of-clauses #'inside contents
                                                 (- (length clause) (length contents)))))))

(define-map-clause obj (map &whole clause head position descriptor &rest contents)
    "(obj name (x y) descriptor contents...)"
  :check (progn (check-position map clause position)
                (check-thing-clause (map-title map) clause head descriptor))
  :code (code-in-thing (map-title map) head descriptor contents)
  :things (destructuring-bind (x y) position
            (list (recipe-of-thing (map-title map) clause head descriptor contents x y))))
