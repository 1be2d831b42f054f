;;;; world-lines.lisp -- WORLD and ROBOT: which robot the prompt commands, and where.

(in-package :ars-magna.cli)

(defun start-world-of-robot (session robot-name)
  (cond ((session-trial session)
         (call-after-leaving-trial session (lambda () (start-world-of-robot session robot-name))))
        ((not (and *simulation* (headless-p *simulation*))) (start-live-run session robot-name))
        ((session-batch-p session) (setf (session-next-robot session) robot-name))
        ((plusp (session-forks session))
         (reject-line "A fork has one world. FORK OFF leaves the fork."))
        (t (reject-line "This prompt is in a headless simulation, which has one world."))))

(defun end-abandoned-run (old)
  (unless (simulation-over old)
    (end-simulation old "the prompt has gone elsewhere")))

(defun end-replaced-run (session old robot)
  "End the run OLD, which SESSION has left for ROBOT's run. Move OLD's other prompts there, too."
  (setf (gethash old *replaced-runs*) (list (robot-simulation robot) (robot-name robot)))
  (end-abandoned-run old)
  (dolist (other (remove-if #'session-place (remove session (sessions-showing old))))
    (multiple-value-bind (simulation name) (run-to-continue-in old (session-robot-name other))
      (when simulation (announce-run other simulation name)))))

(defun start-live-run (session robot-name)
  "End the run of SESSION, and start one in ROBOT-NAME's world, at tick 0 with the same rate."
  (let ((old *simulation*))
    (when (plans) (format t "The plans under way end.~%"))
    ;; A run at tick 0 would continue instead of starting again.
    (when (member robot-name (current-robot-names)) (end-abandoned-run old))
    (let ((robot (simulator robot-name :display nil
                                       :rate (if old (simulation-rate old) *default-rate*))))
      (when old (end-replaced-run session old robot))
      (when (display-wanted-p session) (open-display-or-report robot '()))
      (format t "~A in ~A.~%" (robot-label robot) (simulation-name *simulation*)))))

(defun choose-robot-name (names name)
  "Return the element of NAMES, robots of one world, that equals NAME; the first if NAME is NIL."
  (if name
      (or (find-robot-name name names)
          (reject-line "That world has no robot ~A, only ~{~A~^, ~}." (string-upcase name) names))
      (first names)))

(define-line "WORLD" (session (name :world "a shipped world, or a Lisp file" :optional)
                              (robot :robot-name "a robot there; the first if left out" :optional))
    (:seeing)
    "List the worlds, or end this run and start one in the world NAME at tick 0, to command ROBOT."
  (if name
      (start-world-of-robot session (choose-robot-name (robot-names-in-world name) robot))
      (write-worlds)))

(defun resolve-robot-name (name)
  "Return the name of the robot that the typed NAME means: one of this run, or else of any world."
  (or (find-robot-name name (current-robot-names))
      (find-robot-name name (robot-names))
      (reject-unknown-name "robot" name (robot-names) "ROBOT lists the robots of this world.")))

(defun robot-here-named (name)
  "Return the robot of this run that the typed NAME means."
  (let ((name (resolve-robot-name name)))
    (or (find name (simulation-robots *simulation*) :key #'robot-name)
        (reject-robot-elsewhere name))))

(defun write-robots ()
  (dolist (robot (and *simulation* (simulation-robots *simulation*)))
    (multiple-value-bind (x y) (robot-position robot)
      (write-trimmed-line "~16A @ (~,2F,~,2F)~:[~; commanded~]" robot x y
                          (eq robot (or (robot-of-prompt)
                                        (first (simulation-robots *simulation*))))))))

(defun reject-robot-elsewhere (name)
  "Signal BAD-LINE with a text that tells how to get to the robot NAME in another world."
  (let ((map (map-name (map-of-robot name))))
    (if (eq map (simulation-name *simulation*))
        (reject-line "~A is not in this run. WORLD ~(~A~) ~2:*~(~A~) starts another run, which ~
                      ends this one."
                     name map)
        (reject-line "~A is in another world, ~(~A~). WORLD ~:*~(~A~) ~2:*~(~A~) goes there, at ~
                      tick 0, and ends this run."
                     name map))))

(define-line "ROBOT" (session (name :robot-here "the robot to command" :optional))
    (:seeing)
    "List this world's robots, or command its robot NAME from now on. If several robots have one
name, type the full name, with the package. WORLD leads to other worlds."
  (cond (name
         (setf *prompt-robot* (robot-name (robot-here-named name)))
         (import-robot-names (current-robot-names))
         (note-robot-commanded))
        (t (write-robots))))
