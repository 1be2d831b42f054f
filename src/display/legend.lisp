;;;; legend.lisp -- what a picture of a world shows, each with a sample.

(in-package :ars-magna.display)

(export '(group-by entry-with-sample robot-entry named-entry-with-sample jump-entries))

;;; An entry is a text with a function of a canvas and of X and Y, in pixels. The function draws a
;;; sample around X, Y, at most 16 pixels high and as wide as the entry says.

(defconstant +sample-width+ 18 "The width of most samples, in pixels.")

(defstruct (entry (:constructor make-entry (text sample &key whole (width +sample-width+)))
                  (:copier nil))
  "A legend entry: TEXT beside a sample WIDTH pixels wide. WHOLE is NIL, or the unabridged TEXT."
  (width +sample-width+ :type real :read-only t)
  (text "" :type string :read-only t)
  (sample (constantly nil) :type function :read-only t)
  (whole nil :type (or null string) :read-only t))

(defmacro entry-with-sample ((canvas x y) text &body body)
  "Return a legend entry with TEXT and a sample that BODY draws on CANVAS around X, Y."
  `(make-entry ,text (lambda (,canvas ,x ,y) (declare (ignorable ,canvas ,x ,y)) ,@body)))

(defun named-entry (name sample &optional (more "") (width +sample-width+))
  "Return a legend entry. Its text is the string NAME, abridged if long, followed by the string
MORE. SAMPLE is a function that draws the sample, WIDTH pixels wide."
  (let ((text (short-name name)))
    (make-entry (concatenate 'string text more) sample
                :whole (and (string/= text name) name) :width width)))

(defmacro named-entry-with-sample ((canvas x y) (name &rest more-and-width) &body body)
  "Return a legend entry for NAME with a sample that BODY draws on CANVAS around X, Y.
MORE-AND-WIDTH are optional: a text to append to NAME, and the width of the sample in pixels."
  `(named-entry ,name (lambda (,canvas ,x ,y) (declare (ignorable ,canvas ,x ,y)) ,@body)
                ,@more-and-width))

(defun group-by (objects key)
  "Return the list OBJECTS divided, in order, into lists of objects with equal values of KEY."
  (let ((groups '()))
    (dolist (object objects (mapcar #'reverse (mapcar #'rest (reverse groups))))
      (let* ((value (funcall key object)) (group (assoc value groups :test #'cl:equal)))
        (if group
            (push object (rest group))
            (push (list value object) groups))))))

(defconstant +longest-names+ 32
  "The largest total number of characters of the names beside one sample.")

(defun join-names (texts)
  "Return a text that joins as many of TEXTS as +LONGEST-NAMES+ allows, and counts the others."
  (loop with joined = (first texts)
        for rest on (rest texts)
        for longer = (format nil "~A, ~A" joined (first rest))
        while (<= (length longer) +longest-names+)
        do (setf joined longer)
        finally (return (format nil "~A~@[ and ~D more~]" joined (and rest (length rest))))))

(defun several-names-entry (names sample)
  "Return a legend entry for several NAMES of things that look the same. NAMES are lists (name more)
of two strings. SAMPLE is a function that draws the sample."
  (flet ((texts (function)
           (loop for (name more) in names
                 collect (concatenate 'string (funcall function name) more))))
    (let ((text (join-names (texts #'short-name)))
          (whole (format nil "~{~A~^, ~}" (texts #'identity))))
      (make-entry text sample :whole (and (string/= text whole) whole)))))

;;; Robots.

(defun robot-entry (name position)
  "Return the legend entry for the robot called NAME, at POSITION in its world's list of robots."
  (named-entry-with-sample (canvas x y) (name) (draw-ring canvas x y 6 0 position)))

(defun robot-entries (snapshot)
  (loop for robot in (snapshot-robots snapshot)
        collect (robot-entry (robot-title robot) (robot-image-position robot))))

;;; Walls: the substances, with the range of their parameters.

(defun call-for-shown-cells (function snapshot)
  "Call FUNCTION with the index of each cell in the part of the map that SNAPSHOT shows."
  (destructuring-bind (left top right bottom) (shown-part snapshot)
    (loop with width = (map-width (snapshot-map snapshot))
          for row from top below bottom
          do (loop for index from (+ left (* row width)) below (+ right (* row width))
                   do (funcall function index)))))

(defun parameter-ranges (snapshot)
  "Return a list (number least greatest) for each substance of the walls that SNAPSHOT shows: its
number and the range of its parameters. The lists are sorted by number."
  (let ((map (snapshot-map snapshot)) (ranges '()))
    (flet ((note (index)
             (when (logtest +wall+ (aref (map-flags map) index))
               (let* ((substance (aref (map-substances map) index))
                      (parameter (aref (map-parameters map) index))
                      (range (assoc substance ranges)))
                 (if range
                     (setf (second range) (min parameter (second range))
                           (third range) (max parameter (third range)))
                     (push (list substance parameter parameter) ranges))))))
      (call-for-shown-cells #'note snapshot))
    (sort ranges #'< :key #'first)))

(defun range-text (least greatest)
  (format nil "~A~:[ to ~A~;~]" (number-text least) (= least greatest) (number-text greatest)))

(defconstant +sample-tile+ 6 "The width of tiles of textures in legends, in pixels.")

(defun draw-swatch (canvas x y left right)
  "Draw a sample of two wall cells side by side, with the looks LEFT and RIGHT."
  (with-origin (canvas (- x 9) (- y 6))
    (loop for look in (list left right) for start in '(0 9)
          do (draw-wall-look canvas look (list start 0 9 12) +sample-tile+))))

(defun wall-entries (snapshot)
  (let* ((map (snapshot-map snapshot))
         (materials (materials-of map)) (ranges (parameter-ranges snapshot)))
    (cond ((null ranges) '())
          ((not in-color*)
           (let ((black (make-wall-look black*)))
             (list (entry-with-sample (canvas x y) "wall" (draw-swatch canvas x y black black)))))
          (t (loop for (number least greatest) in ranges
                   collect (wall-entry map number least greatest (svref materials number)))))))

(defun wall-entry (map number least greatest material)
  (named-entry-with-sample (canvas x y)
      ((drawn-name (svref (map-substance-types map) number))
       (format nil " ~A" (range-text least greatest)))
    (draw-swatch canvas x y (wall-look-of material least) (wall-look-of material greatest))))

;;; Places.

(defun shown-place-types (snapshot)
  (let ((map (snapshot-map snapshot)) (numbers '()))
    (call-for-shown-cells (lambda (index) (pushnew (aref (map-places map) index) numbers)) snapshot)
    (loop for type across (map-place-types map) for number from 0
          when (and (member number numbers) (plusp number) (drawn-place-type-p type))
            collect type)))

(defun draw-place-sample (canvas type x y)
  (let ((graphics-scale* 12))
    (draw-place-at canvas type (- x 6) (- y 6))))

(defun place-mark-svg (type)
  "Return an SVG document with the mark of the place type TYPE, to be compared with other marks."
  (let ((color-p in-color*))
    (with-output-to-string (out)
      (with-svg (canvas out :color-p color-p)
        (with-canvas (canvas)
          (draw-place-sample canvas type 8 8)
          (values 16 16))))))

;; As the manual says, concave places and beaks have the same mark without colours.
(defun place-entries (snapshot)
  (loop for types in (group-by (shown-place-types snapshot) #'place-mark-svg)
        collect (let ((type (first types)))
                  (several-names-entry (loop for each in types
                                             collect (list (drawn-name (place-type-name each)) ""))
                                       (lambda (canvas x y) (draw-place-sample canvas type x y))))))

;;; Things: each look once, with the names of all things that look so.

(defun sample-half-width (image)
  "Return half the width, in pixels, of the legend's sample for the thing of IMAGE. The sample is as
wide as the thing on the map if a line of the legend has room for such a sample."
  (let ((graphics-scale* (min graphics-scale* (floor (- +line-height+ 2) +greatest-thing-width+))))
    (thing-half-width image)))

(defun thing-look (image)
  "Return the look of the thing of IMAGE, a list. Things with equal looks are hard to distinguish."
  (list (thing-image-color image) (thing-shape image) (round (sample-half-width image))
        (thing-image-container-p image) (thing-image-obsview-p image)))

(defun things-by-look (snapshot)
  "Return lists of images of things that look the same, sorted by the first name in each list."
  (group-by (stable-sort (coerce (snapshot-things snapshot) 'list)
                         #'name-before-p :key #'drawn-thing-name)
            #'thing-look))

(defun names-with-counts (images)
  "Return lists (name more) for the names of IMAGES, images of things. MORE is a text with the
number of things if several have the same name, else an empty text."
  (loop for (image . others) in (group-by images #'drawn-thing-name)
        collect (list (drawn-thing-name image)
                      (format nil "~@[ (~D)~]" (and others (1+ (length others)))))))

(defun thing-entries (snapshot)
  (if in-color*
      (loop for images in (things-by-look snapshot)
            collect (let ((image (first images)))
                      (several-names-entry (names-with-counts images)
                                           (lambda (canvas x y)
                                             (draw-thing-sample canvas image x y
                                                                (sample-half-width image))))))
      (and (plusp (length (snapshot-things snapshot)))
           (list (entry-with-sample (canvas x y) "thing"
                   (let ((graphics-scale* 12)) (draw-thing-as-line canvas x y)))))))

(defun shape-entries (snapshot)
  (flet ((plain (text predicate &rest options)
           (when (find-if predicate (snapshot-things snapshot))
             (list (entry-with-sample (canvas x y) text
                     (draw-thing-sample canvas (apply #'make-thing-image :color white* options)
                                        x y 5))))))
    (and in-color*
         (append (plain "blocks the way" (lambda (image) (eq :square (thing-shape image)))
                        :obsmove-p t)
                 (plain "lets one pass" (lambda (image) (eq :round (thing-shape image))))
                 (plain "moves by itself" #'thing-image-moving-p :moving-p t)
                 (plain "container" #'thing-image-container-p :container-p t)
                 (plain "blocks the view" #'thing-image-obsview-p :obsview-p t)))))

;;; Lines.

(defun jump-entries (ways snapshot color)
  "Return a list with the legend entry for jumps, drawn in COLOR, if SNAPSHOT shows a jump in WAYS.
A jump is where a robot was put elsewhere. WAYS are lists of pieces, x y ... in pixels."
  (and (jump-visible-p ways (points-to-pixels (shown-part snapshot)))
       (list (entry-with-sample (canvas x y) "put elsewhere"
               (draw-jump-dots canvas (list (list (- x 8) y (+ x 7) y)) color)))))

(defun trail-jump-entries (snapshot)
  (jump-entries (loop for robot in (snapshot-robots snapshot)
                      collect (pieces-of-trail (robot-image-trail robot)))
                snapshot (nth-ink 0)))

(defun sensor-reading-entries (snapshot)
  (declare (ignore snapshot))
  (when in-color*
    (list (entry-with-sample (canvas x y) "read: low to high"
            (loop for ink in +ray-inks+ for at from -8 by 3
                  do (with-color ink
                       (draw-rectangle canvas draw-gcontext* (+ x at) (- y 4) 3 8 t)))))))

(defun line-entry (layer)
  (let ((name (%layer-name layer)))
    (entry-with-sample (canvas x y) (%layer-legend layer)
      (with-halo ((layer-ink name) :dashes (%layer-dashes layer) :width (%layer-width layer))
        (draw-segments canvas draw-gcontext* (list (- x 8) y (+ x 7) y))))))

(defun entries-of-layers (layers snapshot)
  (loop for layer in layers
        when (%layer-entries layer) append (funcall (%layer-entries layer) snapshot)))

(defun line-entries (snapshot layers)
  (let* ((shown (mapcar #'first (all-shown-layers snapshot layers)))
         (drawn (remove-if-not (lambda (layer) (member layer shown)) *layers*))
         (drawn (append (remove-if #'%layer-last-p drawn) (remove-if-not #'%layer-last-p drawn))))
    (append (mapcar #'line-entry (remove nil drawn :key #'%layer-legend))
            (entries-of-layers drawn snapshot))))

;;; The whole.

(defconstant +entry-limit+ 80 "The largest number of entries of a legend.")

(defun fade-samples (entries opacity)
  "Return ENTRIES with their samples drawn at OPACITY, from 0 to 1."
  (loop for entry in entries
        collect (let ((sample (entry-sample entry)))
                  (make-entry (entry-text entry)
                              (lambda (canvas x y)
                                (with-opacity (canvas opacity) (funcall sample canvas x y)))
                              :whole (entry-whole entry) :width (entry-width entry)))))

(defun legend-entries (snapshot layers
                       &key (lines (line-entries snapshot layers))
                            (robots (robot-entries snapshot))
                            (opacity 1))
  "Return the legend entries for a picture of SNAPSHOT with LAYERS. LINES are the entries for lines,
and ROBOTS the entries for robots. OPACITY, from 0 to 1, is the opacity of the map."
  (let* ((terrain (append (wall-entries snapshot)
                          (entries-of-layers (append (layers-at-depth :under-walls layers)
                                                     (layers-at-depth :on-walls layers))
                                             snapshot)))
         (entries (append robots
                          (if (= 1 opacity) terrain (fade-samples terrain opacity))
                          lines
                          (shape-entries snapshot) (thing-entries snapshot)))
         (more (- (length entries) +entry-limit+)))
    (if (plusp more)
        (append (subseq entries 0 +entry-limit+)
                (list (entry-with-sample (canvas x y) (format nil "and ~D more kinds" more))))
        entries)))
