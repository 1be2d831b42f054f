;;;; rpl-robot-answers.lisp -- what each command does to the fluents, in success and failure.

(in-package :ars-magna.tests)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :driver :ars-magna.rpl-robot :ars-magna.tests))

(def-suite* rpl-robot :in ars-magna)

;;; Two rooms and a doorway. FITTER stands among its things, facing a jar in the other room.
(world:defmap workbench (13 11)
  (rect (0 0) (12 10) bricks 5)
  (wall (6 1) (6 4) slate 20)
  (wall (6 6) (6 9) slate 20)
  (obj box (3.5 5.5) ((:size 6) (:capacity 5) (:weight 1) (:color red))
    (pin ((:size .2) (:weight .1) (:color blue))))
  (obj ball (3.5 5.5) ((:size 1.5) (:weight .5) (:color green)))
  (obj jar (9.5 5.5) ((:size 1) (:weight 1) (:color lightred)))
  (obj post (3.5 2.5) ((:size 9) (:obsmove t) (:weight 90) (:color violet))))

(robot:defrobot fitter (workbench (3.5 5.5) 0)
  :cameras (((* 2 pi) 5) (1 3))
  :hands (5 5)
  :bins (10 1)
  :parts ((robot:rangefinder :maximum 20)))

(defmacro with-fitter ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh FITTER that plans drive."
  `(run:with-simulation (fitter ,@options)
     (driver:rpl-init-robot fitter)
     ,@body))

(defun run-form (form)
  "Run FORM as a plan of FITTER's in a clean world. Return its value; it must succeed."
  (with-fitter (:clean t)
    (multiple-value-bind (value state) (driver:run-plan (rpl:make-plan form))
      (is (eq :succeeded state) "~S: ~A" form value)
      value)))

;;; What comes before: plans that do a thing and wait for it.

(rpl:def-interp-proc seen (color &optional (type :local))
  (driver:rpl-camera-get-object-designator 0 type (list (list :color color)))
  (rpl:wait-for (svref driver:camera-input* 0))
  (first (rpl:fluent-value (svref driver:camera-designators* 0))))

(rpl:def-interp-proc tracked (color &optional (type :local))
  (let ((designator (seen color type)))
    (driver:rpl-camera-track 0 designator)
    (rpl:wait-for (svref driver:camera-tracking* 0))
    designator))

(rpl:def-interp-proc grasped (color)
  (driver:rpl-hand-grasp-desig 0 0 (tracked color))
  (rpl:wait-for (svref driver:hand-moved* 0)))

(rpl:def-interp-proc hand-in-bin ()
  (driver:rpl-hand-insert-bin 0 0)
  (rpl:wait-for (svref driver:hand-moved* 0)))

(rpl:def-interp-proc closed (bin)
  (driver:rpl-storage-bin-close bin)
  (rpl:wait-for (svref driver:storage-bin-moved* bin)))

;;; A row: the command, its error code or NIL, the call, what comes before it, and a form that is
;;; true at the pulse.

(defparameter *answer-rows*
  '((command:robot-set-speed nil (driver:rpl-robot-set-speed .5) nil
     (= .5 (driver:rpl-robot-speed)))
    (command:robot-set-speed :too-high-speed (driver:rpl-robot-set-speed 5))
    (command:robot-set-turn-angle nil (driver:rpl-robot-set-turn-angle .2d0) nil
     (= .2d0 (driver:rpl-robot-turn-angle)))
    (command:robot-set-turn-angle :too-low-turn-angle (driver:rpl-robot-set-turn-angle 0))
    (command:robot-turn nil (driver:rpl-robot-turn 1) nil
     (< .99 (rpl:fluent-value driver:robot-angle-diff*) 1.01))
    (command:robot-turn :interrupt (rpl:seq (driver:rpl-robot-turn 1) (rpl:wait-time 3)
                                            (driver:rpl-grab-robot)))
    (command:robot-about-face nil (driver:rpl-robot-about-face) nil
     (< 3 (rpl:fluent-value driver:robot-angle-diff*)))
    (command:robot-turn-left nil (driver:rpl-robot-turn-left) nil
     (< -1.6 (rpl:fluent-value driver:robot-angle-diff*) -1.5))
    (command:robot-turn-right nil (driver:rpl-robot-turn-right) nil
     (< 1.5 (rpl:fluent-value driver:robot-angle-diff*) 1.6))
    (command:robot-turn-corner nil (driver:rpl-robot-turn-corner)
     (robot:place-robot fitter 1.5 1.5 pi)
     (< 1.5 (abs (rpl:fluent-value driver:robot-angle-diff*)) 1.6))
    (command:robot-turn-corner :no-corner (driver:rpl-robot-turn-corner))
    (command:robot-align-place nil (driver:rpl-robot-align-place)
     (robot:place-robot fitter 6.5 5.5 .3)
     (< -.31 (rpl:fluent-value driver:robot-angle-diff*) -.29))
    (command:robot-align-place :no-place-type (driver:rpl-robot-align-place))
    (command:robot-go-forward nil (driver:rpl-robot-go-forward 2))
    (command:robot-go-forward :not-moving (driver:rpl-robot-go-forward 2)
     (driver:rpl-robot-set-speed 0))
    (command:robot-go-forward :robot-blocked (driver:rpl-robot-go-forward 30))
    (command:robot-go-distance nil (driver:rpl-robot-go-distance 1.5))
    (command:robot-go-distance :robot-blocked (driver:rpl-robot-go-distance 30))
    (command:robot-step nil (driver:rpl-robot-step 'west))
    (command:robot-step :robot-blocked (driver:rpl-robot-step 'west)
     (progn (robot:place-robot fitter 1.5 5.5 0) (setf base:step-by-grid* t)))
    (command:robot-step :not-moving (driver:rpl-robot-step 'west) (driver:rpl-robot-set-speed 0))
    (command:robot-step :too-slow (driver:rpl-robot-step 'west) (driver:rpl-robot-set-speed .01))
    (command:robot-push nil (driver:rpl-robot-push 'west))
    (command:robot-push :robot-blocked (driver:rpl-robot-push 'west)
     (progn (robot:place-robot fitter 1.5 5.5 0) (setf base:step-by-grid* t)))
    (command:robot-goto-wall nil (driver:rpl-robot-goto-wall))
    (command:robot-goto-wall :robot-blocked (driver:rpl-robot-goto-wall)
     (robot:place-robot fitter 3.5 5.5 (/ pi -2)))
    (command:robot-follow-wall nil (driver:rpl-robot-follow-wall)
     (robot:place-robot fitter 1.5 5.5 (/ pi 2)))
    (command:robot-follow-wall :not-moving (driver:rpl-robot-follow-wall)
     (rpl:seq (robot:place-robot fitter 1.5 5.5 (/ pi 2)) (driver:rpl-robot-set-speed 0)))
    (command:robot-stop nil (driver:rpl-robot-stop))
    (command:robot-goto-designator nil (driver:rpl-robot-goto-designator 0)
     (tracked 'lightred :non-local)
     (robot:designator-p (rpl:fluent-value driver:robot-arrived-at*)))
    (command:robot-goto-designator :not-tracking (driver:rpl-robot-goto-designator 0) nil
     (null (rpl:fluent-value driver:robot-arrived-at*)))
    (command:robot-place nil (driver:rpl-robot-place) (robot:place-robot fitter 6.5 5.5 0)
     (eq 'doorway (rpl:fluent-value driver:robot-place*)))

    (command:camera-turn nil (driver:rpl-camera-turn 0 1) nil (= 1 (driver:rpl-camera-angle 0)))
    (command:camera-align-robot nil (driver:rpl-camera-align-robot 1))
    (command:camera-align-place nil (driver:rpl-camera-align-place 0)
     (robot:place-robot fitter 6.5 5.5 0))
    (command:camera-align-place :no-place-type (driver:rpl-camera-align-place 0))
    (command:camera-insert nil (driver:rpl-camera-insert 0 0))
    (command:camera-insert :bin-closed (driver:rpl-camera-insert 0 0) (closed 0))
    (command:camera-remove nil (driver:rpl-camera-remove 0)
     (rpl:seq (driver:rpl-camera-insert 0 1) (rpl:wait-for (svref driver:camera-moved* 0))))
    (command:camera-remove :not-inside (driver:rpl-camera-remove 0))
    (command:camera-view nil (driver:rpl-camera-view 1) nil
     (equal (driver:rpl-camera-last-view 1) (rpl:fluent-value (svref driver:camera-views* 1))))
    (command:camera-get-object-designator nil
     (driver:rpl-camera-get-object-designator 0 :local '((:color green))) nil
     (equal '(1.5 green) (let ((data (driver:rpl-designator-data
                                      (first (rpl:fluent-value
                                              (svref driver:camera-designators* 0))))))
                           (list 1.5 (second (assoc :color data))))))
    (command:camera-get-object-designator :designator-not-found
     (driver:rpl-camera-get-object-designator 0 :local '((:color lightblue)))
     (rpl:set-value (svref driver:camera-designators* 0) '(old))
     (null (rpl:fluent-value (svref driver:camera-designators* 0))))
    (command:camera-get-all-object-designators nil
     (driver:rpl-camera-get-all-object-designators 0 :local '()) nil
     (= 2 (length (rpl:fluent-value (svref driver:camera-designators* 0)))))
    (command:camera-get-all-object-designators :already-tracking
     (driver:rpl-camera-get-all-object-designators 0 :local '()) (tracked 'green)
     (null (rpl:fluent-value (svref driver:camera-designators* 0))))
    (command:camera-get-place-designator nil (driver:rpl-camera-get-place-designator 0 'doorway) nil
     (= 1 (length (rpl:fluent-value (svref driver:camera-designators* 0)))))
    (command:camera-get-place-designator :invalid-place-type
     (driver:rpl-camera-get-place-designator 0 'no-such-place))
    (command:camera-get-all-place-designators nil
     (driver:rpl-camera-get-all-place-designators 0 'concave) nil
     (< 1 (length (rpl:fluent-value (svref driver:camera-designators* 0)))))
    (command:camera-get-all-place-designators :camera-enclosed
     (driver:rpl-camera-get-all-place-designators 0 'doorway)
     (rpl:seq (driver:rpl-camera-insert 0 0) (rpl:wait-for (svref driver:camera-moved* 0))))
    (command:camera-track nil (driver:rpl-camera-track 0 designator) (seen 'green))
    (command:camera-track :already-tracking (driver:rpl-camera-track 0 designator) (tracked 'green))
    (command:camera-track-matching
     nil (driver:rpl-camera-track-matching 0 designator '((:color green))) (seen 'green))
    (command:camera-track-matching
     :already-tracking (driver:rpl-camera-track-matching 0 designator '()) (tracked 'green))
    (command:camera-untrack nil (driver:rpl-camera-untrack 0) (tracked 'green)
     (null (robot:camera-tracks (robot:robot-camera fitter 0))))
    (command:camera-untrack :not-tracking (driver:rpl-camera-untrack 0))

    (command:rangefinder-read nil (driver:rpl-rangefinder-read 0) nil
     (equal '(8.5d0) (rpl:fluent-value (svref driver:rangefinder-ranges* 0))))

    (command:hand-insert nil (driver:rpl-hand-insert 0 designator) (seen 'red)
     (eq designator (rpl:fluent-value (svref driver:hand-inside* 0))))
    (command:hand-insert :non-local-designator (driver:rpl-hand-insert 0 designator)
     (seen 'lightred :non-local)
     (null (rpl:fluent-value (svref driver:hand-inside* 0))))
    (command:hand-insert-bin nil (driver:rpl-hand-insert-bin 0 0) nil
     (eq (robot:robot-storage-bin fitter 0) (rpl:fluent-value (svref driver:hand-inside* 0))))
    (command:hand-insert-bin :bin-closed (driver:rpl-hand-insert-bin 0 0) (closed 0)
     (null (rpl:fluent-value (svref driver:hand-inside* 0))))
    (command:hand-remove nil (driver:rpl-hand-remove 0) (hand-in-bin)
     (null (rpl:fluent-value (svref driver:hand-inside* 0))))
    (command:hand-remove :not-inside (driver:rpl-hand-remove 0))
    (command:hand-grasp-desig nil (driver:rpl-hand-grasp-desig 0 0 designator) (tracked 'green)
     (eq designator (rpl:fluent-value (svref driver:hand-grasping* 0))))
    (command:hand-grasp-desig :not-tracked (driver:rpl-hand-grasp-desig 0 0 designator)
     (seen 'green)
     (null (rpl:fluent-value (svref driver:hand-grasping* 0))))
    (command:hand-ungrasp nil (driver:rpl-hand-ungrasp 0) (grasped 'green)
     (null (rpl:fluent-value (svref driver:hand-grasping* 0))))
    (command:hand-ungrasp :not-grasping (driver:rpl-hand-ungrasp 0))
    (command:hand-grasp-check :grasping (driver:rpl-hand-grasp-check 0) (grasped 'green)
     (rpl:fluent-value (svref driver:hand-grasping* 0)))
    (command:hand-grasp-check :not-grasping (driver:rpl-hand-grasp-check 0))
    (command:hand-track :grasp-lost
     (rpl:seq (driver:rpl-hand-track 0) (rpl:wait-time 2)
              (world:move-thing (world:find-thing 'ball) '(8.5 8.5)))
     (grasped 'green)
     (null (rpl:fluent-value (svref driver:hand-grasping* 0))))
    (command:hand-track :not-grasping (driver:rpl-hand-track 0))
    (command:hand-give :not-grasping (driver:rpl-hand-give 0 designator :hand 0) (seen 'red)
     (null (rpl:fluent-value (svref driver:hand-grasping* 0))))

    (command:robot-send nil (driver:rpl-robot-send :all 1))

    (command:storage-bin-close nil (driver:rpl-storage-bin-close 0) nil
     (driver:rpl-storage-bin-closed? 0))
    (command:storage-bin-close :robot-in-bin (driver:rpl-storage-bin-close 0) (hand-in-bin)
     (eq (robot:robot-hand fitter 0) (rpl:fluent-value (svref driver:storage-bin-jammer* 0))))
    (command:storage-bin-open nil (driver:rpl-storage-bin-open 0) (closed 0)
     (not (driver:rpl-storage-bin-closed? 0)))
    (command:storage-bin-open :bin-open (driver:rpl-storage-bin-open 0)))
  "Rows (command error-code call [before [true-at-the-pulse]]); BEFORE returns DESIGNATOR.")

(defun fluents-of (command)
  "Return the forms for the fluents that COMMAND sets to its error code and that it pulses, or NIL."
  (let* ((name (command:command-name command))
         (part (if (member name '(command:camera-view command:camera-align-robot)) 1 0)))
    (flet ((of (error pulse) (list `(svref ,error ,part) (and pulse `(svref ,pulse ,part)))))
      (ecase (command:spec-type (command:command-resource command))
        (robot:robot
         (case name
           ((command:robot-set-speed command:robot-set-turn-angle)
            (list 'driver:robot-movement-error* nil))
           (command:robot-place (list nil 'driver:robot-place-input*))
           (command:robot-send (list 'driver:robot-radio-error* 'driver:robot-sent*))
           (t (list 'driver:robot-movement-error* 'driver:robot-stopped*))))
        (robot:camera
         (case name
           ((command:camera-track command:camera-track-matching)
            (of 'driver:camera-tracking-error* 'driver:camera-tracking*))
           (command:camera-untrack (of 'driver:camera-tracking-error* nil))
           ((command:camera-turn command:camera-align-robot command:camera-align-place
             command:camera-insert command:camera-remove)
            (of 'driver:camera-movement-error* 'driver:camera-moved*))
           (t (of 'driver:camera-error* 'driver:camera-input*))))
        (robot:hand
         (case name
           (command:hand-grasp-check (of 'driver:hand-error* 'driver:hand-input*))
           (command:hand-track (of 'driver:hand-error* 'driver:hand-lost*))
           (t (of 'driver:hand-error* 'driver:hand-moved*))))
        (robot:rangefinder (of 'driver:rangefinder-error* 'driver:rangefinder-input*))
        (robot:storage-bin (of 'driver:storage-bin-error* 'driver:storage-bin-moved*))))))

(defun unpulsed-p (command code)
  "True if COMMAND tells of CODE by no pulse: a track that does not begin, a grip that was none."
  (or (and code (member (command:command-name command)
                        '(command:camera-track command:camera-track-matching)))
      (and (eq code :not-grasping) (eq 'command:hand-track (command:command-name command)))))

(defun answer-form (command call before truth)
  "Return the plan: what comes BEFORE, CALL, and then what was pulsed, the error code, and TRUTH."
  (destructuring-bind (error pulse) (fluents-of command)
    `(let ((designator ,before) (pulsed nil))
       (declare (ignorable designator))
       ,@(when error `((rpl:set-value ,error :stale)))
       (rpl:par (setf pulsed ,(if pulse
                                  `(rpl:wait-for ,pulse :timeout 80)
                                  `(rpl:wait-time 4)))
                ,call)
       (list (and pulsed t)
             ,(if error `(rpl:fluent-value ,error) nil)
             (and ,truth t)))))

