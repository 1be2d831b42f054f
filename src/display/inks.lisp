;;;; inks.lisp -- lines and outlines that are seen on whatever they lie on.

(in-package :ars-magna.display)

(export '(turn-ink to-pixels pixels-of inked around draw-circle box-around overlap-p))

;;; Lines are dark and have a light halo: on light ground the line is seen, on dark ground the halo,
;;; on what is between both. So nobody need know what is below.

(defmacro with-dashes ((dashes &key (width 1)) &body body)
  "Run BODY drawing lines WIDTH pixels wide with DASHES, a list (dash gap ...), or solid if NIL."
  (with-gensyms (value)
    `(let ((,value ,dashes))
       (with-gcontext (draw-gcontext* :line-width ,width :line-style (if ,value :dash :solid)
                                      :dashes (or ,value '(4)))
         ,@body))))

(defun call-inked (function color width dashes)
  (with-gcontext (draw-gcontext* :foreground white* :line-width (+ width 2))
    (funcall function))
  (with-color color
    (with-dashes (dashes :width width)
      (funcall function))))

(defmacro inked ((color &key (width 1) dashes) &body body)
  "Run BODY, which draws lines, twice: for a halo, and then in COLOR, a dark one, WIDTH pixels
wide, with DASHES."
  `(call-inked (lambda () ,@body) ,color ,width ,dashes))

;;; Where there are several of a sort, such as robots and ways, each has a colour and dashes in its
;;; turn. The numbers of both have no common factor: so forty are told apart, and five of them even
;;; without colours. The colours are at least 20 apart in CIE Lab for those who see all colours and
;;; for those who miss one kind of cones; tests/palette.lisp measures it.

(define-constant +turn-inks+
    '(#x1100FF #xAA3300 #x226655 #x220022 #x9911CC #x550000 #x665588 #x000066)
  :test #'cl:equal
  :documentation "The colours of what there are several of, in turn.")

(define-constant +turn-dashes+ '(nil (9 4) (2 3) (9 3 2 3) (4 2))
  :test #'cl:equal
  :documentation "The dashes and gaps of what there are several of, in turn; NIL is a solid line.")

(defun in-turn (position list)
  (nth (mod position (length list)) list))

(defun turn-ink (position)
  "Return the colour of what is at POSITION among several of its sort."
  (in-turn position +turn-inks+))

(defun turn-dashes (position)
  (in-turn position +turn-dashes+))

(defun to-pixels (metres)
  "Return how many pixels METRES are."
  (* metres graphics-scale*))

(defun pixels-of (points)
  "Return the list of coordinates POINTS, in metres, in pixels."
  (mapcar #'to-pixels points))

(defun around (x y angle radius)
  "Return a list of the coordinates RADIUS from X, Y in direction ANGLE."
  (list (+ x (* radius (cosine angle))) (+ y (* radius (sine angle)))))

(defun draw-circle (canvas x y radius fill-p)
  "Draw a circle, or a line of which the middle is RADIUS away from X, Y."
  (let ((reach (if fill-p radius (+ radius (/ (max 1 (gcontext-line-width draw-gcontext*)) 2)))))
    (draw-arc canvas draw-gcontext* (- x reach) (- y reach) (* 2 reach) (* 2 reach) 0 2pi fill-p)))

;;; A box is a list (left top right bottom) in pixels.

(defun overlap-p (a b)
  "True if the boxes A and B, lists (left top right bottom), overlap."
  (and (< (first a) (third b)) (< (first b) (third a))
       (< (second a) (fourth b)) (< (second b) (fourth a))))

(defun box-around (x y half)
  "Return the box that reaches HALF from X, Y to each side."
  (list (- x half) (- y half) (+ x half) (+ y half)))

(defun draw-text (canvas x y text)
  (draw-glyphs canvas draw-gcontext* x y text))

(defun words-width (text)
  "Return how wide TEXT is, in pixels."
  (* +character-width+ (length text)))

(defun draw-text-on-plate (canvas x y text)
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-rectangle canvas draw-gcontext* (- x 1) (- y 10) (+ 2 (words-width text)) 13 t))
  (draw-text canvas x y text))

(define-constant +ray-inks+ '(#x10308C #x4A2480 #x801850 #x8A3010 #x604800)
  :test #'cl:equal
  :documentation "The colours of rays, from the least parameter of walls to the greatest.")

(define-constant +grid-ink+ #x8A8A8A :documentation "The colour of the grid, which lies on white.")
(define-constant +frame-ink+ #x606060 :documentation "The colour of frames and ticks, on white.")
