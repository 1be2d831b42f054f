;;;; choosing.lisp -- an errand with two ways to each place; a trolley may block either.

;;; Shows what rollouts are worth. A messenger has a deadline for the library and one for a meeting
;;; room. Each room has a doorway to the corridor, the short way, and another to the next room, the
;;; long way. A trolley that people use stands in one of the two, or elsewhere. A robot that meets
;;; it has to turn round and is late. So the better way depends on where the trolleys are. Forks of
;;; the run have the trolleys in place; the robot does not see them in advance.

(in-package :ars-worlds)
(in-readtable :nisp)

;;; The world.

(defun add-trolley (name places)
  "Put a trolley called NAME at one of PLACES, a list of points. It blocks robots. NAME and the
world's seed decide where. People move the trolley among PLACES at times. Return the trolley."
  (make-new-thing name (cons *world* (roll-element places (dice-for name)))
                  (list '(:size 30) '(:weight 25) '(:substance metal) '(:obsmove #t)
                        (list :haunts places))
                  :kickers '(be-borrowed)))

(defun leave-trolleys ()
  "Put a trolley near the library and another near the meeting room of OFFICE."
  (add-trolley 'book-trolley '((72.5 34.5) (84.5 24.5) (76.5 4.5)))
  (add-trolley 'tea-trolley '((52.5 34.5) (44.5 26.5) (56.5 20.5))))

;;; The plan chooses ways by WHICH: :FIRST, :SECOND, :ANY (at random) or :BEST (by rollouts).

(defvar forecasts* '()
  "A list with the share of successful rollouts for each choice of an errand, the latest first.")

(defun note-forecast (projections best)
  (push (projection-probability (nth best projections)) forecasts*))

(def-interp-proc follow-way (me points)
  "Bring the robot of the reckoning ME to each of POINTS in turn."
  (dolist (point points) (travel-to me point)))

(def-interp-proc choose-way (me which first second &key (trials 5))
  "Drive the robot of the reckoning ME by the way FIRST or SECOND, lists of points with the same
end. WHICH is :FIRST, :SECOND, :ANY (at random) or :BEST (by TRIALS rollouts of each way)."
  (case which
    (:first (follow-way me first))
    (:second (follow-way me second))
    (:any (follow-way me (roll-element (list first second) (dice-for (princ-to-string first)))))
    (:best (try-best (:trials trials :horizon 1200 :tell #'note-forecast)
             (follow-way me first)
             (follow-way me second)))))

(def-interp-proc be-in-time (me which first second)
  "Do CHOOSE-WAY with a deadline. Fails with DEADLINE-MISSED after 240 ticks."
  (with-deadline (240)
    (choose-way me which first second)))

(def-interp-proc carry-messages (which &key start)
  "Drive from the corridor of OFFICE to the library, back, and then to the meeting room. Each of the
two rooms has a deadline of 240 ticks. WHICH says how each way is chosen, as in CHOOSE-WAY. START is
the robot's position, a list (x y heading); the default is the true position. Return T. Fails with
DEADLINE-MISSED or :CANNOT-GET-THERE."
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

;;; The experiment.

(defun forecast (which)
  "Return the share of 20 rollouts in which CARRY-MESSAGES succeeds if it chooses ways by WHICH."
  (projection-probability (project 'carry-messages :arguments (list which) :horizon 1200)))

(defexperiment choosing-by-rollouts
  "How much does it help to try ways in rollouts before driving? And how good are the forecasts?

A robot that always takes the short way or the long way, or either at random, does not know what
blocks a way. It is in time at both places in about half of all trials. Five rollouts for each way
at each choice show what blocks a way. The measures:
- FORECAST: the forecast probability of success. For :BEST the forecast is the share of successful
  rollouts of the way chosen last, otherwise the share of 20 rollouts at the start.
- MISS: the squared difference between FORECAST and the outcome (1 or 0). Its mean is the Brier
  score."
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
