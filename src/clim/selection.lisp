;;;; selection.lisp -- what the user has picked by a click is marked wherever it is shown.

(in-package :ars-magna.clim)

(defgeneric subject-key (subject)
  (:documentation "Return what stays the same, for EQUAL, of SUBJECT from snapshot to snapshot; NIL
of what cannot be picked.")
  (:method (subject) (declare (ignore subject)) nil)
  (:method ((image thing-image)) (list :thing (thing-image-thing image)))
  (:method ((image robot-image)) (list :robot (robot-image-name image)))
  (:method ((image designator-image)) (list :designator (designator-image-number image)))
  (:method ((cell cell)) (list :cell (cell-x cell) (cell-y cell))))

(defun same-subject-p (one other)
  (or (eq one other)
      (let ((key (subject-key one))) (and key (equal key (subject-key other))))))

(defgeneric subjects-under (pane x y)
  (:documentation "Return what lies at X, Y of PANE, what is meant most likely first.")
  (:method (pane x y)
    (remove-duplicates (subjects-at (pane-subjects pane) x y)
                       :test #'same-subject-p :from-end t)))

(defun picked-first (window subjects)
  "Return SUBJECTS in turn from the one on that is picked in WINDOW, if one of them is."
  (let* ((key (window-selection window))
         (picked (and key (member key subjects :key #'subject-key :test #'equal))))
    (append picked (ldiff subjects picked))))

(defun selected-boxes (pane)
  "Return the boxes, (left top right bottom), in which what is picked was painted in PANE."
  (let ((key (window-selection (window-of pane))))
    (and key
         (loop for (subject . box) in (pane-subjects pane)
               when (equal key (subject-key subject)) collect box))))

(defun mark-box (pane left top right bottom)
  (clim:draw-rectangle* pane (- left 2) (- top 2) (+ right 2) (+ bottom 2)
                        :filled nil :ink clim:+dark-orange+ :line-thickness 2))

(defgeneric paint-selection (pane)
  (:documentation "Mark in PANE what is picked.")
  (:method (pane)
    (loop for box in (selected-boxes pane) do (apply #'mark-box pane box))))

(defun select (window subject)
  (setf (window-selection window) (subject-key subject))
  (refresh window))
