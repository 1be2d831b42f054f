;;;; layers.lisp -- the layers, all that is known of each; and the map drawn with them (manual B).

(in-package :ars-magna.display)

(export '(draw-movers))

;;; Terrain never changes and may be kept by a canvas; movers are drawn over it. Angles grow
;;; clockwise from the right on the map and on the canvas alike.

(defun shown-at (depth layers image &rest more)
  "Return lists (layer shown . MORE) of those of LAYERS at DEPTH that show something of IMAGE, a
snapshot or the image of a robot or camera."
  (loop for layer in (layers-at depth layers)
        for shown = (if (%layer-shown layer)
                        (funcall (%layer-shown layer) image)
                        (getf (robot-image-notes image) (%layer-name layer)))
        when shown collect (list* layer shown more)))

(defun shown-below-things (snapshot layers)
  "Return what LAYERS list of SNAPSHOT that things lie on, as SHOWN-AT does, from the lowest up."
  (append (shown-at :ways layers snapshot)
          (loop for robot in (snapshot-robots snapshot)
                append (loop for camera in (robot-image-cameras robot)
                             append (shown-at :looks layers camera robot snapshot)
                             append (shown-at :cameras layers camera robot snapshot))
                append (shown-at :robots layers robot robot snapshot))
          (shown-at :things layers snapshot)))

(defun shown-above-things (snapshot layers)
  "Return what LAYERS list of SNAPSHOT that lies above things, as SHOWN-AT does."
  (loop for robot in (snapshot-robots snapshot)
        append (shown-at :labels layers robot robot snapshot)))

(defun shown-lines (snapshot layers)
  "Return all that LAYERS list of SNAPSHOT that is drawn for them alone, as SHOWN-AT does."
  (append (shown-below-things snapshot layers) (shown-above-things snapshot layers)))

(defun draw-shown (canvas shown)
  (loop for (layer . arguments) in shown
        do (apply (%layer-draw layer) canvas arguments)))

(defconstant +beyond+ 8
  "How far robots are drawn beyond the edges of the map, in pixels; no margin is narrower.")

(defun draw-movers (canvas snapshot layers)
  "Draw what is not terrain of SNAPSHOT on CANVAS: things, robots, and what LAYERS lists of them."
  (let* ((map (snapshot-map snapshot)) (around (* 2 +beyond+))
         (width (to-pixels (map-width map))) (height (to-pixels (map-height map))))
    (with-clipping (canvas 0 0 width height)
      (draw-shown canvas (shown-below-things snapshot layers)))
    (with-clipping (canvas (- +beyond+) (- +beyond+) (+ width around) (+ height around))
      (draw-robots canvas (snapshot-robots snapshot)))
    (with-clipping (canvas 0 0 width height)
      (draw-things canvas (snapshot-things snapshot))
      (draw-shown canvas (shown-above-things snapshot layers))
      (when (member :names layers) (draw-names canvas snapshot layers)))))

;;;; The layers, in the order of menus

;;; Inks are so dark that what is too light for the halo is light enough for them. No two layers'
;;; lines look alike without colours, either: patterns are so short that samples in legends, 15
;;; pixels long, show them.

(define-layer :places "Places"
  "Marks of places, such as corners and doorways."
  :default-p t :depth :on-walls :draw 'draw-places :entries 'place-entries)

(define-layer :grid "Grid"
  "Borders of cells; where these are small, of every fifth or tenth."
  :depth :under-walls :draw 'draw-grid)

(define-layer :wedges "Fields of view"
  "What each camera has in its field of view, as far as walls and things let it see."
  :depth :cameras :shown 'unobstructed-camera :draw 'draw-wedge
  :ink #x7A1030 :legend "in view"
  :text-name :cones :text 'cone-marks :text-depth :floor)

(define-layer :rays "Rays of the last view"
  "What the last view of each camera came from, in a colour for what was read."
  :depth :looks :shown 'camera-image-look :draw 'draw-rays
  :ink (first +ray-inks+) :dashes '(1 3) :legend "rays" :last-p t :entries 'reading-entries)

(define-layer :tracks "Tracks"
  "Where the robot believes that to be which its cameras track."
  :default-p t :depth :cameras :shown 'camera-image-track :draw 'draw-track :boxes 'track-boxes
  :ink #x8A1010 :dashes '(5 2 1 2) :legend "tracked")

(define-layer :designators "Designators"
  "Where the robot believes that to be which it designates, joined to where it really is."
  :depth :labels :shown 'robot-image-designators :draw 'draw-designators-on-map
  :boxes 'designator-boxes
  :ink #x0C3C78 :dashes '(4) :legend "believed, true"
  :text-name :belief :text 'belief-marks :text-depth :above)

(define-layer :odometer "Odometer"
  "Where the main odometer puts the robot, and between which headings."
  :shown 'robot-image-odometer :draw 'draw-odometer
  :ink #x4A1A80 :dashes '(7 2) :legend "odometer")

(define-layer :trail "Trail"
  "Where each robot has been."
  :depth :ways :shown 'robots-with-trails :draw 'draw-trails
  :dashes '(2 2) :legend "trail" :entries 'trail-jump-entries
  :text-name :way :text 'trail-marks)

(define-layer :planned-way "Planned way"
  "Which way each robot is about to go, as far as its program has told: see PUBLISH-WAY."
  :default-p t :depth :ways :shown 'robots-with-plans :draw 'draw-planned-ways
  :boxes 'ends-of-planned-ways
  :dashes '(6 4) :width 2 :legend "planned way"
  :text-name :plan :text 'planned-marks)

(define-layer :reach "What moves by itself"
  "A dashed ring around each thing that has kickers. How far these take it nobody knows."
  :depth :things :shown 'moving-things :draw 'draw-reach
  :ink #x5A3A00 :dashes '(3 3) :legend "may move")

(define-layer :names "Names"
  "What things and robots are called, where there is room."
  :default-p t :depth :names)

(define-layer :coordinates "Coordinates" "Numbers of metres at the edges."
  :default-p t :depth :margin)

(define-layer :legend "Legend"
  "What substances, places, things and lines look like that are to be seen."
  :default-p t :depth :margin)

(define-layer :scale-bar "Scale bar" "How long some metres are."
  :default-p t :depth :margin)

(define-layer :title "Title" "Which robot in which map, and the tick."
  :default-p t :depth :margin)
