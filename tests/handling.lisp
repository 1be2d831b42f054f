;;;; handling.lisp -- hands, storage bins, and parts inside things (manual 3.4.3, 3.6).

(in-package :ars-magna.tests)

(def-suite* handling :in ars-magna)

;;; COOK stands amid what it can reach.
(world:defmap kitchen (12 12)
  (rect (0 0) (11 11) bricks 1 4 8 12)
  (obj hamper (5.5 5.5) ((:size 12) (:capacity 10) (:weight 2))
    (chest ((:size 6) (:capacity 5) (:weight 1))
      (tin ((:size 1) (:capacity .8) (:weight .5))
        (dot ((:size .1) (:weight .1)))))
    (pen ((:size .2))))
  (obj apple (5.2 5.2) ((:size 1) (:weight 1)))
  (obj melon (5.2 5.8) ((:size 8) (:weight 5)))
  (obj anvil (5.8 5.8) ((:size 4) (:weight 50)))
  (obj jar (5.8 5.2) ((:size 2) (:capacity 1.5) (:closed t)) (pickle ((:size .5))))
  (obj crate (2.5 2.5) ((:size 8) (:capacity 7)) (nail ((:size .1)))))

(robot:defrobot cook (kitchen (5.5 5.5) 0)
  :cameras (((/ pi 4) 3) ((/ pi 2) 5))
  :hands (10 4)
  :bins (20 5))

(defmacro with-cook ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh COOK."
  `(run:with-simulation (cook ,@options) ,@body))

(defun hand (index) (robot:robot-hand cook index))
(defun camera (index) (robot:robot-camera cook index))
(defun bin (index) (robot:robot-storage-bin cook index))
(defun thing (name) (world:find-thing name))

(defun designate (name &key (type :local))
  "Return a new designator of COOK on the thing called NAME, seen where that is."
  (let ((thing (thing name)))
    (robot:add-designator cook :type type :denotation thing
                              :location (robot:thing-enclosure thing))))

(defun hallucinate (&key (type :local))
  "Return a new false designator of COOK."
  (robot:add-designator cook :type type :x 5.5 :y 5.5))

(defun track (camera designator)
  "Let CAMERA track DESIGNATOR at once. Return DESIGNATOR."
  (robot:start-track camera designator nil)
  designator)

(defun put-into (part location)
  "Put PART into LOCATION at once, and no message about it."
  (robot:move-part part location)
  (base:take-messages))

;;; Answers.

(defvar *answers* '() "What continuations were called with, newest first.")

(defun recorder (name)
  "Return a continuation that adds NAME and what it is called with to *ANSWERS*."
  (lambda (&rest arguments) (push (cons name arguments) *answers*)))

(defun answers-to (name)
  (loop for (other . arguments) in (reverse *answers*)
        when (eq name other) collect arguments))

(defun reply (command &rest arguments)
  "Issue COMMAND with ARGUMENTS and pass 20 ticks. Return what its continuation was called with, as
a list; claims that it was called exactly once."
  (let ((calls '()))
    (apply command (append arguments (list (lambda (&rest call) (push call calls)))))
    (run:run-ticks 20)
    (is (= 1 (length calls)) "~S was answered ~D times" command (length calls))
    (first calls)))

(defun code-of (command &rest arguments)
  "Return the error code with which COMMAND with ARGUMENTS ends."
  (first (apply #'reply command arguments)))

(defun ticks-of (command &rest arguments)
  "Return after how many ticks COMMAND with ARGUMENTS is answered."
  (let ((start (run:simulation-tick)) (answered nil))
    (apply command (append arguments (list (lambda (&rest call)
                                             (declare (ignore call))
                                             (setf answered t)))))
    (run:run-until (lambda () answered) :limit 50)
    (- (run:simulation-tick) start)))

(defun texts ()
  "Return the messages queued since last asked, as they are displayed."
  (with-output-to-string (out) (base:error-display out)))

(defmacro with-chance ((name value) &body body)
  "Run BODY with the parameter called NAME set to VALUE."
  `(let ((old (base:parameter-value ,name)))
     (setf (base:parameter-value ,name) ,value)
     (unwind-protect (progn ,@body)
       (setf (base:parameter-value ,name) old))))

