;;;; world-things.lisp -- attributes, things, containers, worlds.

(in-package :ars-magna.tests)
(in-suite world)

(defun open-world (&key (width 20) (height 20) (seed 1) clauses)
  "Return a fresh world of a map with CLAUSES."
  (apply #'map-of width height clauses)
  (world:make-world 'test-map :seed seed))

(defun thing-in (world name x y &optional descriptor &rest options)
  (apply #'world:make-new-thing name (list world x y) descriptor options))

(defun position-of (thing) (multiple-value-list (world:thing-position thing)))

(defmacro is-sound (world)
  `(is (null (world:world-invariant-violations ,world))))

;;; Attributes.

(test defattribute.built-ins-are-the-manuals
  "Manual 5.4 for :color and :size, 3.4.2 for :capacity."
  (let ((color (world:find-attribute :color)) (size (world:find-attribute :size)))
    (is (eq :discrete (world:attribute-kind color)))
    (is (= 8 (length (world:attribute-domain color))))
    (is (< (abs (- .4 (world:attribute-success color))) 1e-6))
    (is (< (abs (- .4 (world:attribute-noticed color))) 1e-6))
    (is (equal '(:substance) (world:attribute-supporters color)))
    (is (eq :numeric (world:attribute-kind size)))
    (is (< (abs (- .8 (world:attribute-base size))) 1e-6))
    (is (= 4 (world:attribute-max-mult size)))
    (is (< (abs (- .7 (world:attribute-noticed size))) 1e-6))
    (is (equal '(:capacity :obsview :weight) (world:attribute-supporters size))))
  (is (equal '(:size :weight) (world:attribute-supporters (world:find-attribute :capacity))))
  (is (subsetp '(:obsmove :obsview :closed :color :size :weight :capacity :substance)
               (mapcar #'world:attribute-name (world:all-attributes))))
  (dolist (name '(:obsmove :obsview :closed))
    (is (equal '(t nil) (world:attribute-domain (world:find-attribute name))))))

(test defattribute.defines-with-defaults
  (with-own-definitions
    (is (null (world:find-attribute :shape nil)))
    (is (eq :shape (eval '(world:defattribute :shape (cylinder cube)))))
    (let ((shape (world:find-attribute :shape)))
      (is (= 1 (world:attribute-success shape)))
      (is (= 0 (world:attribute-base shape)))
      (is (= 1 (world:attribute-max-mult shape)))
      (is (= 0 (world:attribute-noticed shape))))
    (eval '(world:defattribute :shape numeric :base 2 :support .5 :supported-by (:size)))
    (let ((shape (world:find-attribute 'shape)))
      (is (eq :numeric (world:attribute-kind shape)))
      (is (= .5 (world:attribute-noticed shape))))
    (is (= 1 (count :shape (world:all-attributes) :key #'world:attribute-name)))
    (is (null (world:find-attribute :no-such nil)))))

(test defattribute.rejects-malformed-options
  (loop for (form . expected)
          in '(((world:defattribute "x" numeric) . "a symbol")
               ((world:defattribute :x number) . "NUMERIC")
               ((world:defattribute :x ()) . "NUMERIC")
               ((world:defattribute :x numeric :success 2) . "a probability")
               ((world:defattribute :x numeric :base -1) . "not below 0")
               ((world:defattribute :x numeric :base) . "pairs")
               ((world:defattribute :x numeric :noise 1) . ":success")
               ((world:defattribute :x numeric :supported-by :size) . "a list of attribute names")
               ((world:defsubstance "wood" 3) . "a symbol")
               ((world:defsubstance wool "3") . "a number"))
        for complaint = (complaint-about form)
        do (is (and complaint (search expected complaint)) "~S: ~A" form complaint)))

(test substance.values
  (is (= 4.2 (coerce (world:substance-value-parameter 4.2) 'single-float)))
  (is (= 120 (world:substance-value-parameter 'wood)))
  (is (= 120 (world:substance-value-parameter :wood)))
  (is (= 7 (world:substance-value-parameter '(wood 7))))
  (is (= 0 (world:substance-value-parameter nil)))
  (is (eq 'wood (world:substance-value-type '(wood 7))))
  (is (null (world:substance-value-type 3)))
  (with-own-definitions
    (eval '(world:defsubstance wool 33))
    (is (= 33 (world:substance-value-parameter 'wool)))
    (world:make-new-thing 'sheep nil '((:substance phlogiston)))
    (is (search "phlogiston" (first (message-texts))))))

(test substance.numbers-need-no-name
  "A substance without a name is no unknown one: nothing is said."
  (with-own-definitions
    (world:make-new-thing 'sheep nil '((:substance 7)))
    (is (null (message-texts)))
    (world:make-new-thing 'goat nil '((:substance (phlogiston 7))))
    (is (= 1 (length (message-texts))))))

(test attributes.are-set-and-merged
  (with-own-definitions
    (let ((thing (world:make-new-thing 'box nil '((:size 5) (:color red) (:shape cube)))))
      (is (eql 5 (world:get-attribute thing :size)))
      (is (null (world:get-attribute thing :weight)))
      (setf (world:get-attribute thing :weight) 2)
      (is (= 2 (world:get-attribute thing :weight)))
      (is (= 2 (world:thing-weight thing)))
      (is (eql 3 (world:set-attribute thing :size 3)))
      (world:change-attribute thing '((:size 4) (:obsview t)))
      (is (equal '((:size 4) (:color red) (:shape cube) (:weight 2) (:obsview t))
                 (world:thing-attributes thing)))
      (is (world:thing-obsview-p thing))
      (is (not (world:thing-obsmove-p thing)))
      (world:set-attribute thing :size nil)
      (is (= 0 (world:thing-size thing)))
      (is (not (world:thing-substance-p thing)))
      (world:set-attribute thing :substance '(wood 9))
      (is (= 9 (world:thing-substance-parameter thing))))))

(test attributes.reject-what-they-cannot-be
  (let ((thing (world:make-new-thing 'box nil '())))
    (signals base:wrong-argument (world:set-attribute thing :size 'big))
    (signals base:wrong-argument (world:set-attribute thing :color 'beige))
    (signals base:wrong-argument (world:change-attribute thing '(:size 3)))
    (signals base:wrong-argument (world:set-attribute 7 :size 3))
    (signals base:wrong-argument (world:get-attribute nil :size))
    (finishes (world:set-attribute thing :no-such "anything"))))

;;; Making.

(test big-room.is-numbered-as-in-the-session
  "Manual 5.1 and E: contents are made before their container; prototypes take no number."
  (with-own-definitions
    (progv '(proto) (list (world:make-new-thing 'box nil '((:capacity 8) (:size 8) (:weight 2))
                                                :contents (list (world::thing-recipe
                                                                 (world:make-new-thing
                                                                  'coin nil '((:size 1)))))))
      (eval '(world:defmap test-map (75 75)
              (obj lamp (20 20) ((:size 2)))
              (obj small-box (20 20) ((:capacity 5) (:substance wood))
               (pen ((:size .2) (:color green))))
              (obj big-box (30.5 20) ((:capacity 11))
               ((a-box :prototype (symbol-value 'proto)) ((:size 6) (:color BLUE))
                (key ()))))))
    (let ((world (world:make-world 'test-map)))
      (is (equal '("LAMP#1" "PEN#2" "SMALL-BOX#3" "COIN#4" "KEY#5" "A-BOX#6" "BIG-BOX#7")
                 (mapcar #'princ-to-string (world:world-thing-list world))))
      (let ((a-box (world:find-thing 'a-box world)))
        (is (equal '(30.5d0 20d0) (position-of a-box)))
        (is (equal '((:capacity 8) (:size 6) (:weight 2) (:color blue))
                   (world:thing-attributes a-box)))
        (is (eq (world:find-thing "big-box#7" world) (world:thing-outermost a-box)))
        (is (equal '("COIN#4" "KEY#5") (mapcar #'princ-to-string (world:thing-contents a-box))))
        (is (= 7 (world:remaining-capacity a-box)) "8 less the coin's 1"))
      (is (= 2 (length (world:things-at world 20.9 20.1))))
      (is-sound world))))

(defvar *the-map*)
(defvar *the-box*)
(defun box-itself (box number) (declare (ignore number)) box)

(test new-thing.takes-all-locations
  (with-own-definitions
    (let* ((world (open-world)) (world:*world* world))
      (progv '(*the-map* *the-box*) (list (world:find-map 'test-map) nil)
        (let ((box (eval '(setf *the-box* (world:new-thing box (*the-map* (+ 1 2) 4)
                                                           ((:capacity 9)))))))
          (is (equal '(3d0 4d0) (position-of box)))
          (is (eq world (world:thing-world box)))
          (let ((pen (eval '(world:new-thing pen *the-box* ((:size 1)))))
                (cup (eval '(world:new-thing cup (:with *the-box*) ())))
                (cap (eval '(world:new-thing cap (box-itself *the-box* 2) ()))))
            (is (eq box (world:thing-location pen)))
            (is (equal '(3d0 4d0) (position-of pen)))
            (is (eq :floor (world:thing-location cup)))
            (is (equal '(3d0 4d0) (position-of cup)))
            (is (eq box (world:thing-location cap)) "a call of two arguments is a location")
            (is (eq box (world:thing-location
                         (world:make-new-thing 'nib (list :with pen) '())))))
          (let ((copy (eval '(let ((map *the-map*))
                              (world:new-thing copy (map 1 1) ((:size 2)) :prototype *the-box*)))))
            (is (equal '((:capacity 9) (:size 2)) (world:thing-attributes copy)))
            (is (equal '("PEN" "CAP" "NIB")
                       (mapcar (lambda (thing) (string (world:thing-name thing)))
                               (world:thing-contents copy)))))))
      (is-sound world))))


(test new-thing.prototypes-are-nowhere
  (let ((box (world:new-thing box nil ((:capacity 8)))))
    (is (equal "BOX" (princ-to-string box)))
    (is (null (world:thing-world box)))
    (is (equal '(nil nil) (position-of box)))
    (let ((pen (world:make-new-thing 'pen box '())))
      (is (equal (list pen) (world:thing-contents box))))
    (is (null (world:kick-thing box 1 1 t)))
    (signals base:misuse (world:move-thing box 1 1))
    (signals base:misuse (world:destroy-thing box))))

(test new-thing.rejects
  (with-own-definitions
    (let ((world (open-world)))
      (signals base:wrong-argument (thing-in world 'box 20 3))
      (signals base:wrong-argument (thing-in world 'box 'here 3))
      (signals base:wrong-argument (thing-in world "box" 2 3))
      (signals base:wrong-argument (thing-in world 'box 2 3 '(:size 3)))
      (signals base:wrong-argument (world:make-new-thing 'box 17 '()))
      (signals base:wrong-argument (world:make-new-thing 'box '(1 2 3 4) '()))
      (signals base:wrong-argument (world:make-new-thing 'box (list :with nil) '()))
      (signals base:unknown-name (world:make-new-thing 'box (list 'no-map 2 3) '()))
      (is (search "a symbol" (complaint-about '(world:new-thing "x" nil ()))))
      (is (search "each attribute once" (complaint-about '(world:new-thing x nil (:size 3)))))
      (is (= 0 (world:world-live-count world))))))

(test prototype.later-changes-do-not-reach-the-map
  (with-own-definitions
    (let ((box (world:make-new-thing 'box nil '((:size 1)))))
      (progv '(proto) (list box)
        (eval '(world:defmap test-map (5 5) (obj (a :prototype (symbol-value 'proto)) (1 1) ()))))
      (world:set-attribute box :size 7)
      (is (= 1 (world:thing-size (world:find-thing 'a (world:make-world 'test-map))))))))

;;; Moving and destroying.

(test move-thing.moves-and-tells
  (with-own-definitions
    (let* ((world (open-world)) (told '())
           (box (thing-in world 'box 1 1 '((:obsmove t))))
           (pen (thing-in world 'pen 2 2)))
      (setf (world:world-move-watchers world)
            (list (lambda (thing old new) (push (list thing old new) told))))
      (world:move-thing pen box)
      (world:move-thing box 3.5 4.5)
      (is (equal '(3.5d0 4.5d0) (position-of pen)))
      (world:move-thing pen '(6 7))
      (is (equal (list (list pen :floor box) (list box :floor :floor) (list pen box :floor))
                 (reverse told)))
      (is (= (logior world:+occupied+ world:+obsmove+)
             (aref (world:world-flags world) (world:map-index (world:world-map world) 3.5 4.5))))
      (is (= 0 (aref (world:world-flags world) (world:map-index (world:world-map world) 1 1))))
      (is-sound world))))

(test move-thing.rejects
  (with-own-definitions
    (let* ((world (open-world)) (other (world:make-world 'test-map))
           (box (thing-in world 'box 1 1)) (inner (world:make-new-thing 'inner box '())))
      (signals base:misuse (world:move-thing box inner))
      (signals base:misuse (world:move-thing box box))
      (signals base:misuse (world:move-thing box (thing-in other 'box 1 1)))
      (signals base:wrong-argument (world:move-thing box 1 -1))
      (signals base:wrong-argument (world:move-thing box "here"))
      (world:destroy-thing inner)
      (signals base:misuse (world:move-thing inner 1 1))
      (signals base:misuse (world:move-thing box inner))
      (is-sound world))))

(test destroy-thing.leaves-the-contents-where-they-were
  (with-own-definitions
    (let* ((world (open-world))
           (box (thing-in world 'box 3 4)) (inner (world:make-new-thing 'inner box '()))
           (pen (world:make-new-thing 'pen inner '())))
      (world:destroy-thing inner)
      (is (eq box (world:thing-location pen)))
      (world:destroy-thing box)
      (is (eq :floor (world:thing-location pen)))
      (is (equal '(3d0 4d0) (position-of pen)))
      (is (equal (list pen) (world:world-thing-list world)))
      (is (not (world:thing-alive-p box)))
      (finishes (world:destroy-thing box))
      (is-sound world))))

(test find-thing.by-name-or-number
  (with-own-definitions
    (let* ((world (open-world)) (world:*world* world)
           (a (thing-in world 'box 1 1)) (b (thing-in world 'box 2 2)))
      (is (eq a (world:find-thing :box)))
      (is (equal (list a b) (world:find-things "box")))
      (is (eq b (world:find-thing 2)))
      (is (eq b (world:find-thing "Box#2" world)))
      (is (null (world:find-thing 'cup))))))

(test total-weight.counts-contents
  (with-own-definitions
    (let* ((world (open-world)) (box (thing-in world 'box 1 1 '((:weight 2) (:capacity 5))))
           (cup (world:make-new-thing 'cup box '((:weight 1/2) (:size 3)))))
      (world:make-new-thing 'pea cup '((:weight .25)))
      (is (= 2.75 (world:thing-total-weight box)))
      (is (= 2 (world:remaining-capacity box))))))

;;; Worlds.

(test current-world.is-the-bound-one-or-the-resident
  (with-own-definitions
    (let* ((map (map-of 5 5 '(obj lamp (1 1) ()))) (resident (world:map-resident-world map))
           (fresh (world:make-world map)) (other (map-of 6 6)))
      (is (eq resident (world:current-world map)))
      (let ((world:*world* fresh))
        (is (eq fresh (world:current-world map)))
        (is (eq (world:map-resident-world other) (world:current-world other))))
      (world:destroy-thing (world:find-thing 'lamp fresh))
      (is (world:find-thing 'lamp resident))
      (let ((lamp (world:find-thing 'lamp resident)))
        (world:reset-world resident)
        (is (not (world:thing-alive-p lamp)))
        (is (= 1 (world:thing-serial (world:find-thing 'lamp resident))))))))

;; What takes the place of a timeline.
(defstruct clerk (seen '()))

(defmethod world:change-world ((clerk clerk) world function operator arguments)
  (declare (ignore world))
  (push (cons operator arguments) (clerk-seen clerk))
  (funcall function))

(test changes.go-to-the-timeline-of-their-world
  (with-own-definitions
    (let* ((world (open-world))
           (clerk (setf (world:world-timeline world) (make-clerk)))
           (box (thing-in world 'box 1 1)))
      (world:set-attribute box :size 3)
      (world:change-attribute box '((:size 4)))
      (world:kick-thing box 1 0 nil)
      (world:move-thing box 5 5)
      (eval `(world:put-kicker hop (th ,box) (:prob 1/2) (world:kick-thing th 1 1 t)))
      (eval `(world:put-kicker hop (th ,box) ()))
      (world:destroy-thing box)
      (is (equal '(world:make-new-thing world:set-attribute world:change-attribute world:kick-thing
                   world:move-thing world::call-put-kicker world::call-put-kicker
                   world:destroy-thing)
                 (reverse (mapcar #'first (clerk-seen clerk)))))
      (is (equal (list box :size 3) (rest (nth 6 (clerk-seen clerk))))))))

;;; Anything goes.

(defun random-location (world things dice)
  (let ((x (base:roll-between 0 12 dice)) (y (base:roll-between 0 12 dice)))
    (if (and things (base:chance .4 dice))
        (base:roll-element things dice)
        (list world x y))))

(defun do-something (world dice)
  "Do one random operation on WORLD; misuse is part of the game."
  (let* ((things (world:world-thing-list world))
         (thing (and things (base:roll-element things dice)))
         (place (random-location world things dice)))
    (handler-case
        (ecase (if thing (base:roll-index 7 dice) 0)
          (0 (world:make-new-thing 'it place `((:obsmove ,(base:chance .5 dice))
                                               (:obsview ,(base:chance .5 dice)))
                                   :prototype (and (base:chance .3 dice) (< (length things) 60)
                                                   thing)))
          (1 (if (consp place)
                 (world:move-thing thing (rest place))
                 (world:move-thing thing place)))
          ((2 3) (world:kick-thing thing (base:roll-within 5 dice) (base:roll-within 5 dice)
                                   (base:chance .5 dice)))
          (4 (world:set-attribute thing (base:roll-element '(:obsmove :obsview :closed) dice)
                                  (base:chance .5 dice)))
          (5 (world:destroy-thing thing))
          (6 (world:change-attribute thing '((:obsmove t) (:obsview nil)))))
      (base:misuse () nil))))

(defun random-history (seed steps)
  (let ((world (open-world :width 12 :height 12
                           :clauses '((rect (0 0) (12 12) bricks 1) (wall (4 4) (8 7) slate 1))))
        (dice (base:make-dice seed)))
    (loop for step from 1 to steps
          do (do-something world dice)
             (when (zerop (mod step 20)) (is-sound world)))
    world))

(test world.stays-sound-under-random-operations
  (with-own-definitions
    (dotimes (seed 10) (is-sound (random-history seed 400)))))

(test world.invariants-notice-damage
  (with-own-definitions
    (let* ((world (open-world)) (box (thing-in world 'box 1 1)) (pen (thing-in world 'pen 2 2)))
      (flet ((noticed () (world:world-invariant-violations world)))
        (is (null (noticed)))
        (setf (world::thing-x box) 9d0)
        (is (noticed))
        (setf (world::thing-x box) 1d0 (world::thing-obsmove-p box) t)
        (is (noticed))
        (setf (world::thing-obsmove-p box) nil (world::thing-location pen) box)
        (is (noticed))
        (setf (world::thing-location pen) :floor)
        (is (null (noticed)))
        (push pen (world:thing-contents box))
        (signals base:contradiction (world:check-world world))))))

(test digest.is-of-the-state
  (with-own-definitions
    (flet ((digest (world) (base:digest-value (base:digest-state world (base:make-digest)))))
      (is (= (digest (random-history 3 300)) (digest (random-history 3 300))))
      (is (/= (digest (random-history 3 300)) (digest (random-history 4 300))))
      (let* ((world (open-world)) (box (thing-in world 'box 1 1 '((:size 1) (:weight 2))))
             (before (digest world)))
        (world:set-attribute box :size 2)
        (is (/= before (digest world)))
        (world:set-attribute box :size 1)
        (is (= before (digest world)))
        (world:kick-thing box 1d-9 0 nil)
        (is (/= before (digest world)))))))
