;;;; layers.lisp -- the layers of pictures, and the map drawn with them (manual B).

(in-package :ars-magna.display)

(export '(draw-movers))

;;; Terrain never changes, and a canvas may cache it. Movers are drawn over it. Angles grow
;;; clockwise from the right, on the map and on the canvas.

(defun shown-layers-at-depth (depth layers image &rest more)
  "Return lists (layer shown . MORE) for those of LAYERS that are at DEPTH and show something of
IMAGE. SHOWN is what the layer shows. IMAGE is a snapshot or the image of a robot or camera."
  (loop for layer in (layers-at-depth depth layers)
        for shown = (if (%layer-shown layer)
                        (funcall (%layer-shown layer) image)
                        (getf (robot-image-notes image) (%layer-name layer)))
        when shown collect (list* layer shown more)))

(defun shown-layers-below-things (snapshot layers)
  "Return what LAYERS show of SNAPSHOT below things, in the form of SHOWN-LAYERS-AT-DEPTH. The
lowest layer is first."
  (append (shown-layers-at-depth :ways layers snapshot)
          (loop for robot in (snapshot-robots snapshot)
                append (loop for camera in (robot-image-cameras robot)
                             append (shown-layers-at-depth :looks layers camera robot snapshot)
                             append (shown-layers-at-depth :cameras layers camera robot snapshot))
                append (shown-layers-at-depth :robots layers robot robot snapshot))
          (shown-layers-at-depth :things layers snapshot)))

(defun shown-layers-above-things (snapshot layers)
  (loop for robot in (snapshot-robots snapshot)
        append (shown-layers-at-depth :labels layers robot robot snapshot)))

(defun all-shown-layers (snapshot layers)
  (append (shown-layers-below-things snapshot layers) (shown-layers-above-things snapshot layers)))

(defun draw-shown-layers (canvas shown)
  (loop for (layer . arguments) in shown
        do (apply (%layer-draw layer) canvas arguments)))

(defconstant +robot-overhang+ 8
  "How far, in pixels, robots are drawn beyond the edges of the map: the least margin.")

(defun call-on-map (function canvas map &optional (overhang 0))
  "Call FUNCTION. Clip what it draws on CANVAS to MAP and OVERHANG pixels around it."
  (let ((around (* 2 overhang)))
    (with-clipping (canvas (- overhang) (- overhang)
                           (+ (to-pixels (map-width map)) around)
                           (+ (to-pixels (map-height map)) around))
      (funcall function))))

(defun draw-all-movers (canvas snapshot layers shown-robot names-below names-above)
  "Draw what DRAW-MOVERS draws. NAMES-BELOW and NAMES-ABOVE, functions, draw the names below and
above robots and things."
  (let ((map (snapshot-map snapshot)))
    (call-on-map (lambda ()
                   (draw-shown-layers canvas (shown-layers-below-things snapshot layers))
                   (funcall names-below))
                 canvas map)
    (call-on-map (lambda () (draw-robots canvas (snapshot-robots snapshot) shown-robot))
                 canvas map +robot-overhang+)
    (call-on-map (lambda ()
                   (draw-things canvas (snapshot-things snapshot))
                   (draw-shown-layers canvas (shown-layers-above-things snapshot layers))
                   (funcall names-above))
                 canvas map)))

(defun draw-movers (canvas snapshot layers &optional view)
  "Draw SNAPSHOT on CANVAS without its terrain: things, robots, and what LAYERS show of them. VIEW
is the live view of a window, in which names hold still, or NIL."
  (if view
      (multiple-value-bind (below above) (place-names view canvas snapshot layers)
        (let ((*drawn-trail-metres* (longest-live-trail (snapshot-map snapshot))))
          (flet ((draw (names) (dolist (name names) (draw-placed-name canvas name))))
            (draw-all-movers canvas snapshot layers (live-view-robot view)
                             (lambda () (draw below)) (lambda () (draw above))))))
      (draw-all-movers canvas snapshot layers nil #'values
                       (lambda ()
                         (when (names-shown-p layers) (draw-names canvas snapshot layers))))))

;;;; The layers, in the order of menus

;;; Inks are dark enough for any ground that is too light for the halo. Each layer has its own
;;; dashes, so that lines can be told apart without colours. Patterns of dashes are short enough for
;;; the samples in legends, 15 pixels long.

(define-layer :places "Places"
  "Marks of places, such as corners and doorways."
  :default-p t :depth :on-walls :draw 'draw-places :entries 'place-entries)

(define-layer :grid "Grid"
  "Borders of cells. Where cells are small, the borders of every fifth or tenth cell."
  :depth :under-walls :draw 'draw-grid)

(define-layer :wedges "Fields of view"
  "The field of view of each camera, up to walls and things that block the view."
  :depth :cameras :shown 'camera-outside-container :draw 'draw-field-of-view
  :ink #x7A1030 :legend "in view"
  :text-name :cones :text 'cone-marks :text-depth :floor)

(define-layer :rays "Rays of the last view"
  "The rays of the last view of each camera, in colours for the readings."
  :depth :looks :shown 'camera-image-look :draw 'draw-rays
  :ink (first +ray-inks+) :dashes '(1 3) :legend "rays" :last-p t :entries 'sensor-reading-entries)

(define-layer :ranges "Ranges"
  "The distances that each rangefinder has measured last, from where the robot was then."
  :note 'range-scans-of-robot :draw 'draw-ranges
  :ink #x0A5050 :dashes '(2 4) :legend "measured"
  :text-name :ranges :text 'range-marks)

(define-layer :tracks "Tracks"
  "The believed position of each object that a camera tracks."
  :default-p t :depth :cameras :shown 'camera-image-track :draw 'draw-track :boxes 'track-boxes
  :ink #x8A1010 :dashes '(5 2 1 2) :legend "tracked")

(define-layer :designators "Designators"
  "The believed position of each designated object, with a line to its real position."
  :depth :labels :shown 'robot-image-designators :draw 'draw-designators-on-map
  :boxes 'designator-boxes
  :ink #x0C3C78 :dashes '(4) :legend "believed, true"
  :text-name :belief :text 'belief-marks :text-depth :above)

(define-layer :odometer "Odometer"
  "The position and the range of headings that each robot's main odometer estimates."
  :shown 'robot-image-odometer :draw 'draw-odometer
  :ink #x4A1A80 :dashes '(7 2) :legend "odometer")

(define-layer :trail "Trail"
  "The way that each robot has gone."
  :depth :ways :shown 'robots-with-trails :draw 'draw-trails
  :dashes '(2 2) :legend "trail" :entries 'trail-jump-entries
  :text-name :way :text 'trail-marks)

(define-layer :planned-way "Planned way"
  "The way that each robot is about to go, if its program publishes the way: see PUBLISH-WAY."
  :default-p t :depth :ways :shown 'robots-with-planned-ways :draw 'draw-planned-ways
  :boxes 'planned-way-end-boxes
  :dashes '(6 4) :width 2 :legend "planned way"
  :text-name :plan :text 'planned-way-marks)

(define-layer :reach "What moves by itself"
  "A dashed ring around each thing with kickers. How far kickers can move a thing is unknown."
  :depth :things :shown 'moving-thing-images :draw 'draw-reach-marks
  :ink #x5A3A00 :dashes '(3 3) :legend "may move")

(define-layer :names "Names"
  "The names of things and robots, where there is room."
  :default-p t :depth :names)

(define-layer :mover-names "Names of what moves"
  "The names of robots and of things with kickers, where there is room."
  :depth :names)

(define-layer :coordinates "Coordinates" "Numbers of metres at the edges."
  :default-p t :depth :margin)

(define-layer :legend "Legend"
  "The looks of the substances, places, things and lines in the picture."
  :default-p t :depth :margin)

(define-layer :scale-bar "Scale bar" "The length of some metres."
  :default-p t :depth :margin)

(define-layer :title "Title" "The robots, the map and the tick."
  :default-p t :depth :margin)
