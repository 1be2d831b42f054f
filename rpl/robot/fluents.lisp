;;;; fluents.lisp -- the fluents by which plans learn of the robot (manual C).

(in-package :ars-magna.rpl-robot)

(export '(define-fluents all-fluent-variables))

;;; Each variable holds a fluent or, for cameras, hands and bins, a vector of fluents, one for each
;;; such part. RPL-INIT-ROBOT makes them; a headless simulation binds its own.

(defvar *fluent-variables* '() "A list (variable kind name) of all fluent variables; the kind of
part is a symbol, NIL for the robot itself.")

(pushnew '*fluent-variables* *kept-variables*)

(defun fluent-kind (kind)
  "Return the name of the kind of part called KIND, or NIL for ROBOT. Signals MALFORMED-DEFINITION
if there is none."
  (unless (same-name-p kind 'robot)
    (or (find-kind-name kind 'part)
        (reject-clause "define-fluents" kind "ROBOT, or a kind of part such as CAMERA"))))

(defun note-fluent-variable (variable kind)
  (pushnew (list variable (fluent-kind kind) (string-downcase variable)) *fluent-variables*
           :key #'first))

(defmacro define-fluents (kind &body definitions)
  "Define fluent variables for KIND, ROBOT or a kind of part such as CAMERA: (name documentation).
The documentation of those that are pulsed, and never set, begins so. Return their names."
  `(progn
     (fluent-kind ',kind)
     ,@(loop for (name text) in definitions
             collect `(public ,name)
             collect `(defvar ,name nil ,(format nil "~A~@[~A~]~:[~; (Manual C.)~]" text
                                                 (unless (same-name-p kind 'robot)
                                                   (format nil " A vector, by ~(~A~)." kind))
                                                 *marking-p*))
             collect `(note-fluent-variable ',name ',kind)
             collect `(declare-fluent-variable
                       ',name :kind ,(if (same-name-p kind 'robot) t (string-downcase kind))
                              :pulsed-p ,(starts-with-subseq "Pulsed " text))
             collect `(pushnew ',name *simulation-variables*))
     ',(mapcar #'first definitions)))

(define-fluents robot
  (robot-stopped* "Pulsed when the robot stops moving, whether or not it succeeded.")
  (robot-movement-error* "The error code of the last movement command to end; NIL: success.")
  (robot-angle-diff* "The estimated change in angle over the last turn, in radians.")
  (robot-arrived-at* "The designator that the robot last moved to.")
  (robot-place-input* "Pulsed when the robot's place type is sensed.")
  (robot-place* "The name of the place type last sensed, or NIL."))

(define-fluents camera
  (camera-input* "Pulsed when new sensory information is available.")
  (camera-views* "The latest view, a list of numbers.")
  (camera-designators* "The designators found by the last search; () if it failed.")
  (camera-error* "The error code of the last sensing command; NIL: success.")
  (camera-tracking* "Pulsed when the camera starts tracking a designator.")
  (camera-tracking-error* "The code with which the last track failed or ended.")
  (camera-moved* "Pulsed when the camera completes a move.")
  (camera-movement-error* "The error code of the last camera movement; NIL: success."))

(define-fluents hand
  (hand-moved* "Pulsed when the hand completes a movement.")
  (hand-error* "The error code of the last hand command; NIL: success.")
  (hand-lost* "Pulsed when the hand is seen to lose its grasp.")
  (hand-inside* "The designator or bin that the hand is inside of, or NIL.")
  ;; As reading 24 says.
  (hand-grasping* "The designator of what the hand is grasping, or NIL.")
  (hand-input* "Pulsed when sensory information becomes available."))

(define-fluents storage-bin
  (storage-bin-moved* "Pulsed when the bin has opened or closed, or failed to.")
  (storage-bin-error* "The error code of the last bin command; NIL: success.")
  (storage-bin-jammer* "The camera or hand that kept the bin from closing, or NIL."))

(defun all-fluent-variables ()
  "Return lists (variable kind) of all fluent variables, in order of definition; the kind of part is
a symbol, NIL for the robot itself."
  (reverse (loop for (variable kind) in *fluent-variables* collect (list variable kind))))

(defun make-fluents (robot)
  "Give all fluent variables fresh fluents that suit ROBOT (reading 183)."
  (let ((kinds (mapcar #'type-of (robot-parts robot))))
    (loop for (variable kind name) in *fluent-variables*
          do (setf (symbol-value variable)
                   (if kind
                       (create-fluent-vector name (count kind kinds))
                       (create-fluent name))))))
