;;;; leaving.lisp -- warnings about requests left undone when a program or headless run ends.

(in-package :ars-magna.run)

(export '(undone-text note-lines-typed))

;;; A script that commands a live robot and then ends does not wait for the command. A warning says
;;; so if there is no debugger; at a REPL, leaving is the user's choice. The clock may still run:
;;; this code reads single slots and atomic lists, and ignores errors.

(defun issued-by-program-p (request)
  "True if a program has made REQUEST itself, and no plan, continuation or prompt."
  (and (request-name request)
       (starts-with-subseq "Lisp" (note-text (request-asker request)))))

(defun elsewhere-remedy (simulation)
  "Return a text about requests to SIMULATION from inside another one since its last tick, or NIL."
  (and (asked-elsewhere-p (simulation-world simulation))
       (one-line "That was asked for inside of another with-simulation, and only ticks of that one
passed. Use there the robot that it names, or name both: (with-simulation ((ROBOT OTHER)) ...).")))

(defun too-late-text (simulation)
  "Return a text about requests of the program to SIMULATION since its last tick, with a remedy. NIL
if there are none, or they only stop something."
  (let ((names (loop for request in (timeline-inbox (simulation-timeline simulation))
                     when (and (operation-p request)
                               (issued-by-program-p request)
                               (not (trait-p :stops (operation-command request))))
                       collect (string-downcase (request-name request)))))
    (when names
      (format nil "~{~A~^, ~} did nothing, as with-simulation ended before another tick had ~
                   passed. ~:[Call (run-ticks N) or (run-until TEST) after that.~;~:*~A~]"
              (remove-duplicates (reverse names) :test #'string= :from-end t)
              (elsewhere-remedy simulation)))))

;;; At the end of a headless run.

(defun lines-typed-p (simulation)
  "True if SIMULATION is that of a prompt, whose user does not write WITH-SIMULATION."
  (said-p '(:lines-typed) (simulation-world simulation)))

(defun note-lines-typed (simulation)
  "Note that SIMULATION is that of a prompt: warnings at its end name lines to type as the remedy."
  (first-time-p '(:lines-typed) (simulation-world simulation)))

(defparameter *lines-remedy*
  "STEP N lets N ticks pass, PLAN NAME carries out a plan to its end."
  "How to pass ticks at the prompt.")

(defun undone-names (simulation)
  "Return the names of requests to SIMULATION and of plans that have not begun; and those of plans."
  (let ((plans (unfinished-in-participants simulation))
        (requests (loop for request in (timeline-inbox (simulation-timeline simulation))
                        ;; For requests of plans, the plan is named.
                        when (and (request-name request) (not (request-forked-p request)))
                          collect (string-downcase (request-name request)))))
    (values (remove-duplicates (append (reverse requests) plans) :test #'string= :from-end t)
            plans)))

(defun undone-text (simulation)
  "Return a text about what was requested of SIMULATION and has not begun, with a remedy; or NIL."
  (multiple-value-bind (undone plans) (undone-names simulation)
    (when undone
      (format nil "~{~A~^, ~} did nothing. ~A" undone
              (cond ((lines-typed-p simulation) *lines-remedy*)
                    ((elsewhere-remedy simulation))
                    (t (format nil "Call (run-ticks N) or (run-until TEST)~:[~; in it, or ~
                                    (run-plan ...) instead of (begin-plan ...)~]."
                               plans)))))))

(defun cut-off-texts (simulation)
  "Return a list of texts about what the end of SIMULATION cuts off, or NIL if the program has
checked for itself what was in progress. A prompt always does that, which does not count."
  (when (or (lines-typed-p simulation) (not (looked-after-p (simulation-world simulation))))
    (loop for participant in (simulation-participants simulation)
          append (participant-cut-off participant))))

(defun cut-off-text (simulation)
  "Return a text about what the end of SIMULATION cuts off, with a remedy; or NIL."
  (let ((cut-off (cut-off-texts simulation)) (typed (lines-typed-p simulation)))
    (when cut-off
      (format nil "At the end~:[ of with-simulation~;~], at tick ~D, ~{~A~^, ~} had not ended and ~
                   ~:[was~;were~] cut off. ~:[Call (run-ticks N) with more ticks, or ~
                   (run-plan ...) instead of (begin-plan ...).~;~A~]"
              typed (simulation-tick simulation) cut-off (rest cut-off) typed *lines-remedy*))))

(defun text-at-end (simulation)
  "Return a text about requests to SIMULATION, which ends, that had no effect; or NIL."
  (if (zerop (simulation-tick simulation))
      (let ((undone (undone-text simulation)))
        (and undone (format nil "No ticks have passed~:[ in with-simulation~;~], so ~A"
                            (lines-typed-p simulation) undone)))
      (and (eq :report (message-queue-error-policy (simulation-messages simulation)))
           (eq simulation (latest simulation))
           (or (too-late-text simulation)
               ;; A program that reads messages knows about its plans; the user of a prompt may not.
               (and (or (lines-typed-p simulation)
                        (not (message-queue-read-p (simulation-messages simulation))))
                    (cut-off-text simulation))))))

;;; At the end of the program.

(defun left-undone (world)
  "Return the names of requests of programs in WORLD that are in progress or have not begun."
  (loop for request in (append (loop for robot in (world-robots world)
                                     append (mapcar #'resource-event
                                                    (cons robot (robot-parts robot))))
                               (timeline-inbox (world-timeline world)))
        when (and (typep request 'request) (issued-by-program-p request))
          collect (string-downcase (request-name request))))

(defun undone-work-text (world)
  "Return a text about what is left undone in WORLD, with a remedy; or NIL."
  (let ((undone (remove-duplicates (left-undone world) :test #'string=)))
    (when undone
      (format nil "The program ends before ~{~A~^, ~} ~:[has~;have~] ended in ~(~A~), at tick ~D. ~
                   (await-idle) waits for that."
              undone (rest undone) (map-name (world-map world)) (world-tick world)))))

(defun warn-of-undone-work ()
  "If there is no debugger, warn on the error output about requests left undone in resident worlds."
  (when (disabled-hook-p (debugger-hook))
    (dolist (map (all-maps))
      (let ((text (and (map-resident map)
                       (ignore-errors (undone-work-text (map-resident map))))))
        (when text (format *error-output* "~&*WARNING* -> ~A~%" text))))))

(call-when-leaving 'warn-of-undone-work)
