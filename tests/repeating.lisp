;;;; repeating.lisp -- repeated runs with kickers and events that issue requests themselves.

(in-package :ars-magna.tests)

(def-suite* repeating :in ars-magna)

;;; In a replay, kickers and events issue their requests again. The requests of continuations are in
;;; the journal.

(defun is-repeated (journal digest)
  "Check that JOURNAL comes to DIGEST, and the replay to the same journal."
  (run:with-replay (journal)
    (is (= digest (run:state-digest)))
    (is (every #'run::alike-across-runs-p (run:journal-entries journal)
               (run:journal-entries (end-journal time:*simulation*))))
    (is (= (run:journal-length journal)
           (run:journal-length (run:simulation-journal time:*simulation*))))))

(defmacro repeating-run ((&rest options) &body body)
  "Run BODY in a run of rover, let forty ticks pass, and check that its journal repeats it."
  `(let (journal digest)
     (with-rover (:seed 5 :journal t ,@options)
       ,@body
       (run:run-ticks 40)
       (setf journal (end-journal time:*simulation*)
             digest (run:state-digest)))
     (is-repeated journal digest)))

(defun pot-in-run ()
  (world:make-new-thing 'pot (list world:*world* 3.5 3.5) '((:size 1))))

(world:defkicker shove-soon (thing) (:prob .2)
  (time:schedule (nil :timer 2) (world:kick-thing thing .1 0 nil)))

(test repeating.kickers-that-schedule
  (repeating-run () (world:set-kicker (pot-in-run) 'shove-soon)))

(test repeating.events-that-command-and-schedule
  (repeating-run ()
    (let ((pot (pot-in-run)) (rover rover))
      (time:schedule (nil :timer 3)
        (command:robot-turn rover 1)
        (time:schedule (nil :timer 5) (world:kick-thing pot .5 0 nil))))))

(test repeating.functions-act-on-the-run-that-they-are-in
  "With the variables of then, also where the run changes these."
  (repeating-run ()
    (let ((pot (pot-in-run)) (looks 0) (kicks 0))
      (time:schedule (nil :timer 3 :timeout 9 :when (= 3 (incf looks)))
        (world:kick-thing pot (/ looks 10) 0 nil))
      (world:put-kicker shove-more (it pot) (:prob .3)
        (world:kick-thing it 0 (/ (incf kicks) 50) t)))))

(test repeating.continuations-of-commands-that-events-give
  "What they ask for is in the journal: so they are not called besides, in replays or where a run is
rewound."
  (dolist (ticks '(0 20 34))
    (keeping-every 1/1000000
      (repeating-run (:keep t)
        (let ((rover rover))
          (time:schedule (nil :timer 3)
            (command:robot-turn rover 1
              (lambda (&rest results)
                (declare (ignore results))
                (let ((robot (first (run:simulation-robots time:*simulation*))))
                  (command:robot-turn robot 1/4)
                  (pot-in-run))))))
        (run:run-ticks 40)
        (let ((digest (run:state-digest)))
          (run:run-ticks 2)
          (run:rewind 2)
          (is (= digest (run:state-digest)))
          (is (= 1 (count 'pot (world:world-thing-list world:*world*) :key #'world:thing-name))))
        (run:rewind ticks)))))

(defvar *bystander* nil "What another thread does in the midst of a tick, once.")

(test repeating.what-another-thread-asks-in-the-midst-of-a-tick
  "It comes after all that the tick asks for, in the run as where that is repeated."
  (repeating-run ()
    (let ((rover rover))
      (setf *bystander* (lambda () (command:robot-turn rover 2)))
      (time:schedule (nil)
        (command:robot-turn rover 1)
        (let ((bystander (shiftf *bystander* nil)))
          (when bystander (base:join-thread (base:start-thread bystander "bystander"))))
        (command:robot-turn rover 3)))))

(test repeating.parameters-stand-where-they-stood
  (repeating-run ()
    (setf base:motion-noise* 0.3d0)
    (run:state-digest)
    (setf base:motion-noise* 0.4d0)
    (run:state-digest)
    (pot-in-run)
    (command:robot-go-forward rover 9)))
