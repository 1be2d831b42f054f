;;;; abuse-definers.lisp -- damaged definitions.

(in-package :ars-magna.tests)

;;; Each form is valid before it is damaged. A damaged form that is accepted must work: it is used
;;; for some ticks, and the world must not contradict itself.

(defun find-contradictions (world)
  "Signal an error if WORLD contradicts itself."
  (let ((violations (world:world-invariant-violations world)))
    (when violations (error 'contradiction :text (format nil "~{~A~^; ~}" violations)))))

(defun look-about (robot)
  "Let ROBOT do a bit of everything for a dozen ticks."
  (let ((camera (robot:robot-camera robot 0)))
    (command:robot-place robot)
    (run:run-ticks 2)
    (command:camera-get-all-object-designators camera :non-local '())
    (run:run-ticks 3)
    (command:camera-view camera)
    (command:robot-go-forward robot 3)
    (run:run-ticks 4)
    (command:camera-get-object-designator camera :local '((:size (0 5))))
    (run:run-ticks 3)
    (find-contradictions (run:simulation-world (time:current-simulation)))
    (display:text-map robot)
    (run:state-digest)))

(defun open-cell (map)
  "Return the coordinates of the middle of an open cell of MAP near its beginning, or NIL."
  (loop for y from .5 below (min 12 (world:map-height map))
        do (loop for x from .5 below (min 12 (world:map-width map))
                 unless (robot:start-problem-text map x y)
                   do (return-from open-cell (values x y)))))

(defun explore (map)
  "Let a robot look about in MAP, if it has room for one."
  (multiple-value-bind (x y) (open-cell map)
    (when x
      (robot:define-robot 'explorer map (list x y) 0 :cameras '((6 9)) :hands '(10) :bins '(20))
      (run:call-with-simulation (lambda () (look-about (first (run:simulation-robots))))
                                '(explorer) :seed 3))))

(defun newest-map () (first (last (world:all-maps))))

(defun ready-to-define ()
  "Define what the definitions that are to be damaged need."
  (eval '(world:defkicker abuse-hop (thing) (:prob .3) (world:kick-thing thing .3 .2 nil)))
  (eval '(world:defmap abuse-room (9 9)
          (rect (0 0) (8 8) bricks 1)
          (obj (crate :kickers (abuse-hop)) (4.5 4.5) ((:size 2) (:color red))
            (pin ((:size .1)))))))

(defmacro define-form-abuse (name options samples &body use)
  "Define the abuse NAME of the definitions SAMPLES, forms: a mutant of one is evaluated, and if it
is accepted, USE is done. OPTIONS are those of DEFINE-ABUSE and :KEEP, of FORM-MUTANT."
  (destructuring-bind (&key (keep 1) author) options
    `(define-abuse ,name (form :author ,author :samples ',samples)
         (form-mutant (base:roll-element ',samples dice) dice :keep ,keep)
       (ready-to-define)
       (eval form)
       ,@use)))

(define-form-abuse maps ()
    ((world:defmap abuse-map (9 7)
       (rect (0 0) (9 7) bricks 1 10 20 30) (wall (5 1) (5 3) slate 20) (circle (3 3) 2 wood 5)
       (obj crate (6.5 4.5) ((:size 2) (:color red) (:substance metal)) (pin ((:size .1)))))
     (world:defmap abuse-map (8 8)
       (wall (1 1) (6 1) slate 20 30)
       (obj (box :kickers (abuse-hop)) (4.5 5.5) ((:size 6) (:capacity 5) (:weight 1))
         (can ((:size 2) (:capacity 1)) (bead ((:size .1) (:weight .1) (:mood (good 3)))))))
     (world:defmap abuse-map (6 6)
       (obj ball (2.5 2.5) ((:substance (metal 3)) (:closed t) (:obsmove nil) (:obsview t)))))
  (explore (newest-map)))

(define-form-abuse prototypes (:author t)
    ((world:defmap abuse-map (9 7)
       (obj (crate :prototype (world:new-thing crate* nil ((:size 2) (:capacity 1)))
                   :kickers (abuse-hop))
            (6.5 4.5) ((:color red)) (pin ((:size .1)))))
     (let ((box (world:new-thing box* nil ((:size 5) (:capacity 4) (:color blue)))))
       (world:new-thing pin box ((:size 1) (:substance wood)))
       (world:new-thing chest (abuse-room 3 4) ((:weight 2)) :prototype box))
     (world:new-thing lid (abuse-room 3.5 4.5) ((:size 1) (:shape round))))
  (explore (world:find-map 'abuse-room)))

(define-form-abuse robots (:author t)
    ((robot:defrobot abuse-robot (abuse-room (2.5 2.5) 0)
       :cameras (((/ pi 2) 5) ((* 2 pi) 3)) :hands (10 4) :bins (20))
     (robot:defrobot abuse-robot (abuse-room (1.5 3) (/ pi 2)) :cameras ((1 2)) :bins (1 2.5)))
  (run:call-with-simulation (lambda ()
                              (let ((robot (first (run:simulation-robots))))
                                (if (plusp (length (robot:robot-cameras robot)))
                                    (look-about robot)
                                    (run:run-ticks 3))))
                            (list (robot:robot-name (first (last (robot:all-robots)))))))

(define-form-abuse place-types (:author t)
    ((world:def-place-type abuse-nook (cell) :confusion .2
       :check-matchers ((((* * *) (* - *) (x x x)) 1.5) (((x * x) (* - x) (x x x)) 3 0 1)))
     (world:def-place-type abuse-post (cell) :before doorway :invisible t
       :check-matchers ((((*)) 0))
       :graphics ((window x y) (list window x y)))
     (world:def-place-type abuse-far (cell)
       :check-matchers ((((- - - - -) (- - - - -) (* * - * *) (x x - x x) (x x - x x)) 1))))
  (world:rebuild-map 'abuse-room)
  (explore (world:find-map 'abuse-room)))

(define-form-abuse place-code (:author t :keep 3)
    ((world:def-place-type abuse-checked (cell)
       :checker (values (world:cell-filled? cell) 0 1 1.5)
       :directions (values 1 2)))
  (world:rebuild-map 'abuse-room)
  (explore (world:find-map 'abuse-room)))

(define-form-abuse kickers (:author t)
    ((world:defkicker abuse-kick (thing) (:prob .5 :test (< 1 (world:thing-size thing)))
       (world:kick-thing thing .5 -.5 nil))
     (world:defkicker abuse-hop (it) () (world:set-attribute it :color 'blue)))
  (explore (world:find-map 'abuse-room)))

(define-form-abuse attributes (:author t)
    ((world:defattribute :abuse-mood (good bad indifferent) :success .9 :noticed .5)
     (world:defattribute :abuse-heat numeric :base 2 :max-mult 3 :support .5
       :supported-by (:size :color))
     (world:defattribute :color (red green blue) :success .5 :noticed 1)
     (world:defattribute :size numeric :base .1 :max-mult 20 :noticed 1))
  (let ((attribute (first (last (world:all-attributes)))))
    (world:make-new-thing 'toy (list (world:find-map 'abuse-room) 3 4)
                          `((,(world:attribute-name attribute)
                             ,(or (first (world:attribute-domain attribute)) 3))))
    (explore (world:find-map 'abuse-room))))

(define-form-abuse substances (:author t)
    ((world:defsubstance abuse-jelly 40)
     (world:defsubstance slate 3/2))
  (explore (world:find-map 'abuse-room)))

(define-form-abuse manipulations (:author t)
    ((command:defmanipulation abuse-rub (it - ((:size (1 3)) (:color (red blue) 1))
                                         tool - ((:size 1)) :by hand force)
         (:success .9 :delay 3)
       (values nil force))
     (command:defmanipulation abuse-open (box - ((:closed t)) :by hand - hand) ()
       (world:set-attribute box :closed nil) (values nil 1)))
  (explore (world:find-map 'abuse-room)))

(define-form-abuse runs (:author t)
    ((run:with-simulation (rover :seed 4 :clean t :parameters '((max-speed* 2) (motion-noise* .1)))
       (command:robot-turn rover 1 (lambda (err robot angle) (list err robot angle)))
       (run:run-ticks 5))
     (run:with-simulation ((keeper helper) :seed 2 :journal t :clean nil) (run:run-ticks 3))
     (run:with-simulation (rover)
       (time:schedule ((robot:robot-hand rover 0) :priority 2 :when (zerop 1) :timeout 4 :timer 2
                       :interrupt (list 1))
         (list 2))
       (world:put-kicker shy (it (world:find-thing 'crate)) (:prob 1/2) (world:thing-size it))
       (world:put-kicker shy (it (world:find-thing 'crate)))
       (run:run-ticks 5)))
  nil)

;;; Plans.

(define-form-abuse plans (:author t)
    ((rpl:def-interp-proc abuse-plan (&optional (a 1) b - number &key c)
       "Do this and that."
       (rpl:seq (rpl:par (rpl:wait-time 2) (list a b c))
                (rpl:with-policy (rpl:wait-time 3) (rpl:n-times 2 (rpl:wait-time 1)))
                (rpl:try-all (rpl:fail :class 'f) (rpl:wait-time 1))))
     (rpl:def-interp-proc abuse-plan ()
       (let ((abuse-one (rpl:create-fluent 'f 1)))
         (rpl:pursue (rpl:wait-for abuse-one) (rpl:wait-time 3))
         (rpl:par-loop (abuse-two '(1 2)) (rpl:wait-time abuse-two))
         (rpl:try-in-order (rpl:fail) (rpl:evap-protect (rpl:wait-time 1) 3)))))
  (run:call-with-simulation
   (lambda ()
     (let ((driver::*plan-limit* 30))
       (driver:run-plan (rpl:procedure-name (first (last (rpl:all-procedures)))))))
   '(rover)))

(define-form-abuse plan-macros (:author t)
    ((rpl:def-interp-macro (abuse-macro for #.(nisp:make-matchvar 'abuse-one)
                                            do #.(nisp:make-matchvar 'abuse-two))
       "Twice."
       (list 'rpl:n-times 2 abuse-one abuse-two))
     (rpl:def-interp-macro (abuse-macro for #.(nisp:make-matchvar 'abuse-one)
                                            . #.(nisp:make-matchvar 'abuse-two))
       (list 'rpl:par abuse-one (cons 'rpl:seq abuse-two))))
  (eval '(rpl:def-interp-proc abuse-plan () (abuse-macro for 1 do 2))))

(defmacro keeping-packages (&body body)
  "Run BODY; packages that it makes are gone afterwards."
  `(let ((packages (list-all-packages)))
     (unwind-protect (progn ,@body)
       (mapc #'delete-package (set-difference (list-all-packages) packages)))))

(defparameter *packages*
  '((ars-magna.faces:define-user-package :abuse-package (:use :cl :ars :nisp)
     (:export #:kitchen "DOOR") (:shadow #:add) (:import-from :ars-worlds #:watson))
    (ars-magna.faces:define-user-package :abuse-package (:nicknames :abu) (:size 10)
     (:documentation "x") (:shadowing-import-from :ars #:equal)
     (:local-nicknames (:w :ars-worlds))))
  "Definitions of packages.")

(define-abuse packages (form :author t :samples *packages*)
    (form-mutant (base:roll-element *packages* dice) dice)
  (keeping-packages (eval form)))
