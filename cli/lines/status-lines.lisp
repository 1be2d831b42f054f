;;;; status-lines.lisp -- STATUS, THINGS, BINS and the like; STATUS for other programs.

(in-package :ars-magna.cli)

;;; The layouts are those of the session in manual E.

(defun write-parts (heading writer reader)
  (let ((robot (session-robot)))
    (with-time-stopped
      (format t "~A~%-----~%" heading)
      (map nil writer (funcall reader robot)))))

;; As reading 203 says.
(defun write-bin (bin)
  (write-trimmed-line "~2D ~9A ~7A ~4,1F  ~{~A~^ ~}"
              (format nil "~2A" (storage-bin-index bin))
              (if (storage-bin-closed-p bin) "Closed" "Open")
              (plain-number-text (storage-bin-capacity bin))
              (remaining-capacity bin)
              (storage-bin-contents bin)))

(define-line "BINS" (session)
    (:seeing)
    "List the storage bins: open or closed, total and current capacity, contents."
  (write-parts "BIN STATUS TOTAL-CAP CURRENT-CAP CONTENTS" #'write-bin #'robot-bins))

(defun write-camera (camera)
  (write-trimmed-line "~4A ~,2F ~3A~6,2F ~@[~A ~]~@[Tracking ~A~]"
              (camera-index camera)
              (camera-field-of-view camera)
              (camera-resolution camera)
              (zero-if-tiny (camera-angle camera))
              (part-location-text camera)
              (when (camera-tracks camera)
                (let ((designator (designator-status (camera-tracks camera))))
                  (format nil "~A designator @ ~A" (designator-kind-text designator)
                          (designator-bearing-text designator))))))

(define-line "CAMERAS" (session)
    (:seeing)
    "List the cameras: field of view, resolution, angle, location, what they track."
  (write-parts "CAMERA FIELD RES ANGLE" #'write-camera #'robot-cameras))

(defun write-hand (hand)
  (write-trimmed-line "~6A ~7A ~14A ~@[~A~]"
              (hand-index hand)
              (plain-number-text (hand-strength hand))
              (or (hand-holding hand) "")
              (part-location-text hand)))

(define-line "HANDS" (session)
    (:seeing)
    "List the hands: strength, what they hold, location."
  (write-parts "HAND STRENGTH GRASPING" #'write-hand #'robot-hands))

;;;; STATUS and THINGS

;;; The layout of STATUS is that of the session in manual E. The estimated change of position is
;;; added, which the manual lists and its session omits. The contents are those of (status).

(defconstant +most-readings+ 40 "The most readings of a camera that STATUS writes.")

(defun view-text (view)
  "Return the readings in VIEW as text; of more than +MOST-READINGS+ the first, and their number."
  (let ((count (length view)))
    (if (<= count +most-readings+)
        (format nil "~{~,2F~^ ~}" view)
        (format nil "~{~,2F ~}... (~D readings)" (subseq view 0 8) count))))

(defun write-views (cameras)
  (loop for camera in cameras
        for start = "View:  " then "          "
        do (write-trimmed-line "~ACamera ~D: ~:[~;TRACK ~]~A" start (getf camera :number)
                               (getf camera :tracks) (view-text (getf camera :view)))))

(defun write-designator (designator)
  (write-trimmed-line "~D ~A @ ~A" (getf designator :number) (designator-kind-text designator)
                      (designator-bearing-text designator))
  (let ((data (getf designator :data)))
    (if (consp (first data))
        (write-descriptor data)
        (write-trimmed-line "  ~{~:(~A~)~^ ~}" data))))

(defun command-entry-text (entry control)
  "Return ENTRY of :UNDER-WAY or :INTERRUPTED as text: its part, then the output of CONTROL."
  (destructuring-bind (&key part command for by by-for tick) entry
    (format nil "~@[~A: ~]~?" part control (list command for by by-for tick))))

;; While nothing is in progress, these lines are left out, as in the manual's session.
(defun write-commands-in-progress (status)
  (loop for entry in (getf status :under-way)
        do (write-trimmed-line "~19A~A" "Under way:" (command-entry-text entry "~(~A~), for ~A")))
  (loop for entry in (getf status :interrupted)
        do (write-trimmed-line "~19A~A" "Interrupted:"
                               (command-entry-text
                                entry "~(~A~), for ~A, by ~(~A~), for ~A, at tick ~D"))))

(defun thinking-cost-text (status)
  "Return the cost of thinking in STATUS as text; NIL if it is the default."
  (let ((mode (getf status :thinking)))
    (cond ((consp mode) (format nil "charged, and a tick for ~D steps" (third mode)))
          ((eq :charged mode) "charged")
          ((and (eq :free mode) (getf status :live)) "free"))))

(defun sensor-value-text (value)
  "Return VALUE, of a slot of a sensor, as text. Floats have two decimals."
  (cond ((floatp value) (format nil "~,2F" value))
        ((and (consp value) (proper-list-of-p #'floatp value)) (format nil "(~{~,2F~^ ~})" value))
        (t (princ-to-string value))))

(defun write-sensor (sensor)
  (write-trimmed-line "~A:~:{ ~(~A~) ~A~:^,~}" (getf sensor :name)
                      (loop for (name value) in (getf sensor :slots)
                            collect (list name (sensor-value-text value)))))

(defun thinking-text (status)
  "Return what STATUS says of thinking as text; NIL if it is the default."
  (let ((cost (thinking-cost-text status)) (unpaid (getf status :unpaid-thinking)))
    (and (or cost unpaid)
         (format nil "~@[~A~]~:[~;; ~]~@[~A of a tick is added to the next thought~]"
                 cost (and cost unpaid) unpaid))))

;; As readings 17 and 199 say.
(defun write-status (status)
  (loop for (label key) in '(("Position:" :position) ("D Position:" :last-move)
                             ("Est D Position:" :estimated-last-move))
        do (format t "~19A(~{~,2F~^,~})~%" label (mapcar #'zero-if-tiny (getf status key))))
  (loop for (label key) in '(("Angle:" :angle) ("Speed:" :speed) ("Turn Angle:" :turn-angle))
        do (format t "~19A~,2F~%" label (zero-if-tiny (getf status key))))
  (write-views (getf status :cameras))
  ;; Rangefinders and parts of the user's own kinds, with their state and memory.
  (mapc #'write-sensor (getf status :sensors))
  (format t "~19A~A~%" "Place:" (getf status :place))
  (write-commands-in-progress status)
  (let ((thinking (thinking-text status)))
    (when thinking (format t "~19A~A~%" "Thinking:" thinking)))
  (loop for (nil name nil value) in (getf status :variables)
        do (write-trimmed-line "~18A ~A" (format nil "~A:" name) (fact-text value)))
  (format t "Designators:~%")
  (mapc #'write-designator (getf status :designators)))

(defun write-why-no-ticks-pass (session simulation)
  "If SIMULATION, the live run of SESSION, passes no ticks now, print why."
  (when (and (live-p simulation)
             (or (paused-p simulation) (idle-p simulation))
             (null (session-trial session)))
    (format t "~19A~A~%" "Time:" (time-description session simulation))))

(defun write-status-of-all (session robots)
  (unless (report-all-statuses session robots)
    (dolist (robot robots)
      (write-under-robot robot (lambda () (write-status (status robot)))))
    (write-why-no-ticks-pass session (current-simulation))))

(define-line "STATUS" (session (which :robots "ALL, or the name of a robot; the robot commanded if
left out" :optional))
    (:seeing)
    "Show the robot's state: position, last change of position (real and estimated), heading, speed,
turning speed, what its cameras see now, the last place sensed, its designators, the commands in
progress and who issued them, the last interruption, the cost of thinking if it was changed, and the
values of run variables. A line tells if no ticks pass now. STATUS ALL shows each robot of the run.
In Lisp: (status)."
  (let ((robot (session-robot)) (all-p (and which (string-equal which "all"))))
    (when (and which (not all-p)) (setf robot (robot-here-named which)))
    (with-time-stopped
      (cond (all-p (write-status-of-all session (robots-in-order (robot-world robot))))
            ((report-status-object session robot))
            (t (write-status (status robot))
               (write-why-no-ticks-pass session (current-simulation)))))))

(defun thing-place-text (thing)
  (let ((location (thing-location thing)))
    (if (eq location :floor)
        (format nil "@ (~,2F,~,2F)" (thing-x thing) (thing-y thing))
        (format nil "in ~A" (if (rest (simulation-robots *simulation*))
                                (location-phrase location)
                                (location-name location))))))

;; As reading 206 says.
(define-line "THINGS" (session)
    (:seeing)
    "List all things in the world with their locations and attributes."
  (let ((world (world-of-prompt)))
    (with-time-stopped
      (do-things (thing world)
        (write-trimmed-line "~A ~A" thing (thing-place-text thing))
        (write-descriptor (thing-attributes thing) #'plain-number-text)))))

;;; Putting the robot somewhere.

(define-line "POS" (session (x metres "metres from the left") (y metres "metres from the top"))
    (:seeing)
    "Put the robot at X, Y at once, exactly, ignoring obstacles. A message says if a wall is there."
  (let ((robot (session-robot)))
    (place-robot robot x y (robot-angle robot))))

(define-line "ANGLE" (session (ang angle "the new heading"))
    (:seeing)
    "Turn the robot to the heading ANG at once, without error."
  (let ((robot (session-robot)))
    (multiple-value-bind (x y) (robot-position robot)
      (place-robot robot x y ang))))

;;; For other programs: the values of (status) as JSON.

;;; In Lisp NIL is nothing, false or the empty list, and a list may be a property list or not. So
;;; the kinds of such values are listed here by key.

(defparameter *keys-by-json-kind*
  '((:objects :cameras :hands :bins :sensors :under-way :interrupted :designators :variables)
    (:lists :view :contents :slots :data)
    (:truths :live :closed))
  "Lists (kind key...): keys of (status) that JSON shows as arrays of objects, arrays or booleans.")

(defun lists-to-arrays (value)
  (if (or (simple-vector-p value)
          (and (consp value) (null (cdr (last value)))))
      (map 'vector #'lists-to-arrays value)
      value))

(defun value-for-json (key value)
  (case (first (find-if (lambda (kind) (member key (rest kind))) *keys-by-json-kind*))
    (:objects (map 'vector #'object-for-json value))
    (:truths (if value t :false))
    (:lists (if value (lists-to-arrays value) #()))
    (t (if (eq key :failed) (object-for-json value) (lists-to-arrays value)))))

(defun object-for-json (plist)
  "Return PLIST with its values converted for WRITE-JSON, as *KEYS-BY-JSON-KIND* says."
  (loop for (key value) on plist by #'cddr
        collect key
        collect (value-for-json key value)))

(defun status-for-json (robot)
  (let ((status (printing-plainly () (status robot))))
    (object-for-json (list* :robot (string-downcase (robot-label robot)) (cddr status)))))

(defun report-status-object (session robot)
  "If SESSION reports objects, report ROBOT's status and return true. The world must stand still."
  (let ((account (session-account session)))
    (when (reports-objects-p account)
      (apply #'report-object account "status" (status-for-json robot)))))

(defun report-all-statuses (session robots)
  "If SESSION reports objects, report the statuses of ROBOTS in one object and return true."
  (report-object (session-account session) "statuses"
                 :robots (map 'vector #'status-for-json robots)))
