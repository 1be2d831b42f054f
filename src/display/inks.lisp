;;;; inks.lisp -- lines that are visible on any ground, and how walls are told apart.

(in-package :ars-magna.display)

(export '(nth-cyclic nth-ink to-pixels points-to-pixels with-halo point-at-distance
          draw-circle box-around overlap-p))

;;; Lines are dark and have a light halo. The line is visible on light ground, the halo on dark
;;; ground, and both between. So the ground does not matter.

(defun call-with-halo (function color width dashes)
  (with-gcontext (draw-gcontext* :foreground white* :line-width (+ width 2))
    (funcall function))
  (with-color color
    (with-dashes (dashes :width width)
      (funcall function))))

(defmacro with-halo ((color &key (width 1) dashes) &body body)
  "Run BODY, which draws lines, twice: for a white halo, then in dark COLOR, with WIDTH and DASHES."
  `(call-with-halo (lambda () ,@body) ,color ,width ,dashes))

;;; Each of several robots or ways has a colour and dashes by its position. There are 8 colours and
;;; 5 dashes: so 40 can be told apart, and 5 without colours. Any two colours are at least 20 apart
;;; in CIE Lab, with full colour vision and without one kind of cones (see tests/palette.lisp).

(define-constant +line-inks+
    '(#x1100FF #xAA3300 #x226655 #x220022 #x9911CC #x550000 #x665588 #x000066)
  :test #'cl:equal
  :documentation "The colours of robots or ways in one picture, by position of the robot or way.")

(define-constant +line-dashes+ '(nil (9 4) (2 3) (9 3 2 3) (4 2))
  :test #'cl:equal
  :documentation "The dashes and gaps of robots or ways in one picture, by position of the robot or
way. NIL means a solid line.")

(defun nth-cyclic (position sequence)
  "Return the element of SEQUENCE at POSITION, modulo the length of SEQUENCE."
  (elt sequence (mod position (length sequence))))

(defun nth-ink (position)
  "Return the colour of the robot or way at POSITION in a list of robots or ways."
  (nth-cyclic position +line-inks+))

(defun nth-dashes (position)
  (nth-cyclic position +line-dashes+))

(defun to-pixels (metres)
  "Return METRES converted to pixels by GRAPHICS-SCALE*."
  (* metres graphics-scale*))

(defun points-to-pixels (points)
  "Return POINTS, a list of coordinates in metres, converted to pixels."
  (mapcar #'to-pixels points))

(defun point-at-distance (x y angle radius)
  "Return the point (x y) at the distance RADIUS from X, Y in direction ANGLE."
  (list (+ x (* radius (cosine angle))) (+ y (* radius (sine angle)))))

(defun pixel-distance (x y to-x to-y)
  (let ((across (- to-x x)) (down (- to-y y)))
    (sqrt (+ (* across across) (* down down)))))

(defun draw-circle (canvas x y radius fill-p)
  "Draw a circle around X, Y. If FILL-P, fill the circle; else draw a line whose middle is RADIUS
pixels from X, Y."
  (let ((reach (if fill-p radius (+ radius (/ (max 1 (gcontext-line-width draw-gcontext*)) 2)))))
    (draw-arc canvas draw-gcontext* (- x reach) (- y reach) (* 2 reach) (* 2 reach) 0 2pi fill-p)))

;;; A box is a list (left top right bottom) in pixels.

(defun overlap-p (a b)
  "True if the boxes A and B, lists (left top right bottom), overlap."
  (and (< (first a) (third b)) (< (first b) (third a))
       (< (second a) (fourth b)) (< (second b) (fourth a))))

(defun box-around (x y half)
  "Return the square box around X, Y that is twice HALF wide."
  (list (- x half) (- y half) (+ x half) (+ y half)))

(defun draw-text (canvas x y text)
  (draw-glyphs canvas draw-gcontext* x y text))

(defun monospaced-width (text)
  (* +character-width+ (length text)))

(defun fill-with-white (canvas x y width height)
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-rectangle canvas draw-gcontext* x y width height t)))

(define-constant +ray-inks+ '(#x10308C #x4A2480 #x801850 #x8A3010 #x604800)
  :test #'cl:equal
  :documentation "The colours of rays, from the least to the greatest parameter of walls.")

(defconstant +grid-ink+ #x8A8A8A "The colour of the grid, which is drawn on white.")
(defconstant +frame-ink+ #x606060 "The colour of frames and ticks, on white.")

;;;; Walls

;;; A wall has the texture and the hue of its substance. The greater its parameter, the lighter it
;;; is. Hues and textures follow the order in which substances were defined. There are 10 hues and
;;; 11 textures, so that a combination repeats late. If two substances of a map have the same
;;; texture, the one defined later takes a free one.

;;; Text maps write walls in these colours. Pictures tint their greys with them.

(define-constant +substance-inks+ '(:yellow :cyan :red :blue :grey :green :lightcyan :violet
                                    :lightyellow :lightviolet)
  :test #'cl:equal
  :documentation "The colours of substances, in the order in which substances were defined. After
the last colour, they start again.")

(define-constant +tints+ '(:yellow #xC8B060 :cyan #x58B0B8 :red #xC08878 :blue #x7890D0
                           :green #x78A878 :lightcyan #x88C4B0 :violet #xA080C8
                           :lightyellow #xC0C488 :lightviolet #xC8A4D8)
  :test #'cl:equal
  :documentation "The hue that walls get for each of +SUBSTANCE-INKS+. Grey has no hue.")

(defconstant +tint-strength+ 0.55d0 "The strength of the hue of a wall, from 0 to 1.")

(define-constant +wall-textures+ '(:lines :hatching :bricks :falling-hatching :plain :dots :posts
                                   :crosses :net :chequers :arrows)
  :test #'cl:equal
  :documentation "The textures of substances, in the order in which substances were defined. After
the last texture, they start again.")

(defun substance-position (name)
  "Return how many substances are defined before the substance NAME, or NIL if NAME is not defined."
  (position name (all-substances) :key #'substance-name :test #'same-name-p))

(defun substance-ink (name)
  (let ((position (substance-position name)))
    (and position (nth-cyclic position +substance-inks+))))

;;; Lightness.

(defconstant +least-shade+ 8 "The index in GREY* of the shade of the darkest walls.")
(defconstant +shade-of-zero+ 14 "The index in GREY* of the shade of walls with the parameter 0.")
(defconstant +greatest-shade+ 36
  "The index in GREY* of the shade of the lightest walls. This shade is visible on white.")
(defconstant +middle-parameter+ 60
  "The parameter whose shade is halfway between +SHADE-OF-ZERO+ and +GREATEST-SHADE+.")

(defun wall-shade (parameter)
  "Return the index in GREY* of the shade of walls with PARAMETER. It is the same in each map."
  (let ((part (/ parameter (+ (abs parameter) +middle-parameter+))))
    (+ +shade-of-zero+
       (round (* part (if (minusp part)
                          (- +shade-of-zero+ +least-shade+)
                          (- +greatest-shade+ +shade-of-zero+)))))))

(defun wall-color (shade hue)
  "Return the grey at index SHADE of GREY*, tinted with the colour HUE unless HUE is NIL."
  (let ((grey (svref grey* shade)))
    (if hue (tint-grey grey hue +tint-strength+) grey)))

;;; Looks.

(defstruct (material (:constructor make-material (hue texture)) (:copier nil))
  "The look of the walls of a substance. HUE is a colour, or NIL for grey walls."
  (hue nil :type (or null color) :read-only t)
  (texture :plain :type keyword :read-only t))

(defun choose-texture (name taken)
  "Return a texture for the substance called NAME in a map: its usual texture, or the next free
texture if TAKEN contains the usual one. TAKEN are the textures of the map's other substances."
  (let* ((first (or (substance-position name) 0))
         (all (loop for position from first repeat (length +wall-textures+)
                    collect (nth-cyclic position +wall-textures+))))
    (or (find-if-not (lambda (texture) (member texture taken)) all)
        (first all))))

(defun textures-for (names)
  "Return lists (name texture) for NAMES, the names of the substances of a map. The lists are in the
order in which the substances were defined."
  (let ((taken '()))
    (loop for name in (stable-sort (copy-list names) #'<
                                   :key (lambda (name)
                                          (or (substance-position name) most-positive-fixnum)))
          collect (list name (first (push (choose-texture name taken) taken))))))

(defun materials-of (map)
  "Return a vector with the material of each substance of MAP. The index is the substance's number."
  (let ((textures (textures-for (remove nil (coerce (map-substance-types map) 'list)))))
    (cl:map 'vector (lambda (name)
                      (make-material (and name (getf +tints+ (substance-ink name)))
                                     (or (second (assoc name textures)) :plain)))
            (map-substance-types map))))
