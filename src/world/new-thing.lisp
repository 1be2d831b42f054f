;;;; new-thing.lisp -- making things on the fly (manual 5.3).

(in-package :ars-magna.world)

(export '(destroyed-thing))

(defun resolve-position (position)
  "Return the world, :FLOOR and the coordinates for POSITION, a list (map x y)."
  (destructuring-bind (map x y) position
    (let ((world (current-world map)))
      (check-inside 'new-thing (world-map world) x y)
      (values world :floor x y))))

(defun resolve-neighbour (thing)
  (unless (and (thing-p thing) (thing-location thing))
    (reject-argument 'new-thing "location" (list :with thing)
                     "(:with thing), a thing that is somewhere"))
  (values (thing-world thing) (thing-location thing) (thing-x thing) (thing-y thing)))

(defun resolve-location (location)
  "Return, as values, the world, location and coordinates that LOCATION, as NEW-THING takes it
but evaluated, stands for."
  (cond ((null location) nil)
        ((and (proper-list-p location) (= 2 (length location)) (eq :with (first location)))
         (resolve-neighbour (second location)))
        ((and (proper-list-p location) (= 3 (length location)))
         (resolve-position location))
        ((consp location)
         (reject-argument 'new-thing "location" location
                          "NIL, what holds things, (:with thing) or (map x y)"))
        (t (values (check-holder 'new-thing nil location) location))))

;; What is noted does not depend on what becomes of a prototype, or of a map's name.
(defun noted-location (location world)
  "Return LOCATION, in WORLD, for MAKE-THING-AGAIN."
  (if (and (consp location) (not (eq :with (first location))))
      (cons (world-map world) (rest location))
      location))

(addition make-new-thing)
(defun make-new-thing (name location descriptor &key prototype contents kickers)
  "Return a new thing NAME, a symbol, with the attributes of DESCRIPTOR; NEW-THING as a function.
LOCATION is NIL for a prototype, a container, hand or storage bin, or a list (:with thing) or
(map x y), in metres; the map may also be a name or a world. PROTOTYPE is a thing whose attributes
and contents are copied first. CONTENTS, ours, is a list of recipes made by THING-RECIPE; KICKERS,
ours, a list of kickers or their names. Signals WRONG-ARGUMENT and UNKNOWN-NAME, and MISUSE for a
hand that holds something."
  (let ((recipe (write-recipe 'new-thing name descriptor :prototype prototype
                                                         :contents contents :kickers kickers)))
    (multiple-value-bind (world place x y) (resolve-location location)
      (when (location-full-p place)
        (reject-use "new-thing: ~A holds ~{~A~^, ~} and nothing else. Let go of that first."
                    (location-name place) (location-contents place)))
      (if world
          (note-slips name descriptor world)
          (warn-of-slips "new-thing" name descriptor))
      (changing (world make-new-thing name (noted-location location world)
                       (recipe-attributes recipe)
                       :contents (recipe-contents recipe) :kickers (recipe-kickers recipe))
        (let ((thing (follow-recipe recipe world)))
          (cond ((and world (eq place :floor)) (put-by-hand thing x y))
                (world (relocate thing place x y))
                (place (place-thing thing place x y)))
          thing)))))

(defun make-thing-again (name location descriptor &rest more)
  "Do as MAKE-NEW-THING does, in the world at hand and in no other."
  (unless (eq *world* (resolve-location location))
    (reject-argument 'make-new-thing "location" location "a location in the world of this run"))
  (apply #'call-with-data #'make-new-thing name location descriptor more))

(define-operator 'make-new-thing '(name datum datum) #'make-thing-again :rest 'datum)

(defun destroyed-thing (serial world)
  "Return what stands for the thing of WORLD that had the number SERIAL and was destroyed; NIL if
there never was one."
  (when (< 0 serial (world-next-serial world))
    (let ((thing (%make-thing 'destroyed serial world)))
      (setf (thing-alive-p thing) nil)
      thing)))

(defun position-form-p (form environment)
  "True if FORM, three elements long, means (map x y) rather than a call in ENVIRONMENT: it does if
it begins with a variable or the name of a map, and unless it begins with that of a function."
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
  a form whose value is a container, hand or storage bin, or NIL for a prototype;
  (:with form) -- at the location of another thing;
  (map x y) -- in a map, at coordinates in metres; all three are forms, but a symbol that is no
    variable is the name of a map.
PROTOTYPE is a form whose value is a thing; its attributes and contents are copied first, its
kickers are not. To compute name or descriptor use MAKE-NEW-THING. Signals WRONG-ARGUMENT, and
MISUSE for a hand that holds something.
See readings 12 and 167."
  (unless (and name (symbolp name))
    (reject-clause "new-thing" name "a symbol as the name of the thing"))
  (unless (descriptor-p descriptor)
    (reject-clause (title "new-thing" name) descriptor
                   "a list of lists (attribute value), each attribute once"))
  (unless (listp (cdr (last (ensure-list location))))
    (reject-clause (title "new-thing" name) location
                   "a location: a form, (:with form) or (map x y)"))
  (when (typep location '(cons real))
    (reject-clause (title "new-thing" name) location
                   (format nil "a map before the coordinates: (~(~A~) ~{~A~^ ~})"
                           (if *world* (map-name (world-map *world*)) "MAP") location)))
  `(make-new-thing ',name
                   ,(cond ((and (consp location) (eq :with (first location)))
                           `(list :with ,@(rest location)))
                          ((position-form-p location environment)
                           `(list ,(map-form (first location) environment) ,@(rest location)))
                          (t location))
                   ,(descriptor-form name descriptor) :prototype ,prototype))
