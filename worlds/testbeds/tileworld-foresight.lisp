;;;; tileworld-foresight.lisp -- two agents of Tileworld that look ahead: by forks; and with a
;;;; knowledge that no agent has, for an upper bound.

(in-package :ars-testbeds)
(in-readtable :nisp)

;;; Looking ahead: the agent tries each hole in a fork of the run, goes on there as BOLD-NEARER, and
;;; takes the hole with the highest score in the time of HORIZON steps. Forks have other dice than
;;; the run, so they open other holes.

(defun score-ahead (hole horizon seed)
  (with-fork (:seed seed)
    (let ((target (counterpart hole)) (before *score*))
      (go-committed target nil (newest) nil :nearer #'worth)
      (run-ticks (* horizon (step-ticks-here)))
      (- *score* before))))

(defun look-ahead (&key (horizon 24) (forks 2))
  "Play to the end of the game."
  (let ((target nil) (busy nil))
    (flet ((go-on () (setf busy nil)))
      (loop until (game-over-p)
            do (cond (busy (run-ticks 1))
                     ((null *holes*) (setf busy t) (spend-steps 1 #'go-on))
                     (t (setf target (best-ahead horizon forks) busy t)
                        (plan-move (lambda ()
                                     (if (thing-alive-p target)
                                         (step-towards target #'go-on)
                                         (go-on))))))))))

(defun best-ahead (horizon forks)
  "Return the open hole with the highest score in FORKS of HORIZON steps; of equals the worthiest."
  (let ((holes *holes*) (seed (simulation-tick)))
    (if (rest holes)
        (best-hole (lambda (hole)
                     (+ (/ (worth hole) 1000)
                        (loop for fork from 1 to forks
                              sum (score-ahead hole horizon (+ fork seed))))))
        (first holes))))

;;; An upper bound: the agent that knows all holes in advance, plans without cost, and takes the
;;; best of all tours. A hole is a list (x y score begin end), a stop a list (tick score hole before
;;; filled): the hole that was filled, the stop before, and the filled holes that would be open yet.

(defun future-holes ()
  "Return all holes of this run that have not opened, in order."
  (with-fork ()
    (loop with last = 0
          until (game-over-p)
          do (run-ticks 50)
          append (loop for hole in (reverse *holes*)
                       when (< last (thing-serial hole))
                         collect (list (floor (thing-x hole)) (floor (thing-y hole))
                                       (hole-score hole) (get-attribute hole :begin)
                                       (get-attribute hole :end))
                         and do (setf last (thing-serial hole))))))

(defun arrival (hole tick from)
  "Return the tick in which the agent fills HOLE if it leaves the hole FROM in TICK, or NIL."
  (let ((tick (max (fourth hole)
                   (+ tick (* (step-ticks-here)
                              (steps-between (first from) (second from)
                                             (first hole) (second hole)))))))
    (and (< tick (fifth hole)) tick)))

(defun next-stops (stop holes)
  "Return the stops that may follow STOP on the best tour. HOLES are those not closed, in order."
  (destructuring-bind (tick score from before filled) stop
    (declare (ignore before))
    (let ((reach '()) (enough nil))
      (loop for hole in holes
            until (and enough (< enough (fourth hole)))
            do (let ((arrival (and (not (member hole filled)) (arrival hole tick from))))
                 (when arrival
                   (push (cons arrival hole) reach)
                   (setf enough (min (or enough arrival) arrival)))
                 (when (and enough reach)
                   (setf enough (+ (reduce #'min reach :key #'car) (* 28 (step-ticks-here)))))))
      (loop for (arrival . hole) in reach
            unless (loop for (earlier . other) in reach
                         thereis (and (not (eq other hole))
                                      (< earlier arrival)
                                      (eql arrival (arrival hole earlier other))))
              collect (list arrival (+ score (third hole)) hole stop
                            (cons hole (remove-if (lambda (it) (<= (fifth it) arrival))
                                                  filled)))))))

(defun best-tour (holes start)
  "Return the holes of the tour with the highest score among HOLES, in order. START is a stop."
  (let ((by-tick (make-hash-table)) (seen (make-hash-table :test 'eq)) (best start)
        (end (reduce #'max holes :key #'fifth :initial-value 0)))
    (push start (gethash (first start) by-tick))
    (flet ((worse-p (stop other)
             (and (<= (second stop) (second other)) (subsetp (fifth other) (fifth stop)))))
      (loop for tick from (first start) to end
            do (loop while (and holes (<= (fifth (first holes)) tick)) do (pop holes))
               (dolist (stop (sort (gethash tick by-tick) #'> :key #'second))
                 (unless (some (lambda (other) (worse-p stop other)) (gethash (third stop) seen))
                   (push stop (gethash (third stop) seen))
                   (when (> (second stop) (second best)) (setf best stop))
                   (dolist (next (next-stops stop holes))
                     (push next (gethash (first next) by-tick)))))
               (remhash tick by-tick)))
    (rest (reverse (loop for stop = best then (fourth stop) while stop collect (third stop))))))

(defun omniscient ()
  "Play to the end of the game."
  (let ((start (list (simulation-tick) 0 (list (floor (robot-x tiler)) (floor (robot-y tiler)))
                     nil '())))
    (follow-tour (best-tour (future-holes) start))))

(defun follow-tour (tour)
  (when tour
    (destructuring-bind (x y score begin end) (first tour)
      (declare (ignore score end))
      (cond ((plusp (steps-between (robot-x tiler) (robot-y tiler) (+ x .5) (+ y .5)))
             (take-a-step (direction-to (+ x .5) (+ y .5)) (lambda () (follow-tour tour))))
            ((< (simulation-tick) begin)
             (spend-steps (/ (- begin (simulation-tick)) (step-ticks-here))
                          (lambda () (follow-tour tour))))
            (t (follow-tour (rest tour)))))))
