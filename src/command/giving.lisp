;;;; giving.lisp -- handing what a hand holds to another robot.

(in-package :ars-magna.command)

;;; The giver designates the other robot and names one of its hands or bins by number. The command
;;; occupies only the giver's hand. As the receiving hand must be idle, it interrupts no command.

(define-argument-type 'receiving-part
  (lambda (value) (member value '(:hand :bin)))
  ":hand or :bin")

(define-argument-type 'part-number #'whole-p "the number of a hand or bin, from 0")

(defun receiver (designator)
  "Return the robot whose body DESIGNATOR denotes, or NIL."
  (let ((thing (designator-thing designator)))
    (and (body-p thing) (body-robot thing))))

(defun receiving-part (designator kind index)
  "Return the hand (KIND :HAND) or bin (:BIN) with INDEX of the robot that DESIGNATOR denotes, or
NIL if the robot has no such part."
  (let ((parts (ecase kind
                 (:hand (robot-hands (receiver designator)))
                 (:bin (robot-bins (receiver designator))))))
    (and (< index (length parts)) (svref parts index))))

(defun receiving-error-code (part thing)
  "Return the error code for what keeps PART, a hand or bin, from receiving THING, or NIL."
  (cond ((storage-bin-p part)
         (cond ((storage-bin-closed-p part) :bin-closed)
               ((not (has-room-p part (thing-size thing))) :insufficient-capacity)))
        ((hand-location part) :different-location)
        ((resource-event part) :receiver-busy)
        ((hand-holding part) :receiver-full)))

(defun giving-error-code (hand designator kind index)
  "Return the error code for what keeps HAND from giving what it holds, or NIL if nothing does. A
false designator is only noticed when the hand misses."
  (cond ((null (hand-holding hand)) :not-grasping)
        ((not (own-designator-p hand designator)) :bad-designator)
        ((eq (designator-type designator) :non-local) :non-local-designator)
        ((hand-location hand) :different-location)
        ((null (designator-thing designator)) nil)
        ((null (receiver designator)) :not-a-robot)
        ((null (receiving-part designator kind index)) :no-such-part)
        (t (receiving-error-code (receiving-part designator kind index) (hand-holding hand)))))

(defun give (hand designator kind index)
  "Move what HAND holds to another robot's part. Return an error code, or NIL."
  (let ((thing (hand-holding hand)) (receiver (receiver designator)))
    (cond ((or (null receiver)
               (not (part-reaches-p hand (robot-body receiver)))
               (chance prob-miss-grasp* (handling-dice hand)))
           :missed-give)
          (t (let ((part (receiving-part designator kind index)))
               (cond ((and (hand-p part) (> (thing-total-weight thing) (hand-strength part)))
                      :insufficient-strength)
                     (t (move-thing thing part)
                        nil)))))))

(defun receiver-formatter (control)
  "Return a function that formats CONTROL with the giver's hand, the kind and the index of the
receiver's part, and the receiver."
  (lambda (operation)
    (destructuring-bind (designator kind index) (operation-arguments operation)
      (format nil control (operation-resource operation) kind index
              (or (receiver designator) (destination-name designator))))))

(define-command hand-give (operation (hand hand)
                           (designator designator "a local designator of the other robot")
                           (kind receiving-part ":hand or :bin, what is to receive the thing")
                           (index part-number "the index of the other robot's hand or bin, from 0"))
    ((designator "the designator"))
    ((:family :handling) (:delay (+ hand-move-delay* hand-grasp-delay*))
     (:errors (:not-grasping (operation-formatter "~A is not holding anything"))
              (:bad-designator "Designator is not valid")
              (:non-local-designator "Designator is not local")
              (:different-location
               (receiver-formatter "~A not in same location as ~(~A~) ~D of ~A"))
              (:not-a-robot (receiver-formatter "~3*~A is not a robot")
               "The designator denotes a thing, but only robots can be given things."
               "Search for the other robot by its attributes, as its DEFROBOT lists them.")
              (:no-such-part (receiver-formatter "~*There is no ~(~A~) ~D of ~A")
               "The other robot has no hand or bin with this number."
               "Give the number of a hand or bin of the other robot; numbers begin with 0.")
              (:receiver-busy (receiver-formatter "~*~@(~A~) ~D of ~A is carrying out a command")
               "A command of the hand that is to receive the thing is in progress."
               "Try again when the command has ended, or name another hand or a bin.")
              (:receiver-full (receiver-formatter "~*~@(~A~) ~D of ~A is already holding something")
               "The hand that is to receive the thing holds something already."
               "Try again when the hand is empty, or name another hand or a bin.")
              (:bin-closed (receiver-formatter "~*~@(~A~) ~D of ~A is closed"))
              (:insufficient-capacity
               (receiver-formatter "No room for what ~A holds in ~(~A~) ~D of ~A"))
              (:missed-give (receiver-formatter "~A missed ~3@*~A")
               "The hand missed the other robot's hand or bin, and still holds the thing."
               "Try again; look for the other robot again if it has moved.")
              (:insufficient-strength
               (receiver-formatter "~*~@(~A~) ~D of ~A is not strong enough")))
     (:report (designator)
              (destructuring-bind (to kind index) (operation-arguments operation)
                (declare (ignore to))
                (format nil "~A gave ~A to ~(~A~) ~D of ~A" (operation-resource operation)
                        (operation-subject operation) kind index (receiver designator)))))
    "Give what HAND holds to another robot: to its hand INDEX, if KIND is :HAND, which must be empty
and idle; or to its storage bin INDEX, if KIND is :BIN, which must be open."
  (setf (operation-subject operation) (hand-holding hand))
  (end-operation operation
                 (or (giving-error-code hand designator kind index)
                     (give hand designator kind index))
                 designator))

(addition (hand-give :ars :nisp))
