;;;; camera.lisp -- an agent of Tileworld with tiles that sees by its camera.

(in-package :ars-testbeds.tiles)
(in-readtable :nisp)

;;; The law of the world is the same. A look takes some ticks, one more for each thing that it
;;; finds. The agent looks, chooses a hole and fills it. Meanwhile it sees nothing new; if its way
;;; is barred, it looks again. Cells are numbers, as for planning; a hole that was seen is a list
;;; (id score cell...).

(defun seen-cell (designator)
  (let ((angle (+ (robot-angle pusher) (designator-angle designator)))
        (distance (designator-distance designator)))
    (+ (* 16 (floor (+ (robot-y pusher) (* distance (sine angle)))))
       (floor (+ (robot-x pusher) (* distance (cosine angle)))))))

(defun look (specification then)
  "Look for things that fit SPECIFICATION, far and near. Call THEN with a list of designators."
  (flet ((look-for (type then)
           (camera-get-all-object-designators
            (robot-camera pusher 0) type specification
            (continuation (err camera designators)
              (unless (eq err :interrupt) (funcall then designators))))))
    (look-for :non-local
              (lambda (far)
                (look-for :local (lambda (near) (funcall then (append near far))))))))

(defun seen-holes (designators)
  "Return the holes of whose cells DESIGNATORS are."
  (let ((holes '()))
    (dolist (designator designators holes)
      (flet ((seen (name) (second (assoc name (designator-data designator)))))
        (let ((hole (assoc (seen :hole) holes)))
          (if hole
              (push (seen-cell designator) (cddr hole))
              (push (list (seen :hole) (seen :score) (seen-cell designator)) holes)))))))

(defun steps-between (cell other)
  (multiple-value-bind (row column) (floor cell 16)
    (multiple-value-bind (other-row other-column) (floor other 16)
      (+ (abs (- row other-row)) (abs (- column other-column))))))

(defun steps-to-hole (hole cell)
  (loop for goal in (cddr hole) minimize (steps-between goal cell)))

(defun utility-by-sight (hole tiles)
  "Return the likely value of HOLE, as UTILITY does. TILES are cells, the nearest first."
  (let ((count (length (cddr hole))))
    (if (< (length tiles) count)
        0
        (/ (second hole)
           (+ (steps-to-hole hole (agent-cell))
              (* 2 (loop repeat count
                         for tile in tiles sum (steps-to-hole hole tile))))))))

(defun way-by-sight (hole holes tiles obstacles)
  "Return the shortest way to push one of the first three of TILES into HOLE, a list (way tile), or
NIL."
  (let ((pits (pit-bits (loop for other in holes
                              unless (eq other hole) append (cddr other)))))
    (first (sort (loop repeat 3
                       for tile in tiles
                       for solid = (solid-bits (append obstacles (remove tile tiles)))
                       for way = (plan-way tile (cddr hole) solid pits)
                       when way collect (list way tile))
                 #'< :key (lambda (it) (length (first it)))))))

(defun nearest-first (tiles hole)
  (stable-sort (copy-list tiles) #'< :key (lambda (tile) (steps-to-hole hole tile))))

(defun follow-way (way then)
  "Go along WAY, a list of directions; then, or if the way is barred, call THEN with an error code."
  (if way
      (push-to (first way) (lambda (err)
                             (if err (funcall then err) (follow-way (rest way) then))))
      (funcall then nil)))

(defun fill-by-sight (hole holes tiles obstacles)
  "Push tiles into the cells of HOLE until it is full or nothing can be done; then look again."
  (destructuring-bind (&optional way tile)
      (and (cddr hole) (way-by-sight hole holes (nearest-first tiles hole) obstacles))
    (if way
        (follow-way way (lambda (err)
                          (if err
                              (by-utility-camera)
                              (fill-by-sight (without-cell (cell-ahead way) hole) holes
                                             (remove tile tiles) obstacles))))
        (by-utility-camera))))

(defun without-cell (cell hole)
  (list* (first hole) (second hole) (remove cell (cddr hole))))

(defun cell-ahead (way)
  "Return the cell before the agent, which has gone along WAY."
  (+ (agent-cell) (rest (assoc (first (last way)) *directions*))))

(defun go-by-sight (holes tiles obstacles)
  "Think about HOLES, then fill the best that can be filled."
  (flet ((worth (hole) (utility-by-sight hole (nearest-first tiles hole)))
         (fillable-p (hole) (way-by-sight hole holes (nearest-first tiles hole) obstacles)))
    (spend-steps (* deliberation-time* (length holes))
                 (lambda ()
                   (let ((hole (find-if #'fillable-p (stable-sort (copy-list holes) #'>
                                                                  :key #'worth))))
                     (if hole
                         (fill-by-sight hole (remove hole holes) tiles obstacles)
                         (spend-steps 1 #'by-utility-camera)))))))

(defun by-utility-camera ()
  (look '((:hole (1 1000000)) (:score (0 1000)))
        (lambda (holes)
          (look '((:color blue))
                (lambda (tiles)
                  (look '((:color red))
                        (lambda (obstacles)
                          (go-by-sight (seen-holes holes) (mapcar #'seen-cell tiles)
                                       (mapcar #'seen-cell obstacles)))))))))
