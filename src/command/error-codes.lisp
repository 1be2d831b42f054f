;;;; error-codes.lisp -- what the error codes of commands mean, and what to try.

(in-package :ars-magna.command)

(export '(trouble-p))

;;; An error code is only a word. This file has a sentence and a remedy for each that several
;;; commands share. Commands have their own messages, too, and explain their own codes (see
;;; DEFINE-COMMAND).

(defparameter *meanings*
  '((:interrupt
     "Something newer took the robot or part over before the command had ended."
     "Wait for a command's continuation before you give the part another one. (under-way
robot) says what it is doing, and for whom.")
    (:failed
     "It did not succeed: by chance, because nothing was defined for the things meant or a
designator was not local, or by an error in its own code, which an error message then tells."
     "Try again. If it never works, look with (describe (find-manipulation 'name)) at what
its methods want.")
    ;; Moving.
    (:robot-blocked
     "A wall, or a thing that blocks movement, is in the robot's way. The robot has stopped in
front of it."
     "Look where the way is free, with MAP at the prompt or (camera-view ...), and turn before
you go on; go-to and find-way go round what is known.")
    (:not-moving
     "The robot's speed is 0, so it would never arrive."
     "Give it a speed first: (robot-set-speed robot 0.8 nil).")
    (:negative-speed "A speed was below 0. The robot's speed is 0 now."
     "Give a speed from 0 to max-speed*. To go back, turn round.")
    (:too-high-speed "A speed was above max-speed*. The robot has that speed now."
     "Give a lower speed, or set max-speed*.")
    (:too-low-turn-angle "A turning speed was below the least one. The robot has that now."
     "Give a larger angle.")
    (:too-high-turn-angle
     "A turning speed was above max-turn-angle*. The robot has that now."
     "Give a smaller angle, or set max-turn-angle*.")
    (:goto-local
     "The camera tracks something that is next to the robot: there is nowhere to go."
     "Go on with what you wanted to do there.")
    (:no-place-type
     "The robot sensed no place type where it is: it is in the open, or misread the walls."
     "Ask again with robot-place, or drive on to a doorway, corner or the like.")
    (:incorrect-place-type
     "The place type that the robot sensed did not fit what it found when it began to turn."
     "Sense again with robot-place, and then align.")
    (:no-corner "The robot sensed no corner where it is."
     "Drive on along the wall, and sense with robot-place whether this is a corner.")
    ;; Looking.
    (:already-tracking "The camera tracks something, and can do nothing else meanwhile."
     "End that with camera-untrack, or use another camera.")
    (:not-tracking "The camera tracks nothing, or has lost what it tracked."
     "Find it with camera-get-object-designator, and track it with camera-track.")
    (:designator-not-found
     "The camera saw nothing like that. It may be out of its field of view, behind something,
farther away or nearer than asked for, or just overlooked."
     "Turn camera or robot and look again, ask for less, or ask again: :local for what is next
to the robot, :non-local for all else.")
    (:invalid-place-type "There is no place type of that name."
     "(all-place-types) lists those that there are.")
    (:invisible-place-type "Places of that type cannot be recognized from afar."
     "Drive there and sense it with robot-place.")
    (:camera-enclosed "The camera is inside a container, from where no places can be seen."
     "Take it out with camera-remove.")
    (:camera-inside
     "The camera is inside a container, and can track only what is in there with it."
     "Take it out with camera-remove.")
    (:local-not-local
     "The thing and the camera are not in the same place any more: one of them was moved, or
put into a container or out of it."
     "Look for it again from where the camera is now.")
    (:lost-track
     "The camera cannot see the thing any more: it was hidden, moved away or left the field of
view, is next to the robot now, or there never was one."
     "Look for it again; of what the robot has arrived at, look for a :local designator.")
    ;; Handling.
    (:hand-grasping "The hand holds something already."
     "Let that go with hand-ungrasp, or use another hand.")
    (:different-location
     "They are not in the same place: one is inside a container, and the other is not."
     "Bring both there with hand-insert and camera-insert, or out with hand-remove and
camera-remove.")
    (:bad-designator
     "The designator does not stand for anything any more: what it stood for was moved, or
lost from view."
     "Look for the thing again, and use the new designator.")
    (:non-local-grasp "The thing is too far away to be grasped."
     "Go there with robot-goto-designator, and find it again as :local.")
    (:non-local-designator "The thing is too far away."
     "Go there with robot-goto-designator, and find it again as :local.")
    (:not-tracked "The camera does not track what the hand is to grasp."
     "Track it with camera-track first.")
    (:missed-grasp "The hand reached for the thing and missed it."
     "Try again; look for the thing again if its designator was lost.")
    (:insufficient-strength "The thing, with what is in it, is too heavy for the hand."
     "Use a stronger hand, or take out first what is in the thing.")
    (:not-grasping "The hand holds nothing." "Grasp something first with hand-grasp-desig.")
    (:grasping "The hand holds something." "")
    (:grasp-lost "What the hand held is in it no more: it moved away or was taken."
     "Look for it close by, and grasp it again.")
    (:bin-open "The storage bin is open already." "Go on.")
    (:bin-closed "What was to be reached or closed is closed."
     "Open it first: a storage bin with storage-bin-open, a container with a manipulation.")
    (:robot-in-bin "A hand or camera is inside the storage bin, and keeps it from closing."
     "Take it out with hand-remove or camera-remove.")
    (:bin-jammed "Something in the storage bin was in the way of its door just then."
     "Close it again.")
    (:insufficient-capacity "There is no room left in there, with what the hand holds."
     "Take something out first, or use a larger container.")
    (:holding-thing "The hand holds that very container, or what that is in."
     "Put it down first, or use another hand.")
    (:hand-bump "The hand missed the container and bumped into it."
     "Try again; look for the container again if its designator was lost.")
    (:camera-bump "The camera missed the container and bumped into it, and lost it from view."
     "Find and track the container again, and try again.")
    (:not-tracking-destination "The camera tracks something else than where it is to go."
     "Track the container itself with camera-track.")
    (:not-inside "The hand or camera is not inside of anything." "Go on."))
  "Lists (code meaning remedy) for the simulator's own commands: an error code, a sentence, and a
sentence or an empty string.")

(mapc #'note-error-code (mapcar #'first *meanings*))

(defun explanation-of-code (code)
  "Return a list (meaning remedy) of strings for CODE, or NIL."
  (or (rest (assoc code *meanings*))
      (loop for command in (all-commands)
            for own = (find code (command-errors command) :key #'error-code-keyword)
            thereis (and own (error-code-explanation own)))))

(addition error-code-meaning error-code-remedy)
(defun error-code-meaning (code)
  "Return the meaning of CODE, an error code such as :ROBOT-BLOCKED, a sentence; NIL if neither the
simulator nor a command explains it."
  (let ((meaning (first (explanation-of-code code))))
    (and meaning (one-line meaning))))

(defun error-code-remedy (code)
  "Return what to try after a command has ended with CODE, an error code such as :ROBOT-BLOCKED, in
a sentence; NIL if neither the simulator nor a command says."
  (let ((remedy (second (explanation-of-code code))))
    (and remedy (string/= "" remedy) (one-line remedy))))

(defun trouble-p (code)
  "True if CODE, an error code or NIL, is worth reporting as a failure. Plans often look for what is
not there, and interrupt older commands on purpose; such codes do not count."
  (not (member code '(nil :interrupt :designator-not-found))))
