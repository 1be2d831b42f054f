;;;; kickers.lisp -- kickers that move and change things in the shipped worlds.

;;; Use them in any world: (obj (ball :prototype ars-worlds:ball* :kickers (roll-away)) ...).
;;; Kickers are found by name, in any package. Steps are shorter than a cell, so nothing is
;;; kicked through a wall. A movement of several ticks keeps its state in an attribute of the thing,
;;; which robots cannot sense. All randomness comes from the world's dice for users, so a run with
;;; the same seed repeats itself. Manual 5.3.1.

(in-package :ars-worlds)
(in-readtable :nisp)

;;; Helpers for kickers. They use the dice of the current world.

(defun user-dice ()
  "Return the dice of the current world for users' random decisions."
  (world-dice *world* :user))

(defun random-step (length)
  "Return a step of LENGTH metres in a random direction, a list (dx dy)."
  (let ((angle (roll-between 0 2pi (user-dice))))
    (list (* length (cosine angle)) (* length (sine angle)))))

(defun scale-step (factor step)
  "Return STEP, a list (dx dy), scaled by FACTOR."
  (list (* factor (first step)) (* factor (second step))))

(defun take-step (thing step)
  "Move THING by STEP, (dx dy) in metres, and return true, unless a wall or lid blocks THING."
  (kick-thing thing (first step) (second step) #f))

;;; Things.

(defkicker roll-away (ball) (:prob .004)
  ;; Rolls up to about five metres, slowing down, and bounces off walls.
  (let* ((step (or (get-attribute ball :rolling) (random-step .9)))
         (next (scale-step (if (take-step ball step) .85 -.5) step)))
    (if (< (+ (abs (first next)) (abs (second next))) .05)
        (set-attribute ball :rolling #f)
        (progn
          (set-attribute ball :rolling next)
          (run-kicker self)))))

(defkicker blow-about (sheet) (:prob .002)
  (take-step sheet (random-step (roll-between .1 .8 (user-dice)))))

(defkicker be-borrowed (thing) (:prob .0005 :test (and (eq :floor (thing-location thing))
                                                       (get-attribute thing :haunts)))
  ;; Somebody takes the thing and leaves it at one of its :haunts, a list of points (x y).
  (move-thing thing (roll-element (get-attribute thing :haunts) (user-dice))))

(defkicker change-light (lamp) (:prob .02)
  (set-attribute lamp :color
                 (if (string= 'lightred (get-attribute lamp :color)) 'lightgreen 'lightred)))

(defkicker print-page (printer) (:prob .01 :test (< (length (thing-contents printer)) 3))
  (new-thing page printer () :prototype sheet*))

;;; People and pets.

(defkicker wander-about (walker) (:prob .03)
  ;; Walks a few metres straight ahead, then stops.
  (let ((step (or (get-attribute walker :heading) (random-step .4))))
    (if (and (take-step walker step) (chance .9 (user-dice)))
        (progn
          (unless (get-attribute walker :heading) (set-attribute walker :heading step))
          (run-kicker self))
        (set-attribute walker :heading #f))))

(defun approach (walker point stride)
  "Move WALKER at most STRIDE metres towards POINT, a list (x y), or in a random direction if the
way is blocked. Return true if WALKER has arrived."
  (multiple-value-bind (x y) (thing-position walker)
    (let* ((step (list (- (first point) x) (- (second point) y)))
           (distance (sqrt (+ (expt (first step) 2) (expt (second step) 2)))))
      (cond ((<= distance stride)
             (take-step walker step))
            ((not (take-step walker (scale-step (/ stride distance) step)))
             (take-step walker (random-step stride))
             #f)))))

(defkicker do-rounds (walker) (:prob .4 :test (get-attribute walker :rounds))
  ;; Walks from one of its :rounds, a list of points (x y), to the next, again and again.
  (let ((rounds (get-attribute walker :rounds)))
    (when (approach walker (first rounds) .5)
      (set-attribute walker :rounds (append (rest rounds) (list (first rounds)))))))

(document-variables
 roll-away "Makes a ball roll a few metres now and then; it bounces off walls."
 blow-about "Moves a light thing now and then, less than a metre at a time."
 be-borrowed "Moves a thing on the floor to one of its :haunts, points (x y), now and then."
 change-light "Changes a lamp between lightred and lightgreen."
 print-page "Puts a page into a printer, while it contains fewer than three things."
 wander-about "Makes a person or pet walk a few metres now and then."
 do-rounds "Makes a person walk from one of its :rounds, points (x y), to the next, for ever.")
