;;;; agreement-making.lisp -- random scripts: worlds, robots, actions.

(in-package :ars-magna.tests)
(in-suite agreement)

(defvar *making* nil "The dice of which a script is made.")

(defun make-roll (count) (base:roll-index count *making*))
(defun make-luck (probability) (base:chance probability *making*))
(defun make-pick (list) (base:roll-element list *making*))
(defun make-between (low high) (base:roll-between low high *making*))

;;; Worlds. Kickers of the random driver, and two that ask for something in the tick.

(world:defkicker accord-again (thing) (:prob .1)
  (world:kick-thing thing .1 0 t)
  (when (zoo-chance .5) (world:run-kicker world:self)))

(world:defkicker accord-later (thing) (:prob .05)
  (time:schedule (nil :timer 3) (world:kick-thing thing 0 (- (random 2d0) 1) t)))

(defparameter *accord-kickers*
  '(ride-hop ride-be-put-away ride-vanish ride-change accord-again accord-later))

(defun random-clauses (width height)
  "Return clauses of a map: the walls around it, and some inside, but not where robots begin."
  (cons `(rect (0 0) (,(1- width) ,(1- height)) bricks 1 4 8 12)
        (loop repeat (make-roll 4)
              for x = (+ 3 (make-roll (- width 5)))
              for y = (+ 2 (make-roll (- height 6)))
              collect `(wall (,x ,y) (,x ,(+ y (make-roll 3))) slate 20))))

