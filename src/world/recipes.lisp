;;;; recipes.lisp -- how to make a thing: what map clauses and prototypes come to.

(in-package :ars-magna.world)

(export '(make-world reset-world doubt-idle-kickers recipe make-recipe))

;;; A recipe is fixed when it is written: a prototype's attributes and contents are copied then,
;;; so that a world made of it later does not depend on what became of the prototype. Contents
;;; are made before their container, each with the next serial number of the world; prototypes
;;; take none. Manual 5.1 and 5.3.

(defstruct (recipe (:constructor make-recipe (name attributes contents &key kickers x y))
                   (:copier nil))
  "A thing to be made: in a map's recipe, at X, Y."
  (name nil :type symbol :read-only t)
  (attributes '() :type list :read-only t)
  (contents '() :type list :read-only t)
  (kickers '() :type list :read-only t)
  (x nil :type (or null double-float) :read-only t)
  (y nil :type (or null double-float) :read-only t))

(document-functions
  make-recipe "Return the recipe of a thing NAME with ATTRIBUTES, CONTENTS, recipes, and KICKERS,
at X, Y if they are given.")

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
  (unless (and name (symbolp name)) (reject-value operator "name" name "a symbol"))
  (unless (or (null prototype) (thing-p prototype))
    (reject-value operator "prototype" prototype "a thing, made by NEW-THING"))
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
         (thing (%make-thing (recipe-name recipe) (if world (take-serial world) 0) world)))
    (setf (thing-contents thing) contents
          (thing-attributes thing) (recipe-attributes recipe))
    (dolist (inside contents) (setf (thing-location inside) thing))
    (refresh-physics thing)
    (when world (add-thing thing world))
    (dolist (kicker (recipe-kickers recipe)) (attach-by-recipe thing kicker))
    thing))

(defun attribute-names (recipes)
  "Return the names, keywords, of all attributes that things made by RECIPES say something of."
  (remove-duplicates
   (loop for recipe in recipes
         append (mapcar #'first (recipe-attributes recipe))
         append (attribute-names (recipe-contents recipe)))))

;;; Kickers that nothing has.

(defun in-recipe-p (kicker recipes)
  "True if RECIPES, or those in them, put KICKER on things."
  (loop for recipe in recipes
        thereis (or (member kicker (recipe-kickers recipe) :key (lambda (it) (find-kicker it nil)))
                    (in-recipe-p kicker (recipe-contents recipe)))))

(defun code-names-p (name package)
  "True if the code of a function whose name is in PACKAGE, or of another kicker, has NAME, that of
a kicker, in it."
  (flet ((names-it-p (function) (member name (code-references function))))
    (or (loop for kicker in (all-kickers)
                thereis (and (not (eq name (kicker-name kicker)))
                             (names-it-p (kicker-body kicker))))
        (and package
             (do-symbols (symbol package)
               (when (and (users-symbol-p symbol) (fboundp symbol)
                          (not (macro-function symbol))
                          (names-it-p (fdefinition symbol)))
                 (return t)))))))

(defun perhaps-used-p (entry world)
  "True if a program may put the kicker of ENTRY on things of WORLD: a function names it, or it is
from another file than the map, or named there more than once."
  (let ((name (entry-name entry)) (file (source-file (entry-source entry)))
        (map-entry (lookup-entry (map-name (world-map world)) *maps*)))
    (if file
        (not (and map-entry
                  (equal file (source-file (entry-source map-entry)))
                  (eql 1 (count-in-file (name-string name) file))))
        (code-names-p name (symbol-package name)))))

(defun doubt-unused-kicker (entry world)
  "Say if the kicker of ENTRY is new, no program seems to use it, and nothing in WORLD has it, nor
will by any map."
  (let ((kicker (entry-object entry)))
    (unless (or (shiftf (kicker-known-p kicker) t)
                (perhaps-used-p entry world)
                (some (lambda (map) (in-recipe-p kicker (map-things map))) (all-maps)))
      (warn-once (list :kicker (kicker-name kicker)) world
                 (format nil "The kicker ~(~A~) is on no thing, so it never ran. Put it on one: ~
                              (obj (NAME :kickers (~:*~(~A~))) ...) in the map, or ~
                              (set-kicker THING '~:*~(~A~))."
                         (kicker-name kicker))))))

(defun doubt-untrue-kicker (kicker world)
  "Say if the test of KICKER, on a thing of WORLD, was never true, and asks for what nothing has."
  (let ((key (and (eq :no (kicker-held kicker))
                  (find-if-not (lambda (key) (or (attribute-of key) (carried-p key world)))
                               (kicker-asked kicker)))))
    (when key
      (warn-once (list :kicker (kicker-name kicker)) world
                 (format nil "The :test of the kicker ~(~A~) was never true. It asks for ~(~S~), ~
                              which no thing here has, nor is it declared."
                         (kicker-name kicker) key)))))

(defun doubt-idle-kickers (world)
  "Say, when a run in WORLD ends, which kickers were most likely meant to do something in it, and
cannot."
  (dolist (entry (registry-entries *kickers*))
    (doubt-unused-kicker entry world)
    (doubt-untrue-kicker (entry-object entry) world)))

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
