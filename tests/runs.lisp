;;;; runs.lisp -- runs beside one another, requests that go wrong, and what users add of their own.

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

;;; The world that code works in is that of the run it runs for.

(test run.binds-its-world-in-what-it-calls
  (with-pony ()
    (time:schedule ('x :timer 2) (world:kick-thing (ball) 1 0 nil))
    (run:run-ticks 1)
    (let ((copy (run:copy-simulation time:*simulation*)))
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
             (command:robot-turn pony .1 (lambda (&rest ignore)
                                           (declare (ignore ignore))
                                           (run:simulator 'pony :display nil :rate :free)
                                           (base:signal-semaphore done)))
             (let ((first time:*simulation*))
               (is-true (base:wait-on-semaphore done 60))
               (is (not (eq first time:*simulation*)))
               (is-true (time:live-p time:*simulation*))))
        (run:stop-simulator)))))

(test parameters.of-a-run-are-its-own
  (let (copy digest)
    (with-pony (:clean t)
      (command:robot-goto-wall pony)
      (run:run-ticks 2)
      (setf copy (run:copy-simulation time:*simulation*))
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
    (setf base:robot-turn-delay* most-positive-fixnum)
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

;;; What users add.

(base:define-kind (probe :include robot:part)
    "A part that keeps all sorts of things."
  (:fixed
   (reach 1d0 double-float "how far the probe reaches, in metres"))
  (:state
   (history '() list "what the probe has met")
   (spot nil (or null geo:pt) "a spot that it remembers")
   (chart (make-array '(2 2) :initial-element 0) array "a chart of what is around")
   (table (make-hash-table) hash-table "what it knows of what")))

(base:define-argument-type 'probe #'probe-p "a probe")

(command:define-command probe-fail (operation (probe probe)) ((depth "how deep"))
    ((:family :handling) (:report (depth) (format nil "~D deep" depth)))
    "Fail in the body."
  (error "The probe broke."))

(command:define-command probe-forget (operation (probe probe)) ()
    ((:family :handling))
    "Neither end nor go on."
  operation)

(command:define-command probe-misreport (operation (probe probe)) ((depth "how deep"))
    ((:family :handling) (:report () "deep"))
    "Report with too few variables."
  (command:succeed operation 3))

(robot:defrobot diver (meadow (4 10) 0) :cameras ((1 5)) :parts ((probe :reach 2)))

(defmacro with-diver ((&rest options) &body body)
  `(run:with-simulation (diver ,@options) ,@body))

(defun the-probe (&optional (robot diver)) (robot:robot-part robot 'probe 0))

(test command.of-a-users-that-fails-is-a-message
  (loop for (command says . expected) in '((probe-fail "The probe broke." :failed)
                                           (probe-forget "neither ended nor went on" :failed)
                                           (probe-misreport "invalid number of arguments" nil))
        do (with-diver (:journal t)
             (let ((answers '()) (viewed nil))
               (funcall command (the-probe) (lambda (err &rest ignore)
                                              (declare (ignore ignore))
                                              (push err answers)))
               (command:camera-view (robot:robot-camera diver 0)
                                    (lambda (&rest ignore)
                                      (declare (ignore ignore))
                                      (setf viewed t)))
               (run:run-ticks 5)
               (is (equal expected answers) "~A" command)
               (is-true viewed)
               (is (search says (displayed)) "~A" command)
               (is-true (replays-p time:*simulation*))))))

(test state.of-all-sorts-is-digested-and-copied
  (with-diver ()
    (let ((digest (run:state-digest)) (digests '()))
      (flet ((change (function)
               (funcall function (the-probe))
               (push (run:state-digest) digests)))
        (change (lambda (probe) (setf (probe-history probe) (list 1 2 3))))
        (change (lambda (probe) (setf (probe-spot probe) (geo:make-pt 1 2))))
        (change (lambda (probe) (setf (probe-spot probe) (geo:make-pt 7 8))))
        (change (lambda (probe) (setf (aref (probe-chart probe) 1 1) 5)))
        (change (lambda (probe) (setf (gethash :a (probe-table probe)) 5)))
        (change (lambda (probe) (setf (gethash :a (probe-table probe)) 6))))
      (is (= 7 (length (remove-duplicates (cons digest digests)))))
      (let* ((copy (run:copy-simulation time:*simulation*))
             (other (the-probe (first (run:simulation-robots copy)))))
        (is (= (first digests) (run:state-digest copy)))
        (setf (second (probe-history other)) :changed
              (aref (probe-chart other) 0 0) :changed
              (gethash :a (probe-table other)) :changed)
        (geo:set-pt! (probe-spot other) 0 0)
        (is (= (first digests) (run:state-digest)) "the original is not disturbed")))))

(test parts.are-made-with-what-is-fixed-only
  (with-diver () (is (= 2d0 (probe-reach (the-probe)))))
  (loop for (parts word) in '((((probe :rang 2)) "reach") (((probe :reach "far")) "reach")
                              (((probe 2)) "kind of part") (((probe :history (1))) "reach")
                              (((probe :location 3)) "reach") (((camera :resolution 3)) "cameras")
                              (((robot:part)) "cameras") (((nothing-known)) "kind of part"))
        do (handler-case
               (progn (robot:define-robot 'newt 'meadow '(4 4) 0 :parts parts)
                      (fail "~S was taken" parts))
             (base:malformed-definition (trouble)
               (is (search word (princ-to-string trouble)) "~A" trouble)
               (is (search (prin1-to-string (first (first parts))) (princ-to-string trouble)
                           :test #'char-equal)
                   "~A" trouble)))))

(test parts.of-unknown-kinds-are-told-so
  (with-diver ()
    (signals base:unknown-name (robot:robot-part diver 'nosuch 0))
    (signals base:wrong-argument (robot:robot-part diver 'probe 1))
    (signals base:wrong-argument (time:ask 3 (lambda () nil)))
    (signals base:wrong-argument (run:run-until 3))))

(test kinds.are-checked-where-they-are-defined
  (dolist (form '((base:define-kind (k :include robot:part) (:state (a 0 fixnum "x")))
                  (base:define-kind ("k") "K.")
                  (base:define-kind (:k) "K.")
                  (base:define-kind (k) "K." (:state (a 0 fixnum "x") (a 1 fixnum "y")))
                  (base:define-kind (k :include robot:part) "K." (:state (index 0 fixnum "x")))))
    (signals base:malformed-definition (macroexpand-1 form)))
  (dolist (form '((driver:define-outcome (probe-fail) (n) (:set nofluent* n))
                  (driver:define-outcome (probe-fail) (n) (:sett driver:robot-place* n))))
    (signals base:malformed-definition (macroexpand-1 form))))

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

(defclass saboteur () ())

(defmethod run:participant-after-tick ((saboteur saboteur) simulation)
  (declare (ignore simulation))
  (error "A participant that fails."))

(test participant.that-fails-is-a-message
  (with-pony ()
    (run:add-participant (make-instance 'saboteur) time:*simulation*)
    (is (= 2 (run:run-ticks 2)))
    (is (search "A participant that fails." (displayed)))))

(test command.is-checked-where-it-is-defined
  (loop for (clause word) in '((((:famly :moving)) ":famly") (((:family :flying)) ":flying")
                               (((:family :moving) (:delya 5)) ":delya"))
        do (handler-case
               (progn (macroexpand-1 `(command:define-command nap (operation (robot robot:robot)) ()
                                          ,clause "Nap." (command:succeed operation)))
                      (fail "~S was taken" clause))
             (base:malformed-definition (trouble)
               (is (search word (princ-to-string trouble)) "~A" trouble))))
  (signals base:malformed-definition
    (macroexpand-1 '(command:define-command nap (operation (robot robot:robot) x) ()
                     ((:family :moving)) "Nap." (command:succeed operation))))
  (handler-case (progn (eval '(command:define-command nap
                               (operation (robot robot:robot) (x nosuch-type "an x")) ()
                               ((:family :moving)) "Nap." (command:succeed operation)))
                       (fail "was taken"))
    (base:malformed-definition (trouble)
      (is (search "define-command nap" (princ-to-string trouble)))
      (is (search "nosuch-type" (princ-to-string trouble))))))
