;;;; curves.lisp -- the data of a survival chart, checked and made exact.

(in-package :ars-magna.plots)

(defstruct (curve (:constructor make-curve (name index steps censored times)) (:copier nil))
  "STEPS are lists (time survival low high), by time: what holds from then on. CENSORED are times at
which somebody left, TIMES those at which anybody did."
  (name "" :read-only t)
  (index 0 :read-only t)
  (steps '() :type list :read-only t)
  (censored '() :type list :read-only t)
  (times '() :type list :read-only t))

(defun time-p (value) (and (finite-p value) (<= 0 value)))

(defun checked-step (step)
  (check-argument survival-chart step
                  (and (consp step) (ignore-errors (<= 2 (length step) 4))
                       (time-p (first step)) (probability-p (second step)))
                  "a list (time survival low high), with a time from 0 and a survival from 0 to 1")
  (destructuring-bind (time survival &optional low high) step
    (mapcar #'exact (list time survival low high))))

(defun checked-times (times)
  (check-argument survival-chart times
                  (and (typep times 'sequence) (every #'time-p times))
                  "a sequence of times from 0")
  (map 'list #'exact times))

(defun checked-curve (name index &key steps censored times)
  (make-curve (name-text name) index
              (cons '(0 1 nil nil)
                    (stable-sort (mapcar #'checked-step steps) #'< :key #'first))
              (checked-times censored) (checked-times times)))

(defun checked-curves (curves)
  (check-argument survival-chart curves (and (listp curves) (every #'consp curves))
                  "a list of curves, each a list (name :steps ... :censored ... :times ...)")
  (loop for (name . options) in curves
        for index from 0
        collect (apply #'checked-curve name index options)))

(defun curve-end (curve)
  (reduce #'max (append (mapcar #'first (curve-steps curve)) (curve-censored curve)
                        (curve-times curve))))

(defun step-at (time curve)
  (find time (curve-steps curve) :key #'first :test #'>= :from-end t))

(defun known-p (curve)
  "True if there is something to show of CURVE."
  (or (rest (curve-steps curve)) (curve-censored curve) (curve-times curve)))

(defun at-risk (time curve)
  "Return how many of CURVE were still there just before TIME."
  (count time (curve-times curve) :test #'<=))
