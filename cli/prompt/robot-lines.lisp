;;;; robot-lines.lisp -- the robot's commands as line commands.

(in-package :ars-magna.cli)

;;; For each command of the command layer there is a line command of the same arguments, without the
;;; robot. Manual E lists those that differ; they take what a camera tracks for the designator.

(defun slot-of (specification)
  (make-slot (string-downcase (spec-name specification)) (spec-type specification)
             (spec-text specification) nil))

(defun robot-resource-p (command)
  (same-name-p (spec-type (command-resource command)) 'robot))

(defun part-family (command)
  (let ((type (type-key (spec-type (command-resource command)))))
    (case type
      (:robot (case (command-family command)
                (:moving :moving)
                (:thinking :planning)
                (t :manipulating)))
      (t type))))

(defun command-slots (command)
  (append (unless (robot-resource-p command) (list (slot-of (command-resource command))))
          (mapcar #'slot-of (command-parameters command))))

(defun error-details (command)
  (loop for code in (command-errors command)
        for text = (error-code-text code)
        collect (format nil ":~A~:[~; -- ~:*~A~]" (symbol-name (error-code-keyword code))
                        (and (stringp text) text))))

(defun command-details (command)
  (append (when (command-results command)
            (list (format nil "Results: ~{~A~^, ~}."
                          (mapcar #'spec-text (command-results command)))))
          (when (command-errors command)
            (list (format nil "Errors: ~{~A~^; ~}." (error-details command))))
          (list (format nil "In Lisp: ~(~A~).~@[ Manual ~A.~]"
                        (command-name command) (command-section command)))))

(defun line-name-of (command)
  "Return what the line command for COMMAND is called: manual E says -DESIG for designators."
  (let* ((name (string-upcase (command-prompt-name command)))
         (start (search "-DESIG" name :from-end t)))
    (if start (subseq name 0 (+ start 6)) name)))

(defun robot-line (command)
  (make-line :name (line-name-of command)
             :full-name (string-upcase (command-name command))
             :family (part-family command)
             :parameters (command-slots command)
             :sentence (command-documentation command)
             :details (command-details command)
             :action (lambda (session &rest arguments)
                       (if (robot-resource-p command)
                           (send session command (session-robot) arguments)
                           (send session command (first arguments) (rest arguments))))))

(defvar *robot-lines* '(() . ())
  "The robot's commands and the line commands that they make, as when that was looked up last.")

(defun robot-lines ()
  (let ((commands (all-commands)))
    (unless (equal commands (car *robot-lines*))
      (setf *robot-lines* (cons commands (mapcar #'robot-line commands))))
    (cdr *robot-lines*)))

;;; Those that differ.

(defun tracked (camera)
  "Return the designator that CAMERA tracks. Signals BAD-LINE if it tracks none."
  (or (camera-tracks camera)
      (reject-line "~A is not tracking anything." camera)))

(defun send-named (session name resource &rest arguments)
  (send session (find-command name) resource arguments))

(define-line "CAM-INSERT-DESIG" (session (cam camera "the camera to insert"))
    (:camera)
    "Insert the camera CAM into the thing whose local designator it tracks."
  (send-named session 'camera-insert cam (tracked cam)))

(define-line "CAM-INSERT-BIN" (session (cam camera "the camera to insert")
                                       (bin storage-bin "the storage bin"))
    (:camera)
    "Insert the camera CAM into the storage bin BIN."
  (send-named session 'camera-insert cam bin))

(define-line "HAND-INSERT-DESIG" (session (hand hand "the hand to insert")
                                          (cam camera "the camera that tracks the thing"))
    (:hand)
    "Insert the hand HAND into the thing whose local designator the camera CAM tracks."
  (send-named session 'hand-insert hand (tracked cam)))

;; As reading 195 says.
(define-line "HAND-GRASP" (session (hand hand "the hand that is to grasp")
                                   (cam camera "the camera that tracks the thing"))
    (:hand)
    "Let the hand HAND grasp the thing that the camera CAM tracks, in the same location."
  (send-named session 'hand-grasp-desig hand cam (tracked cam)))
