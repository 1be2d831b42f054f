;;;; quantum.lisp -- how accuracy changes with the time that a tick stands for.

;;; Prints tables for drives, turns, kickers and the shipped errands, by the time that a tick stands
;;; for. Times are ticks times the quantum. Without a loss of accuracy all rows would be alike.

(in-package :ars-magna.benchmarks)

(world:defmap skipping (200 200))
(robot:defrobot skipper (skipping (100.5 100.5) 0) :cameras ((3 5)))

(defparameter *quanta* '(1 2 5 10 20))
(defparameter *seeds* 200 "How many runs each figure is the mean of.")

(defun robot-here () (first (run:simulation-robots)))

(defun passed (quantum) (* quantum (run:simulation-tick)))

(defun moved (quantum seed clean command amount)
  "Let a robot do COMMAND by AMOUNT; return where it stands, its heading, and the time it took."
  (run:with-simulation (skipper :seed seed :clean clean :parameters `((tick-quantum* ,quantum)))
    (let ((ended nil))
      (funcall command (robot-here) amount
               (lambda (&rest rest) (declare (ignore rest)) (setf ended (passed quantum))))
      (run:run-until (lambda () ended) :limit 5000)
      (list (- (robot:robot-x (robot-here)) 100.5d0) (robot:robot-angle (robot-here)) ended))))

(defun mean (numbers) (/ (reduce #'+ numbers) (length numbers) 1d0))

(defun spread (numbers)
  (let ((mean (mean numbers)))
    (sqrt (mean (mapcar (lambda (number) (expt (- number mean) 2)) numbers)))))

(defun many-moved (quantum command amount)
  (loop for seed below *seeds* collect (moved quantum seed nil command amount)))

(defun say-moves ()
  (format t "~&| quantum | 20 ticks ahead, clean: m | its time | noisy: mean, spread of m ~
             | turn 1, clean: rad | its time | noisy: spread of rad |~%")
  (dolist (quantum *quanta*)
    (destructuring-bind (x angle time) (moved quantum 0 t 'command:robot-go-forward 20)
      (declare (ignore angle))
      (destructuring-bind (turned-x turned turn-time) (moved quantum 0 t 'command:robot-turn 1)
        (declare (ignore turned-x))
        (let ((noisy (mapcar #'first (many-moved quantum 'command:robot-go-forward 20)))
              (turns (mapcar #'second (many-moved quantum 'command:robot-turn 1))))
          (format t "| ~D | ~,2F | ~D | ~,2F, ~,2F | ~,3F | ~D | ~,4F |~%"
                  quantum x time (mean noisy) (spread noisy) turned turn-time (spread turns)))))))

;;; Kickers.

(defun kicks (quantum time seed probability)
  "Return how often a kicker of PROBABILITY kicks one of 100 things in TIME."
  (run:with-simulation (skipper :seed seed :parameters `((tick-quantum* ,quantum)))
    (let ((kicks 0))
      (world:define-kicker 'skip :prob probability
        :body (lambda (thing) (declare (ignore thing)) (incf kicks)))
      (dotimes (i 100)
        (world:make-new-thing 'box (list world:*world* 5 5) '((:size 1)) :kickers '(skip)))
      (run:run-ticks (ceiling time quantum))
      (/ kicks 100d0))))

(defun say-kicks ()
  (format t "~&| quantum | kicks in 1000 of p = .01 | of p = .1 |~%")
  (dolist (quantum *quanta*)
    (format t "| ~D | ~,2F | ~,2F |~%" quantum
            (kicks quantum 1000 1 .01d0) (kicks quantum 1000 1 .1d0))))

;;; Errands.

(defun brought-home-p ()
  (multiple-value-bind (x y) (world:thing-position (world:find-thing 'globe))
    (< (+ (expt (- x 62) 2) (expt (- y 38) 2)) 9)))

(defun fetches (quantum seed)
  (run:with-simulation (ars-worlds:marvin :seed seed :parameters `((tick-quantum* ,quantum)))
    (let ((ars-magna.rpl-robot:*plan-limit* (ceiling 5000 quantum)))
      (ars-magna.rpl-robot:run-plan 'ars-worlds:fetch-thing
                                    '((:color world:blue) (:substance world:plastic))
                                    '((109 24)))
      (values (brought-home-p) (passed quantum)))))

(defparameter *beat* '((20 18) (5 18) (35 18)) "Where ROBBIE goes on patrol, along the hallway.")

(defun patrols (quantum seed)
  (run:with-simulation (ars-worlds:robbie :seed seed :parameters `((tick-quantum* ,quantum)))
    (let* ((ars-magna.rpl-robot:*plan-limit* (ceiling 5000 quantum))
           (visits (ars-magna.rpl-robot:run-plan 'ars-worlds:patrol-places *beat*)))
      (values (eql visits (length *beat*)) (passed quantum)))))

(defun milliseconds-of-work (function)
  "Call FUNCTION; return how long processors have worked for us meanwhile, in milliseconds."
  (let ((before (get-internal-run-time)))
    (funcall function)
    (/ (- (get-internal-run-time) before) internal-time-units-per-second 1d-3)))

(defun times-of (function quantum)
  "Return the times of those runs of FUNCTION, one for each seed, that did what they should."
  (loop for seed below *seeds*
        for (done time) = (multiple-value-list (funcall function quantum seed))
        when done collect time))

(defun say-errand (name function)
  (format t "~&| quantum | ~A: of ~D | median time of these | ms of a processor a run |~%"
          name *seeds*)
  (dolist (quantum *quanta*)
    (let* ((times '())
           (work (milliseconds-of-work (lambda () (setf times (times-of function quantum))))))
      (format t "| ~D | ~D | ~:[-~;~:*~D~] | ~,2F |~%" quantum (length times)
              (and times (median times)) (/ work *seeds*)))))

(say-moves)
(say-kicks)
(say-errand "fetches in the noisy office" #'fetches)
(say-errand "patrols in the noisy flat" #'patrols)
