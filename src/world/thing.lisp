;;;; thing.lisp -- things: the structure, its attributes and its physics.

(in-package :ars-magna.world)

(export '(location-contents location-position location-world location-closed-p location-full-p
          location-name location-phrase thing body-robot robot-body-p thing-holders-text
          similar-domain-value warn-of-unknown-substance))

;;; The location of a thing is :FLOOR (then it has a position), or its holder, a thing or, in the
;;; layer above, a hand or storage bin, or NIL, as for prototypes and destroyed things. Holders
;;; implement these functions.

(defgeneric location-contents (location)
  (:documentation "Return the list of things directly in LOCATION, a thing, hand or storage bin,
in order of arrival. SETF of LOCATION-CONTENTS does not change the things themselves."))

(defgeneric (setf location-contents) (things location))

(defgeneric location-position (location)
  (:documentation "Return, as two values, the coordinates x and y of LOCATION, in metres."))

(defgeneric location-world (location)
  (:documentation "Return the world that LOCATION is in, or NIL."))

(defgeneric location-closed-p (location)
  (:documentation "True if LOCATION is closed, such as a storage bin, so that nothing gets into or
out of it."))

(defgeneric location-full-p (location)
  (:documentation "True if LOCATION holds as many things as it can, whatever their size.")
  (:method (location)
    (declare (ignore location))
    nil))

(defgeneric location-name (location)
  (:documentation "Return the name of LOCATION for messages, a symbol or string."))

(defgeneric location-phrase (location)
  (:documentation "Return LOCATION's name for the middle of a sentence, with its robot, if any.")
  (:method (location) (location-name location)))

(addition remaining-capacity)
(defgeneric remaining-capacity (location)
  (:documentation "Return the remaining capacity of LOCATION, in units of size: its capacity minus
the sizes of the things directly in it (a double-float, at least 0). Signals WRONG-ARGUMENT.")
  (:method (location)
    (check-argument remaining-capacity location nil "a thing, hand or storage bin")))

;;; The attributes that the simulator uses itself (manual, table 3.3). The manual gives the sensing
;;; parameters of :color and :size and the supporters of :capacity. The rest are our choice. Whether
;;; a thing blocks the way or the view, or is closed, is plain to see if you look. Weight and
;;; capacity are guesses from afar. A symbol as substance is read right with probability :success.

;; As reading 121 says.
(defattribute :obsmove (t nil)
  :success .95 :noticed .3 :supported-by (:size :weight))
(defattribute :obsview (t nil)
  :success .95 :noticed .5 :supported-by (:size))
(defattribute :closed (t nil)
  :success .9 :noticed .3 :supported-by (:capacity))
(public red green blue violet lightred lightblue lightgreen lightviolet)
(defattribute :color (red green blue violet lightred lightblue lightgreen lightviolet)
  :success .4 :noticed .4 :supported-by (:substance))
(defattribute :size numeric
  :base .8 :max-mult 4 :noticed .7 :supported-by (:capacity :obsview :weight))
(defattribute :weight numeric
  :base .5 :max-mult 4 :noticed .2 :supported-by (:size :substance))
(defattribute :capacity numeric
  :base .6 :max-mult 4 :noticed .3 :supported-by (:size :weight))
(defattribute :substance numeric
  :success .8 :base 1 :max-mult 3 :noticed .5 :supported-by (:color))

(setf *built-in-attributes* (defined-names *attributes*))

;;; The attributes of a thing are an object descriptor (manual 3.3): a list of lists (key
;;; value), replaced and never altered in place. Those that physics needs are cached in typed
;;; slots. A thing without a world is a prototype. Manual 3.3 and 5.3.

(addition thing-p)
(define-kind (thing :constructor (%make-thing (name serial world)))
    "An object in a world, or a prototype from which such objects are made."
  (:fixed
   (name nil symbol "the symbol that names the thing, perhaps others, too" :addition)
   (serial 0 fixnum "the thing's number in its world, from 1; 0 for prototypes" :addition)
   (world nil t "the world that the thing is in, or NIL for a prototype" :near :addition))
  (:state
   (location nil t
             "where the thing is: :FLOOR, its holder, or NIL for nowhere" :near :addition)
   (x 0d0 double-float "the x coordinate in metres, now or when the thing was last on the floor"
      :near :addition)
   (y 0d0 double-float "the y coordinate in metres, now or when the thing was last on the floor"
      :near :addition)
   (attributes '() list "the thing's attributes as an object descriptor; do not alter it"
               :shared :addition)
   (contents '() list "the list of things directly inside the thing, in order of arrival" :addition)
   (kickers '() list "the list of the thing's kickers, as ATTACHMENTs" :part :addition)
   (alive-p t boolean "the thing has not been destroyed" :addition)
   (obsmove-p nil boolean "the thing blocks movement" :addition)
   (obsview-p nil boolean "the thing obstructs vision" :addition)
   (closed-p nil boolean "the thing, as a container, is closed" :addition)
   (substance-p nil boolean "the thing has a :substance" :addition)
   (size 0d0 double-float "the thing's :size, 0 if unspecified" :addition)
   (weight 0d0 double-float "the thing's own :weight, 0 if unspecified" :addition)
   (capacity 0d0 double-float "the thing's :capacity, 0 if it is no container" :addition)
   (substance-parameter 0d0 double-float
                        "the parameter of the thing's :substance, 0 if unspecified" :addition)
   (rank 0 fixnum "the index of the thing in the vector of its world's things" :near)))

;; Its position follows the robot's. Serial 0 in a world: bodies are not numbered.
(addition body body-p)
(define-kind (body :include thing :constructor (%make-body (name robot world)))
    "The body of a robot in a world with several robots: a thing that robots see and that blocks
them."
  (:fixed
   (robot nil t "the robot whose body it is" :addition)))

(declaim (inline robot-body-p))
(defun robot-body-p (thing)
  "True if THING, which is in a world, is the body of a robot."
  (zerop (thing-serial thing)))

(defmethod reference ((thing thing))
  (and (thing-world thing) (list :thing (thing-serial thing))))

(defmethod print-object ((thing thing) stream)
  (let ((name (format nil "~A~@[#~D~]" (symbol-name (thing-name thing))
                      (and (plusp (thing-serial thing)) (thing-serial thing)))))
    (print-named thing stream name (concatenate 'string "THING " name))))

;;; Attributes.

(defun similar-domain-value (value domain)
  "Return the symbol in DOMAIN that VALUE probably misspells, or NIL."
  (and (symbolp value)
       (nearest-name value (remove-if-not #'symbolp (remove nil domain)))))

(defun check-attribute-value (operator key value)
  "Signal WRONG-ARGUMENT unless VALUE is valid for the attribute KEY. NIL is always valid."
  (when (typep value '(cons (eql quote)))
    (reject-argument operator key value "an unquoted value, because the value is not evaluated"))
  (let ((attribute (declared-attribute key)))
    (flet ((reject (expected) (reject-argument operator key value expected)))
      (cond ((and (floatp value) (not (finite-p value))) (reject (argument-type-text 'quantity)))
            ((eq key :draw-function)
             (unless (draw-function-p value) (reject (draw-function-advice value))))
            ((or (null value) (null attribute)))
            ((eq key :substance)
             (unless (substance-value-p value)
               (reject "a number from -1e15 to 1e15, a substance's name, or a list (name number)"))
             (warn-of-unknown-substance value))
            ((eq (attribute-kind attribute) :discrete)
             (unless (member value (attribute-domain attribute) :test #'value-equal)
               (reject (format nil "one of ~(~{~A~^, ~}~)~@[; did you mean ~(~A~)?~]"
                               (attribute-domain attribute)
                               (similar-domain-value value (attribute-domain attribute))))))
            ((not (bounded-number-p value)) (reject (argument-type-text 'quantity)))
            ((and (member key '(:size :weight :capacity)) (minusp value))
             (reject (argument-type-text 'amount)))))))

(defun warn-of-unknown-substance (value)
  "Warn if VALUE, the value of a :substance attribute, names an unknown substance. The warning is
about the current definition or, without one, is a message."
  (let ((type (substance-value-type value)))
    (when (and type (null (find-substance type nil)))
      (let ((text (format nil "No substance is called ~(~A~): its parameter counts as 0; see ~
                               DEFSUBSTANCE.~@[ Did you mean ~(~A~)?~]"
                          type (nearest-name type (defined-names *substances*)))))
        (if *definition*
            (warn-of-definition "~@[~A: ~]~A" (clause-location type) text)
            (warning-set text))))))

;;; Doors. The attribute :DOOR is not declared: each declared attribute takes dice in searches, so
;;; runs without doors would change.

(addition closed-door-p)
(defun closed-door-p (thing)
  "True if THING is a closed door: its attributes :DOOR and :CLOSED are true. On the floor, a closed
door makes its cell like a wall: robots, views and kicked things cannot pass, and the cell is no
place. False for the body of a robot."
  (and (thing-closed-p thing)
       (second (assoc :door (thing-attributes thing) :test #'eq))
       t))

;;; Containment.

(addition thing-outermost)
(defun thing-outermost (thing)
  "Return the outermost thing that THING is in; THING itself if it is in no other thing."
  (loop for location = (thing-location thing)
        while (thing-p location) do (setf thing location)
        finally (return thing)))

(defun thing-holders-text (thing)
  "Return a text that lists the holders of THING, from the innermost to the outermost; NIL if none."
  (let ((holders (loop for location = (thing-location thing) then (thing-location location)
                       while (and location (not (eq location :floor)))
                       collect (location-phrase location)
                       while (thing-p location))))
    (and holders (format nil "~{in ~A~^, ~}" holders))))

(addition thing-position)
(defun thing-position (thing)
  "Return two values: the coordinates of THING or its outermost holder in metres, or NIL and NIL."
  (let* ((outermost (thing-outermost thing)) (location (thing-location outermost)))
    (case location
      (:floor (values (thing-x outermost) (thing-y outermost)))
      ((nil) (values nil nil))
      (t (location-position location)))))

(addition thing-total-weight)
(defun thing-total-weight (thing)
  "Return the weight of THING with all that it contains."
  (loop with sum double-float = (thing-weight thing)
        for inside in (thing-contents thing)
        do (incf sum (the double-float (thing-total-weight inside)))
        finally (return sum)))

(defmethod location-contents ((thing thing)) (thing-contents thing))
(defmethod (setf location-contents) (things (thing thing)) (setf (thing-contents thing) things))
(defmethod location-position ((thing thing)) (thing-position thing))
(defmethod location-world ((thing thing)) (thing-world thing))
(defmethod location-closed-p ((thing thing)) (thing-closed-p thing))
(defmethod location-name ((thing thing)) (princ-to-string thing))

(defmethod remaining-capacity ((thing thing))
  (max 0d0 (- (thing-capacity thing)
              (loop for inside in (thing-contents thing) sum (thing-size inside)))))
