;;;; fluents.lisp -- the robot's fluents and readers for plans (manual C).

(in-package :ars-magna.rpl-robot)

(export '(define-fluents all-fluent-variables))

;;; Each variable stands for a fluent or, for cameras, hands and bins, for a vector of fluents, one
;;; for each such part. It is a symbol macro: which robot's fluent it means depends on the calling
;;; plan. See drivers.lisp.

(defvar *fluent-variables* '() "A list (variable kind name) of all fluent variables; the kind of
part is a symbol, NIL for the robot itself.")

(pushnew '*fluent-variables* *variables-to-restore*)

(defun fluent-part-kind (kind)
  "Return the name of KIND, a kind of part; NIL for ROBOT. Signals an error if KIND is unknown."
  (unless (same-name-p kind 'robot)
    (or (find-kind-name kind 'part)
        (reject-clause "define-fluents" kind "ROBOT, or a kind of part such as CAMERA"))))

(defun note-fluent-variable (variable kind)
  (pushnew (list variable (fluent-part-kind kind) (string-downcase variable)) *fluent-variables*
           :key #'first))

(defmacro define-fluents (kind &body definitions)
  "Define fluent variables for KIND, ROBOT or a kind of part such as CAMERA. Each of DEFINITIONS is
(name documentation), followed by :ADDITION if the manual does not have the name. If a fluent is
pulsed, and never set, its documentation begins with the word Pulsed. Return the names."
  `(progn
     (fluent-part-kind ',kind)
     ,@(loop for (name text mark) in definitions
             collect `(,(if mark 'addition 'public) ,name)
             collect `(define-symbol-macro ,name (plan-fluent ',name))
             ;; So that the variable counts as bound.
             collect `(set ',name nil)
             collect `(setf (documentation ',name 'variable)
                            ,(format nil "~A~@[~A~]~:[~; (Manual C.)~]" text
                                     (unless (same-name-p kind 'robot)
                                       (format nil " A vector with a fluent for each ~(~A~)."
                                               kind))
                                     (and *loading-simulator-p* (not mark))))
             collect `(note-fluent-variable ',name ',kind)
             collect `(declare-fluent-variable
                       ',name :kind ,(if (same-name-p kind 'robot) t (string-downcase kind))
                              :pulsed-p ,(starts-with-subseq "Pulsed " text)))
     ',(mapcar #'first definitions)))

(define-fluents robot
  (robot-stopped* "Pulsed when the robot stops moving, whether or not it succeeded.")
  (robot-movement-error* "The error code of the last movement command to end; NIL after success.")
  (robot-angle-diff* "The estimated change in angle over the last turn, in radians.")
  (robot-arrived-at* "The designator that the robot last moved to.")
  (robot-place-input* "Pulsed when the robot's place type is sensed.")
  (robot-place* "The name of the place type last sensed, or NIL."))

(define-fluents camera
  (camera-input* "Pulsed when new sensory information is available.")
  (camera-views* "The latest view, a list of numbers.")
  (camera-designators* "The designators found by the last search; () if it failed.")
  (camera-error* "The error code of the last sensing command; NIL after success.")
  (camera-tracking* "Pulsed when the camera starts tracking a designator, and after each look of
CAMERA-TRACK-MATCHING that updates its data.")
  (camera-tracking-error* "The error code with which the last track failed or ended.")
  (camera-moved* "Pulsed when the camera completes a move.")
  (camera-movement-error* "The error code of the last camera movement; NIL after success."))

(define-fluents hand
  (hand-moved* "Pulsed when the hand completes a movement.")
  (hand-error* "The error code of the last hand command; NIL after success.")
  (hand-lost* "Pulsed when the hand is seen to lose its grasp.")
  (hand-inside* "The designator or bin that the hand is inside of, or NIL.")
  ;; As reading 24 says.
  (hand-grasping* "The designator of what the hand is grasping, or NIL.")
  (hand-input* "Pulsed when sensory information becomes available."))

(define-fluents storage-bin
  (storage-bin-moved* "Pulsed when the bin has opened or closed, or failed to.")
  (storage-bin-error* "The error code of the last bin command; NIL after success.")
  (storage-bin-jammer* "The camera or hand that kept the bin from closing, or NIL."))

(defun all-fluent-variables ()
  "Return lists (variable kind) of all fluent variables, in order; the kind of the robot is NIL."
  (reverse (loop for (variable kind) in *fluent-variables* collect (list variable kind))))

(defun make-fluent-for-variable (variable robot)
  "Return a new fluent for VARIABLE of ROBOT, or a vector of one for each part (reading 183)."
  (destructuring-bind (kind name) (rest (assoc variable *fluent-variables*))
    (if kind
        (create-fluent-vector name (count kind (robot-parts robot) :key #'type-of))
        (create-fluent name))))

(defun make-fluents (robot)
  "Return an alist from all fluent variables to new fluents for ROBOT, or vectors of fluents."
  (loop for (variable) in *fluent-variables*
        collect (cons variable (make-fluent-for-variable variable robot))))

;;; Arguments may be fluents; what counts is their value. Parts are given by index, or as such.

(defun find-part (kind index operator)
  "Return the part of the plans' robot that has this KIND and INDEX. INDEX is the number of the
part, the part itself, or a fluent with either value."
  (let* ((index (fluent-value index))
         (parts (parts-of-kind (rpl-robot) kind)))
    (cond ((find index parts) index)
          ((and (integerp index) (< -1 index (length parts))) (svref parts index))
          (t (error 'wrong-argument
                    :operator operator :name (string-downcase kind) :value index
                    :expected (format nil "the index of a ~(~A~): ~A has ~D, counted from 0"
                                      kind (rpl-robot) (length parts)))))))

(defmacro define-accessors (&body definitions)
  "Define accessors of the plans' robot and its parts, each as (name kind reader documentation)."
  `(progn
     ,@(loop for (name kind reader text) in definitions
             for part-p = (not (eq 'robot kind))
             collect `(public ,name)
             collect `(defun ,name ,(and part-p (list kind))
                        ,(format nil "~A ~:[Signals MISUSE without a robot~;~A is an index or a ~
                                      fluent. Signals WRONG-ARGUMENT~]. (Manual C.)"
                                 text part-p kind)
                        (,reader ,(if part-p `(find-part ',kind ,kind ',name) '(rpl-robot)))))))

(defun num-cameras (robot) (length (robot-cameras robot)))
(defun num-hands (robot) (length (robot-hands robot)))
(defun num-bins (robot) (length (robot-bins robot)))

(define-accessors
  (rpl-robot-speed robot robot-speed "Return the robot's speed, in metres per tick.")
  (rpl-robot-turn-angle robot robot-turn-angle
   "Return the robot's turn angle, in radians per tick.")
  (rpl-robot-num-cameras robot num-cameras "Return how many cameras the robot has.")
  (rpl-robot-num-hands robot num-hands "Return how many hands the robot has.")
  (rpl-robot-num-bins robot num-bins "Return how many storage bins the robot has.")
  (rpl-camera-field-of-view camera camera-field-of-view
   "Return the width of the camera's field of view, in radians.")
  (rpl-camera-resolution camera camera-resolution
   "Return how many pixels the camera's views have.")
  (rpl-camera-angle camera camera-angle
   "Return the camera's angle relative to the robot, in radians.")
  (rpl-camera-last-view camera camera-last-view
   "Return the last view of the camera, a list of numbers; () before the first view.")
  (rpl-hand-strength hand hand-strength
   "Return the largest weight that the hand can lift.")
  (rpl-storage-bin-capacity storage-bin storage-bin-capacity
   "Return the capacity of the bin: the total size of the things that fit into it.")
  (rpl-storage-bin-real-capacity storage-bin remaining-capacity
   "Return the free capacity of the bin: the total size of the things that still fit into it.")
  (rpl-storage-bin-closed? storage-bin storage-bin-closed-p
   "True if the bin is closed."))

(public rpl-designator-data)
(defun rpl-designator-data (designator)
  "Return the description in DESIGNATOR, or in the value of the fluent DESIGNATOR: a place type's
name in a list, or attributes and values. Signals WRONG-ARGUMENT (manual, figure D.4)."
  (let ((designator (fluent-value designator)))
    (check-argument rpl-designator-data designator (designator-p designator)
                    "a designator, or a fluent that holds one")
    (designator-data designator)))

(public rpl-new-odometer)
(defun rpl-new-odometer (name)
  "Return a new odometer of the plans' robot, with the name NAME (manual, figure D.8)."
  (make-odometer (rpl-robot) (fluent-value name)))

;;; Resources.

(addition rpl-robot-part)
(defun rpl-robot-part (kind index)
  "Return a part of the plans' robot. KIND, a symbol, is the kind of the part; INDEX, perhaps a
fluent, is its number. Signals WRONG-ARGUMENT; and MISUSE without a robot."
  (find-part kind index 'rpl-robot-part))

;;; A grab sets the fluents of what it ends at once, as the plan that grabs has nothing to wait for.

(public rpl-grab-robot)
(defun rpl-grab-robot ()
  "Stop the robot's own current command. Its fluents change at once: the error fluent becomes
:INTERRUPT, and the end fluent is pulsed. The robot stands still from the next tick on (manual C)."
  (grab (required-driver) (rpl-robot))
  (values))

(macrolet ((define-grabs (&rest definitions)
             `(progn
                ,@(loop for (name kind text) in definitions
                        collect `(public ,name)
                        collect `(defun ,name (index)
                                   ,(format nil "Stop the current commands of ~A INDEX. Fluents ~
                                                 change at once, as in RPL-GRAB-ROBOT. Signals ~
                                                 WRONG-ARGUMENT. (Manual C.)" text)
                                   (grab (required-driver) (find-part ',kind index ',name))
                                   (values))))))
  (define-grabs
    (rpl-grab-camera camera "the camera")
    (rpl-grab-hand hand "the hand")
    (rpl-grab-bin storage-bin "the storage bin")))
