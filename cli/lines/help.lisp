;;;; help.lisp -- what HELP says of lines, from their definitions, and its menus.

(in-package :ars-magna.cli)

(defparameter *families*
  '((:general . "The prompt") (:seeing . "The robot and its world") (:planning . "Plans")
    (:running . "Running")
    (:moving . "Moving and turning"))
  "The families of the main menu, with what it calls them.")

(defun write-menu (lines)
  (dolist (line lines)
    (write-filled (first-sentence (line-sentence line)) 27 (format nil "  ~A" (usage line)))))

(defun lines-of (family)
  (remove family (all-lines) :key #'line-family :test-not #'eq))

(defun write-main-menu ()
  (loop for (family . title) in *families*
        do (format t "~A~%" title)
           (write-menu (lines-of family)))
  (let ((lines (lines-of :manipulating)))
    (when lines
      (format t "Manipulating~%")
      (write-menu lines)))
  (terpri)
  (write-filled "MENU-CAMERA, MENU-HAND and MENU-BIN list the commands of those parts, PLAN lists
the plans, HELP name tells more of a command, a plan, or whatever has a name; APROPOS word searches.
The beginning of a command's name will do. A line in parentheses is Lisp. HELP KEYS tells how a line
is edited. What has left the screen is still in your terminal's memory: scroll up." 0))

(defun slot-help (slot)
  "Return what HELP says of SLOT."
  (format nil "~A: ~{~A~^; ~}~:[~; (may be left out)~]." (slot-name slot)
          (remove "" (remove-duplicates (list (slot-text slot) (slot-words slot)) :test #'string=)
                  :test #'string=)
          (slot-optional-p slot)))

(defun write-help (line)
  (format t "~A~%" (usage line))
  (write-filled (line-sentence line) 2)
  (dolist (slot (line-parameters line)) (write-filled (slot-help slot) 4))
  (dolist (detail (line-details line)) (write-filled detail 2)))
