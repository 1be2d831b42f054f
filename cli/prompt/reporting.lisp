;;;; reporting.lisp -- what a session tells other programs: objects for messages and ends of lines.

(in-package :ars-magna.cli)

;;; A session with an ACCOUNT counts its lines, so that a script's mistakes can be found. If its
;;; output is an OBJECT-STREAM, it reports by objects instead of text. Their types are documented in
;;; cli/README.md.

(defstruct (account (:constructor make-account (file objects-p)) (:copier nil))
  "Where a session is in FILE, the name of a script or NIL. LINES have been read; the line under way,
TEXT, begins at LINE; ERRORS were there before it. OBJECTS-P says whether objects are written."
  (file nil :type (or null string) :read-only t)
  (objects-p nil :type boolean :read-only t)
  (lines 0 :type fixnum)
  (line 0 :type fixnum)
  (text nil :type (or null string))
  (errors 0 :type fixnum))

(defun reports-p (session)
  "True if SESSION reports by objects."
  (let ((account (session-account session)))
    (and account (account-objects-p account))))

(defun now ()
  "Return the tick of the current simulation, or NIL."
  (and *simulation* (simulation-tick *simulation*)))

(defun report-object (session type &rest properties)
  "Write an object of TYPE, a string, with PROPERTIES, a property list, if SESSION reports by objects.
True if it does."
  (when (reports-p session)
    (with-console (stream (session-console session))
      (write-object (list* :type type properties) stream))
    t))

(defun report-trouble (session text)
  "Report that a line of SESSION makes no sense, as TEXT says, if it reports by objects."
  (report-object session "message" :kind :error :text text :tick (now)
                            :line (account-line-under-way session)))

(defun account-line-under-way (session)
  "Return at which line of its input SESSION is, or NIL."
  (let ((account (session-account session)))
    (and account (plusp (account-line account)) (account-line account))))

(defun placed-text (session text)
  "Return TEXT, of what goes wrong in a line of SESSION, after the place of that line in a script."
  (let ((account (session-account session)))
    (if (and account (account-file account) (account-text account))
        (format nil "~A, line ~D: ~A" (account-file account) (account-line account) text)
        text)))

(defun report-messages (session messages)
  "Report MESSAGES if SESSION reports by objects."
  (when (reports-p session)
    (dolist (message messages t)
      (report-object session "message" :kind (message-kind message) :text (message-text message)
                                :tick (now) :line (account-line-under-way session)))))

;;; Lines.

(defun note-read (session)
  "Note that a line of SESSION has been read."
  (when (session-account session) (incf (account-lines (session-account session)))))

(defun note-line-begun (session text)
  "Note that SESSION is about to do TEXT, the line that was read last."
  (let ((account (session-account session)))
    (when account
      (setf (account-line account) (account-lines account)
            (account-text account) (if (comment-p text) nil text)
            (account-errors account) (session-errors session)))))

(defun note-line-ended (session)
  "Report, if SESSION does that, that the line under way has been done. To be called when all that
it has asked for is done."
  (let ((account (session-account session)))
    (when (and account (account-text account))
      (report-object session "done" :line (account-line account)
                             :text (string-trim " " (account-text account))
                             :ok (if (= (account-errors account) (session-errors session))
                                     t
                                     :false)
                             :tick (now))
      (setf (account-text account) nil))))

;;; The robot.

(defun point-data (x y) (vector x y))

(defun designator-data-of (designator)
  (list :number (designator-number designator)
        :type (designator-type designator)
        :distance (designator-distance designator)
        :angle (designator-angle designator)))

(defun robot-data (robot)
  "Return what STATUS tells of ROBOT, as data."
  (list :tick (now)
        :robot (string-downcase (robot-name robot))
        :world (string-downcase (simulation-name *simulation*))
        :position (multiple-value-call #'point-data (robot-position robot))
        :last-move (multiple-value-call #'point-data (robot-last-move robot))
        :last-move-estimate (multiple-value-call #'point-data (robot-last-move-estimate robot))
        :angle (robot-angle robot)
        :speed (robot-speed robot)
        :turn-angle (robot-turn-angle robot)
        :place (robot-last-place robot)
        :views (map 'vector (lambda (camera) (coerce (glance camera) 'vector))
                    (robot-cameras robot))
        :hands (map 'vector (lambda (hand)
                              (and (hand-holding hand) (princ-to-string (hand-holding hand))))
                    (robot-hands robot))
        :designators (map 'vector #'designator-data-of (live-designators robot))))

(defun report-status (session)
  "Report how the robot of SESSION is, if SESSION reports by objects."
  (when (reports-p session)
    (let ((robot (session-robot)))
      (apply #'report-object session "status" (asking (*simulation*) (robot-data robot))))))
