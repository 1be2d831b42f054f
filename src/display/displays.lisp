;;;; displays.lisp -- the six displays by name, and all of them in one picture (manual B).

(in-package :ars-magna.display)

(export '(draw-display display-title +displays+))

(define-constant +details+
    '((:state "Robot state" draw-state) (:designators "Robot designators" draw-designators)
      (:cameras "Cameras" draw-cameras) (:hands "Hands" draw-hands)
      (:bins "Storage bins" draw-bins))
  :test #'cl:equal
  :documentation "Lists (name title function): the displays but that of the world.")

;; As reading 27 says.
(define-constant +displays+ (cons :world (mapcar #'first +details+))
  :test #'cl:equal
  :documentation "The displays: bird's eye view, robot state, robot designators, cameras, hands and
storage bins.")

(define-constant +detail-width+ 340
  :documentation "How wide every display but that of the world is drawn, in pixels.")

(defun display-title (display)
  "Return what the window of DISPLAY, one of +DISPLAYS+, is called (manual B)."
  (if (eq :world display) "World" (second (assoc display +details+))))

(defun draw-detail (canvas display robot width)
  "Draw one of the displays of ROBOT, WIDTH pixels wide; return its height."
  (let ((*size-unit* (size-unit robot)))
    (funcall (third (assoc display +details+)) canvas robot width)))

(defun draw-titled (canvas display robot x y)
  "Draw a display of ROBOT with its title and a frame, its upper left corner at X, Y; return its
height."
  (let ((height 0) (top (+ +line-height+ 2)))
    (with-origin (canvas x (+ y top))
      (setf height (draw-detail canvas display robot +detail-width+)))
    (with-origin (canvas x y)
      (with-color (svref grey* 56)
        (draw-rectangle canvas draw-gcontext* 0 0 +detail-width+ top in-color*))
      (draw-text canvas +margin+ 13 (display-title display))
      (with-color (svref grey* 40)
        (draw-rectangle canvas draw-gcontext* 0 0 +detail-width+ (+ top height))))
    (+ top height 1)))

(defun draw-all (canvas snapshot robot layers title)
  "Draw the six displays side by side; return the width and height of that."
  (multiple-value-bind (width height) (draw-framed-world canvas snapshot layers :title title)
    (let ((left (+ width +margin+)) (bottom 0))
      (dolist (display (rest +displays+))
        (incf bottom (+ (draw-titled canvas display robot left bottom) +margin+)))
      (values (+ left +detail-width+ 1) (max height bottom)))))

(defun draw-display (canvas display snapshot robot &key (layers *picture-layers*)
                                                     (width +detail-width+) title)
  "Draw DISPLAY, one of +DISPLAYS+ or :ALL, on CANVAS from SNAPSHOT and ROBOT, the image of a robot
in it. Return the width and height drawn, in pixels. WIDTH is that of the details, LAYERS what
the world shows, TITLE what stands above it: see DRAW-FRAMED. To be called within WITH-CANVAS."
  (case display
    (:all (draw-all canvas snapshot robot layers title))
    (:world (draw-framed-world canvas snapshot layers :title title))
    (t (values width (draw-detail canvas display robot width)))))

(defun check-display (operator display)
  (unless (member display (cons :all +displays+))
    (reject-argument operator "display" display
                     (format nil "one of ~{~(~S~)~^, ~}" (append +displays+ '(:all))))))
