;;;; colors.lisp -- the colours of manual B.1, their contrast, and textures.

(in-package :ars-magna.canvas)

(export '(color shade named-shades mix-colors +least-contrast+ primaries color-of-primaries
          luminance color-contrast black-or-white-on tint-grey +textures+ draw-texture))

;;; A colour is an integer #xRRGGBB, like a pixel in CLX. Vectors run from dark to light. The manual
;;; names the vectors; their values are ours. Shade 9 of each is its plain colour. The eight plain
;;; colours were found by a search over hue, chroma and lightness. Any two of them are at least 10
;;; apart in CIE Lab: with full colour vision, without one of the three kinds of cones, and printed
;;; in grey. tests/palette.lisp measures it.

(deftype color ()
  "A colour, an integer #xRRGGBB."
  '(unsigned-byte 24))

(defun mix-colors (dark light fraction)
  "Return the colour at FRACTION, from 0 to 1, between DARK and LIGHT."
  (loop with color = 0
        for position in '(16 8 0)
        for low = (ldb (byte 8 position) dark)
        for high = (ldb (byte 8 position) light)
        do (setf (ldb (byte 8 position) color) (round (+ low (* fraction (- high low)))))
        finally (return color)))

(defun shades (count dark light)
  (coerce (loop for index below count collect (mix-colors dark light (/ index (1- count))))
          'simple-vector))

(public black* white* grey*)
(defvar black* #x000000 "Black, a colour for WITH-COLOR (manual B.1).")
(defvar white* #xFFFFFF "White, a colour for WITH-COLOR (manual B.1).")
(defvar grey* (shades 64 black* white*)
  "A vector of 64 shades of grey: 0 is black, 63 is white (manual B.1).")

(defconstant +plain-shade+ 9 "The index of the plain colour in a vector of 12 shades.")

(defun shades-around (dark plain light)
  "Return a vector of 12 colours from DARK to LIGHT, with PLAIN at the index +PLAIN-SHADE+."
  (concatenate 'simple-vector
               (shades (1+ +plain-shade+) dark plain)
               (subseq (shades (- 12 +plain-shade+) plain light) 1)))

(defmacro define-shades (&rest definitions)
  "Define variables whose values are vectors of 12 shades. DEFINITIONS are lists (variable dark
plain light hue), where HUE is the name of the colour in the documentation."
  `(progn
     ,@(loop for (variable dark plain light hue) in definitions
             collect `(public ,variable)
             collect `(defvar ,variable (shades-around ,dark ,plain ,light)
                        ,(format nil "A vector of 12 shades of ~A, from dark to light. ~
                                      (Manual B.1.)" hue)))))

(define-shades
  (red* #x400000 #xC22418 #xF0705C "red")
  (green* #x06280C #x339035 #x7CC873 "green")
  (blue* #x04003C #x1401B1 #x6A70F0 "blue")
  (violet* #x280040 #x7800AE #xCDA2F5 "violet")
  (lightred* #x7C1038 #xFF97B0 #xFFE0E8 "light red, that is pink")
  (lightgreen* #x22541A #xD3FFB2 #xF2FFE6 "light green")
  (lightblue* #x0A4468 #x9BDBFA #xDAF2FF "light blue")
  (lightviolet* #x421468 #xB585DE #xE8D6F8 "light violet"))

(defun named-shades (name)
  "Return the vector of shades of the colour NAME, a symbol or string, such as the value of a :color
attribute. Return NIL if NAME is not a colour."
  (and (typep name '(and (or symbol string) (not null)))
       (let ((variable (find-symbol (concatenate 'string (name-string name) "*")
                                    :ars-magna.canvas)))
         (and variable (boundp variable) (vectorp (symbol-value variable))
              (symbol-value variable)))))

(defun shade (name &optional (index +plain-shade+))
  "Return shade INDEX of the colour NAME, the value of a :color attribute. INDEX is from 0, dark, to
11, light. Return black if NAME is not a colour (manual B; reading 212)."
  (let ((shades (named-shades name)))
    (if shades (aref shades index) black*)))

;;; Contrast.

;;; Luminance and contrast are those of the Web Content Accessibility Guidelines 2.1. A contrast of
;;; less than 3 is hard to see.

(defconstant +least-contrast+ 3 "The least contrast of lines and texts to their background.")

(defun linear-light (byte)
  "Return the linear light, from 0 to 1, of BYTE, the value of a primary colour from 0 to 255."
  (let ((value (/ byte 255d0)))
    (if (<= value 0.04045d0)
        (/ value 12.92d0)
        (power (/ (+ value 0.055d0) 1.055d0) 2.4d0))))

(defun byte-of-light (light)
  (let ((light (clamp light 0d0 1d0)))
    (round (* 255 (if (<= light 0.0031308d0)
                      (* 12.92d0 light)
                      (- (* 1.055d0 (power light (/ 2.4d0))) 0.055d0))))))

(defun primaries (color)
  "Return the linear light of red, green and blue in COLOR, as a list of numbers from 0 to 1."
  (loop for position in '(16 8 0) collect (linear-light (ldb (byte 8 position) color))))

(defun color-of-primaries (primaries)
  "Return the colour with PRIMARIES, a list of the linear red, green and blue light from 0 to 1."
  (reduce (lambda (color light) (logior (ash color 8) (byte-of-light light)))
          primaries :initial-value 0))

(defun luminance (color)
  "Return the relative luminance of COLOR, from 0 to 1."
  (reduce #'+ (mapcar #'* '(0.2126d0 0.7152d0 0.0722d0) (primaries color))))

(defun color-contrast (color other)
  "Return the contrast ratio of COLOR and OTHER, from 1 to 21."
  (let ((a (+ 0.05d0 (luminance color))) (b (+ 0.05d0 (luminance other))))
    (/ (max a b) (min a b))))

(defun black-or-white-on (color)
  "Return black or white: the one with the higher contrast ratio to COLOR, which is at least 4.5."
  (if (< (color-contrast white* color) (color-contrast black* color)) black* white*))

(defun tint-grey (grey hue fraction)
  "Return the colour GREY mixed with FRACTION, from 0 to 1, of the colour HUE. The result has the
luminance of GREY, so both look the same in a print without colours."
  (let* ((light (luminance grey)) (strength (luminance hue)))
    (color-of-primaries
     (loop for primary in (primaries hue)
           collect (* light (+ (- 1 fraction) (* fraction (/ primary strength))))))))

;;;; Textures

;;; A texture is a list of marks, repeated in square tiles that begin at multiples of the size of a
;;; tile: so the marks of adjacent areas join. Lines run through all tiles of a rectangle, so that
;;; large areas need few of them. Coordinates in a tile are from 0 to 1.

(define-constant +textures+
    '(:plain ()
      :lines ((:across 1/4) (:across 3/4))
      :hatching ((:rising))
      :bricks ((:across 0) (:across 1/2) (:stroke 1/4 0 1/4 1/2) (:stroke 3/4 1/2 3/4 1))
      :dots ((:box 1/4 1/4 1/2 1/2))
      :posts ((:down 1/4) (:down 3/4))
      :falling-hatching ((:falling))
      :crosses ((:rising) (:falling))
      :net ((:across 1/2) (:down 1/2))
      :chequers ((:box 0 0 1/2 1/2) (:box 1/2 1/2 1/2 1/2))
      :arrows ((:stroke 0 1/4 1/2 3/4) (:stroke 1/2 3/4 1 1/4)))
  :test #'equal
  :documentation "The textures by name, as a property list. Each texture is a list of marks:
(:across Y), (:down X), (:rising), (:falling), (:stroke X1 Y1 X2 Y2), (:box X Y WIDTH HEIGHT).")

(defun tile-starts (low high tile)
  "Return the coordinates where tiles begin. The tiles have the size TILE and cover LOW to HIGH."
  (loop for edge from (* tile (floor low tile)) below high by tile collect edge))

(defun tile-coordinates (low high tile part)
  "Return the coordinate at the fraction PART of each tile of size TILE, from LOW to below HIGH."
  (loop for edge in (tile-starts low high tile)
        for level = (+ edge (* part tile))
        when (and (<= low level) (< level high)) collect level))

(defun tile-diagonals (left top right bottom tile sign)
  "Return the diagonals of all tiles as lines x1 y1 x2 y2 ..., clipped to the rectangle LEFT, TOP,
RIGHT, BOTTOM. TILE is the size of tiles. SIGN is 1 for falling diagonals and -1 for rising ones."
  (let* ((ends (list (* sign left) (* sign right)))
         (least (- top (reduce #'max ends))) (most (- bottom (reduce #'min ends))))
    (loop for c in (rest (tile-starts least most tile))
          for from = (if (plusp sign) (max left (- top c)) (max left (- c bottom)))
          for to = (if (plusp sign) (min right (- bottom c)) (min right (- c top)))
          when (< from to)
            append (list from (+ c (* sign from)) to (+ c (* sign to))))))

(defun strokes-in-tiles (left top right bottom tile stroke)
  "Return the line STROKE repeated for each tile of the rectangle, and clipped to the rectangle, as
a list x1 y1 x2 y2 .... STROKE is a list x1 y1 x2 y2 in fractions of a tile."
  (flet ((cut-to (low value high) (clamp value low high)))
    (destructuring-bind (x1 y1 x2 y2) stroke
      (loop for y in (tile-starts top bottom tile)
            append (loop for x in (tile-starts left right tile)
                         append (list (cut-to left (+ x (* x1 tile)) right)
                                      (cut-to top (+ y (* y1 tile)) bottom)
                                      (cut-to left (+ x (* x2 tile)) right)
                                      (cut-to top (+ y (* y2 tile)) bottom)))))))

(defun mark-segments (mark left top right bottom tile)
  "Return the lines x1 y1 x2 y2 ... of MARK, any mark of a texture but :BOX, in the rectangle."
  (ecase (first mark)
    (:across (loop for y in (tile-coordinates top bottom tile (second mark))
                   append (list left y right y)))
    (:down (loop for x in (tile-coordinates left right tile (second mark)) append
                 (list x top x bottom)))
    (:rising (tile-diagonals left top right bottom tile -1))
    (:falling (tile-diagonals left top right bottom tile 1))
    (:stroke (strokes-in-tiles left top right bottom tile (rest mark)))))

(defun mark-boxes (mark left top right bottom tile)
  "Return the boxes x y width height ... of MARK, a :BOX mark of a texture, in the rectangle."
  (destructuring-bind (x y width height) (rest mark)
    (loop for (x1 y1 x2 y2) on (strokes-in-tiles left top right bottom tile
                                                 (list x y (+ x width) (+ y height)))
            by #'cddddr
          when (and (< x1 x2) (< y1 y2))
            append (list x1 y1 (- x2 x1) (- y2 y1)))))

(defun draw-texture (canvas gcontext texture rectangles tile)
  "Draw TEXTURE, a name in +TEXTURES+, in RECTANGLES, a list x y width height .... The tiles of the
texture are TILE pixels wide and high."
  (let ((segments '()) (boxes '()) (marks (getf +textures+ texture)))
    (loop for (x y width height) on rectangles by #'cddddr
          do (dolist (mark marks)
               (let ((box (list x y (+ x width) (+ y height) tile)))
                 (if (eq :box (first mark))
                     (setf boxes (nconc (apply #'mark-boxes mark box) boxes))
                     (setf segments (nconc (apply #'mark-segments mark box) segments))))))
    (when segments (paint-segments canvas gcontext segments))
    (when boxes (paint-rectangles canvas gcontext boxes t))))
