;;;; colors.lisp -- the colours that drawing code can name (manual B.1).

(in-package :ars-magna.canvas)

;;; A colour is an integer, as a pixel is to CLX: #xRRGGBB. Vectors run from dark to light. The
;;; manual names the vectors; their values are ours. Shade 9 of each is its plain colour. The eight
;;; plain colours were chosen, by a search over hue, chroma and lightness, so that any two of them
;;; are at least 10 apart in CIE Lab to those who see all colours, to those who miss one of the
;;; three kinds of cones, and on a print in grey; tests/palette.lisp measures it.

(deftype color ()
  "A colour as #xRRGGBB."
  '(unsigned-byte 24))

(defun mix (dark light fraction)
  "Return the colour that is FRACTION, 0 to 1, of the way from DARK to LIGHT."
  (loop with color = 0
        for position in '(16 8 0)
        for low = (ldb (byte 8 position) dark)
        for high = (ldb (byte 8 position) light)
        do (setf (ldb (byte 8 position) color) (round (+ low (* fraction (- high low)))))
        finally (return color)))

(defun shades (count dark light)
  "Return a vector of COUNT colours from DARK to LIGHT."
  (coerce (loop for index below count collect (mix dark light (/ index (1- count))))
          'simple-vector))

(public black* white* grey*)
(defvar black* #x000000 "Black, a colour for WITH-COLOR (manual B.1).")
(defvar white* #xFFFFFF "White, a colour for WITH-COLOR (manual B.1).")
(defvar grey* (shades 64 black* white*)
  "A vector of 64 shades of grey: 0 is black, 63 is white (manual B.1).")

(define-constant +plain+ 9 :documentation "The index of the plain colour in a vector of 12 shades.")

(defun shades-around (dark plain light)
  "Return a vector of 12 colours from DARK by way of PLAIN, at +PLAIN+, to LIGHT."
  (concatenate 'simple-vector
               (shades (1+ +plain+) dark plain)
               (subseq (shades (- 12 +plain+) plain light) 1)))

(defmacro define-shades (&rest definitions)
  "Define each of the variables as a vector of 12 shades around a plain colour."
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

(defun color-called (name)
  "Return the vector of shades that has the same name as NAME, the value of a :color attribute
(a symbol or string), or NIL if NAME is no colour."
  (and (typep name '(and (or symbol string) (not null)))
       (let ((variable (find-symbol (concatenate 'string (name-string name) "*")
                                    :ars-magna.canvas)))
         (and variable (boundp variable) (vectorp (symbol-value variable))
              (symbol-value variable)))))

(defun shade (name &optional (index +plain+))
  "Return shade INDEX (0, dark, to 11, light) of the colour NAME, the value of a :color
attribute. Black if NAME is none (manual B; reading 212)."
  (let ((shades (color-called name)))
    (if shades (aref shades index) black*)))
