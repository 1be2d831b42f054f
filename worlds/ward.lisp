;;;; ward.lisp -- draws the floor worlds/floors/ward.yaml, as a robot's scanner would see a ward.

;;; A floor to import if you have none: thirteen metres by ten, a corridor between five rooms, a
;;; pixel for each tenth of a metre. Walls are two pixels thick and doorways ten wide. There are the
;;; errors of a real scanner: some pixels beside walls are occupied, some in walls are missing, and
;;; the areas behind walls and inside a cupboard are unknown. The same code makes the same bytes.

(in-package :ars-worlds)

(defparameter *ward-rooms*
  '((8 8 49 39) (48 8 89 39) (88 8 121 39) (8 60 71 91) (70 60 121 91) (8 38 121 61))
  "Lists (x0 y0 x1 y1): the rooms of the ward, then its corridor, from outer wall to outer wall.")

(defparameter *ward-doors*
  '((20 38 29 39) (60 38 69 39) (100 38 109 39) (30 60 39 61) (90 60 99 61))
  "Lists (x0 y0 x1 y1): the doorways.")

(defparameter *ward-furniture*
  '((12 14 13 15) (24 14 25 15) (12 26 13 27) (24 26 25 27) (56 11 78 12) (104 12 105 13)
    (104 22 105 23) (14 86 28 88) (112 66 119 80) (78 84 79 85) (86 84 87 85))
  "Lists (x0 y0 x1 y1): the furniture as the scanner sees it.")

(defun in-box-p (x y box)
  (destructuring-bind (x0 y0 x1 y1) box
    (and (<= x0 x x1) (<= y0 y y1))))

(defun in-wall-of-room-p (x y room)
  "True if the pixel (X, Y) is in a wall of ROOM; walls are two pixels thick."
  (destructuring-bind (x0 y0 x1 y1) room
    (and (in-box-p x y room)
         (not (in-box-p x y (list (+ x0 2) (+ y0 2) (- x1 2) (- y1 2)))))))

(defun ward-occupied-p (x y)
  "True if there is a wall or furniture at the pixel (X, Y) of the ward."
  (flet ((at-p (box) (in-box-p x y box)))
    (or (some #'at-p *ward-furniture*)
        (and (notany #'at-p *ward-doors*)
             (some (lambda (room) (in-wall-of-room-p x y room)) *ward-rooms*)))))

(defun ward-scanned-p (x y)
  "True if the scanner has seen the pixel (X, Y), which is not behind walls or in the cupboard."
  (and (in-box-p x y '(8 8 121 91))
       (not (in-box-p x y '(113 67 119 79)))))

(defun beside-ward-wall-p (x y)
  (loop for (dx dy) in '((1 0) (-1 0) (0 1) (0 -1))
           thereis (ward-occupied-p (+ x dx) (+ y dy))))

(defun ward-pixel (x y dice)
  "Return the scanner's value for the pixel (X, Y): T for occupied, NIL for free, or UNKNOWN."
  (cond ((not (ward-scanned-p x y)) 'unknown)
        ((ward-occupied-p x y) (if (chance 1/25 dice) 'unknown t))
        ((beside-ward-wall-p x y) (chance 1/12 dice))
        (t nil)))

(defun ward-clauses ()
  "Return the clauses of a map with a cell for each pixel of the ward."
  (let ((dice (ars-magna.base:make-dice 1992)))
    (loop for y below 100
             append (loop for x below 130
                             for pixel = (ward-pixel x y dice)
                             when pixel
                             collect `(wall (,x ,y) (,x ,y)
                                            ,@(if (eq pixel 'unknown) '(glass 5) '(plaster 60)))))))

(defun save-ward-picture (yaml file ends scale &rest options)
  "Import YAML with OPTIONS. Save a picture of the map, with a way between the two ENDS, in FILE."
  (apply #'import-map yaml :name 'pictured-ward :unknown 'glass options)
  (save-way-picture 'pictured-ward (list (apply #'find-way 'pictured-ward ends)) file
                    :title "ward" :scale scale)
  (undefine 'map 'pictured-ward))

(defun write-ward-files (directory)
  "Write ward.yaml and its image into DIRECTORY, and pictures of two maps imported from ward.yaml."
  (eval `(defmap ward-drawing (130 100 :frame (1/10 -13/2 -5 0)) ,@(ward-clauses)))
  (flet ((file (name) (merge-pathnames name directory)))
    (export-map 'ward-drawing (file "ward.yaml") :unknown 'glass)
    (undefine 'map 'ward-drawing)
    (save-ward-picture (file "ward.yaml") (file "ward.svg") '((20 20) (95 70)) 4)
    (save-ward-picture (file "ward.yaml") (file "ward-coarse.svg") '((2 2) (9.5 7)) 40
                       :cell 1 :share 1/8)))
