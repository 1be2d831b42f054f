;;;; recipes.lisp -- how to make a thing, for a map, from a prototype, or on the fly.

(in-package :ars-magna.world)

(export '(make-world reset-world recipe make-recipe destroyed-thing))

;;; A recipe is fixed when it is written: a prototype's attributes and contents are copied then, so
;;; later changes do not affect worlds made from it. Contents are made before their container, each
;;; with the next serial number of the world; prototypes take none. Manual 5.1 and 5.3.

(define-record (recipe (:constructor make-recipe (name attributes contents &key kickers x y)))
  "A recipe for a thing with NAME, ATTRIBUTES, CONTENTS and KICKERS; in a map's recipe, at X, Y."
  (name nil symbol)
  (attributes '() list "the thing's attributes, an object descriptor")
  (contents '() list "the recipes of the thing's contents")
  (kickers '() list "the kickers on the thing")
  (x nil (or null double-float)
     "the x coordinate of the thing, in metres, or NIL")
  (y nil (or null double-float)
     "the y coordinate of the thing, in metres, or NIL"))

(defmethod reference ((recipe recipe))
  (list :recipe (recipe-name recipe) (recipe-attributes recipe) (recipe-contents recipe)
        (recipe-kickers recipe)))

(defun thing-recipe (thing)
  "Return the recipe of things like THING: attributes and contents, but no kickers."
  (make-recipe (thing-name thing) (thing-attributes thing)
               (mapcar #'thing-recipe (thing-contents thing))))

(defun recipe-from-descriptor (operator name descriptor &key prototype contents kickers x y)
  "Return the recipe of a thing NAME with the attributes and contents of PROTOTYPE, overridden by
DESCRIPTOR, and with the recipes CONTENTS added (reading 58). Signals WRONG-ARGUMENT."
  (unless (and name (symbolp name)) (reject-argument operator "name" name "a symbol"))
  (unless (or (null prototype) (thing-p prototype))
    (reject-argument operator "prototype" prototype "a thing, made by NEW-THING"))
  (let ((own (checked-descriptor operator descriptor)))
    (make-recipe name
                 (merge-descriptors own (and prototype (thing-attributes prototype)))
                 (append (and prototype (mapcar #'thing-recipe (thing-contents prototype)))
                         contents)
                 :kickers (loop for kicker in kickers
                                for found = (find-kicker kicker)
                                collect (if (kicker-p kicker) kicker (kicker-name found)))
                 :x (and x (double x)) :y (and y (double y)))))

(defun attach-recipe-kicker (thing kicker)
  "Attach KICKER, a kicker or its name, to THING; warn if there is no such kicker any more."
  (let ((found (find-kicker kicker nil)))
    (if found
        (attach-kicker thing found)
        (warning-set thing " is made without the kicker " kicker ", which is no longer defined."))))

(defun follow-recipe (recipe world)
  "Make a thing by RECIPE, without a location. If WORLD is NIL, make a prototype (reading 63)."
  (let* ((contents (loop for inside in (recipe-contents recipe)
                         collect (follow-recipe inside world)))
         (thing (%make-thing (recipe-name recipe) (if world (world-next-serial world) 0) world)))
    (setf (thing-contents thing) contents
          (thing-attributes thing) (recipe-attributes recipe))
    (dolist (inside contents) (setf (thing-location inside) thing))
    (update-physics-slots thing)
    (when world
      (incf (world-next-serial world))
      (incf (world-live-count world))
      (add-to-stock thing (world-stock world)))
    (dolist (kicker (recipe-kickers recipe)) (attach-recipe-kicker thing kicker))
    thing))

(defun find-recipe-if (test recipes)
  "Return the first recipe in RECIPES, or in their contents, that passes TEST, and TEST's value."
  (dolist (recipe recipes)
    (let ((value (funcall test recipe)))
      (when value (return (values recipe value))))
    (multiple-value-bind (inside value) (find-recipe-if test (recipe-contents recipe))
      (when inside (return (values inside value))))))

(defun kicker-on-map-p (kicker map)
  (find-recipe-if (lambda (recipe)
                    (member kicker (recipe-kickers recipe) :key (lambda (it) (find-kicker it nil))))
                  (map-things map)))

(defun recipe-attribute-names (recipes)
  (remove-duplicates
   (loop for recipe in recipes
         append (mapcar #'first (recipe-attributes recipe))
         append (recipe-attribute-names (recipe-contents recipe)))))

;;; Worlds.

(defun clear-world (world)
  "Reset WORLD to an empty map: destroy all things, and reset the robots."
  (let ((map (world-map world)))
    (do-things (thing world)
      (setf (thing-alive-p thing) nil (thing-location thing) nil (thing-contents thing) '())
      (detach-all-kickers thing))
    (reset world)
    (setf (world-flags world) (copy-seq (map-flags map))
          (world-stock world) (make-stock (* (map-width map) (map-height map)))
          (world-kicker-generation world) *kicker-generation*)))

(defun reset-world (world &key (seed (world-seed world)))
  "Reset WORLD to its initial state with the integer SEED: the things of the map's recipes, tick 0,
robots at their starts. The timeline and the move watchers stay. Return WORLD."
  (clear-world world)
  (seed-world world seed)
  (dolist (recipe (map-things (world-map world)) world)
    (place-thing (follow-recipe recipe world) :floor (recipe-x recipe) (recipe-y recipe))))

(defun make-world (map &key (seed 0))
  "Return a fresh world of MAP, a map or its name, that depends only on MAP and the integer SEED."
  (reset-world (%make-world (find-map map)) :seed seed))

;;; Objects of maps and definitions are shared.
(define-shared-types map cell substance attribute place-type place rule recipe)

;;; Making things on the fly (manual 5.3).

(defun resolve-location (location)
  "Return the world, location and coordinates for LOCATION, an argument of MAKE-NEW-THING."
  (cond ((null location) nil)
        ((and (proper-list-p location) (= 2 (length location)) (eq :with (first location)))
         (let ((thing (second location)))
           (unless (and (thing-p thing) (thing-location thing))
             (reject-argument 'new-thing "location" location
                              "(:with thing), a thing that has a location"))
           (values (thing-world thing) (thing-location thing) (thing-x thing) (thing-y thing))))
        ((and (proper-list-p location) (= 3 (length location)))
         (destructuring-bind (map x y) location
           (let ((world (current-world map)))
             (check-inside-map 'new-thing (world-map world) x y)
             (values world :floor x y))))
        ((consp location)
         (reject-argument 'new-thing "location" location
                          "NIL, a holder of things, (:with thing) or (map x y)"))
        (t (values (check-holder 'new-thing nil location) location))))

;; What is noted is independent of later changes to a prototype, or to a map's name.
(defun location-for-journal (location world)
  (if (and (consp location) (not (eq :with (first location))))
      (cons (world-map world) (rest location))
      location))

(addition make-new-thing)
(defun make-new-thing (name location descriptor &key prototype contents kickers)
  "Make and return a thing NAME, a symbol, with the attributes of DESCRIPTOR, as NEW-THING does.
LOCATION is a container, hand or storage bin, a list (:with thing) or (map x y), in metres, or NIL
to make a prototype. In the list, the map may also be a name or a world. PROTOTYPE is a thing whose
attributes and contents are copied first. CONTENTS, an addition, is a list of recipes made by
THING-RECIPE. KICKERS, an addition, is a list of kickers or their names. Signals WRONG-ARGUMENT and
UNKNOWN-NAME, and MISUSE for a hand that holds something."
  (let ((recipe (recipe-from-descriptor 'new-thing name descriptor :prototype prototype
                                                                   :contents contents :kickers
                                                                   kickers)))
    (multiple-value-bind (world place x y) (resolve-location location)
      (when (location-full-p place)
        (reject-use "new-thing: ~A holds ~{~A~^, ~} already and can hold nothing else. Let it drop ~
                     that first."
                    (location-name place) (location-contents place)))
      (if world
          (warn-once-of-misspellings name descriptor world)
          (warn-of-misspellings "new-thing" name descriptor))
      (changing (world make-new-thing name (location-for-journal location world)
                       (recipe-attributes recipe)
                       :contents (recipe-contents recipe) :kickers (recipe-kickers recipe))
        (let ((thing (follow-recipe recipe world)))
          (cond ((and world (eq place :floor)) (put-on-floor-with-warning thing x y))
                (world (relocate thing place x y))
                (place (place-thing thing place x y)))
          thing)))))

(defun make-thing-in-replay (name location descriptor &rest more)
  "Make a thing as MAKE-NEW-THING does, but only in the current world."
  (unless (eq *world* (resolve-location location))
    (reject-argument 'make-new-thing "location" location "a location in the world of this run"))
  (apply #'call-with-values-as-data #'make-new-thing name location descriptor more))

(define-operator 'make-new-thing '(name datum datum) #'make-thing-in-replay :rest 'datum)

(defun destroyed-thing (serial world)
  "Return a placeholder for the destroyed thing SERIAL of WORLD; NIL if WORLD never had this thing."
  (when (< 0 serial (world-next-serial world))
    (let ((thing (%make-thing 'destroyed serial world)))
      (setf (thing-alive-p thing) nil)
      thing)))

(defun position-form-p (form environment)
  "True if FORM is (map x y) rather than a call: its first element is a form, a variable, the name
of a map, or a symbol that names no function."
  (and (proper-list-p form) (= 3 (length form))
       (let ((head (first form)))
         (or (consp head)
             (and (symbolp head)
                  (or (known-variable-p head environment)
                      (find-map head nil)
                      (not (fboundp head))))))))

(public new-thing)
(define-user-macro new-thing (name location descriptor &key prototype &environment environment)
  "Make and return a thing NAME with the attributes of DESCRIPTOR, both unevaluated (manual 5.3).
LOCATION is one of
  a form whose value is a container, hand or storage bin, or NIL to make a prototype;
  (:with form) -- at the location of another thing;
  (map x y) -- in a map, at coordinates in metres; MAP, X and Y are forms, but a symbol
    MAP that is no variable is the name of a map.
PROTOTYPE is a form whose value is a thing; its attributes and contents are copied first, its
kickers are not. To compute the name or the descriptor, use MAKE-NEW-THING. Signals WRONG-ARGUMENT,
and MISUSE for a hand that holds something. See readings 12 and 167."
  (unless (and name (symbolp name))
    (reject-clause "new-thing" name "a symbol as the name of the thing"))
  (unless (descriptor-p descriptor)
    (reject-clause (definition-title "new-thing" name) descriptor
                   "a list of lists (attribute value), each attribute once"))
  (unless (listp (cdr (last (ensure-list location))))
    (reject-clause (definition-title "new-thing" name) location
                   "a location: a form, (:with form) or (map x y)"))
  (when (typep location '(cons real))
    (reject-clause (definition-title "new-thing" name) location
                   (format nil "a map before the coordinates: (~(~A~) ~{~A~^ ~})"
                           (if *world* (map-name (world-map *world*)) "MAP") location)))
  `(make-new-thing ',name
                   ,(cond ((and (consp location) (eq :with (first location)))
                           `(list :with ,@(rest location)))
                          ((position-form-p location environment)
                           `(list ,(map-reference-form (first location) environment)
                                  ,@(rest location)))
                          (t location))
                   ,(descriptor-form name descriptor) :prototype ,prototype))
