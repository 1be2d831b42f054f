;;;; leaving.lisp -- what a program leaves undone when it, or its headless run, ends.

(in-package :ars-magna.run)

;;; A script that commands a live robot and then ends does not wait for the command. A warning says
;;; so where there is no debugger; at a REPL leaving is the user's choice. The clock may still run:
;;; what is read here are single slots and atomic lists, and an error in reading is ignored.

(defun programs-request-p (request)
  "True if a program has asked for REQUEST itself, as no plan, continuation or prompt has."
  (and (request-name request)
       (starts-with-subseq "Lisp" (note-text (request-asker request)))))

(defun too-late-text (simulation)
  "Return in sentences what the program has asked for in SIMULATION since its last tick, and a
remedy; NIL if there is nothing, or it only ends something."
  (let ((names (loop for request in (timeline-inbox (simulation-timeline simulation))
                     when (and (operation-p request)
                               (programs-request-p request)
                               (not (member (request-name request) '(robot-stop camera-untrack)
                                            :test #'same-name-p)))
                       collect (string-downcase (request-name request)))))
    (when names
      (format nil "~{~A~^, ~} did nothing, as with-simulation ended before another tick had ~
                   passed. Call (run-ticks N) or (run-until TEST) after that."
              (remove-duplicates (reverse names) :test #'string= :from-end t)))))

(defun left-undone (world)
  "Return the names of what programs have asked for in WORLD that is under way or has not begun."
  (let ((resources (loop for robot in (world-robots world)
                         append (cons robot (robot-parts robot)))))
    (loop for request in (append (mapcar #'resource-event resources)
                                 (timeline-inbox (world-timeline world)))
          when (and (typep request 'request) (programs-request-p request))
            collect (string-downcase (request-name request)))))

(defun text-on-leaving (world)
  "Return in sentences what is left undone in WORLD, and a remedy; NIL if there is nothing."
  (let ((undone (remove-duplicates (left-undone world) :test #'string=)))
    (when undone
      (format nil "The program ends before ~{~A~^, ~} ~:[has~;have~] ended in ~(~A~), at tick ~D. ~
                   (await-idle) waits for that."
              undone (rest undone) (map-name (world-map world)) (world-tick world)))))

(defun tell-of-left-undone ()
  "Write to the error output what is left undone in the worlds that top-level code works in, if
there is no debugger."
  (when (disabled-hook-p (debugger-hook))
    (dolist (map (all-maps))
      (let ((text (and (map-resident map)
                       (ignore-errors (text-on-leaving (map-resident map))))))
        (when text (format *error-output* "~&*WARNING* -> ~A~%" text))))))

(call-when-leaving 'tell-of-left-undone)
