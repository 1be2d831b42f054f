;;;; same-bits.lisp -- a run has the same bits with each SBCL, C library and processor.

(in-package :ars-magna.tests)

(def-suite* same-bits :in ars-magna)

;;; tests/same-bits has the records of one machine: the digests of 40 set-ups, the journal of one of
;;; them, and a saved run. All machines must produce the same. After a change in behaviour, record
;;; again with (record-same-bits), and give the reason in the commit. A new command is no reason:
;;; random rides draw from the commands in commands.txt, in this order; nothing writes that file.

(defun same-bits-file (name)
  (project-file (format nil "tests/same-bits/~A" name)))

(defun recorded-commands ()
  (loop for name in (file-lines (same-bits-file "commands.txt"))
        collect (command:find-command (find-symbol (string-upcase name) :ars-magna.command))))

(defun ride-as-recorded (seed &rest options)
  "Drive at random by 150 of the recorded commands. Return what DRIVE-AT-RANDOM returns."
  (let ((*commands-to-draw* (recorded-commands)))
    (apply #'drive-at-random 150 seed options)))

(defun tour (robot seed clean)
  "Return the digest of a run in which ROBOT, of a shipped world, turns, drives and looks about."
  (let ((count 0))
    (labels ((next (&rest results)
               (declare (ignore results))
               (incf count)
               (case (mod count 4)
                 (0 (command:robot-turn robot (* 0.37d0 count) #'next))
                 (1 (command:robot-go-forward robot 12 #'next))
                 (2 (command:camera-view (robot:robot-camera robot 0) #'next))
                 (3 (command:robot-goto-wall robot #'next)))))
      (run:call-with-simulation (lambda ()
                                  (next)
                                  (run:run-ticks 300)
                                  (run:state-digest))
                                (list robot) :seed seed :clean clean))))

(defun set-ups ()
  "Return a list (name . function) for each set-up; the function returns the digest of its run."
  (append
   (loop for name in '(ars-worlds:robbie ars-worlds:marvin ars-worlds:gofer ars-worlds:porter
                       ars-worlds:dot)
         append (loop for seed from 1 to 4
                      for clean = (evenp seed)
                      collect (let ((name name) (seed seed) (clean clean))
                                (cons (format nil "~(~A~) ~D ~:[noisy~;clean~]" name seed clean)
                                      (lambda () (tour (robot:find-robot name) seed clean))))))
   (loop for seed from 1 to 20
         collect (let ((seed seed))
                   (cons (format nil "ride ~D" seed)
                         (lambda () (nth-value 2 (ride-as-recorded seed))))))))

(defun set-up-lines ()
  "Return a line (name and digest) for each set-up."
  (loop for (name . function) in (set-ups)
        collect (format nil "~A: ~16,'0X" name (funcall function))))

(test same-bits.digests-are-those-of-the-other-machines
  (let ((recorded (file-lines (same-bits-file "digests.txt"))) (lines (set-up-lines)))
    (is (= 40 (length recorded) (length lines)))
    (loop for line in lines
          for other in recorded
          do (is (string= other line)))))

(defun recorded-digest (name)
  "Return the digest that tests/same-bits/digests.txt has for NAME."
  (let ((line (find-if (lambda (line) (begins-with-p (format nil "~A: " name) line))
                       (file-lines (same-bits-file "digests.txt")))))
    (parse-integer line :start (+ 2 (position #\: line :from-end t)) :radix 16)))

;; Anyway: the file of the rides' kickers may have been edited since.
(test same-bits.a-journal-of-another-machine-replays
  (is (= (recorded-digest "ride 7")
         (nth-value 1 (run:replay (same-bits-file "ride.journal") :anyway t)))))

(defun after-saved ()
  "Return the digest of the recorded run, 100 ticks after it was saved."
  (let ((simulation (run:load-simulation (same-bits-file "ride.run") :anyway t)))
    (run:run-ticks 100 simulation)
    (format nil "~16,'0X" (run:state-digest simulation))))

(test same-bits.a-run-saved-on-another-machine-goes-on
  (is (string= (first (file-lines (same-bits-file "after-saved.txt"))) (after-saved))))

(defun save-ride ()
  "Save the run of a ride, while much is under way."
  (call-at-moments (lambda (simulation)
                     (run:save-simulation (same-bits-file "ride.run") simulation))
                   5 7))

(defun record-same-bits ()
  "Write what the tests of this suite compare with."
  (write-lines (set-up-lines) (same-bits-file "digests.txt"))
  (run:write-journal (nth-value 1 (ride-as-recorded 7 :journal t))
                     (same-bits-file "ride.journal"))
  (save-ride)
  (write-lines (list (after-saved)) (same-bits-file "after-saved.txt")))