(test answers.set-the-fluents-as-the-manual-says
  (loop for (name code call before (truth)) in (loop for (a b c d . e) in *answer-rows*
                                                     collect (list a b c d (or e '(t))))
        for command = (command:find-command name)
        do (destructuring-bind (pulsed error true)
               (run-form (answer-form command call before truth))
             (is (eq (and (second (fluents-of command)) (not (unpulsed-p command code)) t) pulsed)
                 "pulse of ~A ~A" name code)
             (is (eq error (if (first (fluents-of command)) code nil))
                 "~A: ~A instead of ~A" name error code)
             (is-true true "~A ~A: ~S" name code truth))))

(test answers.of-every-command
  "Each command is tried with success, and with a failure of its own if it has any."
  (dolist (command (own-commands))
    (let ((codes (loop for (name code) in *answer-rows*
                       when (eq name (command:command-name command)) collect code))
          (own (mapcar #'command:error-code-keyword (command:command-errors command))))
      (is-true (or (null own) (intersection own codes)) "failure of ~A" command)
      ;; Two only ask, and tell the answer by a code; THINK is a construct of plans; HAND-GIVE
      ;; needs another robot (see giving.lisp).
      (is-true (or (member nil codes)
                   (member (command:command-name command)
                           '(command:hand-grasp-check command:hand-track command:think
                             command:hand-give)))
               "success of ~A" command))))
