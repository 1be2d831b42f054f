;;;; status-lines.lisp -- STATUS, THINGS, MAP, POS and ANGLE.

(in-package :ars-magna.cli)

;;; The layout of STATUS is that of the session in manual E, with a line for the estimated change
;;; of position, which the manual lists and its session leaves out.

(defun glance (camera)
  "Return what CAMERA sees now. The run does not notice: dice and last view stay as they
were (reading 201)."
  (let* ((dice (world-dice (robot-world (part-robot camera)) :looking))
         (state (dice-state dice))
         (last-view (camera-last-view camera)))
    (unwind-protect (take-view camera)
      (setf (dice-state dice) state
            (camera-last-view camera) last-view))))

(defun view-text (camera)
  (format nil "~:[~;TRACK ~]~{~,2F~^ ~}" (camera-tracks camera) (glance camera)))

(defun write-views (robot)
  (loop for camera across (robot-cameras robot)
        for start = "View:  " then "          "
        do (put-line "~ACamera ~D: ~A" start (camera-index camera) (view-text camera))))

(defun own-slots (part)
  "Return what is known of the slots that the kind of PART has besides those that all parts have."
  (set-difference (kind-slots (kind-of part))
                  (kind-slots (find 'part (all-kinds) :key #'kind-name))))

(defun write-sensors (robot)
  "Show the parts of ROBOT that are of kinds of the user's own: their state and memory."
  (loop for part across (robot-sensors robot)
        do (put-line "~A:~{ ~A~^,~}" part
                     (loop for slot in (reverse (own-slots part))
                           when (member (kind-slot-role slot) '(:state :memory))
                             collect (format nil "~(~A~) ~A" (kind-slot-name slot)
                                             (funcall (kind-slot-reader slot) part))))))

(defun write-designator (designator)
  (put-line "~D ~A @ ~A" (designator-number designator)
            (kind-text designator) (bearing-text designator))
  (let ((data (designator-data designator)))
    (if (consp (first data))
        (write-descriptor data)
        (put-line "  ~{~:(~A~)~^ ~}" data))))

(defun write-designators (robot)
  (format t "Designators:~%")
  (mapc #'write-designator (live-designators robot)))

(defun write-position (label x y)
  (format t "~19A(~,2F,~,2F)~%" label x y))

;; A line of the manual's session would be in the way while nothing goes on.
(defun write-ownership (robot)
  "Show whose commands ROBOT and its parts carry out, and whose were interrupted last by whose."
  (dolist (resource (cons robot (robot-parts robot)))
    (let ((name (if (robot-p resource) "" (format nil "~A: " resource))))
      (loop for (label text) in `(("Under way:" ,(under-way-text resource))
                                  ("Interrupted:" ,(interruption-text resource)))
            when text do (put-line "~19A~A~A" label name text)))))

(defun thinking-text (simulation)
  "Return in words what thinking costs in SIMULATION, or NIL if that is as it is by default."
  (let ((mode (simulation-thinking simulation)))
    (cond ((consp mode) (format nil "charged, and a tick for ~D steps" (third mode)))
          ((eq :charged mode) "charged")
          ((and (eq :free mode) (live-p simulation)) "free"))))

;; As readings 17 and 199 say.
(defun write-status (robot)
  (multiple-value-call #'write-position "Position:" (robot-position robot))
  (multiple-value-call #'write-position "D Position:" (robot-last-move robot))
  (multiple-value-call #'write-position "Est D Position:" (robot-last-move-estimate robot))
  (loop for (label number) in `(("Angle:" ,(robot-angle robot))
                                ("Speed:" ,(robot-speed robot))
                                ("Turn Angle:" ,(robot-turn-angle robot)))
        do (format t "~19A~,2F~%" label number))
  (write-views robot)
  (write-sensors robot)
  (format t "~19A~A~%" "Place:" (robot-last-place robot))
  (write-ownership robot)
  (let ((thinking (thinking-text (robot-simulation robot))))
    (when thinking (format t "~19A~A~%" "Thinking:" thinking)))
  (write-designators robot))

(define-line "STATUS" (session)
    (:seeing)
    "Show the robot: position, last change of position, real and estimated, heading, speed, turning
speed, the views of its cameras, the place it sensed last, whose commands it and its parts carry
out, whose was interrupted last by whose, what thinking costs unless that is as usual, its
designators."
  (let ((robot (session-robot)))
    (still (or (report-status session robot) (write-status robot)))))

(defun where-text (thing)
  (let ((location (thing-location thing)))
    (if (eq location :floor)
        (format nil "@ (~,2F,~,2F)" (thing-x thing) (thing-y thing))
        (format nil "in ~A" (location-name location)))))

;; As reading 206 says.
(define-line "THINGS" (session)
    (:seeing)
    "List all things in the world with their locations and attributes."
  (let ((world (robot-world (session-robot))))
    (still
      (do-things (thing world)
        (put-line "~A ~A" thing (where-text thing))
        (write-descriptor (thing-attributes thing) #'amount-text)))))

;;; The map.

(defun terminal-width (session)
  "Return how many columns the terminal of SESSION has, as far as can be found out."
  (or (ignore-errors (parse-integer (environment-value "COLUMNS")))
      (and (terminal-p session)
           (ignore-errors
            (let ((size (nth-value 1 (run-command "stty" '("size") :input :interactive
                                                                   :output :string))))
              (parse-integer size :start (position #\Space size)))))
      80))

(define-line "MAP" (session (radius count "how many cells around the robot to show" :optional))
    (:seeing)
    "Show the world as characters: all of it, or what is within RADIUS cells of the robot."
  (let ((robot (session-robot))
        (columns (max 20 (1- (terminal-width session)))))
    (still (write-string (text-map robot :columns columns :radius radius)))))

;;; Putting the robot somewhere.

(define-line "POS" (session (x metres "metres from the left") (y metres "metres from the top"))
    (:seeing)
    "Put the robot at X, Y at once, without error and ignoring obstacles."
  (let ((robot (session-robot)))
    (place-robot robot x y (robot-angle robot))))

(define-line "ANGLE" (session (ang angle "the new heading"))
    (:seeing)
    "Turn the robot to the heading ANG at once, without error."
  (let ((robot (session-robot)))
    (multiple-value-bind (x y) (robot-position robot)
      (place-robot robot x y ang))))
