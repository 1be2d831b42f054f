;;;; leaving.lisp -- what a program leaves undone when it, or its headless run, ends.

(in-package :ars-magna.run)

(export '(undone-text note-lines-typed))

;;; A script that commands a live robot and then ends does not wait for the command. A warning says
;;; so where there is no debugger; at a REPL leaving is the user's choice. The clock may still run:
;;; what is read here are single slots and atomic lists, and an error in reading is ignored.

(defun programs-request-p (request)
  "True if a program has asked for REQUEST itself, as no plan, continuation or prompt has."
  (and (request-name request)
       (starts-with-subseq "Lisp" (note-text (request-asker request)))))

(defun elsewhere-remedy (simulation)
  "Return in sentences that SIMULATION was asked inside of another since its last tick, or NIL."
  (and (asked-elsewhere-p (simulation-world simulation))
       (one-line "That was asked for inside of another with-simulation, and only ticks of that one
passed. Use there the robot that it names, or name both: (with-simulation ((ROBOT OTHER)) ...).")))

(defun too-late-text (simulation)
  "Return in sentences what the program has asked for in SIMULATION since its last tick, and a
remedy; NIL if there is nothing, or it only ends something."
  (let ((names (loop for request in (timeline-inbox (simulation-timeline simulation))
                     when (and (operation-p request)
                               (programs-request-p request)
                               (not (trait-p :stops (operation-command request))))
                       collect (string-downcase (request-name request)))))
    (when names
      (format nil "~{~A~^, ~} did nothing, as with-simulation ended before another tick had ~
                   passed. ~:[Call (run-ticks N) or (run-until TEST) after that.~;~:*~A~]"
              (remove-duplicates (reverse names) :test #'string= :from-end t)
              (elsewhere-remedy simulation)))))

;;; At the end of a headless run.

(defun lines-typed-p (simulation)
  "True if SIMULATION is of a prompt, whose user knows no WITH-SIMULATION."
  (said-p '(:lines-typed) (simulation-world simulation)))

(defun note-lines-typed (simulation)
  "Note that SIMULATION is of a prompt: what is left undone at its end is told with lines to type."
  (first-time-p '(:lines-typed) (simulation-world simulation)))

(defparameter *lines-remedy*
  "STEP N lets N ticks pass, PLAN NAME carries out a plan to its end."
  "What lets ticks pass where lines are typed.")

(defun undone-in (simulation)
  "Return the names of what was asked for in SIMULATION and has not begun, and those of plans."
  (let ((plans (unfinished-in-participants simulation))
        (requests (loop for request in (timeline-inbox (simulation-timeline simulation))
                        ;; What plans have asked for is said of plans.
                        when (and (request-name request) (not (request-forked-p request)))
                          collect (string-downcase (request-name request)))))
    (values (remove-duplicates (append (reverse requests) plans) :test #'string= :from-end t)
            plans)))

(defun undone-text (simulation)
  "Return in words what was asked for in SIMULATION and has not begun, and a remedy; NIL if there is
nothing."
  (multiple-value-bind (undone plans) (undone-in simulation)
    (when undone
      (format nil "~{~A~^, ~} did nothing. ~A" undone
              (cond ((lines-typed-p simulation) *lines-remedy*)
                    ((elsewhere-remedy simulation))
                    (t (format nil "Call (run-ticks N) or (run-until TEST)~:[~; in it, or ~
                                    (run-plan ...) instead of (begin-plan ...)~]."
                               plans)))))))

(defun cut-off-in (simulation)
  "Return in words, in a list, what the end of SIMULATION cuts off, unless the program has looked
itself at what was under way. What a prompt does for its user always looks at that."
  (when (or (lines-typed-p simulation) (not (looked-after-p (simulation-world simulation))))
    (loop for participant in (simulation-participants simulation)
          append (participant-cut-off participant))))

(defun cut-off-text (simulation)
  "Return in sentences what the end of SIMULATION cuts off, and a remedy; NIL if there is nothing."
  (let ((cut-off (cut-off-in simulation)) (typed (lines-typed-p simulation)))
    (when cut-off
      (format nil "At the end~:[ of with-simulation~;~], at tick ~D, ~{~A~^, ~} had not ended and ~
                   ~:[was~;were~] cut off. ~:[Call (run-ticks N) with more ticks, or ~
                   (run-plan ...) instead of (begin-plan ...).~;~A~]"
              typed (simulation-tick simulation) cut-off (rest cut-off) typed *lines-remedy*))))

(defun text-at-end (simulation)
  "Return in sentences what was asked for in SIMULATION, which ends, and came to nothing; or NIL."
  (if (zerop (simulation-tick simulation))
      (let ((undone (undone-text simulation)))
        (and undone (format nil "No ticks have passed~:[ in with-simulation~;~], so ~A"
                            (lines-typed-p simulation) undone)))
      (and (eq :report (message-queue-error-policy (simulation-messages simulation)))
           (eq simulation (latest simulation))
           (or (too-late-text simulation)
               ;; Who reads messages looks after the plans; a prompt reads them for its user.
               (and (or (lines-typed-p simulation)
                        (not (message-queue-read-p (simulation-messages simulation))))
                    (cut-off-text simulation))))))

;;; At the end of the program.

(defun left-undone (world)
  "Return the names of what programs have asked for in WORLD that is under way or has not begun."
  (loop for request in (append (loop for robot in (world-robots world)
                                     append (mapcar #'resource-event
                                                    (cons robot (robot-parts robot))))
                               (timeline-inbox (world-timeline world)))
        when (and (typep request 'request) (programs-request-p request))
          collect (string-downcase (request-name request))))

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
