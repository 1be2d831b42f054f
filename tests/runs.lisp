;;;; runs.lisp -- runs side by side, requests that fail, changes from several threads.

(in-package :ars-magna.tests)

(def-suite* runs :in ars-magna)

(world:defmap paddock (12 12)
  (obj ball (6 6) ((:size 1) (:color world:red))))
(world:defmap meadow (12 12)
  (obj ball (3 3) ((:size 1) (:color world:blue))))
(robot:defrobot pony (paddock (4 10) 0) :cameras ((1 5)) :hands (10))
(robot:defrobot foal (meadow (4 10) 0))

(defmacro with-pony ((&rest options) &body body)
  `(run:with-simulation (pony ,@options) ,@body))

(defun ball () (world:find-thing 'ball))
(defun ball-in (simulation) (world:find-thing 'ball (run:simulation-world simulation)))

(defun replays-p (simulation)
  "True if the journal of SIMULATION gives its digest, from a file."
  (with-temporary-file (file)
    (run:save-journal file simulation)
    (= (run:state-digest simulation) (nth-value 1 (run:replay file)))))

;;; Code works in the world of its own run.

(test run.binds-its-world-in-what-it-calls
  (with-pony ()
    (time:schedule ('x :timer 2) (world:kick-thing (ball) 1 0 nil))
    (run:run-ticks 1)
    (let ((copy (run:fork-simulation time:*simulation*)))
      (run:run-ticks 5 copy)
      (is (= 6 (world:thing-x (ball))) "the original's ball stays")
      (is (= 7 (world:thing-x (ball-in copy))))))
  (let ((seen '()))
    (with-pony ()
      (let ((outer time:*simulation*) (robot pony))
        (time:schedule ('x) (push (world:thing-world (ball)) seen))
        (command:robot-turn pony .5 (lambda (&rest ignore)
                                      (declare (ignore ignore))
                                      (push (world:thing-world (ball)) seen)))
        (run:with-simulation (foal)
          (run:run-ticks 9 outer))
        (is (equal (list (robot:robot-world robot) (robot:robot-world robot)) seen))))))

(test live.runs-side-by-side-have-their-own-worlds
  (with-messages
    (let ((done (base:make-semaphore "done")) seen)
      (unwind-protect
           (progn
             (run:simulator 'pony :display nil :rate :free)
             (time:pause)
             (command:robot-turn pony .5 (lambda (err robot angle)
                                           (declare (ignore err angle))
                                           (setf seen (eq (world:thing-world (ball))
                                                          (robot:robot-world robot)))
                                           (base:signal-semaphore done)))
             (let ((first time:*simulation*))
               (run:simulator 'foal :display nil)
               (time:resume first)
               (is-true (base:wait-on-semaphore done 60))
               (is-true seen)
               (run:stop-simulator first)))
        (run:stop-simulator)))))

(test live.can-be-started-anew-from-a-continuation
  (with-messages
    (let ((done (base:make-semaphore "done")))
      (unwind-protect
           (progn
             (run:simulator 'pony :display nil :rate :free)
             (let ((first time:*simulation*))
               (command:robot-turn pony .1 (lambda (&rest ignore)
                                             (declare (ignore ignore))
                                             (run:simulator 'pony :display nil :rate :free)
                                             (base:signal-semaphore done)))
               (is-true (base:wait-on-semaphore done 60))
               (is (not (eq first time:*simulation*)))
               (is-true (time:live-p time:*simulation*))))
        (run:stop-simulator)))))

(test parameters.of-a-run-are-its-own
  (let (copy digest)
    (with-pony (:clean t)
      (command:robot-goto-wall pony)
      (run:run-ticks 2)
      (setf copy (run:fork-simulation time:*simulation*))
      (run:run-ticks 50)
      (setf digest (run:state-digest)))
    (run:run-ticks 50 copy)
    (is (= digest (run:state-digest copy)) "also of a copy, out here"))
  (with-pony (:journal t :parameters '((base:max-speed* 1d0)))
    (run:run-ticks 20)
    (is-true (replays-p time:*simulation*) "1.0 is not 1, to a digest")))

;;; Requests.

(test requests.behind-one-that-fails-are-not-lost
  (with-pony (:clean t)
    (let ((turned 0))
      (time:post (make-errand (lambda () (error "An errand that fails."))) time:*simulation*)
      (command:robot-turn pony 1 (lambda (&rest ignore)
                                   (declare (ignore ignore))
                                   (incf turned)))
      (signals error (run:run-ticks 1))
      (run:run-ticks 20)
      (is (= 1 turned))
      (is (< .9 (robot:robot-angle pony) 1.1)))))

(test requests.for-ages-hence-are-refused-or-wait
  (with-pony ()
    (signals base:wrong-argument (time:schedule ('x :timer (expt 10 30)) nil))
    (signals base:wrong-argument (time:schedule ('x :timeout (expt 10 30) :when nil) nil))
    (setf base:robot-turn-delay* (expt 10 9))
    (command:robot-turn pony 1)
    (run:run-ticks 5)
    (is (= 1 (time:agenda-pending (run:simulation-agenda time:*simulation*))))))

(test journal.reaches-to-the-end-of-its-run
  (let ((journal (with-pony (:journal t)
                   (command:robot-turn pony 1)
                   (run:run-ticks 50)
                   (run:simulation-journal time:*simulation*))))
    (is (= 50 (run:journal-end journal)))
    (is (= 50 (run:simulation-tick (run:replay journal))))
    (is (= 30 (run:with-replay (journal :until 30) (run:simulation-tick))))))

(test seed.given-at-the-first-start-loses-nothing
  (with-messages
    (unwind-protect
         (progn
           (world:move-thing (world:find-thing 'ball (world:find-map 'meadow)) 5 5)
           (run:simulator 'foal :display nil :seed 5 :rate :free)
           (time:pause)
           (is (= 5 (world:thing-x (ball))))
           (is (= 5 (run:simulation-seed time:*simulation*)))
           (is (find 'world:move-thing (run:journal-entries
                                        (run:simulation-journal time:*simulation*))
                     :key #'second))
           (run:stop-simulator)
           (is-true (replays-p time:*simulation*)))
      (run:stop-simulator))))

;;; Journals on file.

(test journal.has-what-was-set-just-now
  (with-pony (:seed 1 :journal t)
    (run:run-ticks 1)
    (setf base:max-speed* 1/2)
    (is-true (replays-p time:*simulation*))))

(test journal.knows-what-has-been-destroyed
  (with-pony (:seed 1 :journal t)
    (let ((ball (ball)))
      (world:destroy-thing ball)
      (run:run-ticks 1)
      (world:set-attribute ball :size 5)
      (world:kick-thing ball 1 0 nil)
      (run:run-ticks 1)
      (is-true (replays-p time:*simulation*)))))

(test journal.tells-when-an-attribute-has-been-defined-since
  (with-pony (:seed 1 :journal t)
    (world:set-attribute (ball) :sweetness 5)
    (run:run-ticks 1)
    (with-temporary-file (file)
      (run:save-journal file)
      (run:replay file)
      (world:define-attribute 'sweetness :numeric :base 3 :max-mult 9)
      (handler-case (progn (run:replay file) (fail "was replayed"))
        (run:different-definitions (trouble)
          (is (search "attribute sweetness has been defined since" (princ-to-string trouble))))))))

(test journal.can-be-read-when-it-could-be-saved
  (with-pony (:seed 1 :journal t)
    (loop for length in '(999940 999949 999950 999951)
          do (setf (run:simulation-journal time:*simulation*) nil)
             (run:begin-journal time:*simulation*)
             (world:set-attribute (ball) :label (make-string length :initial-element #\a))
             (with-temporary-file (file)
               (when (tolerating (base:misuse) (run:save-journal file) t)
                 (is (run:journal-p (run:load-journal file)) "~D" length))))))

(test journal.names-that-are-not-known-are-one-symbol-each
  (with-temporary-file (file)
    (with-pony (:seed 1 :journal t)
      (let ((word (intern "NEVER-HEARD-OF" :keyword)))
        (world:set-attribute (ball) :label word)
        (world:set-attribute (ball) :owner word)
        (run:save-journal file)
        (unintern word :keyword)))
    (let ((entries (run:journal-entries (run:load-journal file))))
      (is (string= "NEVER-HEARD-OF" (fifth (first entries))))
      (is (eq (fifth (first entries)) (fifth (second entries))))
      (is (null (find-symbol "NEVER-HEARD-OF" :keyword))))))

(test parameters.are-checked-when-a-run-begins
  (let ((base:max-speed* -1))
    (signals base:wrong-argument (with-pony () (run:run-ticks 1))))
  (with-pony ()
    (signals base:wrong-argument (setf (base:parameter-value 'base:max-speed*) (expt 10 400)))
    (signals base:wrong-argument (robot:place-robot pony (expt 10 400) 5 1))
    (signals base:wrong-argument (world:set-attribute (ball) :size (expt 10 400)))))

;;; Who may wait, and who is told.

(test journal.has-kickers-that-were-asked-for
  (with-pony (:seed 1 :journal t)
    (world:put-kicker hop (thing (ball)) (:prob 0) (world:kick-thing thing 1 0 nil))
    (let ((hop (first (world:thing-kickers (ball)))))
      (world:run-kicker hop)
      (run:run-ticks 2)
      (command:robot-turn pony 1 (lambda (&rest ignore)
                                   (declare (ignore ignore))
                                   (world:run-kicker hop)))
      (run:run-ticks 9)
      (is (= 8 (world:thing-x (ball))))
      (is (= (run:state-digest)
             (nth-value 1 (run:replay (run:simulation-journal time:*simulation*))))))))

(test messages.of-a-live-run-reach-who-started-it
  (with-messages
    (unwind-protect
         (progn
           (with-pony () (run:robot-simulation foal))
           (run:simulator 'foal :display nil :rate :free)
           (command:robot-turn foal 1)
           (run:await-idle)
           (is (search "Robot turned" (displayed))))
      (run:stop-simulator))))

(test ticks.do-not-pass-inside-themselves
  (with-pony ()
    (let ((ticks '()))
      (run:add-observer (lambda (simulation) (push (run:simulation-tick simulation) ticks)))
      (command:robot-turn pony 1 (lambda (&rest ignore)
                                   (declare (ignore ignore))
                                   (run:run-ticks 3)))
      (run:run-ticks 10)
      (is (search "a tick is under way" (displayed)))
      (is (equal '(1 2 3 4 5 6 7 8 9 10) (reverse ticks)))
      (is (= 11 (run:run-ticks 1)) "and go on passing"))))

(test ticks.other-threads-are-answered-between-them
  "Who asks in tick 1 of a headless run is answered before tick 2, not when all ticks have passed."
  (with-pony ()
    (let* ((simulation time:*simulation*) (asker nil) (told nil)
           (custody (time::timeline-custody (run:simulation-timeline simulation))))
      (flet ((ask-tick ()
               (time:asking (simulation) (setf told (run:simulation-tick simulation)))))
        (run:add-observer (lambda (simulation)
                            (declare (ignore simulation))
                            (unless asker
                              (setf asker (base:start-thread #'ask-tick "asker"))
                              (await (lambda () (time::custody-questions custody)))))))
      (is (= 5 (run:run-ticks 5)))
      (base:join-thread asker)
      (is (eql 1 told)))))

(test live.nobody-waits-for-himself
  (with-messages
    (let ((done (base:make-semaphore "done")))
      (unwind-protect
           (progn
             (run:simulator 'foal :display nil :rate :free)
             (command:robot-turn foal 1 (lambda (&rest ignore)
                                          (declare (ignore ignore))
                                          (unwind-protect (run:await-idle)
                                            (base:signal-semaphore done))))
             (is-true (base:wait-on-semaphore done 60))
             (is-true (run:await-idle foal))
             (is (search "would wait for itself" (displayed))))
        (run:stop-simulator foal)))))

(test await-idle.waits-for-no-kickers
  "They go on as long as the run; at a rate, too."
  (with-messages
    (unwind-protect
         (progn
           (run:simulator 'ars-worlds:robbie :display nil :rate 500)
           (command:robot-turn ars-worlds:robbie 1/10)
           (is-true (run:await-idle time:*simulation* 20))
           (is-false (run:idle-p)))
      (run:stop-simulator))))

(defclass saboteur () ())

(defmethod run:participant-after-tick ((saboteur saboteur) simulation)
  (declare (ignore simulation))
  (error "A participant that fails."))

(test participant.that-fails-is-a-message
  (with-pony ()
    (run:add-participant (make-instance 'saboteur) time:*simulation*)
    (is (= 2 (run:run-ticks 2)))
    (is (search "A participant that fails." (displayed)))))

;;; Several threads.

(defun race (count function other)
  "Call FUNCTION and OTHER with a number below COUNT, each in a thread, for all of them at once."
  (flet ((runner (function)
           (let ((simulation time:*simulation*))
             (base:start-thread
              (lambda ()
                (let ((time:*simulation* simulation)
                      (world:*world* (run:simulation-world simulation)))
                  (dotimes (i count)
                    (tolerating (base:misuse base:wrong-argument) (funcall function i)))))
              "racer"))))
    (mapc #'base:join-thread (list (runner function) (runner other)))))

(test changes.from-several-threads-are-checked-by-the-owner
  (with-messages
    (unwind-protect
         (progn
           (run:simulator 'foal :display nil :rate :free)
           (let* ((count 300)
                  (things (coerce (loop repeat (* 2 count)
                                        collect (world:make-new-thing
                                                 'tub '(meadow 3 3) '((:size 1) (:capacity 5))))
                                  'vector)))
             (flet ((first-of (i) (aref things (* 2 i)))
                    (second-of (i) (aref things (1+ (* 2 i)))))
               (race count
                     (lambda (i) (world:move-thing (first-of i) (second-of i)))
                     (lambda (i) (world:move-thing (second-of i) (first-of i))))
               (race count
                     (lambda (i) (world:destroy-thing (first-of i)))
                     (lambda (i)
                       (world:make-new-thing 'pea (list :with (first-of i)) '((:size .1)))
                       (world:move-thing (first-of i) 4 4)))))
           (is (null (time:asking (time:*simulation*)
                       (world:world-invariant-violations
                        (run:simulation-world time:*simulation*)))))
           (run:stop-simulator)
           (is (= (run:state-digest)
                  (nth-value 1 (run:replay (run:simulation-journal time:*simulation*))))))
      (run:stop-simulator))))

(test journal.ends-with-its-run
  (let (digest journal)
    (with-pony (:journal t)
      (command:robot-turn pony 1 (lambda (&rest ignore)
                                   (declare (ignore ignore))
                                   (world:move-thing (ball) 5 5)))
      (run:run-ticks 1)
      (setf digest (run:state-digest)
            journal (run:simulation-journal time:*simulation*)))
    (is (= digest (nth-value 1 (run:replay journal))))
    (is (= digest (nth-value 1 (run:replay journal :until (run:journal-end journal)))))))

(test journal.knows-designators-of-earlier-runs-as-dropped
  (with-pony (:journal t)
    (let ((old (robot:make-designator :robot pony :serial 0 :number 0 :valid-p nil)))
      (command:camera-track (elt (robot:robot-cameras pony) 0) old (constantly nil))
      (run:run-ticks 1)
      ;; In a replay its reference must not mean the designator that has its number by then.
      (is (equal '(-1 0) (subseq (ars-magna.base:reference old) 2 4))))))

(test run.that-is-clean-keeps-noise-that-is-given
  (run:with-simulation ('ars-worlds:dot :clean t :parameters '((motion-noise* 1/5)))
    (is (eql 1/5 base:motion-noise*))
    (is (eql 0d0 base:prob-lose-track*))
    (is-true base:no-sensor-error*)
    (base:clean-simulation)
    (is (eql 1/5 base:motion-noise*))
    (base:dirty-simulation)
    (is (eql 1/5 base:motion-noise*))
    (is (plusp base:prob-lose-track*))
    (is-false base:no-sensor-error*))
  (run:with-simulation ('ars-worlds:dot :clean t :parameters '((base:no-sensor-error* nil)))
    (is-false base:no-sensor-error*)
    (is (eql 0d0 base:motion-noise*))))
