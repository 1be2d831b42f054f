;;;; layer.lisp -- what a picture of the world can show besides walls, things and robots.

(in-package :ars-magna.display)

(export '(text-layers picture-layers layer-title define-layer layer-named
          text-layer-named layer-words))

;;; All there is to know of a layer stands in its DEFINE-LAYER. The menus, the prompt, the
;;; documentation, the legend, pictures and text maps read it. For the layers themselves see
;;; layers.lisp. A layer is drawn at a depth:
;;;
;;;   :UNDER-WALLS, :ON-WALLS     on the map, which never changes: (draw canvas map window)
;;;   :WAYS, :THINGS              of the whole snapshot, below robots, below things:
;;;                               (draw canvas shown)
;;;   :ROBOTS, :LABELS            of each robot, below and above things:
;;;                               (draw canvas shown robot snapshot)
;;;   :LOOKS, :CAMERAS            of each camera, below :ROBOTS; looks lie lower: the same
;;;   :NAMES, :MARGIN             names.lisp and margins.lisp draw these
;;;
;;; The function :SHOWN of a snapshot, or of the image of a robot or camera, returns what there is
;;; to draw, SHOWN, or NIL. What the legend has is what is drawn: it asks the same function.

(defstruct (layer (:copier nil) (:conc-name %layer-))
  "What pictures can show, and how: see DEFINE-LAYER."
  (name nil :type keyword) (title "" :type string) (sentence "" :type string)
  (default-p nil) (depth :robots :type keyword) (shown nil) (draw nil) (note nil) (boxes nil)
  (ink nil) (dashes '() :type list) (width 1) (legend nil) (entries nil) (last-p nil)
  (text-name nil) (text-depth :below :type keyword) (text nil))

(defvar *layers* '() "The layers, in the order of menus.")

(addition *picture-layers*)
(defvar *picture-layers* '())

(defun picture-layers ()
  "Return the names of the layers, in the order of menus."
  (mapcar #'%layer-name *layers*))

(defun document-layers ()
  (setf (documentation '*picture-layers* 'variable)
        (format nil "A list of what pictures of the world show besides walls, things and robots, ~
                     unless their :LAYERS say otherwise: some of the following. By default those ~
                     with a star.~2%~:{  ~S~:[~; *~] -- ~A: ~A~%~}~%Rays and trails are known ~
                     from KEEP-HISTORY on."
                (loop for layer in *layers*
                      collect (list (%layer-name layer) (%layer-default-p layer)
                                    (%layer-title layer) (%layer-sentence layer))))))

(defun add-layer (layer)
  "Let pictures know LAYER, in the place of one of the same name, or after all others."
  (let* ((name (%layer-name layer)) (old (find name *layers* :key #'%layer-name)))
    (cond (old (setf *layers* (substitute layer old *layers*)))
          (t (setf *layers* (append *layers* (list layer)))
             (when (%layer-default-p layer)
               (setf *picture-layers* (append *picture-layers* (list name))))))
    (document-layers)
    name))

(defmacro define-layer (name title sentence &rest options)
  "Define the layer NAME, a keyword, called TITLE in menus; SENTENCE says what it shows. OPTIONS:
- :default-p t: pictures show it unless told otherwise.
- :depth: where it is drawn, by default :ROBOTS: see the head of layer.lisp.
- :shown, a function: what there is to draw, by default the :note of the robot.
- :draw, a function that draws this: see there.
- :note, a function of a robot: what snapshots keep for this layer, an image or data for EQUAL.
- :ink, by default that of each robot, :dashes and :width: what its lines look like.
- :legend: what the legend calls these lines. :entries, a function of the snapshot, returns further
  entries; :last-p t puts its line after those of other layers.
- :boxes, a function of what :draw takes but the canvas: boxes that names leave alone.
- :text-name, :text, :text-depth: what text maps call it, a function of a text view and the image
  of a robot that returns pairs of a block and a glyph, and where these show: :ABOVE things,
  :BELOW things, or on the :FLOOR, where there is nothing else."
  `(add-layer (make-layer :name ,name :title ,title :sentence ,sentence ,@options)))

;;; What is asked of layers, by name.

(defun layer-called (name)
  "Return the layer called NAME. Signals WRONG-ARGUMENT."
  (or (find name *layers* :key #'%layer-name)
      (reject-argument 'layer-title "layer" name
                       (format nil "one of ~{~(~S~)~^, ~}" (picture-layers)))))

(defun layer-title (name)
  "Return what menus call the layer NAME, a keyword."
  (%layer-title (layer-called name)))

(defun layer-ink (name)
  "Return the colour of lines of the layer NAME; for lines in the colours of robots, the first."
  (or (%layer-ink (layer-called name)) (nth-ink 0)))

(defun layer-dashes (name) (%layer-dashes (layer-called name)))

(defun layers-at (depth &optional (names (picture-layers)))
  "Return those of the layers called NAMES that are drawn at DEPTH, in the order of menus."
  (remove-if-not (lambda (layer)
                   (and (eq depth (%layer-depth layer)) (member (%layer-name layer) names)))
                 *layers*))

;;; Text maps have other names for layers. Lines of the prompt take both.

(defun text-layers ()
  "Return what text maps call the layers that they can show."
  (remove nil (mapcar #'%layer-text-name *layers*)))

(defun layer-named (name)
  "Return the layer of pictures that NAME, a keyword, means: its own name or that in text maps."
  (let ((layer (find name *layers* :key #'%layer-text-name)))
    (if layer (%layer-name layer) name)))

(defun text-layer-named (name)
  "Return the layer of the text map that NAME, a keyword, means, either of its names."
  (let ((layer (find name *layers* :key #'%layer-name)))
    (or (and layer (%layer-text-name layer)) name)))

(defun layer-words (name)
  "Return what lines of the prompt call the layer NAME: one name or two."
  (format nil "~A~@[ or ~A~]" name (%layer-text-name (layer-called name))))
