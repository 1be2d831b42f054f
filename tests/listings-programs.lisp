;;;; listings-programs.lisp -- the manual's programs with continuations, and its prompt (D, A).

(in-package :ars-magna.tests)

(in-suite listings)

;;; VALET, with ROBBIE's parts, stands in an empty hall; each test puts things there.
(world:defmap depot (24 16)
  (rect (0 0) (23 15) bricks 10))

(robot:defrobot valet (depot (6.5 8.5) 0)
  :cameras (((/ pi 4) 3) ((/ pi 2) 5))
  :hands (10 4)
  :bins (20 5))

(defmacro with-valet ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh VALET."
  `(run:with-simulation (valet ,@options) ,@body))

(defun valets-camera (index) (robot:robot-camera valet index))

(defun put-ball (x y &optional (color 'red))
  (put 'ball (list x y) :size 1.5 :weight .5 :color color))

(defun contents-of-bin (index)
  (world:location-contents (robot:robot-storage-bin valet index)))

;;; D.1: scanning.

(defun scan (ticks &key (type :non-local) (spec '((:color red))))
  "Scan for SPEC with camera 0, for TICKS. Return the arguments of each call of the continuation."
  (mapcar #'rest (call-times ticks (own 'scan-for-object) (valets-camera 0) type spec)))

(test scan-for-object.turns-and-finds
  "Not what is in view before the camera has turned."
  (with-listings ("d1-scan-for-object")
    (with-valet (:clean t)
      (put-ball 10.5 8.5)
      (let* ((ball (put-ball 10.5 12.5)) (answers (scan 30)))
        (is (= 1 (length answers)))
        (destructuring-bind (err designator) (first answers)
          (is (null err))
          (is (eq ball (robot:designator-denotation designator)))
          (is (near (/ pi 4) (robot:designator-angle designator))))
        (is (near (/ pi 4) (robot:camera-angle (valets-camera 0))))))))

(test scan-for-object.returns-at-once-and-answers-later
  "When the delays of a turn and of a search have passed."
  (with-listings ("d1-scan-for-object")
    (with-valet (:clean t)
      (put-ball 10.5 12.5)
      (is (equal (list (+ base:camera-align-delay* base:camera-desig-delay*))
                 (mapcar #'first (call-times 30 (own 'scan-for-object) (valets-camera 0)
                                             :non-local '((:color red)))))))))

(test scan-for-object.ends-with-the-error-of-its-turn
  (with-listings ("d1-scan-for-object")
    (with-valet (:clean t)
      (let ((calls '()))
        (call-own 'scan-for-object (valets-camera 0) :non-local '((:color red))
                  (lambda (&rest call) (push call calls)))
        (command:camera-turn (valets-camera 0) 1 nil)
        (run:run-ticks 20)
        (is (equal '((:interrupt nil)) calls))))))

(test scan-for-object.cannot-turn-twice
  "Its own bug: it calls itself without TYPE when there is nothing in view."
  (with-listings ("d1-scan-for-object")
    (with-valet (:clean t)
      (put-ball 2.5 8.5)
      (is (null (scan 60)))
      (is-true (has-words-p (texts) "Error in the continuation of camera-get-object-designator"
                            "invalid number of arguments: 3")))))

(test scan-for-object.finds-amid-noise-what-a-search-does
  "What is there, if it is not overlooked and its colour is read as red; or else an error."
  (with-listings ("d1-scan-for-object")
    (let ((found (loop for seed from 1 to 400
                       count (with-valet (:seed seed :parameters '((false-thing-prob* 0)))
                               (put-ball 10.5 12.5)
                               (let ((answers (scan 12)))
                                 (is (or answers (search "invalid number" (texts))))
                                 answers)))))
      (is (frequent-p found 400 (* .95 .475))))))

;;; D.3: going there. It waits for the simulator, which has to run by itself.

(defun call-while-live (function)
  "Call FUNCTION in a thread of its own while the simulation runs live. Return its value, or NIL if
it does not return."
  (let ((simulation (time:current-simulation)) (value nil) (returned nil))
    (run:start-clock simulation :rate :free)
    (unwind-protect
         (progn
           (base:start-thread (base:function-with-specials (lambda ()
                                                             (setf value (funcall function)
                                                                   returned t))
                                                           'time:*simulation* 'base:*message-queue*
                                                           'valet '*home*)
                              "a listing")
           (await (lambda () returned)))
      (run:stop-clock simulation))
    value))

(defmacro with-live-valet ((&key clean (seed 0)) &body body)
  "Run BODY in a simulation with a fresh VALET, which is clean even when it runs live."
  ;; A live simulation has the global values of parameters.
  `(unwind-protect (progn (when ,clean (base:clean-simulation))
                          (with-valet (:seed ,seed) ,@body))
     (base:dirty-simulation)))

