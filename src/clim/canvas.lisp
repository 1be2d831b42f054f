;;;; canvas.lisp -- a canvas that is a sheet, or a pixmap, of CLIM.

(in-package :ars-magna.clim)

;;; It records in which boxes the subjects were drawn, so that a click finds them. Partial arcs are
;;; drawn as lines, because CLIM counts angles in its own way.

(defclass clim-canvas (canvas)
  ((medium :initarg :medium :reader canvas-medium)
   ;; What was drawn where, as far as it is visible: lists (subject left top right bottom).
   (subjects :initform '() :accessor canvas-subjects)
   ;; The box drawn in so far, or NIL outside of subjects.
   (reach :initform nil :accessor canvas-reach)
   ;; How many screen pixels wide one of its pixels is.
   (magnification :initarg :magnification :initform 1 :reader canvas-magnification)
   ;; The height of what it paints on, in pixels, if text cut there is left out; or NIL.
   (bottom :initarg :bottom :initform nil :reader canvas-bottom)
   ;; The visible box (left top right bottom) of what it paints on, or NIL: all.
   (seen :initform nil :accessor canvas-seen)
   (dx :initform 0 :accessor canvas-dx)
   (dy :initform 0 :accessor canvas-dy))
  (:documentation "A canvas that paints on a CLIM medium."))

;;; CLIM magnifies the positions of lines and letters, but not their thickness and size.

(defun clim-line-thickness (canvas gcontext)
  "Return the thickness of lines that GCONTEXT draws on CANVAS, in screen pixels."
  (* (canvas-magnification canvas) (max 1 (gcontext-line-width gcontext))))

(defun clim-line-dashes (canvas gcontext)
  "Return a list of the dashes and gaps of GCONTEXT in screen pixels, or NIL for solid lines."
  (let ((dashes (gcontext-dashes gcontext)))
    (unless (eq :solid (gcontext-line-style gcontext))
      (loop for length in (if (listp dashes) dashes (list dashes dashes))
            collect (* (canvas-magnification canvas) length)))))

(defun clim-drawing-options (canvas gcontext fill-p)
  "Return CLIM's options for drawing a shape, filled if FILL-P, as GCONTEXT says. Filled shapes need
no line style; setting one takes time."
  (list* :filled (and fill-p t) :ink (clim-ink (gcontext-foreground gcontext))
         (unless fill-p
           (list :line-thickness (clim-line-thickness canvas gcontext)
                 :line-dashes (clim-line-dashes canvas gcontext)))))

(defun extend-bounding-box (canvas left top right bottom)
  (let ((reach (canvas-reach canvas)))
    (when reach
      (setf (canvas-reach canvas)
            (list (min (first reach) left) (min (second reach) top)
                  (max (third reach) right) (max (fourth reach) bottom))))))

(defun extend-bounding-box-over-points (canvas points)
  (when (canvas-reach canvas)
    (loop for (x y) on points by #'cddr
          minimize x into left minimize y into top
          maximize x into right maximize y into bottom
          finally (when points (extend-bounding-box canvas left top right bottom)))))

;;; Painting.

(defun corners-of-rectangles (rectangles)
  "Return RECTANGLES, a sequence x y width height ..., as a list left top right bottom ...."
  (loop for (x y width height) on (coerce rectangles 'list) by #'cddddr
        append (list x y (+ x width) (+ y height))))

(defmethod paint-rectangles ((canvas clim-canvas) gcontext rectangles fill-p)
  (let ((corners (corners-of-rectangles rectangles)))
    (extend-bounding-box-over-points canvas corners)
    (apply #'clim:draw-rectangles* (canvas-medium canvas) corners
           (clim-drawing-options canvas gcontext fill-p))))

(defun arc-points (x y width height start extent)
  "Return points x y ... along an arc, so close together that the arc looks round."
  (let* ((across (/ width 2)) (down (/ height 2))
         (count (max 4 (ceiling (* (abs extent) (sqrt (max 1 across down)))))))
    (loop for index from 0 to count
          for angle = (+ start (* extent (/ index count)))
          collect (+ x across (* across (cosine angle)))
          collect (- (+ y down) (* down (sine angle))))))

(defun paint-ellipse (canvas gcontext x y width height fill-p)
  (apply #'clim:draw-ellipse* (canvas-medium canvas) (+ x (/ width 2)) (+ y (/ height 2))
         (/ width 2) 0 0 (/ height 2) (clim-drawing-options canvas gcontext fill-p)))

(defun box-for-outline (x y width height thickness)
  "Return the box, as values x, y, width and height, along which an outline of THICKNESS must be
drawn to stay inside the box X, Y, WIDTH, HEIGHT."
  (let ((inset (/ (1- thickness) 2)))
    (values (+ x inset) (+ y inset)
            (max 1 (- width thickness)) (max 1 (- height thickness)))))

(defmethod paint-arc ((canvas clim-canvas) gcontext x y width height start extent fill-p)
  (extend-bounding-box canvas x y (+ x width) (+ y height))
  (if fill-p
      (paint-arc-in-box canvas gcontext x y width height start extent t)
      (multiple-value-bind (x y width height)
          (box-for-outline x y width height (max 1 (gcontext-line-width gcontext)))
        (paint-arc-in-box canvas gcontext x y width height start extent nil))))

(defun paint-arc-in-box (canvas gcontext x y width height start extent fill-p)
  (if (>= (abs extent) (- (* 2 pi) 1d-9))
      (paint-ellipse canvas gcontext x y width height fill-p)
      (let ((points (arc-points x y width height start extent)))
        (paint-path canvas gcontext
                    (if fill-p (list* (+ x (/ width 2)) (+ y (/ height 2)) points) points)
                    fill-p))))

(defmethod paint-path ((canvas clim-canvas) gcontext points fill-p)
  (let ((points (coerce points 'list)))
    (extend-bounding-box-over-points canvas points)
    (apply #'clim:draw-polygon* (canvas-medium canvas) points :closed (and fill-p t)
           (clim-drawing-options canvas gcontext fill-p))))

(defmethod paint-segments ((canvas clim-canvas) gcontext segments)
  (let ((points (coerce segments 'list)))
    (extend-bounding-box-over-points canvas points)
    (clim:draw-lines* (canvas-medium canvas) points
                      :ink (clim-ink (gcontext-foreground gcontext))
                      :line-thickness (clim-line-thickness canvas gcontext)
                      :line-dashes (clim-line-dashes canvas gcontext))))

(defun text-fully-visible-p (canvas y)
  (let ((bottom (canvas-bottom canvas)) (y (+ y (canvas-dy canvas))))
    (or (null bottom) (<= 10 y (- bottom 3)))))

(defmethod paint-string ((canvas clim-canvas) gcontext x y string)
  (extend-bounding-box canvas x (- y 10) (+ x (* +character-width+ (length string))) (+ y 3))
  (when (text-fully-visible-p canvas y)
    (if (plain-text-p string)
        (draw-characters canvas gcontext x y string)
        (paint-each-character canvas gcontext x y string))))

(defgeneric colored-text-p (port)
  (:documentation "True if PORT draws text in the right colours. McCLIM does so only on screens of
24 bits per pixel or more.")
  (:method (port) (declare (ignore port)) t)
  (:method ((port clim-clx:clx-port))
    (let ((screen (xlib:display-default-screen (clim-clx:clx-port-display port))))
      (<= 24 (xlib:screen-root-depth screen)))))

(defun text-ink (canvas gcontext)
  (if (colored-text-p (clim:port (canvas-medium canvas)))
      (clim-ink (gcontext-foreground gcontext))
      clim:+black+))

(defun column-text-style (canvas)
  (text-style :fix :roman +column-font-size+ (canvas-magnification canvas)))

(defun draw-characters (canvas gcontext x y string &optional (style (column-text-style canvas)))
  (clim:draw-text* (canvas-medium canvas) string x y
                   :text-style style :ink (text-ink canvas gcontext)))

(defun text-style-for-character (canvas character)
  "Return the text style to draw CHARACTER in on CANVAS. Say so in the window if there is no font."
  (let ((medium (canvas-medium canvas)) (standard (column-text-style canvas)))
    (when (and (null (font-for character)) (typep medium 'display-pane))
      (report-missing-character (window-of medium) character))
    (or (fallback-text-style (clim:port medium) character (clim:text-style-size standard)
                             (* (canvas-magnification canvas) +character-width+
                                (max 1 (ars-magna.cli:char-columns character))))
        standard)))

(defun paint-each-character (canvas gcontext x y string)
  "Paint STRING, each character in a font that has it. Wide characters take two columns."
  (loop for character across string
        for at = x then (+ at width)
        for width = (* +character-width+ (ars-magna.cli:char-columns character))
        do (draw-characters canvas gcontext at y
                            (if (< +greatest-drawable-code+ (char-code character))
                                +box-in-place-of-character+
                                (string character))
                            (text-style-for-character canvas character))))

(defmethod paint-text ((canvas clim-canvas) gcontext x y string size anchor upward-p bold-p)
  (declare (ignore upward-p))
  (let* ((size (max size +label-size+)) (width (text-width string size bold-p))
         (left (- x (ecase anchor (:start 0) (:middle (/ width 2)) (:end width)))))
    (extend-bounding-box canvas left (- y size) (+ left width) (+ y 3))
    (cond ((not (text-fully-visible-p canvas y)))
          ((plain-text-p string)
           (clim:draw-text* (canvas-medium canvas) string x y
                            :align-x (ecase anchor (:start :left) (:middle :center) (:end :right))
                            :text-style (text-style :sans-serif (if bold-p :bold :roman) size
                                                    (canvas-magnification canvas))
                            :ink (text-ink canvas gcontext)))
          (t (paint-each-character canvas gcontext left y string)))))

(defmethod character-width ((canvas clim-canvas) size)
  (* 61/100 (max size +label-size+)))

;;; Where.

(defun box-on-medium (canvas left top right bottom)
  (let ((dx (canvas-dx canvas)) (dy (canvas-dy canvas)))
    (list (+ dx left) (+ dy top) (+ dx right) (+ dy bottom))))

(defun visible-part (canvas box)
  "Return the part of BOX that CANVAS shows, or NIL. Both are in coordinates of the medium."
  (if (canvas-seen canvas)
      (destructuring-bind ((left top right bottom) (from-x from-y to-x to-y))
          (list box (canvas-seen canvas))
        (and (< from-x right) (< left to-x) (< from-y bottom) (< top to-y)
             (list (max left from-x) (max top from-y) (min right to-x) (min bottom to-y))))
      box))

(defmethod call-with-clipping (function (canvas clim-canvas) x y width height)
  (let* ((reach (shiftf (canvas-reach canvas) nil)) (right (+ x width)) (bottom (+ y height))
         (seen (canvas-seen canvas)))
    (setf (canvas-seen canvas) (or (visible-part canvas (box-on-medium canvas x y right bottom))
                                   '(0 0 -1 -1)))
    (unwind-protect
         (clim:with-drawing-options ((canvas-medium canvas)
                                     :clipping-region (clim:make-rectangle* x y right bottom))
           (funcall function))
      (setf (canvas-reach canvas) reach
            (canvas-seen canvas) seen)
      (extend-bounding-box canvas x y right bottom))))

(defmethod call-with-origin (function (canvas clim-canvas) x y)
  (incf (canvas-dx canvas) x)
  (incf (canvas-dy canvas) y)
  (unwind-protect
       (clim:with-translation ((canvas-medium canvas) x y)
         (funcall function))
    (decf (canvas-dx canvas) x)
    (decf (canvas-dy canvas) y)))

;;; What is where.

(defmethod call-with-subject (function (canvas clim-canvas) subject)
  (let ((outer (canvas-reach canvas)))
    (setf (canvas-reach canvas) (list 1d9 1d9 -1d9 -1d9))
    (multiple-value-prog1 (funcall function)
      (destructuring-bind (left top right bottom) (canvas-reach canvas)
        (setf (canvas-reach canvas) outer)
        (extend-bounding-box canvas left top right bottom)
        (let ((box (visible-part canvas (box-on-medium canvas left top right bottom))))
          (when box (push (cons subject box) (canvas-subjects canvas))))))))

(defconstant +subject-tolerance+ 3
  "The number of pixels by which a click may miss what it selects.")

(defun subjects-at (subjects x y)
  "Return the objects drawn at X, Y or close to that point, the smallest first. SUBJECTS are lists
(object left top right bottom) of what was drawn on a canvas."
  (let ((found (loop for (subject left top right bottom) in subjects
                     when (and (<= (- left +subject-tolerance+) x (+ right +subject-tolerance+))
                               (<= (- top +subject-tolerance+) y (+ bottom +subject-tolerance+)))
                       collect (cons (* (- right left) (- bottom top)) subject))))
    (cl:map 'list #'cdr (stable-sort found #'< :key #'car))))

(defun subject-at (subjects x y)
  "Return the smallest object of SUBJECTS drawn at X, Y or close to that point, or NIL."
  (first (subjects-at subjects x y)))
