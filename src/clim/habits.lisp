;;;; habits.lisp -- what the user has chosen in a window is kept for the next, and what was said.

(in-package :ars-magna.clim)

;;; Kept as long as this Lisp runs. The last window that closes counts; what was said there comes
;;; back in a window of the same robot.

(defvar *habits-lock* (make-lock "habits"))
(defvar *habits* '()
  "Layers, whether in colour, and wishes of the window that closed last, in a list; or NIL.")

(defstruct (legacy (:copier nil))
  "What a window leaves to the next of its robot: the LINES that it said, newest first; what had
been TYPED there, or NIL; AWAY-P if it was in a trial or fork, which it has left; QUIET-P if its
prompt did not tell of plans' commands."
  (lines '() :type list :read-only t)
  (typed nil :type (or null string) :read-only t)
  (away-p nil :read-only t)
  (quiet-p nil :read-only t))

(defvar *said* '()
  "An alist from the names of robots to the legacy of the last window that has shown each.")

(defun legacy-of (window)
  (let ((session (conversation-session (window-conversation window))))
    (make-legacy :lines (transcript-lines (window-transcript window))
                 :typed (being-typed (window-conversation window))
                 :away-p (and (ars-magna.cli:away-p session) t)
                 :quiet-p (ars-magna.cli:session-quiet-p session))))

(defun take-legacy (window legacy)
  (let ((conversation (window-conversation window)) (transcript (window-transcript window)))
    (setf (ars-magna.cli:session-quiet-p (conversation-session conversation))
          (legacy-quiet-p legacy))
    (go-on-from transcript (legacy-lines legacy))
    (when (legacy-away-p legacy)
      (say transcript (format nil "From here on: ~A in ~A.~%" (shown-robot window)
                              (ars-magna.cli:words-for-run (window-simulation window)))))
    (when (legacy-typed legacy) (give-key conversation (legacy-typed legacy)))))

(defun keep-habits (window)
  (let ((habits (list (window-layers window) (window-color-p window) (window-wishes window)))
        (legacy (legacy-of window)))
    (with-lock (*habits-lock*)
      (setf *habits* habits)
      (dolist (name (window-robots-shown window))
        (setf *said* (acons name legacy (remove name *said* :key #'first)))))))

(defun take-habits (window)
  "Let WINDOW, which is new, be as the user has chosen before, and go on from what was said."
  (destructuring-bind (habits legacy)
      (with-lock (*habits-lock*)
        (list *habits* (rest (assoc (shown-robot window) *said*))))
    (when habits
      (destructuring-bind (layers color-p wishes) habits
        (setf (window-layers window) layers
              (window-color-p window) color-p
              (window-wishes window) (copy-wishes wishes))))
    (if legacy
        (take-legacy window legacy)
        (ars-magna.cli:tell-first-messages
         (conversation-session (window-conversation window))))))
