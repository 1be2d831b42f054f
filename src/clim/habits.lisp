;;;; habits.lisp -- what the user has chosen in a window is kept for the next, and what was said.

(in-package :ars-magna.clim)

;;; Kept as long as this Lisp runs. The last window that closes counts; what was said there comes
;;; back in a window of the same robot.

(defvar *habits-lock* (make-lock "habits"))
(defvar *habits* '()
  "Layers, whether in colour, and wishes of the window that closed last, in a list; or NIL.")
(defvar *said* '()
  "An alist from the names of robots to what the last window that has shown each said: its lines,
newest first.")

(defun keep-habits (window)
  "Keep what the user has chosen in WINDOW, which closes, and what it says."
  (let ((habits (list (window-layers window) (window-color-p window) (window-wishes window)))
        (lines (transcript-lines (window-transcript window))))
    (with-lock (*habits-lock*)
      (setf *habits* habits)
      (dolist (name (window-robots-shown window))
        (setf *said* (acons name lines (remove name *said* :key #'first)))))))

(defun take-habits (window)
  "Let WINDOW, which is new, be as the user has chosen before, and go on from what was said."
  (destructuring-bind (habits said)
      (with-lock (*habits-lock*)
        (list *habits* (rest (assoc (shown-robot window) *said*))))
    (when habits
      (destructuring-bind (layers color-p wishes) habits
        (setf (window-layers window) layers
              (window-color-p window) color-p
              (window-wishes window) (copy-wishes wishes))))
    (when said (go-on-from (window-transcript window) said))))
