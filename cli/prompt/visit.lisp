;;;; visit.lisp -- a trial that a prompt is in: how far it is, and how time passes in it.

(in-package :ars-magna.cli)

(defstruct (visit (:constructor make-visit (experiment condition trial directory)) (:copier nil))
  "A trial that the prompt is in."
  (experiment nil :read-only t)
  (condition nil :read-only t)
  (trial 0 :type integer :read-only t)
  ;; Where it has a row, or NIL.
  (directory nil :type (or null string) :read-only t)
  ;; A line has been read in it.
  (begun-p nil :type boolean)
  ;; How many ticks are to pass before the next line, and whether to say so when they have.
  (steps 0 :type (integer 0))
  (stepped-p nil :type boolean)
  ;; What says at a terminal how many have passed, or NIL.
  (progress nil)
  ;; Ticks pass by themselves, at RATE, the next when it is DUE.
  (running-p nil :type boolean)
  (rate *default-rate*)
  (due 0d0 :type double-float)
  ;; The user has pressed control C while ticks passed; it is being left.
  (interrupted-p nil :type boolean)
  (left-p nil :type boolean)
  ;; What came of it, once it is over, and the tick from which on it was no longer the same run.
  (result nil)
  (changed nil :type (or null integer)))

;;; Steering.

(defun check-visit-goes-on (visit)
  (when (visit-result visit)
    (reject-line "The trial is over. TRIAL name condition number opens one, TRIAL OFF leads out.")))

(defun pause-visit (visit)
  (setf (visit-running-p visit) nil
        (visit-steps visit) 0))

(defun resume-visit (visit)
  (check-visit-goes-on visit)
  (setf (visit-running-p visit) t
        (visit-due visit) (seconds-now)))

(defun set-visit-rate (visit rate)
  (check-visit-goes-on visit)
  (setf (visit-rate visit) rate
        (visit-due visit) (seconds-now)))

(defun step-visit (visit count)
  (check-visit-goes-on visit)
  (unless (whole-p count 1)
    (reject-line "N cannot be ~D. Give a number of ticks, from 1 to 1e9." count))
  (setf (visit-running-p visit) nil
        (visit-stepped-p visit) t)
  (incf (visit-steps visit) count))

(defun visit-text (visit)
  (cond ((visit-result visit) "over")
        ((visit-running-p visit) (rate-text (visit-rate visit)))
        (t "paused")))

(defun pace-of-visit (visit)
  "Return how time passes in VISIT: :RUNNING, :PAUSED or :ENDED; and at what rate, or NIL where it
has none."
  (cond ((visit-result visit) :ended)
        ((plusp (visit-steps visit)) :running)
        ((visit-running-p visit) (values :running (visit-rate visit)))
        (t (values :paused (visit-rate visit)))))
