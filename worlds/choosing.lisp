;;;; choosing.lisp -- an errand with two ways to each place, of which one may be barred just now.

;;; Good for a look at what rollouts are worth. A messenger has to be in time in the library and
;;; then in a meeting room. Each has a doorway to the corridor, which is the short way, and another
;;; to a room beside it, which is the long way. A trolley that people use stands in one of the two,
;;; or somewhere else; who meets it has to turn round, and is late. So neither way is the better
;;; one: it depends on where the trolleys are, and a fork of the run, unlike the robot, knows that.

(in-package :ars-worlds)
(in-readtable :nisp)

;;; The world.

(defun leave-trolley (name places)
  "Put a trolley NAME, which blocks the way, at one of PLACES, points of the world that is being
run, as NAME and the world's seed decide, and let people use it now and then. Return it."
  (make-new-thing name (cons *world* (roll-element places (dice-for name)))
                  (list '(:size 30) '(:weight 25) '(:substance metal) '(:obsmove #t)
                        (list :haunts places))
                  :kickers '(be-borrowed)))

(defun leave-trolleys ()
  "Put a trolley near the library and another near the meeting room of OFFICE."
  (leave-trolley 'book-trolley '((72.5 34.5) (84.5 24.5) (76.5 4.5)))
  (leave-trolley 'tea-trolley '((52.5 34.5) (44.5 26.5) (56.5 20.5))))

;;; The plan. WHICH says how it chooses: :FIRST, :SECOND, :ANY or :BEST.

(defvar forecasts* '()
  "How probable success was by the rollouts of each choice of an errand, the latest first.")

(defun note-forecast (projections best)
  "Note how probable it is by PROJECTIONS that the one number BEST succeeds."
  (push (projection-probability (nth best projections)) forecasts*))

(def-interp-proc follow-way (me points)
  "Bring the robot of the reckoning ME to each of POINTS in turn."
  (dolist (point points) (travel-to me point)))

(def-interp-proc choose-way (me which first second &key (trials 5))
  "Bring the robot of ME to where the ways FIRST and SECOND, lists of points, end, by one of them."
  (case which
    (:first (follow-way me first))
    (:second (follow-way me second))
    (:any (follow-way me (roll-element (list first second) (dice-for (princ-to-string first)))))
    (:best (try-best (:trials trials :horizon 1200 :tell #'note-forecast)
             (follow-way me first)
             (follow-way me second)))))

(def-interp-proc be-in-time (me which first second)
  "Do as CHOOSE-WAY. Fails with a DEADLINE-MISSED after 240 ticks."
  (with-deadline (240)
    (choose-way me which first second)))

(def-interp-proc carry-messages (which &key start)
  "Let the robot of OFFICE's corridor be in the library in time, then back in the corridor, and then
in the meeting room in time, choosing its ways as WHICH says. START is where it is, a list (x y
heading); by default it finds that out."
  (with-valve ((rpl-robot-valve))
    (let ((me (begin-reckoning (or start (here (rpl-robot))))))
      (be-in-time me which
                  '((72.5 31.5) (74 26))
                  '((94.5 31) (82 24.5) (74 26)))
      (travel-to me '(62 38))
      (be-in-time me which
                  '((52.5 31.5) (50 28))
                  '((32.5 31.5) (42 26.5) (50 28)))
      t)))

;;; The question.

(defun forecast (which)
  "Return how probable it is by 20 rollouts that CARRY-MESSAGES, by WHICH, succeeds."
  (projection-probability (project 'carry-messages :arguments (list which) :horizon 1200)))

(defexperiment choosing-by-rollouts
  "What is it worth to try ways in one's head before one goes? And how good are the forecasts?

Always the short way, always the long one, or any: each is in time at both places in about half of
all trials, as it does not know what stands in it. Five rollouts for each way at each choice find
that out. FORECAST is what 20 rollouts at the start say of the ways that do not choose, and for
those that do what those of the last choice said of the way taken; MISS is the square of its
distance from what happened, whose mean is Brier's score."
  (:robots marvin)
  (:vary (which :first :second :any :best))
  (:trials 500)
  (:limit 4000)
  (:run (leave-trolleys)
        (let* ((before (if (eq which :best) nil (forecast which)))
               (result (multiple-value-list (run-plan 'carry-messages which))))
          (setf forecasts* (list (or before (first forecasts*) .5)))
          (values-list result)))
  (:measure (forecast (first forecasts*))
            (miss (expt (- (first forecasts*)
                           (if (eq :succeeded (second (trial-values))) 1 0))
                        2))))
