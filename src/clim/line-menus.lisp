;;;; line-menus.lisp -- the prompt's lines as menus, by the families under which HELP lists them.

(in-package :ars-magna.clim)

;;; A line without arguments is given at once; another is put where the user can type its arguments.

(defparameter *line-groups*
  '((:moving "Moving") (:camera "Cameras") (:hand "Hands") (:storage-bin "Storage bins")
    (:manipulating "Manipulating") (:seeing "Seeing") (:planning "Plans") (:running "Running")
    (:general "Prompt"))
  "Lists (family menu), in the order in which the menus are shown.")

(defun line-group (line)
  "Return the menu that holds LINE; that of the prompt for a family that has none."
  (second (or (assoc (ars-magna.cli:line-family line) *line-groups*)
              (assoc :general *line-groups*))))

(defun line-items (group)
  "Return the items of the menu GROUP."
  (loop for line in (sort (copy-list (ars-magna.cli:all-lines)) #'string<
                          :key #'ars-magna.cli:line-name)
        when (string= group (line-group line))
          collect (line-item (ars-magna.cli:line-name line))))

(defun line-item (name)
  (list name (lambda () (choose-line clim:*application-frame* name))))

(defun choose-line (window name)
  "Give the prompt the line command called NAME, or let the user add its arguments."
  (let ((conversation (window-conversation window)) (text (string-downcase name)))
    (cond ((ars-magna.cli:line-parameters (ars-magna.cli:find-line name))
           (begin-line-with conversation (format nil "~A " text))
           (type-into (pane-named window 'interactor)))
          (t (give-line conversation text)))))
