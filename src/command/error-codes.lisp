;;;; error-codes.lisp -- what the error codes of commands mean, and what to try.

(in-package :ars-magna.command)

(export '(failure-code-p))

;;; An error code is only a word. Here are a sentence and a remedy for each that several commands
;;; share. Commands have their own messages, and explain their own codes (see DEFINE-COMMAND).

(defparameter *error-code-explanations*
  '((:interrupt
     "A newer request took over the robot or part before the command had ended."
     "Wait for the command's continuation before you issue another command to the part. (under-way
robot) returns what the robot is doing, and for whom.")
    (:failed
     "The command did not succeed: by chance, because no method fits the things, because a
designator was not local, or because of an error in its code, which an error message reports."
     "Retry. If it never works, (describe (find-manipulation 'name)) shows the things it takes.")
    ;; Moving.
    (:robot-blocked
     "A wall, another robot, or a thing that blocks movement, is in the robot's way. The robot has
stopped in front of the obstacle."
     "Look for a free direction, with MAP at the prompt or (camera-view ...), and turn before you
drive on; go-to and find-way avoid known obstacles. Another robot may move on if you wait.")
    (:not-moving
     "The robot's speed is 0, so the robot would never arrive."
     "Set the robot's speed first: (robot-set-speed robot 0.8 nil).")
    (:too-slow "At its speed and turn angle, the robot needs longer than step-duration*."
     "Raise step-duration*, the robot's speed or its turn angle.")
    (:negative-speed "A speed was below 0. The robot's speed is 0 now."
     "Give a speed from 0 to max-speed*. To drive back, turn the robot round.")
    (:too-high-speed "A speed was above max-speed*. The robot's speed is max-speed* now."
     "Give a lower speed, or set max-speed*.")
    (:too-low-turn-angle "The turn angle was below min-turn-angle*; it is min-turn-angle* now."
     "Give a larger angle.")
    (:too-high-turn-angle
     "A turn angle was above max-turn-angle*. The robot's turn angle is max-turn-angle* now."
     "Give a smaller angle, or set max-turn-angle*.")
    (:goto-local
     "The camera tracks something that is next to the robot already, so the robot does not move."
     "Continue with the next command, such as grasping.")
    (:no-place-type
     "The robot sensed no place type: the robot is in the open, or misread the walls."
     "Sense again with robot-place, or drive on to a place such as a doorway or a corner.")
    (:incorrect-place-type
     "The place type that the robot sensed proved wrong when the robot began to turn."
     "Sense again with robot-place, and then align.")
    (:no-corner "The robot sensed no corner where it is."
     "Drive on along the wall, and sense with robot-place whether this is a corner.")
    ;; Looking.
    (:already-tracking "The camera tracks something, and can do nothing else meanwhile."
     "End the track with camera-untrack, or use another camera.")
    (:not-tracking "The camera tracks nothing, or has lost what it tracked."
     "Find the thing with camera-get-object-designator; track its designator with camera-track.")
    (:designator-not-found
     "The camera found no such thing or place. The thing or place may be out of the field of view,
hidden, nearer or farther away than the search asked for, or overlooked by chance."
     "Turn the camera or the robot and search again, or search for fewer attributes. Search for
:local things next to the robot, and for :non-local things everywhere else.")
    (:invalid-place-type "There is no place type of that name."
     "(all-place-types) lists all place types.")
    (:invisible-place-type "Places of that type cannot be recognized from afar."
     "Drive to the place and sense its type with robot-place.")
    (:camera-enclosed "The camera is inside a container, from where no places can be seen."
     "Take the camera out with camera-remove.")
    (:camera-inside
     "The camera is inside a container, and can track only things in the same container."
     "Take the camera out with camera-remove.")
    (:local-not-local
     "The thing and the camera are not in the same place any more: one of them was moved, or
put into a container or out of it."
     "Search for the thing again from where the camera is now.")
    (:lost-track
     "The camera cannot see the thing any more: the thing was hidden, moved away, left the field of
view, is next to the robot now, or never existed."
     "Search for the thing again; if the robot is there, search for a :local designator.")
    ;; Handling.
    (:hand-grasping "The hand holds something already."
     "Drop the thing with hand-ungrasp, or use another hand.")
    (:different-location
     "The hand is inside a container and the camera or thing is not, or the reverse."
     "Insert both into the container with hand-insert and camera-insert, or take both out with
hand-remove and camera-remove.")
    (:bad-designator
     "The designator is not valid any more: its thing or place was moved, or lost from view."
     "Look for the thing again, and use the new designator.")
    (:non-local-grasp "The thing is too far away to be grasped."
     "Drive to the thing with robot-goto-designator, and search for it again as :local.")
    (:non-local-designator "The thing is too far away."
     "Drive to the thing with robot-goto-designator, and search for it again as :local.")
    (:not-tracked "The camera does not track what the hand is to grasp."
     "Track the designator with camera-track first.")
    (:missed-grasp "The hand reached for the thing and missed it."
     "Try again; look for the thing again if its designator was lost.")
    (:insufficient-strength "The thing and its contents are too heavy for the hand."
     "Use a stronger hand, or empty the thing first.")
    (:not-grasping "The hand holds nothing." "Grasp something first with hand-grasp-desig.")
    (:grasping "The hand holds something." "")
    (:grasp-lost "The hand no longer holds the thing: the thing moved away or was taken."
     "Search for the thing nearby, and grasp it again.")
    (:bin-open "The storage bin is open already." "Go on.")
    (:bin-closed "The container or storage bin is closed."
     "Open a storage bin with storage-bin-open first, or a container with a manipulation.")
    (:robot-in-bin "A hand or camera is inside the storage bin, and keeps it from closing."
     "Take the hand or camera out with hand-remove or camera-remove.")
    (:bin-jammed "Something in the storage bin was in the way of its door."
     "Close it again.")
    (:insufficient-capacity "The container lacks room for what the hand holds, or is no container."
     "Take something out first, or use a larger container.")
    (:holding-thing "The hand holds the container, or something that the container is in."
     "Put the thing down first, or use another hand.")
    (:hand-bump "The hand missed the container and bumped into it."
     "Try again; look for the container again if its designator was lost.")
    (:camera-bump "The camera missed the container, bumped into it and lost it from view."
     "Find and track the container again, and try again.")
    (:not-tracking-destination "The camera tracks something other than the container to enter."
     "Track the container itself with camera-track.")
    (:not-inside "The hand or camera is not inside of anything." "Go on."))
  "Lists (code meaning remedy) for the simulator's own commands. An empty remedy is \"\".")

(mapc #'note-error-code (mapcar #'first *error-code-explanations*))

(defun explanation-of-code (code)
  "Return a list (meaning remedy) of strings for CODE, or NIL."
  (or (rest (assoc code *error-code-explanations*))
      (loop for command in (all-commands)
            for own = (find code (command-errors command) :key #'error-code-keyword)
            thereis (and own (error-code-explanation own)))))

(addition error-code-meaning error-code-remedy)
(defun error-code-meaning (code)
  "Return a sentence with the meaning of the error code CODE, such as :ROBOT-BLOCKED; NIL if neither
the simulator nor a command explains CODE."
  (let ((meaning (first (explanation-of-code code))))
    (and meaning (one-line meaning))))

(defun error-code-remedy (code)
  "Return a sentence on what to try after a command has ended with the error code CODE, such as
:ROBOT-BLOCKED; NIL if neither the simulator nor a command has a remedy."
  (let ((remedy (second (explanation-of-code code))))
    (and remedy (string/= "" remedy) (one-line remedy))))

(defun failure-code-p (code)
  "True if CODE, an error code or NIL, is worth reporting as a failure. :DESIGNATOR-NOT-FOUND and
:INTERRUPT do not count: plans often search for absent things and interrupt commands on purpose."
  (not (member code '(nil :interrupt :designator-not-found))))
