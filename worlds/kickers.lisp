;;;; kickers.lisp -- what makes things in the shipped worlds move and change by themselves.

;;; Good for any world: write (obj (ball :prototype ars-worlds:ball* :kickers (roll-away)) ...).
;;; Kickers go by name, whatever the package. Steps are shorter than a cell, so nothing is kicked
;;; through a wall. Where a movement goes on, what it was doing is an attribute of the thing, which
;;; no robot senses. All chance comes from the world's dice for users: a run with the same seed
;;; repeats itself. Manual 5.3.1.

(in-package :ars-worlds)
(in-readtable :nisp)

;;; Chance. These are for kickers: they use the dice of the world that is being run.

(defun user-dice ()
  "Return the dice of the world being run, for what users decide by chance."
  (world-dice *world* :user))

(defun random-step (length)
  "Return a step of LENGTH metres in any direction, as a list (dx dy)."
  (let ((angle (roll-between 0 2pi (user-dice))))
    (list (* length (cosine angle)) (* length (sine angle)))))

(defun scale-step (factor step)
  "Return STEP, a list (dx dy), FACTOR times as long."
  (list (* factor (first step)) (* factor (second step))))

(defun take-step (thing step)
  "Move THING by STEP, a list (dx dy) in metres, unless a wall or lid is in the way. True if it
moved."
  (kick-thing thing (first step) (second step) #f))

;;; Things.

(defkicker roll-away (ball) (:prob .004)
  ;; Rolls up to some five metres, slower and slower, and bounces off walls.
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
  ;; Somebody uses what lies about and leaves it at one of its :haunts, a list of points (x y).
  (move-thing thing (roll-element (get-attribute thing :haunts) (user-dice))))

(defkicker change-light (lamp) (:prob .02)
  (set-attribute lamp :color
                 (if (string= 'lightred (get-attribute lamp :color)) 'lightgreen 'lightred)))

(defkicker print-page (printer) (:prob .01 :test (< (length (thing-contents printer)) 3))
  (new-thing page printer () :prototype sheet*))

;;; People and pets.

(defkicker wander-about (walker) (:prob .03)
  ;; Walks a few metres straight on and stands still again.
  (let ((step (or (get-attribute walker :heading) (random-step .4))))
    (if (and (take-step walker step) (chance .9 (user-dice)))
        (progn
          (unless (get-attribute walker :heading) (set-attribute walker :heading step))
          (run-kicker self))
        (set-attribute walker :heading #f))))

(defun approach (walker point stride)
  "Move WALKER by at most STRIDE metres towards POINT, a list (x y); if the way is barred, in any
direction. True if it has arrived."
  (multiple-value-bind (x y) (thing-position walker)
    (let* ((step (list (- (first point) x) (- (second point) y)))
           (distance (sqrt (+ (expt (first step) 2) (expt (second step) 2)))))
      (cond ((<= distance stride)
             (take-step walker step))
            ((not (take-step walker (scale-step (/ stride distance) step)))
             (take-step walker (random-step stride))
             #f)))))

(defkicker do-rounds (walker) (:prob .4 :test (get-attribute walker :rounds))
  ;; Walks from one to the next of its :rounds, a list of points (x y), for ever.
  (let ((rounds (get-attribute walker :rounds)))
    (when (approach walker (first rounds) .5)
      (set-attribute walker :rounds (append (rest rounds) (list (first rounds)))))))

(document-variables
 roll-away "Lets a ball start rolling; it rolls some metres and bounces off walls."
 blow-about "Lets what is light be blown about, less than a metre at a time."
 be-borrowed "Lets somebody use what lies about, and leave it at one of its :haunts, points (x y)."
 change-light "Lets a lamp change between lightred and lightgreen."
 print-page "Lets a printer put a page into itself, while it holds fewer than three things."
 wander-about "Lets a person or pet walk a few metres now and then."
 do-rounds "Lets somebody walk from one to the next of his :rounds, points (x y), for ever.")