(defun random-attributes ()
  (append (list (list :size (make-between .1 9)) (list :weight (make-between 0 3))
                (list :color (make-pick '(red blue green))))
          (make-pick '(() ((:capacity 8)) ((:capacity 2)) ((:closed t) (:capacity 8))
                       ((:obsmove t)) ((:obsview t))))))

(defun random-make (width height)
  `(make ,(make-pick '(ball box crate pin)) ,(make-between 1.2 (- width 1.2))
         ,(make-between 1.2 (- height 1.2)) ,(random-attributes)
         ,(loop repeat (make-roll 3) collect (make-pick *accord-kickers*))))

(defun random-robots ()
  "Return one robot, or two or three in different cells."
  (loop for name in (make-pick '((accord-one) (accord-one accord-two)
                                 (accord-one accord-two accord-three)))
        for row from 1 by 2
        collect (list name (list (make-between 1.3 2.8) (make-between (+ row .1) (+ row .9)))
                      (make-pick '(0 1 2 4))
                      :cameras (list (list (* 2 pi) 5)) :hands '(10) :bins '(8)
                      :parts '((robot:rangefinder :beams 4 :arc 5)))))

;;; Deeds.

(defun accord-argument (type)
  "Return a word in a deed for an argument of TYPE."
  (let ((index (make-roll 8)))
    (ecase (intern (string type) :keyword)
      (:robot `(:robot ,index))
      (:camera `(:camera ,index))
      (:hand `(:hand ,index))
      (:storage-bin `(:bin ,index))
      (:rangefinder `(:sensor ,index))
      (:designator `(:designator ,index))
      (:destination (make-pick `((:bin ,index) (:designator ,index))))
      (:designator-type (make-pick '(:local :non-local)))
      (:specification (make-pick '(() ((:size (0 100))) ((:color (red blue))) ((:closed nil)))))
      (:place-type (make-pick '(doorway convex concave)))
      (:receiving-part (make-pick '(:hand :bin)))
      (:part-number (make-pick '(0 1)))
      (:recipient :all)
      (:message (make-pick '(:go "word" (1 (2 "word")))))
      ((:number :speed :distance) (make-pick '(0 1 .3 .8 2 5)))
      (:angle (make-pick '(0 1 -2 .1 3.2d0 1/2)))
      (:direction (make-pick '(:north :south-east :west)))
      (:duration (make-pick '(0 1/4 3/2 5 20)))
      ((:ticks :tick-span) (make-pick '(0 1 2 5 20))))))

(declaim (ftype function random-deed))

(defun random-deeds (depth)
  "Return what a continuation does, at most DEPTH deep."
  (if (or (zerop depth) (make-luck .4))
      '()
      (loop repeat (1+ (make-roll 2)) collect (random-deed (1- depth)))))

(defun random-command (depth)
  (let ((command (make-pick (own-commands))))
    `(command ,(command:command-name command)
              ,(accord-argument (command:spec-type (command:command-resource command)))
              ,(loop for spec in (command:command-parameters command)
                     collect (accord-argument (command:spec-type spec)))
              ,@(random-deeds depth))))

(defun random-look (depth)
  "Return a deed that looks for something, tracks it and takes it."
  (let ((index (make-roll 4)))
    `(command command:camera-get-object-designator (:camera ,index) (:non-local ())
              (command ,@(if (make-luck .5)
                             `(command:camera-track
                               (:camera ,index) ((:designator ,(make-roll 4))))
                             `(command:camera-track-matching
                               (:camera ,index)
                               ((:designator ,(make-roll 4)) ,(make-pick '(() ((:color green)))))))
                       ,@(if (make-luck .5)
                             `((command command:hand-grasp-desig (:hand ,index)
                                        ((:camera ,index) (:designator ,(make-roll 4)))
                                        ,@(random-deeds depth)))
                             (random-deeds depth))))))

(defun random-change ()
  (let ((thing `(:thing ,(make-roll 12))))
    (ecase (make-roll 10)
      (0 `(move ,thing ,(make-between 2 6) ,(make-between 2 6)))
      (1 `(put ,thing ,(make-pick `((:hand ,(make-roll 2)) (:bin ,(make-roll 2))
                                    (:thing ,(make-roll 9))))))
      (2 `(set ,thing ,@(make-pick '((:closed t) (:closed nil) (:weight 9) (:color green)))))
      (3 `(kick ,thing ,(make-between -1 1) ,(make-between -1 1)))
      (4 (if (make-luck .8)
             `(attach ,thing ,(make-pick *accord-kickers*))
             `(put-kicker ,thing (:thing ,(make-roll 9)))))
      ((5 6) `(run-kicker ,thing ,(make-roll 3)))
      (7 (random-make 9 9))
      (8 (if (make-luck .3) `(destroy ,thing) `(grab (:camera ,(make-roll 2)))))
      (9 `(place (:robot ,(make-roll 2)) ,(make-between 2 6) ,(make-between 2 6) 1)))))

(defun random-event (depth)
  (let ((thing `(:thing ,(make-roll 12))) (timer (make-roll 9)) (priority (make-roll 3))
        (resource (make-pick '(nil :bell (:robot 0) (:camera 0)))))
    (ecase (make-roll 6)
      (0 `(kick-later ,thing ,timer .3 -.2))
      (1 `(kick-twice ,thing ,timer .3 .1))
      (2 `(count-and-kick ,thing ,resource ,priority ,timer ,(make-pick '(nil 2 9 20))))
      (3 `(kick-by-chance ,thing ,timer))
      (4 `(command-later (:robot ,(make-roll 2)) ,timer 1 ,@(random-deeds depth)))
      (5 `(do-later ,resource ,priority ,timer ,(list (random-change)))))))

(defun random-script-setting ()
  (ecase (make-roll 4)
    (0 `(seed ,(make-roll 1000)))
    (1 `(parameter base:motion-noise* ,(/ (make-roll 9) 10d0)))
    (2 '(turn-by-chance (:robot 0)))
    (3 `(thinking ,(make-pick '(:free :charged (:charged :budget 30)))))))

(defun random-word-to-plans ()
  (let ((task `(:task ,(make-roll 20))))
    (ecase (make-roll 12)
      ((0 1) `(begin ,(make-pick '(mutter brood)) ,(make-roll 9) ,(1+ (make-roll 5))))
      (2 `(begin ,(make-pick '(roam-about peer brief)) ,(make-roll 9)))
      (3 `(begin shove-later (:thing ,(make-roll 9)) ,(1+ (make-roll 4))))
      ((4 5) `(begin-text ,(make-roll 10000)))
      (6 `(end ,task))
      (7 `(suspend ,task))
      (8 `(wake-up ,task))
      (9 `(evaporate ,task))
      (10 '(plan-turn 1/2))
      (11 '(pulse)))))

;; Which deeds there are: a run with plans or events under way cannot be saved.
(defvar *accord-sorts* '(:commands :changes) "What a script may be made of.")

(defun random-deed (depth)
  (ecase (make-pick *accord-sorts*)
    (:commands (case (make-roll 10)
                 ((0 1) (random-look depth))
                 (2 `(manipulate ,(make-pick '(open close lock)) (:designator ,(make-roll 4))
                                 (:hand ,(make-roll 2)) ,@(random-deeds depth)))
                 (t (random-command depth))))
    (:changes (if (make-luck .2) (random-script-setting) (random-change)))
    (:events (random-event depth))
    ;; What an observer says to plans in the place of a continuation comes too late in the tick.
    (:plans (if (= depth 3) (random-word-to-plans) (random-command depth)))))

(defun random-sorts ()
  (append '(:commands :commands :changes)
          (and (make-luck .4) '(:events))
          (and (make-luck .35) '(:plans))))

(defun random-steps (ticks)
  (sort (loop repeat (+ 5 (make-roll 40))
              collect (list (make-roll ticks)
                            (if (make-luck .25) :observer :between)
                            (random-deed 3)))
        #'< :key #'first))

(defun random-script (seed)
  "Return the script that comes from SEED."
  (let* ((*making* (base:make-dice seed "agreement"))
         (width (+ 8 (make-roll 6))) (height (+ 8 (make-roll 6))) (ticks (+ 10 (make-roll 90)))
         (*accord-sorts* (random-sorts)))
    (make-script :seed seed :width width :height height :ticks ticks :at (make-roll (1+ ticks))
                 :clauses (random-clauses width height) :robots (random-robots)
                 :thinking (make-pick '(:free :free :charged)) :keep (make-pick '(2 5 30))
                 :stride (make-pick '(1 3 10)) :late-p (make-luck .5)
                 :steps (append (loop repeat (make-roll 8)
                                      collect (list 0 :between (random-make width height)))
                                (random-steps ticks)))))
