;;;; skipping.lisp -- skipped time: results of a run when a tick stands for more time.

(in-package :ars-magna.tests)

(def-suite* skipping :in ars-magna)

(defmacro at-quantum ((quantum &rest options) &body body)
  "Run BODY with a fresh ROVER, alone in its arena, where a tick stands for QUANTUM of time."
  `(with-rover (:parameters `((tick-quantum* ,,quantum)) ,@options)
     ,@body))

(defun ends-at (quantum command &rest arguments)
  "Return where a clean ROVER is, x and heading, when COMMAND ends, and how much time that took."
  (at-quantum (quantum :clean t)
    (let ((ended nil) (x (robot:robot-x rover)))
      (apply command rover (append arguments (list (lambda (&rest rest)
                                                     (declare (ignore rest))
                                                     (setf ended (tick-now))))))
      (run:run-until (lambda () ended) :limit 1000)
      (list (- (robot:robot-x rover) x) (robot:robot-angle rover) (* quantum ended)))))

(test skipping.drives-go-as-far
  (dolist (quantum '(1 3/2 2 4 7 50))
    (destructuring-bind (x angle time) (ends-at quantum 'command:robot-go-forward 5)
      (is (< (abs (- x 4)) 1d-9) "~A m at ~A" x quantum)
      (is (zerop angle))
      (is (<= 6 time (+ 9 (* 2 quantum)))))))

(test skipping.turns-go-as-far
  (dolist (quantum '(1 3/2 2 4 7 50))
    (destructuring-bind (x angle time) (ends-at quantum 'command:robot-turn 1)
      (is (zerop x))
      (is (< (abs (- angle 1)) 1d-9))
      (is (<= 4 time (+ 5 (* 2 quantum)))))))

(test skipping.coasts-as-far
  "A robot that is stopped coasts for the time of BRAKING*."
  (flet ((coasted (quantum)
           (at-quantum (quantum :clean t)
             (setf base:robot-move-delay* 0)
             (command:robot-go-forward rover 100)
             (run:run-ticks 1)
             (let ((x (robot:robot-x rover)))
               (command:robot-stop rover)
               (run:run-ticks 10)
               (- (robot:robot-x rover) x)))))
    (let ((far (coasted 1)))
      (is (< (abs (- far 1.6d0)) 1d-9))
      (is (< (abs (- far (coasted 2))) 1d-9)))))

(test skipping.noise-adds-up-to-as-much
  "The spread of where drives end is that of single units of time, within a fifth."
  (flet ((spread (quantum)
           (let ((ends (loop for seed below 300
                             collect (at-quantum (quantum :seed seed)
                                       (command:robot-go-forward rover 8)
                                       (run:run-ticks 20)
                                       (robot:robot-x rover)))))
             (sample-deviation ends))))
    (let ((fine (spread 1)))
      (dolist (quantum '(2 4 8))
        (is (< .8 (/ (spread quantum) fine) 1.2))))))

(test skipping.odometers-contain-the-truth
  (dolist (quantum '(1 2 5 20))
    (dotimes (seed 20)
      (at-quantum (quantum :seed seed)
        (let ((x (robot:robot-x rover)))
          (command:robot-go-forward rover 8)
          (run:run-ticks 20)
          (let ((interval (geo:pt-interval-x
                           (robot:get-odometer-pos (robot:robot-main-odometer rover)))))
            (is (<= (geo:interval-min interval) (- (robot:robot-x rover) x)
                    (geo:interval-max interval)))))))))

(test skipping.delays-take-as-long
  (is (equal '(5 5 3 1 1) (mapcar (lambda (quantum)
                                    (let ((base:tick-quantum* quantum)) (base:ticks-for 5)))
                                  '(1 1.0 2 5 100)))))

(test skipping.errands-succeed-in-fewer-ticks
  (flet ((patrol (quantum)
           (run:with-simulation (ars-worlds:robbie :seed 2
                                                   :parameters `((tick-quantum* ,quantum)))
             (list (driver:run-plan 'ars-worlds:patrol-places '((20 18) (5 18) (35 18)))
                   (tick-now)))))
    (destructuring-bind (visits ticks) (patrol 1)
      (destructuring-bind (visits-of-five ticks-of-five) (patrol 5)
        (is (= 3 visits visits-of-five))
        (is (< ticks-of-five (/ ticks 2)))))))
