;;;; recipes.lisp -- how to make a thing: what map clauses and prototypes come to.

(in-package :ars-magna.world)

(export '(make-world reset-world recipe make-recipe))

;;; A recipe is fixed when it is written: a prototype's attributes and contents are copied then,
;;; so that a world made of it later does not depend on what became of the prototype. Contents
;;; are made before their container, each with the next serial number of the world; prototypes
;;; take none. Manual 5.1 and 5.3.

(define-record (recipe (:constructor make-recipe (name attributes contents &key kickers x y)))
  "A thing to be made: NAME with ATTRIBUTES, CONTENTS and KICKERS; in a map's recipe, at X, Y."
  (name nil symbol)
  (attributes '() list "what it is like, an object descriptor")
  (contents '() list "the recipes of what is in it")
  (kickers '() list "the kickers on it")
  (x nil (or null double-float)
     "where it is put, the x coordinate in metres; NIL if it is not said")
  (y nil (or null double-float)
     "where it is put, the y coordinate in metres; NIL if it is not said"))

(defmethod reference ((recipe recipe))
  (list :recipe (recipe-name recipe) (recipe-attributes recipe) (recipe-contents recipe)
        (recipe-kickers recipe)))

(defun thing-recipe (thing)
  "Return the recipe of things like THING: attributes and contents, but no kickers."
  (make-recipe (thing-name thing) (thing-attributes thing)
               (mapcar #'thing-recipe (thing-contents thing))))

(defun write-recipe (operator name descriptor &key prototype contents kickers x y)
  "Return the recipe of a thing NAME: the attributes of the thing PROTOTYPE, if any, overridden by
DESCRIPTOR; its contents followed by the recipes CONTENTS. Signals WRONG-ARGUMENT. See reading 58."
  (unless (and name (symbolp name)) (reject-argument operator "name" name "a symbol"))
  (unless (or (null prototype) (thing-p prototype))
    (reject-argument operator "prototype" prototype "a thing, made by NEW-THING"))
  (let ((own (normal-descriptor operator descriptor)))
    (make-recipe name
                 (merge-descriptors own (and prototype (thing-attributes prototype)))
                 (append (and prototype (mapcar #'thing-recipe (thing-contents prototype)))
                         contents)
                 :kickers (mapcar #'known-kicker kickers)
                 :x (and x (double x)) :y (and y (double y)))))

(defun known-kicker (kicker)
  "Return KICKER, a kicker or the name of one, for a recipe. Signals UNKNOWN-NAME."
  (let ((found (find-kicker kicker)))
    (if (kicker-p kicker) kicker (kicker-name found))))

(defun attach-by-recipe (thing kicker)
  "Put on THING the KICKER, which a recipe may know by name; say so if there no longer is one."
  (let ((found (find-kicker kicker nil)))
    (if found
        (attach-kicker thing found)
        (warning-set thing " goes without the kicker " kicker ", which is no longer defined."))))

(defun follow-recipe (recipe world)
  "Return a new thing made by RECIPE, nowhere yet, in WORLD, or a prototype if WORLD is
NIL (reading 63)."
  (let* ((contents (loop for inside in (recipe-contents recipe)
                         collect (follow-recipe inside world)))
         (thing (%make-thing (recipe-name recipe) (if world (world-next-serial world) 0) world)))
    (setf (thing-contents thing) contents
          (thing-attributes thing) (recipe-attributes recipe))
    (dolist (inside contents) (setf (thing-location inside) thing))
    (refresh-physics thing)
    (when world
      (incf (world-next-serial world))
      (incf (world-live-count world))
      (add-to-stock thing (world-stock world)))
    (dolist (kicker (recipe-kickers recipe)) (attach-by-recipe thing kicker))
    thing))

(defun find-recipe (test recipes)
  "Return the first of RECIPES, or of those in them, of which TEST is true; and its value."
  (dolist (recipe recipes)
    (let ((value (funcall test recipe)))
      (when value (return (values recipe value))))
    (multiple-value-bind (inside value) (find-recipe test (recipe-contents recipe))
      (when inside (return (values inside value))))))

(defun attribute-names (recipes)
  "Return the names, keywords, of all attributes that things made by RECIPES say something of."
  (remove-duplicates
   (loop for recipe in recipes
         append (mapcar #'first (recipe-attributes recipe))
         append (attribute-names (recipe-contents recipe)))))

;;; Worlds.

(defun empty-world (world)
  "Leave WORLD without things and kickers, as its map is. What was in it is destroyed, and its
robots are as they were made."
  (let ((map (world-map world)))
    (do-things (thing world)
      (setf (thing-alive-p thing) nil (thing-location thing) nil (thing-contents thing) '())
      (detach-all-kickers thing))
    (reset world)
    (setf (world-flags world) (copy-seq (map-flags map))
          (world-stock world) (make-stock (* (map-width map) (map-height map)))
          (world-kicker-generation world) *kicker-generation*)))

(defun reset-world (world &key (seed (world-seed world)))
  "Make WORLD as it was when it was fresh, with the integer SEED: the things of its map's recipe,
tick 0, robots where they start. Timeline and watchers stay. Return WORLD."
  (empty-world world)
  (seed-world world seed)
  (dolist (recipe (map-things (world-map world)) world)
    (place-thing (follow-recipe recipe world) :floor (recipe-x recipe) (recipe-y recipe))))

(defun make-world (map &key (seed 0))
  "Return a fresh world of MAP (a map or its name) that depends on it and the integer SEED only."
  (reset-world (%make-world (find-map map)) :seed seed))

;;; What a map or a definition says is everybody's.
(define-shared map cell substance attribute place-type place rule recipe)
