;;;; task-tree.lisp -- the tree of running tasks as a picture.

(in-package :ars-magna.rpl-pictures)

(export '(draw-task-tree fold-mark))

(defconstant +indent+ 12 "The indentation of the parts of a task, in pixels.")
(defconstant +greatest-indented-depth+ 14
  "The greatest depth to which parts of tasks are indented.")
(defconstant +task-mark-size+ 9 "The width of the mark for the state of a task, in pixels.")

(defparameter *task-looks*
  '((:running #x1E8232 "runs") (:waiting #x3C64B4 "waits") (:blocked #x6E6E78 "is blocked")
    (:cleaning #xAF6400 "cleans up") (:ending #xC8281E "ends")
    (:stepped #x8C3CB4 "stops at each expression"))
  "Lists (look color text): the colour and the legend text of the mark for each state of a task.")

(define-record (fold-mark (:constructor make-fold-mark (serial folded-p)))
  "The triangle on which a click folds or unfolds the parts of a task."
  (serial 0 fixnum "the number of the task whose parts a mark folds away" :export)
  (folded-p nil boolean "the parts are to be folded away"))

(defmethod subject-title ((mark fold-mark))
  (format nil "~:[Fold the parts of task ~D away~;Show the parts of task ~D~]"
          (fold-mark-folded-p mark) (fold-mark-serial mark)))

(defmethod subject-title ((image task-image))
  (format nil "Task ~D ~A: ~A~@[, waits for ~A since tick ~D~]" (task-image-serial image)
          (or (task-image-name image) (task-image-form image))
          (task-image-state image) (task-image-awaits image) (task-image-since image)))

;;; Marks.

(defun draw-task-mark (canvas look x y)
  "Draw the mark of a task with LOOK at X, Y, +TASK-MARK-SIZE+ pixels wide and high. Each look has a
different shape, so that colours are not needed."
  (let* ((size +task-mark-size+) (right (+ x size)) (low (+ y size)) (middle (floor size 2)))
    (ecase look
      (:running (draw-lines canvas draw-gcontext* (list x y right (+ y middle) x low) :fill-p t))
      (:waiting (draw-arc canvas draw-gcontext* x y size size 0 (* 2 pi)))
      (:blocked (draw-rectangle canvas draw-gcontext* x y size size t))
      (:cleaning (draw-lines canvas draw-gcontext*
                             (list (+ x middle) y right (+ y middle) (+ x middle) low x
                                   (+ y middle))
                             :fill-p t))
      (:ending (draw-segments canvas draw-gcontext* (list x y right low x low right y)))
      (:stepped (draw-rectangle canvas draw-gcontext* x y (1- size) (1- size))))))

(defun draw-fold-mark (canvas image x y)
  "Draw the triangle that folds the parts of the task of IMAGE at X, Y. It points down, or to the
right if the parts are folded."
  (let ((folded-p (task-image-folded-p image)))
    (with-subject (canvas (make-fold-mark (task-image-serial image) folded-p))
      (with-color #x404048
        (draw-lines canvas draw-gcontext*
                    (if folded-p
                        (list x y x (+ y 8) (+ x 6) (+ y 4))
                        (list (- x 1) (+ y 1) (+ x 7) (+ y 1) (+ x 3) (+ y 7)))
                    :fill-p t)))))

;;; Rows.

(defun task-line-text (image)
  (format nil "~D ~@[~A ~]~A~@[  (~D part~:P folded)~]" (task-image-serial image)
          (task-image-name image) (task-image-form image)
          (and (task-image-folded-p image) (task-image-parts image))))

(defun task-condition-text (image)
  "Return a text about the wait or the state of the task of IMAGE, or NIL if its mark says enough."
  (cond ((task-image-awaits image)
         (format nil "waits for ~A since tick ~D~:[, ~A~;~]" (task-image-awaits image)
                 (task-image-since image)
                 (string= "waiting" (task-image-state image)) (task-image-state image)))
        ((member (task-image-look image) '(:waiting :running)) nil)
        (t (task-image-state image))))

(defun draw-name-and-state (canvas image x y width)
  "Write the name, expression and state of the task of IMAGE at X, Y. Return the number of lines."
  (let* ((head (task-line-text image)) (plight (task-condition-text image))
         (room (max 8 (floor (- width x) +character-width+)))
         (one-p (and plight (<= (+ 2 (length head) (length plight)) room))))
    (write-text-at canvas x y (cut head room))
    (cond ((null plight) 1)
          (one-p (write-text-at canvas (+ x (* +character-width+ (+ 2 (length head)))) y plight
                                #x505868)
                 1)
          (t (write-text-at canvas (+ x (* 2 +character-width+)) (+ y +line-height+)
                            (cut plight (max 8 (- room 2))) #x505868)
             2))))

(defun draw-calls (canvas image x y width)
  "Write the plan calls in progress in the task of IMAGE, from X, Y down. Return their number."
  (loop for call in (task-image-calls image)
        for line from 0
        for left = (+ x (* +character-width+ (1+ (min line 8))))
        do (write-text-at canvas left (+ y (* line +line-height+))
                          (cut call (max 8 (floor (- width left) +character-width+)))
                          #x505868))
  (length (task-image-calls image)))

(defun draw-task-texts (canvas image x y width)
  "Write all texts about the task of IMAGE from X, Y down. Return the number of lines."
  (let ((lines (draw-name-and-state canvas image x y width)))
    (+ lines (draw-calls canvas image x (+ y (* lines +line-height+)) width))))

(defun draw-task (canvas image y width)
  "Draw the task of IMAGE with its upper edge at Y. Return its height in pixels."
  (let ((x (+ 6 (* +indent+ (min +greatest-indented-depth+ (task-image-depth image))))))
    (prog1 (with-subject (canvas image)
             (with-color (second (assoc (task-image-look image) *task-looks*))
               (with-lines (:width 2)
                 (draw-task-mark canvas (task-image-look image) (+ x 12) (+ y 3))))
             (* +line-height+ (draw-task-texts canvas image (+ x 27) (+ y 12) width)))
      (when (plusp (task-image-parts image))
        (draw-fold-mark canvas image x (+ y 4))))))

;;; The whole.

(defun omitted-tasks-text (image)
  "Return how many tasks the tree IMAGE leaves out, as text; or NIL if it shows all."
  (let ((unseen (- (tree-image-tasks image) (length (tree-image-rows image)))))
    (and (plusp unseen)
         (format nil "~D more task~:P not shown: folded, or beyond the limit." unseen))))

(defun draw-task-tree (canvas image &key (width 640) (top 0))
  "Draw IMAGE, a value of IMAGE-OF-TASKS, on CANVAS, WIDTH pixels wide, from TOP down. Return the y
coordinate of its end, in pixels."
  (let ((y (+ top 4)))
    (write-text-at canvas 6 (+ y 11)
                   (format nil "~D plan~:P, ~D task~:P; as of tick ~D" (tree-image-plans image)
                           (tree-image-tasks image) (tree-image-tick image)))
    (incf y (+ 4 +line-height+))
    (dolist (row (tree-image-rows image)) (incf y (draw-task canvas row y width)))
    (let ((unseen (omitted-tasks-text image)))
      (when unseen
        (write-text-at canvas 6 (+ y 12) unseen #x606060)
        (incf y +line-height+)))
    (+ y 4)))

(defun tree-svg (image)
  (with-output-to-string (stream)
    (with-svg (canvas stream)
      (with-canvas (canvas) (values 640 (draw-task-tree canvas image))))))

(addition save-plan-tree)
(define-with-keywords save-plan-tree
    (file &key runner (most 300))
  "Save in FILE a picture of the running tasks, replacing an older file. The name ends in .svg or,
if the program rsvg-convert is installed, in .png. Each task is below its parent task, with a mark
for its state, its expression, and what it waits for. RUNNER is the plan runner, by default the plan
runner in use. At most MOST tasks are drawn; the others are counted. Return the truename of FILE.
Signals WRONG-ARGUMENT, and MISUSE where no plans have run."
  (check-argument save-plan-tree most (whole-p most 1 1000000) "an integer from 1 to 1000000")
  (let ((kind (picture-kind 'save-plan-tree file))
        (image (call-with-plans-in-use
                (lambda (in-use)
                  (image-of-tasks (or runner in-use (runner-to-show)) :most most)))))
    (save-svg (tree-svg image) file kind)))
