;;;; forking-borders.lisp -- what a fork must not share: exited frames, other runs, threads.

(in-package :ars-magna.tests)
(in-suite forking)

;;; Closures that leave blocks and tags.

(defun fork-with-dead-exit (how)
  "Return a fork in which a continuation is to leave a block or tag, as HOW says, that is no more."
  (block done
    (tagbody
       (command:robot-turn rover 1 (lambda (&rest ignore)
                                     (declare (ignore ignore))
                                     (ecase how
                                       (:block (return-from done :left))
                                       (:tag (go out)))))
       (return-from done (run:fork-simulation :continuations t))
     out)
    :out))

(test borders.blocks-and-tags-that-are-gone-are-errors-in-forks
  (dolist (how '(:block :tag))
    (run:with-simulation (rover :seed 1)
      (let ((fork (fork-with-dead-exit how)))
        (run:run-ticks 20 fork)
        (is (= 20 (run:simulation-tick fork)))
        (is (search "no longer exists" (messages-text fork)) "~A" how)))))

(test borders.blocks-that-are-there-can-be-left-from-forks
  (run:with-simulation (rover :seed 1)
    (is (eq :left (block done
                    (command:robot-turn rover 1 (lambda (&rest ignore)
                                                  (declare (ignore ignore))
                                                  (return-from done :left)))
                    (run:run-ticks 20 (run:fork-simulation :continuations t))
                    :not-left)))))

;;; What looks like two things, and is one.

(test borders.parts-of-arrays-stay-parts
  (run:with-simulation (rover :seed 1)
    (let ((task (driver:begin-plan
                 (rpl:interp-lambda ()
                   (let* ((base (make-array 4 :initial-element 0))
                          (part (make-array 2 :displaced-to base :displaced-index-offset 1)))
                     (rpl:wait-time 3)
                     (setf (aref part 0) 9)
                     base)))))
      (run:run-ticks 1)
      (run:with-fork ()
        (let ((task (first (driver:plans))))
          (run:run-ticks 5)
          (is (equalp #(0 9 0 0) (rpl:task-result task)))))
      (run:run-ticks 5)
      (is (equalp #(0 9 0 0) (rpl:task-result task))))))

(defclass caller () () (:metaclass sb-mop:funcallable-standard-class)
  (:documentation "A function that is an instance."))

(test borders.functions-that-are-instances-cannot-be-forked
  (run:with-simulation (rover :seed 1)
    (driver:begin-plan (rpl:interp-lambda (function) (rpl:wait-time 5) function)
                       (make-instance 'caller))
    (run:run-ticks 1)
    (signals base:cannot-fork (run:fork-simulation))))

;;; Other runs.

(test borders.things-and-robots-of-the-run-around-are-not-touched
  (with-rover (:seed 1)
    (let* ((ball (world:make-new-thing 'ball (list world:*world* 5.5 9.5) '((:size 1))))
           (outer rover)
           (digest (run:state-digest)))
      (run:with-fork ()
        (signals base:misuse (world:move-thing ball '(5.5 8.5)))
        (signals base:misuse (command:robot-turn outer 1))
        (signals base:misuse (run:simulator rover))
        (world:move-thing (run:counterpart ball time:*simulation*) '(5.5 8.5))
        (command:robot-turn rover 1)
        (run:run-ticks 9)
        (is (= 8.5d0 (world:thing-y (world:find-thing 'ball)))))
      (is (= digest (run:state-digest))))))

(test borders.ending-a-plan-in-a-fork-ends-that-of-the-fork
  (with-rover (:seed 1)
    (let ((task (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 50)))))
      (run:run-ticks 1)
      (run:with-fork ()
        (driver:end-plan task)
        (is (null (driver:plans))))
      (is (equal (list task) (driver:plans))))))

(test borders.errors-in-forks-are-told-where-the-fork-was-asked-for
  (with-rover (:seed 1)
    (command:robot-turn rover 1 (lambda (&rest ignore)
                                  (declare (ignore ignore))
                                  (run:with-fork () (error "Lost in a fork."))))
    (run:run-ticks 9)
    (is (search "Lost in a fork." (displayed)))))

(defvar *border-bell* (fluents:create-fluent 'bell))
(defvar *border-rings* (fluents:fl-pulsed *border-bell*))

(test borders.global-views-are-those-of-the-fork
  "Also while no task waits for them, so that no plan leads to them."
  (with-rover (:seed 1)
    (let ((task (driver:begin-plan
                 (rpl:interp-lambda ()
                   (let ((heard '()))
                     (rpl:par (rpl:n-times 8 (rpl:wait-time 1) (rpl:pulse *border-bell*))
                              (rpl:n-times 4
                                (rpl:wait-for *border-rings*)
                                (push (rpl:plan-time) heard)
                                (rpl:wait-time 1)))
                     heard)))))
      (run:run-ticks 3)
      (let ((there (run:with-fork ()
                     (let ((task (first (driver:plans))))
                       (run:run-ticks 20)
                       (rpl:task-result task)))))
        (run:run-ticks 20)
        (is-true there)
        (is (equal (rpl:task-result task) there))))))

;;; Threads.

(test borders.ticks-pass-while-another-thread-forks
  (with-rover (:seed 1)
    (let* ((simulation time:*simulation*)
           (done-p nil)
           (forks 0)
           (thread (base:start-thread
                    (lambda ()
                      (loop until done-p
                            do (run:release-fork (run:fork-simulation simulation))
                               (incf forks)))
                    "forks")))
      (unwind-protect (loop until (and (< 20 forks) (<= 200 (run:simulation-tick)))
                            do (run:run-ticks 1))
        (setf done-p t)
        (base:join-thread thread))
      (is (< 20 forks)))))

;;; Forks that a continuation makes, while others of the same tick are still to be called.

(defvar *told* '() "Whether those were forks in which something was told.")

(defun note-told (&rest ignore)
  (declare (ignore ignore))
  (push (run:fork-p time:*simulation*) *told*))

(defun told-in-fork (continuations)
  "Return how often the second of two continuations of a tick is called ahead, in a fork that the
first makes, and in the run itself."
  (let ((*told* '()))
    (run:with-simulation (ars-worlds:robbie)
      (command:robot-place ars-worlds:robbie
                           (lambda (&rest ignore)
                             (declare (ignore ignore))
                             (run:with-fork (:continuations continuations) (run:run-ticks 1))))
      (command:camera-view (robot:robot-camera ars-worlds:robbie 0) #'note-told)
      (run:run-ticks 2))
    (list (count t *told*) (count nil *told*))))

(test forks.of-continuations-call-the-others-of-their-tick
  (is (equal '(1 1) (told-in-fork t)))
  (is (equal '(0 1) (told-in-fork nil))))

(test forks.of-continuations-let-plans-hear-of-that-tick
  "A plan whose command ends in the tick of the continuation that forks goes on in the fork."
  (let ((ahead nil))
    (run:with-simulation (ars-worlds:robbie)
      (command:robot-place ars-worlds:robbie
                           (lambda (&rest ignore)
                             (declare (ignore ignore))
                             (run:with-fork ()
                               (run:run-ticks 3)
                               (setf ahead (driver:plans)))))
      (driver:begin-plan (rpl:interp-lambda ()
                           (driver:rpl-camera-view 0)
                           (rpl:wait-for (svref driver:camera-input* 0))))
      (is (= 1 (length (driver:plans))))
      (run:run-ticks 2)
      (is (null (driver:plans))))
    (is (null ahead))))

;;; What clean-simulation has changed.

(test forks.clean-and-dirty-by-themselves
  (flet ((noise () base:motion-noise*))
    (run:with-simulation (ars-worlds:robbie)
      (let ((noise (noise)))
        (run:with-fork () (base:clean-simulation))
        (base:clean-simulation)
        (is (zerop (noise)))
        (run:with-fork () (base:dirty-simulation) (is (= noise (noise))))
        (base:dirty-simulation)
        (is (= noise (noise)))))))

(defun noise-after (function)
  "Return the noise of motion after FUNCTION and DIRTY-SIMULATION in a run that keeps forks."
  (run:with-simulation (ars-worlds:robbie :keep t)
    (funcall function)
    (base:dirty-simulation)
    base:motion-noise*))

(test rewinds.keep-what-dirty-simulation-restores
  (let ((noise base:motion-noise*))
    (flet ((cleaned (back)
             (lambda ()
               (base:clean-simulation)
               (run:run-ticks 3)
               (run:rewind back))))
      (is (= noise (noise-after (cleaned 1)) (noise-after (cleaned 3)))))
    (is (= noise (noise-after (lambda ()
                                (base:clean-simulation)
                                (run:run-ticks 3)
                                (base:dirty-simulation)
                                (run:run-ticks 3)
                                (run:rewind 5)
                                (is (zerop base:motion-noise*))))))))

(test replays.keep-what-dirty-simulation-restores
  (let* ((noise base:motion-noise*)
         (journal (run:with-simulation (ars-worlds:robbie :journal t)
                    (base:clean-simulation)
                    (run:run-ticks 3)
                    (run:simulation-journal time:*simulation*))))
    (run:with-replay (journal)
      (is (zerop base:motion-noise*))
      (base:dirty-simulation)
      (is (= noise base:motion-noise*)))))

(test forks.of-continuations-let-plans-act-in-that-tick
  (let ((*told* '()))
    (run:with-simulation (ars-worlds:robbie)
      (driver:begin-plan (rpl:interp-lambda () (push (rpl:plan-time) *told*)))
      (command:robot-place ars-worlds:robbie
                           (lambda (&rest ignore)
                             (declare (ignore ignore))
                             (run:with-fork () (run:run-ticks 3))))
      (run:run-ticks 3))
    (is (equal '(1 1) *told*))))
