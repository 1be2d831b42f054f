;;;; leaving.lisp -- warnings about requests left undone when a program or headless run ends.

(in-package :ars-magna.run)

(export '(undone-requests-text mark-as-prompt-run))

;;; A script that commands a live robot and then ends does not wait for the command. A warning says
;;; so if there is no debugger; at a REPL, leaving is the user's choice. The clock may still run:
;;; this code reads single slots and atomic lists, and ignores errors.

(defun issued-by-program-p (request)
  "True if REQUEST was made directly by a program, not by a plan, a continuation or a prompt."
  (and (request-name request)
       (starts-with-subseq "Lisp" (asker-note-text (request-asker request)))))

(defun wrong-simulation-remedy (simulation)
  "If another run has made requests to SIMULATION since its last tick, return a remedy; else NIL."
  (and (requested-by-other-run-p (simulation-world simulation))
       (one-line "The request was made inside another with-simulation, and only its ticks passed.
There, use the robot that it names, or name both: (with-simulation ((ROBOT OTHER)) ...).")))

(defun requests-too-late-text (simulation)
  "Return a text, with a remedy, about requests that the program has made to SIMULATION since its
last tick. Requests that only stop something do not count. Return NIL if no others exist."
  (let ((names (loop for request in (timeline-inbox (simulation-timeline simulation))
                     when (and (operation-p request)
                               (issued-by-program-p request)
                               (not (trait-p :stops (operation-command request))))
                       collect (string-downcase (request-name request)))))
    (when names
      (format nil "~{~A~^, ~} did nothing, because with-simulation ended before another tick had ~
                   passed. ~:[Call (run-ticks N) or (run-until TEST) after the request.~;~:*~A~]"
              (remove-duplicates (reverse names) :test #'string= :from-end t)
              (wrong-simulation-remedy simulation)))))

;;; At the end of a headless run.

(defun belongs-to-prompt-p (simulation)
  "True if SIMULATION belongs to a prompt, whose user types lines instead of WITH-SIMULATION."
  (warning-given-p '(:lines-typed) (simulation-world simulation)))

(defun mark-as-prompt-run (simulation)
  "Record that SIMULATION belongs to a prompt, so that warnings at its end suggest lines to type."
  (first-warning-for-key-p '(:lines-typed) (simulation-world simulation)))

(defparameter *prompt-remedy*
  "STEP N passes N ticks; PLAN NAME carries out a plan to its end."
  "How to pass ticks at the prompt.")

(defun undone-request-names (simulation)
  "Return two lists of names: requests to SIMULATION and plans that have not begun; these plans
only."
  (let ((plans (unfinished-work-texts simulation))
        (requests (loop for request in (timeline-inbox (simulation-timeline simulation))
                        ;; For requests of plans, the plan is named.
                        when (and (request-name request) (not (request-forked-p request)))
                          collect (string-downcase (request-name request)))))
    (values (remove-duplicates (append (reverse requests) plans) :test #'string= :from-end t)
            plans)))

(defun undone-requests-text (simulation)
  "Return a text and remedy about requests to SIMULATION and plans that have not begun; or NIL."
  (multiple-value-bind (undone plans) (undone-request-names simulation)
    (when undone
      (format nil "~{~A~^, ~} did nothing. ~A" undone
              (cond ((belongs-to-prompt-p simulation) *prompt-remedy*)
                    ((wrong-simulation-remedy simulation))
                    (t (format nil "Call (run-ticks N) or (run-until TEST)~:[~; before the end, or ~
                                    (run-plan ...) instead of (begin-plan ...)~]."
                               plans)))))))

(defun cut-off-work-texts (simulation)
  "Return a list of texts about work that the end of SIMULATION cuts off. Return NIL if the program
itself has checked which work was in progress; checks by a prompt do not count."
  (when (or (belongs-to-prompt-p simulation)
            (not (progress-checked-p (simulation-world simulation))))
    (loop for participant in (simulation-participants simulation)
          append (participant-cut-off participant))))

(defun cut-off-work-text (simulation)
  (let ((cut-off (cut-off-work-texts simulation)) (typed (belongs-to-prompt-p simulation)))
    (when cut-off
      (format nil "At the end~:[ of with-simulation~;~], at tick ~D, ~{~A~^, ~} had not ended and ~
                   ~:[was~;were~] cut off. ~:[Call (run-ticks N) with more ticks, or ~
                   (run-plan ...) instead of (begin-plan ...).~;~A~]"
              typed (simulation-tick simulation) cut-off (rest cut-off) typed *prompt-remedy*))))

(defun warning-at-end-text (simulation)
  "Return a text about requests to SIMULATION that had no effect or are cut off by its end; or NIL."
  (if (zerop (simulation-tick simulation))
      (let ((undone (undone-requests-text simulation)))
        (and undone (format nil "No ticks have passed~:[ in with-simulation~;~], so ~A"
                            (belongs-to-prompt-p simulation) undone)))
      (and (eq :report (message-queue-error-policy (simulation-messages simulation)))
           (eq simulation (latest-successor simulation))
           (or (requests-too-late-text simulation)
               ;; A program that reads messages knows about its plans; the user of a prompt may not.
               (and (or (belongs-to-prompt-p simulation)
                        (not (message-queue-read-p (simulation-messages simulation))))
                    (cut-off-work-text simulation))))))

;;; At the end of the program.

(defun undone-program-requests (world)
  (loop for request in (append (loop for robot in (world-robots world)
                                     append (mapcar #'resource-event
                                                    (cons robot (robot-parts robot))))
                               (timeline-inbox (world-timeline world)))
        when (and (typep request 'request) (issued-by-program-p request))
          collect (string-downcase (request-name request))))

(defun undone-work-text (world)
  "Return a text, with a remedy, about requests of programs that are left undone in WORLD; or NIL."
  (let ((undone (remove-duplicates (undone-program-requests world) :test #'string=)))
    (when undone
      (format nil "The program ends before ~{~A~^, ~} ~:[has~;have~] ended in ~(~A~), at tick ~D. ~
                   (await-idle) waits until all commands have ended."
              undone (rest undone) (map-name (world-map world)) (world-tick world)))))

(defun warn-of-undone-work ()
  "If Lisp has no debugger, warn on the error output about requests left undone in resident worlds."
  (when (disabled-hook-p (debugger-hook))
    (dolist (map (all-maps))
      (let ((text (and (map-resident map)
                       (ignore-errors (undone-work-text (map-resident map))))))
        (when text (format *error-output* "~&*WARNING* -> ~A~%" text))))))

(call-at-exit 'warn-of-undone-work)
