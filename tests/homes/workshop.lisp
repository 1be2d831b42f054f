;;;; workshop.lisp -- A joiner's workshop, where blades go blunt and a ball rolls about.

;;; The package uses only Common Lisp; what names of its we need for things of ours are shadowed.
(ars:define-user-package :workshop (:use :cl) (:shadow #:room #:max #:open #:step #:position))
(in-package :workshop)

(ars:defattribute :edge (blunt sharp keen) :success .9 :noticed .3)
(ars:defattribute :length numeric :base .2 :max-mult 3 :supported-by (:size))
(ars:defsubstance sawdust 33)
;; A pillar is a single filled cell; the place is the empty cell to its north, facing north.
(ars:def-place-type pillar (cell)
  :checker (if (equal '((nil nil nil) (nil t nil) (nil nil nil))
                      (ars:cell-occupancy-window cell 3 3))
               (values t 0 -1 (- (/ pi 2))) (values nil 0 0 0)))
;; A blade wears by chance, a chest falls open now and then, and the ball rolls east.
(ars:defkicker wear (blade) (:test (ars:chance .3 (ars:world-dice ars:*world* :user)))
  (setf (ars:get-attribute blade :edge) 'blunt))
(ars:defkicker open (chest) (:prob .2) (ars:set-attribute chest :closed nil))
(ars:defkicker step (ball) (:prob .3)
  (ars:kick-thing ball (ars:roll-between 0 1 (ars:world-dice ars:*world* :user)) 0 nil))
(defparameter table* (ars:new-thing table nil ((:size 14) (:color green) (:substance wood))))
(defparameter saw* (ars:new-thing saw nil ((:size 2) (:weight 2) (:color blue) (:edge sharp))))

(ars:defmap room (30 14)
  (rect (0 0) (29 13) stone 5)
  (wall (20 1) (20 8) slate 10 20)
  (wall (12 4) (12 4) bricks 12)                       ; the pillar
  (obj (table :prototype table*) (3 3) ())
  (obj (saw :prototype saw* :kickers (wear)) (3.5 10) ())
  (obj (saw :prototype saw* :kickers (wear)) (8.75 11.2) ((:color lightblue)))
  (obj (knife :prototype saw*) (6.2 6.3) ((:size 1) (:color red) (:length 2)))
  (obj spoon (6.7 6.1) ((:size 1) (:weight 1) (:color violet) (:length 2.5)))
  (obj axe (6.1 6.9) ((:size 3) (:weight 5) (:color lightred) (:edge blunt)))
  (obj (ball :kickers (step)) (15 11) ((:size 1) (:weight 1) (:color lightviolet)))
  (obj (chest :kickers (open)) (16 5) ((:capacity 25) (:size 26) (:closed t) (:color violet))
    (bag ((:capacity 4) (:size 4) (:color red))
      (list ((:size .1) (:color red) (:substance paper)))
      (nails ((:size 1) (:color blue) (:substance metal))))
    (glue ((:size 1) (:color red))))
  (obj bin (6 6) ((:capacity 9) (:size 10) (:color green) (:substance sawdust)))
  (obj lamp (25.5 7.25) ((:size 2) (:color red) (:obsmove t))))

(ars:defrobot max (room (6.5 6.5) 0)
  :cameras (((* 2 pi) 12) ((/ pi 3) 4)) :hands (10 2) :bins (20 5))
(ars:defrobot porter (room (12.5 1.5) (/ pi 2)) :cameras (((/ pi 2) 5)) :hands (50) :bins (90))
;; A keen edge is what grinding makes of a blunt one, and the later method of a sharp one too.
(ars:defmanipulation grind (tool - ((:edge (blunt sharp))) :by hand) (:delay 3)
  (ars:set-attribute tool :edge 'keen) (values nil :ground))
(ars:defmanipulation grind (tool - ((:edge sharp)) :by hand) () (values :sharp-enough tool))
;; To push a thing takes how far, by a number after the hand.
(ars:defmanipulation push (thing - ((:weight (0 3))) :by hand dx) ()
  (values nil (ars:kick-thing thing dx 0 nil)))
(nisp:def-interp-proc position (spec)
  "Find the one thing that fits SPEC, and go there; return what camera 0 said of its colour."
  (nisp:rpl-camera-get-object-designator 0 :non-local spec)
  (nisp:wait-for (nisp:vref nisp:camera-input* 0))
  (let ((found (first (nisp:fluent-value (nisp:vref nisp:camera-designators* 0)))))
    (nisp:rpl-camera-track 0 found)
    (nisp:wait-for (nisp:vref nisp:camera-tracking* 0))
    (nisp:rpl-robot-goto-designator 0)
    (nisp:wait-for nisp:robot-stopped*)
    (second (assoc :color (nisp:rpl-designator-data found)))))
(defun answers (command &rest arguments &aux (told '()))
  "What COMMAND tells its continuation in 30 ticks, a list of lists."
  (apply command (append arguments (list (nisp:continuation (&rest all) (push all told)))))
  (ars:run-ticks 30)
  told)
(defun seen (type spec) "The designators of what MAX sees that fits SPEC."
  (let ((eye (ars:robot-camera max 0)))
    (third (first (answers 'ars:camera-get-all-object-designators eye type spec)))))
(defun handle (name color &rest more) "What manipulation NAME answers for the thing of COLOR here."
  (apply 'answers 'ars:run-manipulation name
         (first (seen :local `((:color ,color)))) (ars:robot-hand max 0) more))
(defun claims (&rest claims) "Of texts and values in turn, the texts whose value is NIL."
  (loop for (text value) on claims by #'cddr unless value collect text))

(defun check ()
  (ars:with-simulation ((max porter) :seed 8 :clean t)
    (nisp:rpl-init-robot max)
    (claims
     "a sharp knife is sharp enough" (eq :sharp-enough (caar (handle 'grind 'red)))
     "a blunt axe is ground, once" (equal '((nil :ground)) (handle 'grind 'lightred))
     "and is keen" (eq 'keen (ars:get-attribute (ars:find-thing 'axe) :edge))
     "a spoon is not ground" (eq :failed (caar (handle 'grind 'violet)))
     "a spoon is pushed" (equal '((nil t)) (handle 'push 'violet 2))
     "to where it should be" (< 8.6 (ars:thing-x (ars:find-thing 'spoon)) 8.8)
     "the first saw is blunt" (eq 'blunt (ars:get-attribute (ars:find-thing 'saw) :edge))
     "the chest is open" (not (ars:get-attribute (ars:find-thing 'chest) :closed))
     "the ball has rolled" (< 15 (ars:thing-x (ars:find-thing 'ball)))
     "two things are violet, in our word for it"
     (equal '(violet violet) (loop for it in (seen :non-local '((:color violet)))
                                   collect (second (assoc :color (ars:designator-data it)))))
     "the pillar is a place" (let ((place (ars:cell-type (ars:map-cell room 12.5 3.5))))
                               (eq 'pillar (ars:place-type-name (ars:place-type place))))
     "the plan goes to the lighter saw"
     (eq 'lightblue (nisp:run-plan 'position '((:color lightblue))))
     "and is there" (and (= 8 (floor (ars:robot-x max))) (= 11 (floor (ars:robot-y max)))))))

(defun live-check (&aux (told '()))
  (ars:simulator porter :rate :free :display nil :seed 4)
  (unwind-protect
       (progn
         (ars:asking ((ars:current-simulation))           ; nothing is to happen by itself
           (dolist (name '(ball chest saw))
             (dolist (thing (ars:find-things name)) (ars:destroy-thing thing))))
         (ars:robot-go-forward porter 3 (nisp:continuation (err robot) (push err told)
           (ars:robot-turn robot 1 (nisp:continuation (err &rest r) (push err told)))))
         (claims "the world comes to rest" (ars:await-idle (ars:current-simulation) 20)
                 "two continuations, called once each" (= 2 (length told))))
    (ars:stop-simulator)))
