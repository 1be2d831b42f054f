;;;; accessors.lisp -- what plans ask of their robot without its doing anything (manual C).

(in-package :ars-magna.rpl-robot)

;;; Arguments may be fluents; what counts is their value. Parts are given by index, or as such.

(defun find-part (kind index operator)
  "Return the part of KIND with INDEX (an integer, one of the parts, or a fluent) of the plans'
robot."
  (let* ((index (fluent-value index))
         (parts (parts-of-kind (rpl-robot) kind)))
    (cond ((find index parts) index)
          ((and (integerp index) (< -1 index (length parts))) (svref parts index))
          (t (error 'wrong-argument
                    :operator operator :name (string-downcase kind) :value index
                    :expected (format nil "the index of a ~(~A~): ~A has ~D, counted from 0"
                                      kind (rpl-robot) (length parts)))))))

(defmacro define-robot-accessors (&body definitions)
  "Define accessors of the plans' robot: (name reader documentation)."
  `(progn
     ,@(loop for (name reader text) in definitions
             collect `(public ,name)
             collect `(defun ,name ()
                        ,(format nil "~A Signals MISUSE without a robot. (Manual C.)" text)
                        (,reader (rpl-robot))))))

(defmacro define-part-accessors (&body definitions)
  "Define accessors of its parts: (name kind reader documentation)."
  `(progn
     ,@(loop for (name kind reader text) in definitions
             collect `(public ,name)
             collect `(defun ,name (,(intern (string kind)))
                        ,(format nil "~A ~A is an index or a fluent. Signals WRONG-ARGUMENT. ~
                                      (Manual C.)" text kind)
                        (,reader (find-part ',kind ,(intern (string kind)) ',name))))))

(defun num-cameras (robot) (length (robot-cameras robot)))
(defun num-hands (robot) (length (robot-hands robot)))
(defun num-bins (robot) (length (robot-bins robot)))

(define-robot-accessors
  (rpl-robot-speed robot-speed "Return the robot's speed, in metres per tick.")
  (rpl-robot-turn-angle robot-turn-angle "Return the robot's turn angle, in radians per tick.")
  (rpl-robot-num-cameras num-cameras "Return how many cameras the robot has.")
  (rpl-robot-num-hands num-hands "Return how many hands the robot has.")
  (rpl-robot-num-bins num-bins "Return how many storage bins the robot has."))

(define-part-accessors
  (rpl-camera-field-of-view camera camera-field-of-view
   "Return how wide the camera sees, in radians.")
  (rpl-camera-resolution camera camera-resolution
   "Return how many pixels the camera's views have.")
  (rpl-camera-angle camera camera-angle
   "Return the camera's angle relative to the robot, in radians.")
  (rpl-camera-last-view camera camera-last-view
   "Return the last view of the camera, a list of numbers; () before the first.")
  (rpl-hand-strength hand hand-strength
   "Return the largest weight that the hand can lift.")
  (rpl-storage-bin-capacity storage-bin storage-bin-capacity
   "Return the size of all that fits into the bin.")
  (rpl-storage-bin-real-capacity storage-bin remaining-capacity
   "Return the size of what still fits into the bin.")
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
  "Return a new odometer of the plans' robot, called NAME (manual, figure D.8)."
  (make-odometer (rpl-robot) (fluent-value name)))

;;; Resources.

(addition rpl-robot-part)
(defun rpl-robot-part (kind index)
  "Return the part of the plans' robot of KIND, a symbol, with INDEX, perhaps a fluent. Signals
WRONG-ARGUMENT, and MISUSE without a robot."
  (find-part kind index 'rpl-robot-part))

;;; What a grab ends is told to plans before the one that grabs goes on: it has nothing to wait for.

(public rpl-grab-robot)
(defun rpl-grab-robot ()
  "Stop whatever the robot itself is doing. Fluents say so at once: error code :INTERRUPT and the
pulse; the robot stands from the next tick on (manual C)."
  (grab (the-interface) (rpl-robot))
  (values))

(macrolet ((define-grabs (&rest definitions)
             `(progn
                ,@(loop for (name kind text) in definitions
                        collect `(public ,name)
                        collect `(defun ,name (index)
                                   ,(format nil "Stop whatever goes on on ~A INDEX. Fluents say ~
                                                 so at once; see RPL-GRAB-ROBOT. Signals ~
                                                 WRONG-ARGUMENT. (Manual C.)" text)
                                   (grab (the-interface) (find-part ',kind index ',name))
                                   (values))))))
  (define-grabs
    (rpl-grab-camera camera "the camera")
    (rpl-grab-hand hand "the hand")
    (rpl-grab-bin storage-bin "the storage bin")))
