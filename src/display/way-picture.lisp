;;;; way-picture.lisp -- a map with ways drawn on it, in a file.

(in-package :ars-magna.display)

;;; Ways as points.

(defun coordinates-of (point)
  "Return the coordinates of POINT, a PT or a list (x y), as a list in pixels."
  (list (to-pixels (if (pt-p point) (pt-x point) (first point)))
        (to-pixels (if (pt-p point) (pt-y point) (second point)))))

(defun draw-ways-on-map (canvas ways)
  (draw-way-lines canvas (loop for way in ways for position from 0
                               collect (make-way-line position
                                                      (list (mapcan #'coordinates-of way)))))
  (draw-way-marks canvas
                  (loop for way in ways for position from 0
                        for color = (turn-ink position)
                        collect `(draw-start ,@(coordinates-of (first way)) ,color)
                        collect `(draw-goal ,@(coordinates-of (first (last way))) ,color))))

(defun way-p (way)
  (and (consp way) (proper-list-p way)
       (every (lambda (point) (or (pt-p point) (number-pair-p point))) way)))

(defun check-ways (ways)
  (when (and (proper-list-p ways) (member nil ways))
    (reject-argument 'save-way-picture 'ways ways
                     (format nil "a list of ways. There is a NIL in it, which FIND-WAY returns ~
                                  where there is no way: leave that out")))
  (check-argument save-way-picture ways (and (proper-list-p ways) (every #'way-p ways))
                  "a list of ways, each a list of PTs or of lists (x y)"))

(defun point-on-map-p (point map)
  (destructuring-bind (x y) (if (pt-p point) (list (pt-x point) (pt-y point)) point)
    (and (<= 0 x (map-width map)) (<= 0 y (map-height map)))))

(defun check-ways-on (map ways)
  (dolist (way ways)
    (dolist (point way)
      (unless (point-on-map-p point map)
        (reject-argument 'save-way-picture 'ways point
                         (format nil "ways on the map ~A, with x from 0 to ~D and y from 0 to ~D"
                                 (drawn-name (map-name map)) (map-width map) (map-height map)))))))

(defun ways-entries (ways)
  (append (loop for nil in ways for number from 0
                collect (let ((position number))
                          (sample-of-name (canvas x y)
                              ((format nil "way~:[~; ~D~]" (rest ways) (1+ position)) "" 38)
                            (draw-way-sample canvas (list (- x 18) y (+ x 18) y)
                                             (turn-ink position) position))))
          (and ways (list (sample-of (canvas x y) "start" (draw-start canvas x y black*))
                          (sample-of (canvas x y) "end" (draw-goal canvas x y black*))))))

(defun snapshot-of-map (map)
  "Return a snapshot of the current world, if that is of MAP, or else of MAP with nothing in it."
  (let ((simulation *simulation*))
    (if (and simulation (eq map (world-map (simulation-world simulation))))
        (asking (simulation) (take-snapshot (simulation-world simulation)))
        (make-snapshot :map map))))

(defun way-picture-text (snapshot ways &key layers in-color scale title)
  (let ((more (ways-entries ways)))
    (with-output-to-string (stream)
      (with-map-svg (canvas stream snapshot :layers layers :in-color in-color :scale scale)
        (draw-framed canvas snapshot layers
                     (lambda ()
                       (draw-terrain canvas (snapshot-map snapshot) :layers layers)
                       (draw-ways-on-map canvas ways)
                       (draw-movers canvas snapshot layers))
                     :title title :more more)))))

(addition save-way-picture)
(define-with-keywords save-way-picture
    (map ways file &key title (layers *picture-layers*) (in-color t) scale)
  "Save in FILE, replacing it, a picture of MAP, a map or the name of one, and of WAYS in it: a
list of ways, each a list of PTs or of lists (x y), as FIND-WAY returns it. If the current
simulation is in MAP, its things and robots are shown as they are now. TITLE, a string, stands
above. FILE and the other arguments are those of SAVE-PICTURE. Return the file's truename. Signals
WRONG-ARGUMENT, UNKNOWN-NAME, and MISUSE without the program that PNG needs."
  (check-ways ways)
  (check-map-options 'save-way-picture :title title :layers layers :scale scale)
  (let* ((map (find-map map)) (kind (picture-kind 'save-way-picture file)))
    (check-ways-on map ways)
    (save-svg (telling-what-breaks
                (way-picture-text (snapshot-of-map map) ways
                                  :layers layers :in-color in-color :scale scale
                                  :title (or title (drawn-name (map-name map)))))
              file kind)))
