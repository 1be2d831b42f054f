;;;; ward.lisp -- A hospital ward with a corridor, where patients fret and a window blows open.

;;; Common Lisp and the simulator; of Nisp only its syntax, for the ?x of a manipulation.
(ars:define-user-package :ward (:use :cl :ars) (:shadow #:room #:open #:step))
(in-package :ward)
(nisp:in-readtable :nisp)
(defattribute :mood (calm restless) :success .9)
(defattribute :label numeric :base .1)
(defsubstance linen 105)
;; A corridor is one cell wide, with walls on both sides.
(def-place-type corridor (cell)
  :check-matchers ((((t nil t) (t nil t) (t nil t)) (/ pi 2))
                   (((t t t) (nil nil nil) (t t t)) 0)))

;; A window blows open, a patient steps out of bed and back, and a calm one starts to fret.
(defkicker open (window) (:prob .25 :test (get-attribute window :closed))
  (set-attribute window :closed nil))
(defkicker step (patient) (:prob .5)
  (kick-thing patient (roll-element '(-.5 .5) (world-dice *world* :user)) 0 t))
(defkicker fret (patient) (:test (eq (get-attribute patient :mood) 'calm))
  (when (chance .3 (world-dice *world* :user)) (set-attribute patient :mood 'restless)))

(defparameter bed* (new-thing bed nil ((:size 20) (:color lightblue) (:substance linen))))
(defparameter patient* (new-thing patient nil ((:size 6) (:weight 70) (:color lightred))))

(defmap room (20 20)
  (rect (0 0) (19 19) plaster 60 70 60 70)
  (wall (6 1) (6 6) stone 40)                        ; the corridor lies between x = 6 and 8
  (wall (8 1) (8 6) stone 40 45)
  (obj (bed :prototype bed*) (2 2) ())
  (obj (bed :prototype bed*) (2.5 4.5) ())
  (obj (patient :prototype patient* :kickers (step fret)) (4 10) ((:mood calm)))
  (obj (patient :prototype patient*) (12.5 10.5) ((:mood calm)))
  (obj (visitor :prototype patient*) (12.1 10.1) ((:mood restless) (:color green)))
  (obj (window :kickers (open)) (17.5 1.5) ((:size 9) (:closed t) (:capacity 1) (:substance glass)))
  (obj table (12 10) ((:size 8) (:weight 30) (:color violet)))
  (obj cabinet (12.9 10.9) ((:capacity 30) (:size 31) (:label 7) (:color blue))
    (box ((:capacity 5) (:size 5) (:color green))
      (pill ((:size .1) (:color red) (:label 7)))))
  (obj bottle (12.3 10.3) ((:size 1) (:weight .5) (:color red) (:label 7)))
  (obj flask (12.6 10.2) ((:size 1) (:weight .5) (:color lightviolet) (:label 9)))
  (obj lamp (16 15) ((:size 2) (:color red) (:substance metal))))

(defrobot nurse (room (12.5 10.5) 0) :cameras ((7/4 5) (2pi 8)) :hands (10 3) :bins (20))
(defrobot porter (room (7.5 10.5) (- (/ pi 2))) :cameras ((1 5)) :hands (80) :bins (50 50))

(defmanipulation wash (patient - ((:mood calm)) :by hand) (:delay 1) (values nil :clean))
(defmanipulation wash (patient - ((:mood restless)) :by hand) () (values :kicks-back hand))
;; What has the same label as a cabinet belongs there.
(defmanipulation sort (what - ((:label ?x) (:weight (0 1)))
                       where - ((:label ?x) (:capacity (9 99))) :by hand) ()
  (move-thing what where)
  (values nil (thing-name where)))

(nisp:def-interp-proc step (angle)
  "Turn by ANGLE and go a little; return the error, if any, and what the turn was."
  (nisp:rpl-robot-turn angle)
  (nisp:wait-for nisp:robot-stopped*)
  (let ((turned (nisp:fluent-value nisp:robot-angle-diff*)))
    (nisp:rpl-robot-go-forward 2)
    (nisp:wait-for nisp:robot-stopped*)
    (list (nisp:fluent-value nisp:robot-movement-error*) (round turned))))

(defun answer (command &rest arguments &aux (told '()))
  "All that COMMAND tells its continuation within 40 ticks: a list of lists."
  (apply command (append arguments (list (lambda (&rest all) (push all told)))))
  (run-ticks 40)
  told)
(defun near (spec) "A designator of the one thing next to the nurse that fits SPEC."
  (third (first (answer 'camera-get-object-designator (robot-camera nurse 1) :local spec))))
(defun do-it (name &rest specs)
  "What manipulation NAME answers, with the things that fit SPECS and the nurse's first hand."
  (apply 'answer 'run-manipulation name (append (mapcar 'near specs) (list (robot-hand nurse 0)))))
(defun claims (&rest claims) "Of texts and values in turn, the texts whose value is NIL."
  (loop for (text value) on claims by #'cddr unless value collect text))

(defun check ()
  (append
   (with-simulation (nurse :seed 11 :clean t)
     (claims
      "the calm are washed, once" (equal '((nil :clean)) (do-it 'wash '((:mood calm))))
      "the restless kick" (eq :kicks-back (caar (do-it 'wash '((:mood restless)))))
      "a table is not washed" (eq :failed (caar (do-it 'wash '((:color violet)))))
      "labels differ" (eq :failed (caar (do-it 'sort '((:color lightviolet)) '((:color blue)))))
      "labels agree" (equal '((nil cabinet)) (do-it 'sort '((:color red)) '((:color blue))))
      "the bottle is put away" (eq (find-thing 'cabinet) (thing-location (find-thing 'bottle)))
      "of all red things just the lamp is seen from here"
      (equal '(red) (loop for found in (third (first (answer 'camera-get-all-object-designators
                                               (robot-camera nurse 1) :non-local '((:color red)))))
                          collect (second (assoc :color (designator-data found)))))
      "the window is open" (not (get-attribute (find-thing 'window) :closed))
      "a patient frets" (eq 'restless (get-attribute (find-thing 'patient) :mood))
      "and keeps to a line" (= 10 (floor (thing-y (find-thing 'patient))))))
   (with-simulation (porter :seed 11 :clean t)
     (claims "a plan turns and goes" (equal '(nil 1) (nisp:run-plan 'step 1))
             "the corridor is found" (let ((place (cell-type (map-cell room 7.5 3.5))))
                                       (eq 'corridor (place-type-name (place-type place))))))))

(defun live-check (&aux (told '()) (heard (sb-thread:make-semaphore)))
  (flet ((hear (&rest all) (push all told) (sb-thread:signal-semaphore heard)))
    (simulator nurse :rate :free :display nil :seed 2)
    (unwind-protect
         (progn
           (robot-turn nurse 1 (lambda (&rest all) (apply #'hear all)   ; and then, in its turn,
                                 (hand-grasp-check (robot-hand nurse 1) #'hear)))
           (claims "two answers come" (sb-thread:wait-on-semaphore heard :n 2 :timeout 20)
                   "one says that the hand is empty" (find :not-grasping told :key 'first)
                   "one that the nurse has turned" (find nil told :key 'first)
                   "there are no others" (= 2 (length told))))
      (stop-simulator))))
