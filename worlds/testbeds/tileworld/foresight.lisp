;;;; foresight.lisp -- two agents of Tileworld: one forks, the other knows the future.

(in-package :ars-testbeds)
(in-readtable :nisp)

;;; Both agents would wait forever for the end of a game that has not begun.

(defun check-game-begun ()
  "Signal an error if no hole has opened."
  (when (zerop *opened*)
    (error "No game has begun. Start one: (play-holes 'AGENT), as (run-testbed 'tileworld) does.")))

;;; Looking ahead. The agent tries each hole in a fork of the run in which no more holes open. It
;;; goes there, then on as BOLD-NEARER. Scores are read several times, so earlier ones count more.

(defun score-ahead (hole horizon)
  "Return what HOLE as the first brings in HORIZON steps: the sum of four readings of the score."
  (with-fork ()
    (put-kicker open-next (clock (find-thing 'clock)))
    (go-committed (counterpart hole) nil :nearer (newest) (lambda () (decide nil :nearer)))
    (loop repeat 4
          do (run-ticks (ceiling (* horizon (step-ticks-here)) 4))
          sum *score*)))

(defun best-ahead (horizon)
  "Return the open hole with the highest score in HORIZON steps, of equals the worthiest, or NIL."
  (if (rest *holes*)
      (best-hole (lambda (hole) (+ (score-ahead hole horizon) (/ (worth hole) 1000))))
      (first *holes*)))

(defun look-ahead (&key (horizon 24))
  "Play to the end of the game. Forks are made between ticks, so the agent passes them itself."
  (let ((idle t) (reaction (if (zerop planning-time*) :any :nearer)))
    (flet ((rest-a-moment () (setf idle t)))
      (loop until (game-over-p)
            do (if idle
                   (let ((target (best-ahead horizon)) (seen (newest)))
                     (setf idle nil)
                     (if target
                         (plan-move (lambda ()
                                      (go-committed target nil reaction seen #'rest-a-moment)))
                         (spend-steps 1 #'rest-a-moment)))
                   (run-ticks 1))
               (when (< 50 (simulation-tick)) (check-game-begun))))))

;;; An upper bound: the agent that knows all holes in advance, plans without cost, and takes the
;;; best of all tours. A hole is a list (x y score begin end), a stop a list (tick score hole before
;;; filled): the hole that was filled, the stop before, and the filled holes that would be open yet.

(defun future-holes ()
  "Return all holes of this run that have not opened, in order."
  (with-fork ()
    (loop with last = 0
          until (game-over-p)
          do (run-ticks 50)
             (check-game-begun)
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
