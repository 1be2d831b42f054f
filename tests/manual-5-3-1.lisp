;;;; manual-5-3-1.lisp -- Kickers (manual 5.3.1).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-5-3-1 :in ars-magna)

(defmap pasture (30 20)
  (rect (0 0) (29 19) stone 40)
  (wall (20 5) (20 9) stone 40)
  (wall (24 3) (26 3) stone 1)
  (wall (24 4) (26 4) stone 1)
  (wall (24 5) (26 5) stone 1)
  (obj calf (7 7) ((:size 8) (:capacity 4)))
  (obj lamb (10.5 7.5) ((:size 3))))

(defrobot shepherd (pasture (4 4) 0) :hands (10) :bins (20))

(defvar *runs* '() "What a test's kickers ran on, newest first.")

(defun note-run (thing) (push (princ-to-string thing) *runs*))

(defun calf () (find-thing 'calf))
(defun lamb () (find-thing 'lamb))

(defmacro at-pasture ((&rest options) &body body)
  "Run BODY in a fresh pasture, with *RUNS* empty."
  `(let ((*runs* '()))
     (with-simulation (shepherd ,@options) ,@body)))

(defkicker bleat (beast) () (note-run beast))
(defkicker drift (beast) (:prob .25) (note-run beast))
(defkicker shy (beast) (:test (get-attribute beast :color)) (note-run beast))
(defkicker graze (beast) (:prob .5 :test (get-attribute beast :color)) (note-run beast))

(defun runs-of (kicker ticks &rest options)
  "Return how often KICKER runs on the calf in TICKS."
  (at-pasture (:seed 11)
    (set-kicker (calf) kicker)
    (dolist (option options) (funcall option))
    (run-ticks ticks)
    (length *runs*)))

;;; When they run.

(test manual-5-3-1.kickers-run-each-tick-by-default
  "5.3.1, reading 169: :prob is 1 and :test true unless given; a kicker is tried once a tick."
  (is (= 7 (runs-of 'bleat 7)))
  (at-pasture ()
    (set-kicker (calf) 'bleat)
    (run-ticks 3)
    (is (equal '("CALF#1" "CALF#1" "CALF#1") *runs*) "the variable is the kicker's object")))

(test manual-5-3-1.prob-is-the-probability-in-a-tick
  "5.3.1: the body runs with probability :prob on any tick."
  (is-true (frequent-p (runs-of 'drift 4000) 4000 .25)))

(test manual-5-3-1.ticks-are-independent
  "5.3.1: that it ran in a tick does not say whether it runs in the next."
  (at-pasture (:seed 3)
    (set-kicker (calf) 'drift)
    (let* ((ran (loop repeat 4000
                      do (setf *runs* '()) (run-ticks 1)
                      collect (and *runs* t)))
           (after (loop for (one next) on ran when one collect next)))
      (is-true (frequent-p (count t after) (length after) .25)))))

(test manual-5-3-1.test-must-hold
  "5.3.1: on a tick on which the test form, with the variable bound to the thing, is false, the body
does not run; probability and test go together."
  (is (= 0 (runs-of 'shy 5)))
  (is (= 5 (runs-of 'shy 5 (lambda () (set-attribute (calf) :color 'red)))))
  (is (= 0 (runs-of 'graze 50)))
  (is-true (frequent-p (runs-of 'graze 2000 (lambda () (set-attribute (calf) :color 'red)))
                       2000 .5)))

(test manual-5-3-1.tests-are-asked-each-tick
  "5.3.1: the value of the test may change from tick to tick."
  (at-pasture ()
    (set-kicker (calf) 'shy)
    (run-ticks 2)
    (set-attribute (calf) :color 'red)
    (run-ticks 3)
    (set-attribute (calf) :color nil)
    (run-ticks 4)
    (is (= 3 (length *runs*)))))

(test manual-5-3-1.kickers-run-on-what-is-in-the-map-only
  "5.3.1, reading 169: on things on the floor, held or contained, but not on prototypes or on what
has been destroyed."
  (at-pasture ()
    (let ((prototype (new-thing pup nil ())) (flea (new-thing flea (calf) ((:size .1))))
          (bird (new-thing bird (robot-hand shepherd 0) ((:size 1)))))
      (dolist (thing (list prototype flea bird (calf) (lamb))) (set-kicker thing 'bleat))
      (destroy-thing (lamb))
      (run-ticks 1)
      (is (equal '("BIRD#4" "CALF#1" "FLEA#3") (sort *runs* #'string<))))))

(test manual-5-3-1.abstract-kickers-go-on-any-number-of-things
  "5.3.1: DEFKICKER defines a kicker that may be attached to any object by (set-kicker thing name),
by its name or as the value of its variable (reading 171)."
  (at-pasture ()
    (set-kicker (calf) 'bleat)
    (set-kicker (lamb) bleat)
    (run-ticks 2)
    (is (= 2 (count "CALF#1" *runs* :test #'string=) (count "LAMB#2" *runs* :test #'string=)))
    (signals unknown-name (set-kicker (lamb) 'no-such-kicker))))

(test manual-5-3-1.things-may-have-several-kickers
  "5.3.1: each name counts once."
  (at-pasture ()
    (set-kicker (calf) 'bleat)
    (set-kicker (calf) 'bleat)
    (set-kicker (calf) 'shy)
    (set-attribute (calf) :color 'red)
    (run-ticks 1)
    (is (= 2 (length *runs*)))))

(test manual-5-3-1.kickers-defined-anew-hold-for-all-who-have-them
  "5.3.1: the newest definition of the name counts, on things that have it already."
  (at-pasture ()
    (eval '(defkicker hop (beast) () (push :old *runs*)))
    (set-kicker (calf) 'hop)
    (run-ticks 1)
    (eval '(defkicker hop (beast) () (push :new *runs*)))
    (run-ticks 1)
    (is (equal '(:new :old) *runs*))))

;;; put-kicker

(test manual-5-3-1.put-kicker-is-for-one-thing
  "5.3.1: PUT-KICKER defines a kicker for one object, with :prob and :test as in DEFKICKER; its
name is not globally bound."
  (at-pasture (:seed 1)
    (put-kicker sway (beast (calf)) (:prob .5 :test (not (get-attribute beast :color)))
      (note-run beast))
    (run-ticks 1000)
    (is-true (frequent-p (length *runs*) 1000 .5))
    (is-false (boundp 'sway))
    (is-false (find-kicker 'sway nil))
    (signals unknown-name (set-kicker (lamb) 'sway))
    (setf *runs* '())
    (set-attribute (calf) :color 'red)
    (run-ticks 50)
    (is (null *runs*))))

(test manual-5-3-1.put-kicker-of-the-same-name-replaces
  "5.3.1: the name serves to redefine the kicker."
  (at-pasture ()
    (put-kicker sway (beast (calf)) () (push :old *runs*))
    (put-kicker sway (beast (calf)) () (push :new *runs*))
    (put-kicker sway (beast (lamb)) () (push :lamb *runs*))
    (run-ticks 1)
    (is (equal '(:lamb :new) (sort *runs* #'string<)))))

(test manual-5-3-1.put-kicker-without-a-body-removes
  "5.3.1: with a null body the kicker of that name is taken from the thing, even a global one, and
from that thing only."
  (at-pasture ()
    (set-kicker (calf) 'bleat)
    (set-kicker (lamb) 'bleat)
    (put-kicker sway (beast (calf)) () (push :sway *runs*))
    (put-kicker bleat (beast (calf)) ())
    (put-kicker sway (beast (calf)))
    (run-ticks 2)
    (is (equal '("LAMB#2" "LAMB#2") *runs*))))

;;; run-kicker

(test manual-5-3-1.run-kicker-runs-it-again-next-tick
  "5.3.1, reading 170: (run-kicker self) runs the kicker once more in the next tick whatever its
probability and its test say; its own trial is left out then."
  (at-pasture ()
    (let ((left 3) (ticks '()))
      (put-kicker gallop (beast (calf)) (:prob 1 :test (null ticks))
        (push (simulation-tick) ticks)
        (when (plusp (decf left)) (run-kicker self)))
      (run-ticks 9)
      (is (equal '(3 2 1) ticks))))
  (at-pasture ()
    (put-kicker trot (beast (calf)) () (note-run beast) (run-kicker self) (run-kicker self))
    (run-ticks 5)
    (is (= 5 (length *runs*)) "once a tick, however often it asks")))

(test manual-5-3-1.run-kicker-moves-along-a-trajectory
  "5.3.1: so a thing can be moved along a path, step by step."
  (at-pasture ()
    (put-kicker roll (beast (calf)) (:prob 1 :test (= 7 (thing-x beast)))
      (kick-thing beast .5 0 nil)
      (when (< (thing-x beast) 10) (run-kicker self)))
    (is (equalp '((7.5 7) (8 7) (8.5 7) (9 7) (9.5 7) (10 7) (10 7))
                (loop repeat 7 do (run-ticks 1) collect (where (calf)))))))

;;; kick-thing

(test manual-5-3-1.kick-thing-moves-by-so-much
  "5.3.1: the thing moves by (dx,dy), exactly, from whole and from other places, and T is returned."
  (at-pasture ()
    (is (equal '(t t) (list (kick-thing (calf) 1 -2 nil) (kick-thing (lamb) -.25 .5 t))))
    (is (equalp '((8 5) (10.25 8)) (list (where (calf)) (where (lamb)))))))

(test manual-5-3-1.kick-into-a-wall-does-nothing
  "5.3.1: without kick-if-wall nothing is moved if the destination is in a wall, and nil is
returned; off the map is as in a wall (reading 172)."
  (at-pasture ()
    (is (null (kick-thing (calf) 13 0 nil)))
    (is (null (kick-thing (calf) -7 0 nil)) "the border")
    (is (null (kick-thing (calf) 0 400 nil)) "beyond it")
    (is (equalp '(7 7) (where (calf))))))

(test manual-5-3-1.kick-into-a-wall-goes-beside-it-if-told
  "5.3.1: with kick-if-wall the thing goes into a cell next to that one which is no wall."
  (at-pasture ()
    (is (eq t (kick-thing (calf) 13.5 0 t)))
    (is-false (wall-at-p pasture (thing-x (calf)) (thing-y (calf))))
    (is (<= (max (abs (- (floor (thing-x (calf))) 20)) (abs (- (floor (thing-y (calf))) 7))) 1))
    (move-thing (calf) '(22 4))
    (is (null (kick-thing (calf) 3 0 t)) "reading 172: all cells next to that one are walls")
    (is (equalp '(22 4) (where (calf))))))

(test manual-5-3-1.kick-over-a-wall
  "Reading 172: only the end of a kick matters, not what is on the way."
  (at-pasture ()
    (is (eq t (kick-thing (calf) 15 0 nil)))
    (is (equalp '(22 7) (where (calf))))))

(test manual-5-3-1.kick-in-something-closed-fails
  "5.3.1, reading 155: in a closed object or storage bin a kick does nothing and returns nil,
whatever kick-if-wall."
  (at-pasture (:clean t)
    (let ((bin (robot-storage-bin shepherd 0)) (bug (new-thing bug (calf) ((:size .1)))))
      (set-attribute (calf) :closed #t)
      (is (equal '(nil nil) (list (kick-thing bug 1 0 nil) (kick-thing bug 1 0 t))))
      (move-thing bug bin)
      (is (null (end-code 'storage-bin-close bin)))
      (is (equal '(nil nil) (list (kick-thing bug 1 0 nil) (kick-thing bug 1 0 t))))
      (is (eq bin (thing-location bug)))
      (let ((flea (new-thing flea (new-thing pot bin ((:capacity 1))) ())))
        (is (null (kick-thing flea 1 0 t)) "in something open in something closed")))))

(test manual-5-3-1.kick-out-of-something-open
  "Reading 172: out of an open container or bin a thing is kicked onto the floor, as far from
there."
  (at-pasture ()
    (let ((bug (new-thing bug (calf) ((:size .1))))
          (fly (new-thing fly (robot-storage-bin shepherd 0) ((:size .1)))))
      (is (equal '(t t) (list (kick-thing bug 1 .5 nil) (kick-thing fly 0 2 nil))))
      (is (equalp '((8 7.5) (4 6)) (list (where bug) (where fly))))
      (is (equal '(nil nil) (list (thing-contents (calf))
                                  (storage-bin-contents (robot-storage-bin shepherd 0))))))))

(test manual-5-3-1.kick-out-of-a-hand
  "Reading 172: a hand loses a thing that is kicked from it; its track ends with :GRASP-LOST."
  (at-pasture (:clean t)
    (let* ((hand (robot-hand shepherd 0)) (fish (new-thing fish hand ((:size 1)))) (codes '()))
      (hand-track hand (continuation (err hand) (push err codes)))
      (run-ticks 3)
      (is (eq t (kick-thing fish 1 0 nil)))
      (run-ticks 2)
      (is (null (hand-holding hand)))
      (is (equalp '(5 4) (where fish)))
      (is (equal '(:grasp-lost) codes)))))

;;; What kickers may do.

(test manual-5-3-1.kickers-may-do-what-programs-may
  "5.3.1: kickers can change attributes, create and destroy objects, and move themselves or others."
  (at-pasture ()
    (put-kicker grow (beast (calf)) () (set-attribute beast :size (1+ (get-attribute beast :size))))
    (put-kicker lay (beast (lamb)) (:test (null (find-thing 'egg)))
      (new-thing egg (:with beast) ((:size .1))))
    (run-ticks 1)
    (put-kicker eat (beast (calf)) (:test (find-thing 'lamb)) (destroy-thing (lamb)))
    (run-ticks 1)
    (is (equal '(10 nil) (list (get-attribute (calf) :size) (lamb))))
    (is (equalp '(10.5 7.5) (where (find-thing 'egg))))))

(test manual-5-3-1.kickers-run-before-cameras-look
  "src/time/README.md: kickers act in the tick before tracks are tended, so what they move is
followed at once, and what they say goes to the messages if it is an error."
  (at-pasture ()
    (put-kicker fail (beast (calf)) () (error "It kicks back"))
    (run-ticks 1)
    (is-true (has-words-p (first (message-texts)) "FAIL" "CALF#1" "It kicks back"))
    (run-ticks 1)
    (is (= 2 (simulation-tick)) "and the run goes on")))
