;;;; errand.lisp -- finds and stows a thing, with continuations instead of a plan.

;;; Compare it with the plans of plans-handling.lisp to see what both styles cost. RUN-ERRAND finds
;;; a thing, goes to it, grasps it and stows it, as the manual's figures D.1, D.3 and D.5 do. Those
;;; handle no errors; this program handles all of them. Each step is a function that issues a
;;; command and returns at once; its continuation takes the next step. The steps share an ERRAND.
;;;
;;;   (with-simulation (ars-worlds:dot :seed 1)
;;;     (ars-worlds:run-errand ars-worlds:dot '((:color red)) #'report)
;;;     (run-ticks 500))

(in-package :ars-worlds)
(in-readtable :nisp)

(defstruct (errand (:include claim) (:copier nil))
  "The parts, description and continuation of an errand. The errand ends after PATIENCE setbacks."
  (camera nil :read-only t)
  (hand nil :read-only t)
  (bin nil :read-only t)
  (description '() :type list :read-only t)
  (continuation nil :read-only t)
  (patience 100 :type fixnum)
  (looks 0 :type fixnum)
  (too-heavy 0 :type fixnum)
  (over #f))

(defun run-errand (robot description continuation &key (camera 0) (hand 0) (bin 0))
  "Make ROBOT find something that fits DESCRIPTION, go to it, grasp it with HAND and stow it in BIN.
The camera, hand and bin are given by index. Returns at once. At the end CONTINUATION gets an error
code or NIL, and ROBOT. The codes:
- :GAVE-UP after too many setbacks.
- :INSUFFICIENT-STRENGTH after three things that were too heavy.
- :INSUFFICIENT-CAPACITY if BIN has no room. The hand then still holds the thing.
- :INTERRUPT if another command took over a part or the robot."
  (find-target (make-errand :robot robot :asked (commands-received robot)
                            :description description :continuation continuation
                            :camera (robot-camera robot camera)
                            :hand (robot-hand robot hand)
                            :bin (robot-storage-bin robot bin)))
  (values))

;;; Endings and setbacks.

(defun end-errand (errand err)
  "End ERRAND with the error code ERR, or NIL for success. Does nothing if ERRAND has ended."
  (unless (errand-over errand)
    (setf (errand-over errand) #t)
    (funcall (errand-continuation errand) err (errand-robot errand))))

(defun step-after-setback (errand err step)
  "Take STEP, a function of ERRAND, after the setback ERR. End ERRAND if no patience is left."
  (cond ((errand-over errand) nil)
        ((must-end-p errand err) (end-errand errand :interrupt))
        ((zerop (decf (errand-patience errand))) (end-errand errand :gave-up))
        (t (funcall step errand))))

(defun take-next-step (errand err next otherwise &rest harmless)
  "Take the step NEXT of ERRAND if ERR is NIL or one of HARMLESS, else the step OTHERWISE."
  (if (and (member err (cons nil harmless)) (not (must-end-p errand err)))
      (funcall next errand)
      (step-after-setback errand err otherwise)))

(defun call-unless-interrupted (errand err step)
  "Call STEP, a function of no arguments, whether the command succeeded or not. If ERR or the state
of the robot shows that another program took over the robot, end ERRAND instead."
  (if (must-end-p errand err)
      (end-errand errand :interrupt)
      (funcall step)))

;;; Finding.

(defun find-target (errand)
  "Search where the camera points. Track and approach the thing found; if none, look elsewhere."
  (camera-get-object-designator (errand-camera errand) :non-local (errand-description errand)
    (continuation (err camera designator)
      (cond ((must-end-p errand err) (end-errand errand :interrupt))
            (designator (track-target errand designator))
            ((eq err :already-tracking) (stop-camera-track errand #'find-target))
            (t (step-after-setback errand err #'look-elsewhere))))))

(defun look-elsewhere (errand)
  "Turn the camera by its field of view. After every eight turns, search beside the robot too."
  (let ((camera (errand-camera errand)))
    (camera-turn camera (camera-field-of-view camera)
      (continuation (err camera angle)
        (take-next-step errand err
                        (if (zerop (mod (incf (errand-looks errand)) 8))
                            #'check-target
                            #'find-target)
                        #'find-target)))))

(defun stop-camera-track (errand next)
  "Stop the camera's track, if any, and take the step NEXT."
  (camera-untrack (errand-camera errand)
    (continuation (err camera) (take-next-step errand err next next :not-tracking))))

;;; Going there.

(defun track-and-continue (errand designator next otherwise)
  "Track DESIGNATOR. Take the step NEXT when the track has begun, or OTHERWISE if it cannot begin."
  (let ((begun #f))
    (camera-track (errand-camera errand) designator
      (continuation (err camera designator)
        ;; It is called again when the track ends; a command that needs the track fails by itself.
        (cond (begun nil)
              (t (setf begun #t)
                 (take-next-step errand err next otherwise)))))))

(defun track-target (errand designator)
  (track-and-continue errand designator #'go-to-target #'find-target))

(defun go-to-target (errand)
  "Drive to what the camera tracks. If something blocks the way, check whether the target is near."
  (robot-goto-designator (robot-to-command errand) (errand-camera errand)
    (continuation (err robot camera designator)
      (call-unless-interrupted errand err
        (lambda ()
          (stop-camera-track errand
                             (lambda (errand)
                               (take-next-step errand err #'check-target #'find-target
                                               :goto-local :robot-blocked))))))))

(defun turn-aside (errand)
  "Turn aside, drive on for two ticks, and search again."
  (robot-turn (robot-to-command errand) (if (evenp (errand-patience errand)) 1.3 -1.3)
    (continuation (err robot angle)
      (call-unless-interrupted errand err
        (lambda ()
          (robot-go-forward (robot-to-command errand) 2
            (continuation (err robot)
              (take-next-step errand err #'find-target #'find-target :robot-blocked))))))))

;;; Checking. Cameras often misread colours, so only a thing that fits in three looks is taken.

(defun check-target (errand)
  (look-closely-at errand 12 3 #'grasp-target #'turn-aside))

(defun look-closely-at (errand looks wanted next otherwise)
  "Search for local things, next to the robot or in the bin, until WANTED searches have succeeded;
then take the step NEXT with the last designator. After LOOKS searches take the step OTHERWISE."
  (camera-get-object-designator (errand-camera errand) :local (errand-description errand)
    (continuation (err camera designator)
      (let ((wanted (if designator (- wanted 1) wanted)))
        (cond ((must-end-p errand err) (end-errand errand :interrupt))
              ((zerop wanted) (funcall next errand designator))
              ((zerop looks) (step-after-setback errand err otherwise))
              (t (look-closely-at errand (- looks 1) wanted next otherwise)))))))

;;; Grasping and stowing.

(defun grasp-target (errand designator)
  (track-and-continue errand designator
                      (lambda (errand) (grasp-tracked-thing errand designator))
                      #'check-target))

(defun grasp-tracked-thing (errand designator)
  "Grasp DESIGNATOR, which the camera tracks. If the thing is too heavy, look for another one."
  (hand-grasp-desig (errand-hand errand) (errand-camera errand) designator
    (continuation (err hand designator)
      (call-unless-interrupted errand err
        (lambda ()
          (stop-camera-track errand
                             (lambda (errand)
                               (if (eq err :insufficient-strength)
                                   (seek-lighter-thing errand)
                                   (take-next-step errand err #'open-for-target #'check-target
                                                   :hand-grasping)))))))))

(defun seek-lighter-thing (errand)
  "Look for something lighter. End ERRAND after three heavy things."
  (if (= 3 (incf (errand-too-heavy errand)))
      (end-errand errand :insufficient-strength)
      (step-after-setback errand :insufficient-strength #'turn-aside)))

(defun open-for-target (errand)
  (storage-bin-open (errand-bin errand)
    (continuation (err bin)
      (take-next-step errand err #'insert-target #'open-for-target :bin-open))))

(defun insert-target (errand)
  "Put the hand into the bin; try again if the hand bumps. End ERRAND if the bin has no room."
  (hand-insert-bin (errand-hand errand) (errand-bin errand)
    (continuation (err hand bin)
      (if (and (eq err :insufficient-capacity) (not (must-end-p errand err)))
          (end-errand errand err)
          (take-next-step errand err #'drop-target #'open-for-target)))))

(defun drop-target (errand)
  "Drop the thing inside the bin. If the hand is empty, the thing was lost: search again."
  (hand-ungrasp (errand-hand errand)
    (continuation (err hand)
      (let ((lost (eq err :not-grasping)))
        (call-unless-interrupted errand err
          (lambda ()
            (hand-remove hand
              (continuation (err hand)
                (if (and lost (not (eq err :interrupt)))
                    (step-after-setback errand :not-grasping #'find-target)
                    (take-next-step errand err #'close-on-target #'close-on-target))))))))))

(defun close-on-target (errand)
  "Close the bin, try again if it jams, and end ERRAND."
  (storage-bin-close (errand-bin errand)
    (continuation (err bin part)
      (take-next-step errand err (lambda (errand) (end-errand errand nil)) #'close-on-target
                      :bin-closed))))
