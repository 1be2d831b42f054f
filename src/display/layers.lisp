;;;; layers.lisp -- what a picture of the world can show besides walls, things and robots.

(in-package :ars-magna.display)

;;; This table is all there is to know of layers: menus, the prompt and the documentation list it. A
;;; layer of the kind :TERRAIN never moves, one of :MOVERS does, one of :MARGIN stands beside the
;;; map.

(define-constant +layers+
    '((:places :terrain t "Places"
      "Marks of places, such as corners and doorways.")
     (:grid :terrain nil "Grid"
      "Borders of cells; where these are small, of every fifth or tenth.")
     (:wedges :movers nil "Fields of view"
      "What each camera has in its field of view, as far as walls and things let it see.")
     (:rays :movers nil "Rays of the last view"
      "What the last view of each camera came from, in a colour for what was read.")
     (:tracks :movers t "Tracks"
      "Where the robot believes that to be which its cameras track.")
     (:designators :movers nil "Designators"
      "Where the robot believes that to be which it designates, joined to where it really is.")
     (:odometer :movers nil "Odometer"
      "Where the main odometer puts the robot, and between which headings.")
     (:trail :movers nil "Trail"
      "Where each robot has been.")
     (:planned-way :movers t "Planned way"
      "Which way each robot is about to go, as far as its program has told: see PUBLISH-WAY.")
     (:reach :movers nil "What moves by itself"
      "A dashed ring around each thing that has kickers. How far these take it nobody knows.")
     (:names :movers t "Names"
      "What things and robots are called, where there is room.")
     (:coordinates :margin t "Coordinates"
      "Numbers of metres at the edges.")
     (:legend :margin t "Legend"
      "What substances, places, things and lines look like that are to be seen.")
     (:scale-bar :margin t "Scale bar"
      "How long some metres are.")
     (:title :margin t "Title"
      "Which robot in which map, and the tick."))
  :test #'cl:equal
  :documentation "Lists (name kind default-p title sentence), in the order of menus.")

(define-constant +picture-layers+ (mapcar #'first +layers+)
  :test #'cl:equal
  :documentation "The names of the layers, in the order of menus.")

(defun layer-entry (name)
  (or (assoc name +layers+)
      (reject-argument 'layer-title "layer" name
                       (format nil "one of ~{~(~S~)~^, ~}" +picture-layers+))))

(define-constant +other-names+
    '((:wedges :cones) (:trail :way) (:planned-way :plan) (:designators :belief))
  :test #'cl:equal
  :documentation "Lists (layer name): what the text map calls that which pictures call LAYER. Lines
of the prompt take both.")

(defun layer-named (name)
  "Return the layer of pictures that NAME, a keyword, means: its own name or the other."
  (or (first (rassoc (list name) +other-names+ :test #'cl:equal)) name))

(defun text-layer-named (name)
  "Return the layer of the text map that NAME, a keyword, means, either of its names."
  (or (second (assoc name +other-names+)) name))

(defun layer-words (layer)
  "Return what lines of the prompt call LAYER, one of those of pictures: one name or two."
  (format nil "~A~@[ or ~A~]" layer (second (assoc layer +other-names+))))

(defun layer-title (name)
  "Return what menus call the layer NAME, a keyword."
  (fourth (layer-entry name)))

(defun layer-documentation (name)
  "Return a sentence that says what the layer NAME, a keyword, shows."
  (fifth (layer-entry name)))

(defun layers-of-kind (kind)
  "Return the names of the layers of KIND: :TERRAIN, :MOVERS or :MARGIN."
  (loop for (name its-kind) in +layers+ when (eq kind its-kind) collect name))

(defun default-layers ()
  "Return the names of the layers that pictures show by default."
  (loop for (name nil default-p) in +layers+ when default-p collect name))

(addition *picture-layers*)
(defvar *picture-layers* (default-layers))

(setf (documentation '*picture-layers* 'variable)
      (format nil "A list of what pictures of the world show besides walls, things and robots, ~
                   unless their :LAYERS say otherwise: some of the following. By default those ~
                   with a star.~2%~:{  ~S~:[~; *~] -- ~A: ~A~%~}~%Rays and trails are known from ~
                   KEEP-HISTORY on."
              (loop for (name nil default-p title sentence) in +layers+
                    collect (list name default-p title sentence))))

(defun check-layers (operator layers)
  "Signal WRONG-ARGUMENT unless LAYERS, an argument of OPERATOR, is a list of layers."
  (unless (and (proper-list-p layers) (subsetp layers +picture-layers+))
    (reject-argument operator "layers" layers
                     (format nil "a list of some of ~{~(~S~)~^, ~}" +picture-layers+))))
