;;;; pushing.lisp -- pushing things from cell to cell, with a step to a neighbouring cell.

(in-package :ars-magna.command)

;;; ROBOT-PUSH is a step that makes way for itself. When the robot has turned, what bars movement in
;;; the next cell slides one cell on, with its place in the cell, and so does what bars movement in
;;; the cell beyond, and so on: a row. Then the robot drives into the cell. Things that bar no
;;; movement stay where they are. Doors and other robots cannot be pushed.

(defun wall-ahead-p (world x y columns rows)
  "True if what is at (X,Y) cannot go COLUMNS and ROWS of cells on, because a wall or closed door is
there, or because both cells beside the corner between the cells are barred."
  (or (blocked-cell-p world (+ x columns) (+ y rows) +wall-or-door+)
      (and (blocked-cell-p world (+ x columns) y +blocking+)
           (blocked-cell-p world x (+ y rows) +blocking+)
           (/= 0 columns)
           (/= 0 rows))))

(defun row-ahead (robot columns rows)
  "Return the things that bar the way of ROBOT to the cell COLUMNS and ROWS on, and the row of such
things behind them, the farthest first. The second value is true if the row cannot slide, because a
wall, a door or another robot is behind it."
  (let ((world (robot-world robot)) (row '()))
    (loop for from-x = (robot-x robot) then x
          for from-y = (robot-y robot) then y
          for x = (+ from-x columns)
          for y = (+ from-y rows)
          do (when (wall-ahead-p world from-x from-y columns rows)
               (return (values row t)))
             (let ((things '()))
               (do-cell-things (thing (map-index (world-map world) x y) world)
                 (when (thing-obsmove-p thing) (push thing things)))
               (when (or (null things) (some #'body-p things))
                 (return (values row (and things t))))
               (setf row (append things row))))))

(defun push-row (robot direction)
  "Push what bars the way of ROBOT in DIRECTION one cell on. Return an error code, or NIL."
  (destructuring-bind (columns rows) (rest (find-step-direction direction))
    (multiple-value-bind (row stuck) (row-ahead robot columns rows)
      (cond ((null row) nil)
            (stuck :push-stuck)
            ((> (reduce #'+ row :key #'thing-total-weight) push-strength*) :too-heavy)
            (t (dolist (thing row)
                 (move-thing thing (+ (thing-x thing) columns) (+ (thing-y thing) rows))))))))

(define-step push-on (operation (and (robot-p (operation-resource operation))
                                     (typep (operation-subject operation) 'step-subject)))
  "Turn the robot for a tick or, if no angle is left, push what is in its way, and drive on."
  (let ((robot (operation-resource operation)))
    (destructuring-bind (angle end) (operation-subject operation)
      (if (/= 0 angle)
          (turn-for-step operation robot angle end)
          (let ((code (push-row robot (first (operation-arguments operation)))))
            (if code
                (fail-with operation code)
                (go-on-now operation 'step-on)))))))

(define-command robot-push (operation (robot robot)
                            (direction direction "where to go; north is up in pictures"))
    ()
    ((:family :moving) (:delay 1) (:traits :drives)
     (:arguments keyword-of-direction)
     (:errors (:robot-blocked "Robot is blocked")
              (:not-moving "Robot cannot move: its speed is 0")
              (:too-slow "Robot cannot turn and drive a cell in the time of a step")
              (:push-stuck "Robot cannot push: a wall, a door or a robot is behind what it pushes"
               "What the robot would push, one thing or a row, cannot slide on."
               "Push from another side.")
              (:too-heavy "Robot cannot push: what is in its way is too heavy"
               "The things in a row, with what is inside them, weigh more than push-strength*."
               "Raise push-strength*, or push fewer things at once."))
     (:report () (phrase "Robot pushed ~(~A~)" (first (operation-arguments operation)))))
    "Step to the middle of the next cell in DIRECTION as ROBOT-STEP does, and push what bars the
way: the things in the next cell that bar movement slide one cell on, with the row of such things
behind them. They may weigh PUSH-STRENGTH* together. Where nothing bars the way, this is a step."
  (begin-step operation robot direction 'push-on))

(addition (robot-push :ars :nisp))