(defun grasp (index name)
  "Let hand INDEX grasp the thing called NAME by way of camera 0. Return the error code."
  (let ((designator (track (camera 0) (designate name))))
    (prog1 (code-of 'command:hand-grasp-desig (hand index) (camera 0) designator)
      (robot:end-track (camera 0) :interrupt)
      (robot:drop-designator designator :silently t))))

;;; Grasping.

(test grasp.takes-what-is-designated
  (with-cook (:clean t)
    (let* ((designator (track (camera 0) (designate 'apple)))
           (reply (reply 'command:hand-grasp-desig (hand 0) (camera 0) designator)))
      (is (equal (list nil (hand 0) designator) reply))
      (is (eq (thing 'apple) (robot:hand-holding (hand 0))))
      (is (eq (hand 0) (world:thing-location (thing 'apple))))
      (is-true (robot:designator-valid-p designator) "clean grasps lose nothing")
      (is-true (robot:tracking-p (camera 0) designator)))))

(test grasp.takes-both-delays
  (with-cook (:clean t)
    (let ((designator (track (camera 0) (designate 'apple))))
      (is (= 6 (ticks-of 'command:hand-grasp-desig (hand 0) (camera 0) designator)))
      (is (= 1 (ticks-of 'command:hand-ungrasp (hand 0))))
      (is (= 1 (ticks-of 'command:hand-grasp-check (hand 0))))
      (is (= 2 (ticks-of 'command:hand-insert-bin (hand 0) (bin 0))))
      (is (= 2 (ticks-of 'command:hand-remove (hand 0))))
      (is (= 2 (ticks-of 'command:camera-insert (camera 1) (bin 0))))
      (is (= 2 (ticks-of 'command:camera-remove (camera 1))))
      (is (= 2 (ticks-of 'command:storage-bin-close (bin 0))))
      (is (= 2 (ticks-of 'command:storage-bin-open (bin 0)))))))

(test grasp.error-codes-in-the-printed-order
  (with-cook (:clean t)
    (flet ((try (designator) (code-of 'command:hand-grasp-desig (hand 0) (camera 0) designator))
           (other (designator)
             (code-of 'command:hand-grasp-desig (hand 1) (camera 0) designator)))
      (let ((invalid (designate 'anvil)) (far (designate 'crate :type :non-local)))
        (robot:drop-designator invalid)
        ;; Nothing is wrong but the strength.
        (is (eq :insufficient-strength (try (track (camera 0) (designate 'anvil)))))
        (robot:end-track (camera 0) :interrupt)
        (is (eq :missed-grasp (try (track (camera 0) (hallucinate)))))
        (robot:end-track (camera 0) :interrupt)
        (is (eq :not-tracked (try (designate 'anvil))))
        (is (eq :non-local-grasp (try (track (camera 0) far))))
        (robot:end-track (camera 0) :interrupt)
        (is (eq :bad-designator (try invalid)))
        (put-into (camera 0) (bin 0))
        (is (eq :different-location (try invalid)))
        (world:move-thing (thing 'apple) (hand 0))
        (is (eq :hand-grasping (try invalid)))
        (is (eq :different-location (other invalid)))))))

(test grasp.misses-by-chance-before-strength-matters
  (with-cook (:clean t)
    (with-chance ('prob-miss-grasp* 1)
      (is (eq :missed-grasp (grasp 0 'anvil))))))

(test grasp.weighs-contents-too
  "The hamper weighs 2, with contents 3.6; the second hand lifts 4."
  (with-cook (:clean t)
    (is (null (grasp 1 'hamper)))
    (world:move-thing (thing 'hamper) 5.5 5.5)
    (world:move-thing (thing 'apple) (thing 'hamper))
    (is (eq :insufficient-strength (grasp 1 'hamper)))))

(test grasp.misses-what-has-gone
  "The track still says local; the thing has moved between the ticks."
  (with-cook (:clean t)
    (let ((designator (track (camera 0) (designate 'apple))) (*answers* '()))
      (command:hand-grasp-desig (hand 0) (camera 0) designator (recorder 'grasp))
      (run:run-ticks 5)
      (world:move-thing (thing 'apple) 9.5 9.5)
      (run:run-ticks 1)
      (is (equal '(:missed-grasp) (mapcar #'first (answers-to 'grasp)))))))

(test grasp.from-another-hand
  (with-cook (:clean t)
    (let ((*answers* '()))
      (grasp 0 'apple)
      (command:hand-track (hand 0) (recorder 'track))
      (is (null (grasp 1 'apple)))
      (is (null (robot:hand-holding (hand 0))))
      (is (eq (thing 'apple) (robot:hand-holding (hand 1))))
      (is (equal (list (list :grasp-lost (hand 0))) (answers-to 'track))))))

(test grasp.loses-designators-silently
  (with-cook (:clean t)
    (with-chance ('prob-grasp-lose-desig* 1)
      (let* ((designator (track (camera 0) (designate 'apple)))
             (others (list (designate 'apple) (designate 'apple))))
        (texts)
        (is (null (code-of 'command:hand-grasp-desig (hand 0) (camera 0) designator)))
        (is (notany #'robot:designator-valid-p (cons designator others)))
        (is (null (robot:camera-tracks (camera 0))))
        (is (string= (format nil "hand-grasp: Hand 0 grasped APPLE#6~%") (texts)))))))

(test grasp.loses-designators-even-when-it-fails
  (with-cook (:clean t)
    (with-chance ('prob-grasp-lose-desig* 1)
      (let ((designator (track (camera 0) (designate 'anvil))))
        (is (eq :insufficient-strength
                (code-of 'command:hand-grasp-desig (hand 0) (camera 0) designator)))
        (is-false (robot:designator-valid-p designator))))))

;;; Letting go.

(test ungrasp.drops-on-the-floor-where-the-robot-stands
  (with-cook (:clean t)
    (grasp 0 'apple)
    (robot:place-robot cook 7.25 6.5 1)
    (is (equal (list nil (hand 0)) (reply 'command:hand-ungrasp (hand 0))))
    (is (eq :floor (world:thing-location (thing 'apple))))
    (is (equal '(7.25d0 6.5d0) (multiple-value-list (world:thing-position (thing 'apple)))))
    (is (null (robot:hand-holding (hand 0))))
    (is (eq :not-grasping (code-of 'command:hand-ungrasp (hand 0))))))

(test ungrasp.drops-into-what-the-hand-is-inside-of
  (with-cook (:clean t)
    (grasp 0 'apple)
    (code-of 'command:hand-insert-bin (hand 0) (bin 1))
    (texts)
    (code-of 'command:hand-ungrasp (hand 0))
    (is (eq (bin 1) (world:thing-location (thing 'apple))))
    (is (string= (format nil "hand-ungrasp: Hand 0 dropped APPLE#6 into Storage-bin 1~%")
                 (texts)))
    (is (= 4 (world:remaining-capacity (bin 1))))
    (code-of 'command:hand-remove (hand 0))
    (grasp 0 'melon)
    (code-of 'command:hand-insert (hand 0) (designate 'hamper))
    (code-of 'command:hand-ungrasp (hand 0))
    (is (eq :floor (world:thing-location (thing 'melon))) "it is too big for the hamper")))

(test ungrasp.never-fails-for-room
  "The room is checked when the hand goes in, and taken up when it lets go."
  (with-cook (:clean t)
    (world:set-attribute (thing 'melon) :size 5)
    (grasp 0 'melon)
    (grasp 1 'apple)
    (is (null (code-of 'command:hand-insert-bin (hand 0) (bin 1))))
    (is (null (code-of 'command:hand-insert-bin (hand 1) (bin 1))))
    (is (null (code-of 'command:hand-ungrasp (hand 0))))
    (is (null (code-of 'command:hand-ungrasp (hand 1))))
    (is (= 2 (length (robot:storage-bin-contents (bin 1)))))
    (is (= 0 (world:remaining-capacity (bin 1))) "never below 0")))

(test ungrasp.keeps-designators
  (with-cook (:clean t)
    (let ((designator (track (camera 0) (designate 'apple))))
      (is (null (code-of 'command:hand-grasp-desig (hand 0) (camera 0) designator)))
      (is (null (code-of 'command:hand-ungrasp (hand 0))))
      (is-true (robot:designator-valid-p designator))
      (is-true (robot:tracking-p (camera 0) designator)))))

;;; Feeling.

(test grasp-check.answers-with-a-code
  (with-cook (:clean t)
    (is (equal (list :not-grasping (hand 0)) (reply 'command:hand-grasp-check (hand 0))))
    (grasp 0 'apple)
    (texts)
    (is (equal (list :grasping (hand 0)) (reply 'command:hand-grasp-check (hand 0))))
    (is (string= (format nil "hand-grasp-check: Hand 0 is holding something~%") (texts)))))

(test hand-track.needs-something-to-track
  (with-cook (:clean t)
    (is (equal (list :not-grasping (hand 0)) (reply 'command:hand-track (hand 0))))))

(test hand-track.ends-when-the-grip-is-lost
  (with-cook (:clean t)
    (dolist (theft (list (lambda () (world:kick-thing (thing 'apple) 1 1 nil))
                         (lambda () (world:move-thing (thing 'apple) (bin 0)))
                         (lambda () (world:destroy-thing (thing 'apple)))))
      (let ((*answers* '()))
        (world:move-thing (thing 'apple) 5.5 5.5)
        (is (null (grasp 0 'apple)))
        (command:hand-track (hand 0) (recorder 'track))
        (run:run-ticks 2500)
        (is (null *answers*))
        (funcall theft)
        (run:run-ticks 1)
        (is (equal (list (list :grasp-lost (hand 0))) (answers-to 'track)))))))

(test hand-track.tells-of-a-kicker-in-its-own-tick
  (with-cook (:clean t)
    (let ((*answers* '()) (kicked nil))
      (grasp 0 'apple)
      (command:hand-track (hand 0) (recorder 'track))
      (world:put-kicker squirm (apple (thing 'apple)) (:prob .01)
        (when (robot:in-location apple (hand 0))
          (setf kicked (run:simulation-tick))
          (world:kick-thing apple 0.3 0.3 t)))
      (run:run-until (lambda () *answers*))
      (is (eql kicked (run:simulation-tick)))
      (is (equal '(:grasp-lost) (mapcar #'first (answers-to 'track)))))))

(test hand-track.is-interrupted-by-any-command-to-the-hand
  (with-cook (:clean t)
    (grasp 0 'apple)
    (loop for (command . arguments) in `((command:hand-grasp-check) (command:hand-track)
                                         (command:hand-insert-bin ,(bin 0))
                                         (command:hand-remove) (command:hand-ungrasp))
          do (let ((*answers* '()))
               (command:hand-track (hand 0) (recorder 'track))
               (run:run-ticks 3)
               (apply command (hand 0) arguments)
               (run:run-ticks 3)
               (is (equal (list (list :interrupt (hand 0))) (answers-to 'track)) "~S" command)))
    (let ((*answers* '()))
      (code-of 'command:hand-ungrasp (hand 0))
      (grasp 0 'apple)
      (command:hand-track (hand 0) (recorder 'track))
      (run:run-ticks 3)
      (time:grab-resource (hand 0))
      (run:run-ticks 1)
      (is (equal '(:interrupt) (mapcar #'first (answers-to 'track)))))))
