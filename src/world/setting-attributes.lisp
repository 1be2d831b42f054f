;;;; setting-attributes.lisp -- changing what things in a world are like (manual 5.3).

(in-package :ars-magna.world)

(defun change-attributes (thing descriptor)
  "Give THING the attributes in DESCRIPTOR and make caches and flags agree."
  (setf (thing-attributes thing) (merge-descriptors descriptor (thing-attributes thing)))
  ;; What REFRESH-PHYSICS reads.
  (when (intersection '(:obsmove :obsview :closed :size :weight :capacity :substance)
                      (mapcar #'first descriptor))
    (refresh-physics thing)
    (when (eq (thing-location thing) :floor)
      (set-mark thing (world-stock (thing-world thing)))
      (refresh-cell-flags (thing-world thing) (thing-index thing)))))

(defun checked-entry (operator name value)
  (let ((key (attribute-key name)))
    (check-attribute-value operator key value)
    (list key (if (eq key :draw-function) (draw-function-said value) value))))

(defun normal-descriptor (operator descriptor)
  "Return the object descriptor DESCRIPTOR with keywords as names, a copy. Signals WRONG-ARGUMENT."
  (unless (descriptor-p descriptor)
    (reject-argument operator "descriptor" descriptor
                     "a list of lists (attribute value), each attribute once"))
  (loop for (name value) in (given operator "descriptor" descriptor)
        collect (checked-entry operator name value)))

(defun descriptor-p (object)
  (and (proper-list-p object)
       (loop for entry in object
             always (and (proper-list-p entry) (= 2 (length entry))
                         (first entry) (symbolp (first entry))))
       (loop for ((name) . rest) on object
             never (find name rest :key #'first :test #'same-name-p))))

(public set-attribute)
(defun set-attribute (thing attribute new-value)
  "Set ATTRIBUTE, a keyword, of THING to NEW-VALUE and return that (manual 5.3). NIL means false
or unspecified. Of lists, strings and vectors THING gets copies. Signals WRONG-ARGUMENT for a value
that the attribute cannot have. Warns as GET-ATTRIBUTE does."
  (check-argument set-attribute thing (thing-p thing) (argument-type-text 'thing thing))
  (check-argument set-attribute attribute (and attribute (symbolp attribute)) "a keyword")
  (let ((descriptor (if (typep new-value '(or symbol number))
                        (list (checked-entry 'set-attribute attribute new-value))
                        (normal-descriptor 'set-attribute (list (list attribute new-value))))))
    (note-slip 'set-attribute thing (first (first descriptor)))
    (changing ((world-of-living thing) set-attribute
               thing attribute (second (first descriptor)))
      (change-attributes thing descriptor)))
  new-value)

(defun set-attribute-again (thing attribute new-value)
  (call-with-data #'set-attribute thing attribute new-value))

(define-operator 'set-attribute '(thing name datum) #'set-attribute-again)

(defun (setf get-attribute) (new-value thing attribute)
  (set-attribute thing attribute new-value))

(public change-attribute)
(defun change-attribute (thing descriptor)
  "Set all attributes of THING that the object descriptor DESCRIPTOR gives; others stay
(manual 5.3). Signals WRONG-ARGUMENT. Return THING. See reading 173."
  (check-argument change-attribute thing (thing-p thing) (argument-type-text 'thing thing))
  (let ((descriptor (normal-descriptor 'change-attribute descriptor)))
    (loop for (key) in descriptor do (note-slip 'change-attribute thing key))
    (changing ((world-of-living thing) change-attribute thing descriptor)
      (change-attributes thing descriptor)))
  thing)

(defun change-attribute-again (thing descriptor)
  (call-with-data #'change-attribute thing descriptor))

(define-operator 'change-attribute '(thing datum) #'change-attribute-again)
