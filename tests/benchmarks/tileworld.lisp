;;;; tileworld.lisp -- games of Tileworld: their speed, and agreement with a bare program.

(ars:define-user-package :ars-magna.benchmarks.tileworld
  (:documentation "Benchmarks of the testbed Tileworld.")
  (:import-from :ars-magna.base #:start-thread #:join-thread)
  (:import-from :ars-magna.benchmarks #:bytes-for #:per-second #:say))

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(in-package :ars-magna.benchmarks.tileworld)

(defun game (agent seed &optional (settings '()))
  "Play a game of 600 holes with commands. Return the effectiveness."
  (with-simulation ('ars-testbeds:tiler
                    :seed seed :clean t :thinking :charged :errors :signal
                    :parameters (append settings '((max-speed* 2) (max-turn-angle* 4)
                                                   (step-by-grid* t))))
    (ars-testbeds:play-holes agent)
    (measure-value 'ars-testbeds:effectiveness)))

(defun play-games (agent first count)
  (cl:loop for seed from first repeat count do (game agent seed)))

(defun play-in-threads (agent count threads)
  (let ((share (floor count threads)))
    (mapc #'join-thread
          (cl:loop for thread below threads
                   collect (let ((first (* thread share)))
                             (start-thread (lambda () (play-games agent first share))
                                           "games"))))))

(defun agent (name) (first (find name (testbed-agents (find-testbed 'tileworld))
                                 :key #'first :test #'string=)))

(cl:dolist (name '(bold normal cautious bold-nearer))
  (let ((agent (agent name)))
    (play-games agent 0 5)
    (flet ((rate (threads) (per-second 100 (lambda () (play-in-threads agent 100 threads))
                                       :runs 3)))
      (let ((one (rate 1)) (two (rate 2)))
        (say (format nil "games of 600 holes, ~(~A~)" name) one "games/s")
        (say "  in two threads" two (format nil "games/s, ~,2F times as many" (/ two one)))
        (say "  allocated for each" (/ (bytes-for (lambda () (play-games agent 0 20))) 20)
             "bytes")))))

;;; Paired, over 100 seeds: the score with the simulator minus that without it.

(cl:dolist (case '((bold nil nil 32 1) (cautious 1 nil 32 1/2) (normal-any 4 :any 24 2)
                   (bold-nearer nil :nearer 64 1/2) (bold-target nil :target 16 4)))
  (destructuring-bind (name boldness reaction gamma p) case
    (let ((settings `((ars-testbeds:dynamism* ,gamma) (ars-testbeds:planning-time* ,p))))
      (say (format nil "~(~A~), gamma ~A, p ~A: largest difference from the bare program" name
                   gamma p)
           (cl:loop for seed from 1 to 100
                    for holes = (ars-magna.tests::tileworld-holes seed settings)
                    maximize (abs (- (game (agent name) seed settings)
                                     (ars-magna.tests::bare-effectiveness
                                      holes gamma p boldness reaction))))
           "of 1"))))
