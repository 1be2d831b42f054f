;;;; history.lisp -- what pictures show of the past: where robots went, what cameras last saw.

(in-package :ars-magna.display)

;;; A history is kept by an observer of its simulation from when somebody first asks for it. Its
;;; lists only ever grow at the front, so a snapshot may share them.

(defstruct (trail (:copier nil))
  "Where a robot has been: POINTS is a list x y x y ..., newest first; X, Y is the newest."
  (points '() :type list)
  (count 0 :type fixnum)
  (x -1d9 :type double-float)
  (y -1d9 :type double-float))

(defstruct (look (:constructor make-look (view x y ends)) (:copier nil))
  "What a camera's last view came from: rays from X, Y to ENDS, a list x y x y ...."
  (view '() :type list :read-only t)
  (x 0d0 :type double-float :read-only t)
  (y 0d0 :type double-float :read-only t)
  (ends '() :type list :read-only t))

(defstruct (history (:copier nil))
  "The past of one simulation, as far as pictures show it."
  ;; Robots and cameras come in small numbers: association lists.
  (trails '() :type list)
  (looks '() :type list))

(define-constant +trail-length+ 4000 :documentation "How many points of a trail are kept.")
(define-constant +trail-step+ 0.1d0
  :documentation "How far apart the points of a trail are at least, in metres.")

(defmacro entry-of (key place new)
  "Return what KEY has in the association list in PLACE, entering NEW if it has nothing."
  `(or (cdr (assoc ,key ,place :test #'eq))
       (cdr (first (push (cons ,key ,new) ,place)))))

(defun extend-trail (trail x y)
  (setf (trail-x trail) x
        (trail-y trail) y
        (trail-points trail) (list* x y (trail-points trail)))
  (when (> (incf (trail-count trail)) (* 2 +trail-length+))
    (setf (trail-points trail) (subseq (trail-points trail) 0 (* 2 +trail-length+))
          (trail-count trail) +trail-length+)))

(defun note-position (trail robot)
  "Note where ROBOT is, if it has moved; this runs in every tick."
  (declare #.*hot* (type trail trail) (type robot robot))
  (unless (< (+ (abs (- (robot-x robot) (trail-x trail)))
                (abs (- (robot-y robot) (trail-y trail))))
             +trail-step+)
    (extend-trail trail (robot-x robot) (robot-y robot))))

;;; Looks.

(declaim (inline ray-end))
(defun ray-end (map opaque-p x y angle)
  "Return, as two values, where what a camera at X, Y can see of MAP in direction ANGLE ends.
OPAQUE-P is a function of the index of a cell."
  (declare (type function opaque-p))
  (let* ((dx (cos angle)) (dy (sin angle))
         (end (walk-grid (lambda (index at column)
                           (declare (ignore at column))
                           (funcall opaque-p index))
                         (map-width map) (map-height map) x y dx dy +no-limit+)))
    (values (+ x (* end dx)) (+ y (* end dy)))))

(defun world-ray-end (world x y angle)
  (let ((flags (world-flags world)))
    (ray-end (world-map world) (lambda (index) (logtest +opaque+ (aref flags index))) x y angle)))

(defun look-of (camera)
  "Return the look that CAMERA's last view comes from, if it was taken where CAMERA is now."
  (let* ((robot (camera-robot camera))
         (x (robot-x robot)) (y (robot-y robot))
         (count (min 60 (camera-resolution camera)))
         (width (camera-field-of-view camera))
         (first (- (+ (robot-angle robot) (camera-angle camera))
                   (* 0.5d0 (- width (/ width count))))))
    (make-look (camera-last-view camera) x y
               (loop for ray below count
                     append (multiple-value-list
                             (world-ray-end (robot-world robot) x y
                                      (+ first (* ray (/ width count)))))))))

(defun note-look (history camera)
  (declare #.*hot* (type history history) (type camera camera))
  (let ((entry (assoc camera (history-looks history) :test #'eq)))
    (unless (or (eq (camera-last-view camera) (and entry (look-view (cdr entry))))
                (null (robot-cell-index (camera-robot camera))))
      (let ((look (look-of camera)))
        (if entry
            (setf (cdr entry) look)
            (push (cons camera look) (history-looks history)))))))

;;; Keeping.

(defun note-moment (history simulation)
  "Let HISTORY know of what is so in SIMULATION now."
  (declare #.*hot* (type history history))
  (dolist (robot (simulation-robots simulation))
    (declare (type robot robot))
    (note-position (entry-of robot (history-trails history) (make-trail)) robot)
    (loop for camera across (robot-cameras robot) do (note-look history camera))))

(defvar *histories* (make-hash-table :test #'eq :weakness :key :synchronized t)
  "From simulations to pairs of their history and the observer that keeps it.")

(defun history-of (simulation)
  "Return the history that is kept of SIMULATION, or NIL."
  (car (gethash simulation *histories*)))

(addition keep-history)
(defun keep-history (&optional (simulation (current-simulation)))
  "From now on keep a history of SIMULATION, so that its pictures can show the trails of robots and
the rays of the last looks. Return it."
  (or (history-of simulation)
      (let* ((history (make-history))
             (observer (lambda (simulation) (note-moment history simulation))))
        (setf (gethash simulation *histories*) (cons history observer))
        (asking (simulation)
          (note-moment history simulation)
          (add-observer observer simulation))
        history)))

(defun follow-rewind (old new)
  "Keep a history of NEW, which is to go on in the place of OLD, if one is kept of that."
  (let ((entry (gethash old *histories*)))
    (when entry
      (remhash old *histories*)
      (remove-observer (cdr entry) new)
      (keep-history new))))

(pushnew 'follow-rewind *rewind-hooks*)
