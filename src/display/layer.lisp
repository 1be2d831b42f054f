;;;; layer.lisp -- what a picture of the world can show besides walls, things and robots.

(in-package :ars-magna.display)

(export '(check-layers text-layers picture-layers layer-title define-layer picture-layer-name
          text-layer-name layer-prompt-text))

;;; DEFINE-LAYER defines a layer for menus, the prompt, the documentation, legends, pictures and
;;; text maps. The layers themselves are in layers.lisp. A layer is drawn at a depth:
;;;
;;;   :UNDER-WALLS, :ON-WALLS     on the map, which never changes: (draw canvas map window)
;;;   :WAYS, :THINGS              of the snapshot, below robots or things: (draw canvas shown)
;;;   :ROBOTS, :LABELS            of each robot, below or above things:
;;;                               (draw canvas shown robot snapshot)
;;;   :LOOKS, :CAMERAS            of each camera, below :ROBOTS; :LOOKS below :CAMERAS:
;;;                               (draw canvas shown robot snapshot)
;;;   :NAMES, :MARGIN             names.lisp and margins.lisp draw these
;;;
;;; The function :SHOWN gets a snapshot, or the image of a robot or camera. It returns what to draw,
;;; the argument SHOWN, or NIL. The legend calls it too, and so lists exactly what is drawn.

(defstruct (layer (:copier nil) (:conc-name %layer-))
  "A layer: something that pictures can show besides walls, things and robots. See DEFINE-LAYER."
  (name nil :type keyword) (title "" :type string) (sentence "" :type string)
  (default-p nil) (depth :robots :type keyword) (shown nil) (draw nil) (note nil) (boxes nil)
  (ink nil) (dashes '() :type list) (width 1) (legend nil) (entries nil) (last-p nil)
  (text-name nil) (text-depth :below :type keyword) (text nil))

(defvar *layers* '() "The layers, in the order of menus.")

(addition *picture-layers*)
(defvar *picture-layers* '())

(addition *window-layers*)
(defvar *window-layers*
  '(:wedges :tracks :trail :planned-way :mover-names :places :coordinates :scale-bar)
  "The layers that the first window shows: a list of names of layers. See *PICTURE-LAYERS* for the
names. Later windows show the layers of the window that was closed last.")

(defun picture-layers ()
  "Return the names of all layers, in the order of menus."
  (mapcar #'%layer-name *layers*))

(defun check-layers (operator parameter layers)
  "Signal WRONG-ARGUMENT unless LAYERS, the value of PARAMETER of OPERATOR, is a list of layers."
  (unless (and (proper-list-p layers) (subsetp layers (picture-layers)))
    (reject-argument operator parameter layers
                     (format nil "a list of some of ~{~(~S~)~^, ~}" (picture-layers)))))

(defun document-layers ()
  (setf (documentation '*picture-layers* 'variable)
        (addition-docstring
         (format nil "The layers that pictures show besides walls, things and robots unless ~
                      :LAYERS is given: a list of some of the following names. The default is ~
                      those with a star.~2%~:{  ~S~:[~; *~]~@[ (~S in text maps)~] -- ~A: ~A~%~}~%~
                      Rays and trails are recorded only after KEEP-HISTORY."
                 (loop for layer in *layers*
                       collect (list (%layer-name layer) (%layer-default-p layer)
                                     (%layer-text-name layer) (%layer-title layer)
                                     (%layer-sentence layer)))))))

(defun add-layer (layer)
  "Add LAYER at the end of *LAYERS*, or in place of the layer of its name. Return LAYER's name."
  (let* ((name (%layer-name layer)) (old (find name *layers* :key #'%layer-name)))
    (cond (old (setf *layers* (substitute layer old *layers*)))
          (t (setf *layers* (append *layers* (list layer)))
             (when (%layer-default-p layer)
               (setf *picture-layers* (append *picture-layers* (list name))))))
    (document-layers)
    name))

(defmacro define-layer (name title sentence &rest options)
  "Define the layer NAME, a keyword, with TITLE in menus. SENTENCE says what it shows. OPTIONS:
- :default-p t: pictures show the layer unless :LAYERS is given.
- :depth: the depth at which the layer is drawn, by default :ROBOTS. See the head of layer.lisp.
- :shown, a function: returns what to draw. The default is the value of :note for the robot. See the
  head of layer.lisp.
- :draw, a function: draws the value of :shown. See the head of layer.lisp.
- :note, a function of a robot: returns what snapshots keep for this layer, an image or data that
  can be compared by EQUAL.
- :ink, :dashes and :width: the look of the layer's lines. The default :ink is each robot's colour.
- :legend: the text for these lines in the legend. :entries, a function of the snapshot, returns
  further entries of the legend. :last-p t puts the entry of the lines after those of other layers.
- :boxes, a function of the arguments of :draw except the canvas: returns boxes that names avoid.
- :text-name: the name of the layer in text maps. :text, a function of a text view and the image of
  a robot, returns pairs of a block and a glyph. :text-depth is the depth of these glyphs: :ABOVE
  things, :BELOW things, or on the :FLOOR, below everything else."
  `(add-layer (make-layer :name ,name :title ,title :sentence ,sentence ,@options)))

;;; Layers by name.

(defun find-layer (name)
  "Return the layer called NAME. Signals WRONG-ARGUMENT if there is none."
  (or (find name *layers* :key #'%layer-name)
      (reject-argument 'layer-title "layer" name
                       (format nil "one of ~{~(~S~)~^, ~}" (picture-layers)))))

(defun layer-title (name)
  "Return the title in menus of the layer NAME, a keyword."
  (%layer-title (find-layer name)))

(defun layer-ink (name)
  "Return the colour of the lines of the layer NAME. If the lines have the colours of robots, return
the colour of the first robot."
  (or (%layer-ink (find-layer name)) (nth-ink 0)))

(defun layer-dashes (name) (%layer-dashes (find-layer name)))

(defun layers-at-depth (depth &optional (names (picture-layers)))
  "Return the layers drawn at DEPTH whose names are in the list NAMES, in the order of menus."
  (remove-if-not (lambda (layer)
                   (and (eq depth (%layer-depth layer)) (member (%layer-name layer) names)))
                 *layers*))

;;; Text maps have other names for layers. The prompt accepts both.

(defun text-layers ()
  "Return the names in text maps of the layers that text maps can show."
  (remove nil (mapcar #'%layer-text-name *layers*)))

(defun picture-layer-name (name)
  "Return a layer's name in pictures. NAME, a keyword, is its name in pictures or in text maps."
  (let ((layer (find name *layers* :key #'%layer-text-name)))
    (if layer (%layer-name layer) name)))

(defun text-layer-name (name)
  "Return a layer's name in text maps. NAME, a keyword, is its name in pictures or in text maps."
  (let ((layer (find name *layers* :key #'%layer-name)))
    (or (and layer (%layer-text-name layer)) name)))

(defun layer-prompt-text (name)
  "Return a text with the one or two names that the prompt accepts for the layer NAME."
  (format nil "~{~A~^ or ~}" (remove-duplicates (list name (text-layer-name name)))))