(defun go-to-object (timeout)
  "Make VALET go to a red thing. Return the arguments of each call of the continuation."
  (let ((calls '()))
    (call-while-live
     (lambda ()
       (call-own 'go-to-object valet (valets-camera 0) '((:color red)) timeout
                 (lambda (&rest call) (push call calls)))
       (await (lambda () calls))))
    calls))

(defun near-thing-p (thing)
  "True if VALET is in the cell of THING or beside it."
  (multiple-value-bind (x y) (world:thing-position thing)
    (robot:within-reach-p valet x y)))

(test go-to-object.goes-to-what-it-finds
  (with-listings ("d1-scan-for-object" "d3-go-to-object")
    (with-live-valet (:clean t)
      (let* ((ball (put-ball 12.5 14.5)) (calls (go-to-object 3)))
        (is (= 1 (length calls)))
        (destructuring-bind (err designator) (first calls)
          (is (null err))
          (is (robot:designator-p designator)))
        (is (near-thing-p ball))
        (is (not (robot:camera-tracks (valets-camera 0))) "its camera was grabbed")))))

(test go-to-object.says-that-there-is-nothing
  "As printed it then passes its continuation four arguments, where it passes two on success. The
robot has driven ahead meanwhile."
  (with-listings ("d1-scan-for-object" "d3-go-to-object")
    (with-live-valet (:clean t)
      (put-ball 2.5 8.5)
      (is (equal (list (list :no-object-found valet (valets-camera 0) nil)) (go-to-object 4)))
      (is (near 9.7 (robot:robot-x valet) 1d-6) "four ticks at .8"))))

(test go-to-object.ends-amid-noise-too
  "Each run answers once: with nothing found, with the thing, or with how going there failed."
  (with-listings ("d1-scan-for-object" "d3-go-to-object")
    (let ((codes (loop for seed from 1 to 12
                       collect (with-live-valet (:seed seed)
                                 (put-ball 12.5 14.5)
                                 (let ((calls (go-to-object 3)))
                                   (is (= 1 (length calls)))
                                   (first (first calls)))))))
      (is (subsetp codes '(nil :no-object-found :not-tracking :robot-blocked :goto-local))
          "~S" codes)
      (is (member nil codes)))))

;;; D.5: grasping, and stowing away.

(defun grab ()
  "Make VALET grab a red thing. Return the arguments of each call of the continuation."
  (mapcar #'rest (call-times 80 (own 'grab-object) (robot:robot-hand valet 0)
                             (valets-camera 0) '((:color red))
                             (robot:robot-storage-bin valet 0))))

(test grab-object.is-given-too-little-by-scan-for-object
  "Its own bug: it wants an error code, a camera and a designator, and D.1 leaves out the camera."
  (with-listings ("d1-scan-for-object" "d5-grab-object")
    (with-valet (:clean t)
      (progn
        (put-ball 6.5 8.5)
        (is (null (grab)))
        (is-true (has-words-p (texts) "Error in the continuation of camera-get-object-designator"
                              "invalid number of arguments: 2"))
        (is (null (robot:hand-holding (robot:robot-hand valet 0))))))))

(defun define-scanner ()
  "Define SCAN-FOR-OBJECT as GRAB-OBJECT wants it: its continuation gets the camera too."
  (setf (fdefinition (own 'scan-for-object))
        (lambda (camera type spec continuation)
          (command:camera-get-object-designator camera type spec continuation))))

(test grab-object.stows-away-what-it-sees
  "With a scanner that returns what it needs. An open bin is no problem. As printed, the last of the
manual's five steps is missing: the hand stays inside the bin, and the bin open."
  (with-listings ("d5-grab-object")
    (define-scanner)
    (with-valet (:clean t)
      (let* ((ball (put-ball 6.5 8.5)) (answers (grab))
             (bin (robot:robot-storage-bin valet 0)) (hand (robot:robot-hand valet 0)))
        (is (= 1 (length answers)))
        (is (null (first (first answers))))
        (is (robot:designator-p (second (first answers))))
        (is (equal (list ball) (contents-of-bin 0)))
        (is (null (robot:hand-holding hand)))
        (is (eq bin (robot:part-location hand)))
        (is (not (world:location-closed-p bin)))))
    (with-valet (:clean t)
      (let ((ball (put-ball 6.5 8.5)))
        (call-once 'command:storage-bin-close (robot:robot-storage-bin valet 0))
        (is (equal '(nil) (mapcar #'first (grab))))
        (is (equal (list ball) (contents-of-bin 0)) "it opens the bin")))))

(test grab-object.tells-what-went-wrong
  (with-listings ("d5-grab-object")
    (define-scanner)
    (with-valet (:clean t)
      (is (equal '((:no-designator-found nil)) (grab))))
    (with-valet (:clean t)
      (world:set-attribute (put-ball 6.5 8.5) :weight 11)
      (is (equal '(:insufficient-strength) (mapcar #'first (grab))))
      (is (null (contents-of-bin 0))))))

(defun grab-amid-noise (seed)
  "Let VALET grab a ball by chance of SEED. Return the error code, and whether the ball is stowed."
  (with-valet (:seed seed :parameters '((false-thing-prob* 0)))
    (put-ball 6.5 8.5)
    (let ((answers (grab)))
      (is (= 1 (length answers)))
      (list (first (first answers)) (and (contents-of-bin 0) t)))))

(test grab-object.ends-amid-noise-too
  "Found with .95 times .475, tracked for two ticks, grasped with .96, inserted with .95; but it
does not ask whether the hand got into the bin."
  (with-listings ("d5-grab-object")
    (define-scanner)
    (let* ((runs (loop for seed from 1 to 400 collect (grab-amid-noise seed)))
           (codes (remove-duplicates (mapcar #'first runs)))
           (grasped (* .95 .475 .99 .99 .96)))
      (is (subsetp codes '(nil :no-designator-found :missed-grasp :not-tracking
                           :bad-designator))
          "~S" codes)
      (is (frequent-p (count nil runs :key #'first) 400 grasped))
      (is (frequent-p (count '(nil t) runs :test #'equal) 400 (* grasped .95)))
      (is (null (find t (remove nil runs :key #'first) :key #'second))))))

;;; A: what one types first.

(defun typed-at-prompt (form &rest lines)
  "Return what FORM, which runs the prompt, makes it write when LINES are typed."
  (with-output-to-string (*standard-output*)
    (with-input-from-string (*standard-input* (joined lines))
      (eval form))))

(test running.as-printed
  "A robot runs live, and stays so after QUIT."
  (with-listings ("5-2-robbie")
    (destructuring-bind (load-form simulator-form cli-form) (listing-forms "a-running")
      (let ((time:*simulation* nil) (world:*world* nil) (driver::*default-interface* nil)
            (robbie (symbol-value (own 'robbie))))
        (is-true (eval load-form))
        (progv (list (own 'robot)) (list robbie)
          (unwind-protect
               (progn
                 (let ((*standard-output* (make-broadcast-stream)))
                   (is (eq robbie (eval simulator-form))))
                 (is (time:live-p (time:current-simulation)))
                 (let ((text (typed-at-prompt cli-form "status" "quit")))
                   (is (eql 0 (search "Robot> " text)))
                   (is (search "Position:          (10.00,5.00)" text)))
                 (is (time:live-p (time:current-simulation))))
            (run:stop-simulator)))))))

;;; C: fluents.

(test fluents.as-printed
  "A plan waits until a fluent comes true; of a vector, by index."
  (with-listings ()
    (destructuring-bind (wait vref) (listing-forms "c-fluent-vectors")
      (eval `(rpl:def-interp-proc ,(own 'await) (,(own 'f))
               (rpl:par (seq ,wait :heard) (seq (rpl:wait-time 2) (rpl:set-value ,(own 'f) t)))))
      (let ((fluent (rpl:create-fluent 'f)))
        (is (eq :succeeded (nth-value 1 (rpl:run-plan-alone (own 'await)
                                                                :arguments (list fluent)))))
        (is (eq fluent (funcall (compile nil `(lambda (,(own 'fluent-vec) ,(own 'i)) ,vref))
                                (vector nil fluent) 1)))))))
