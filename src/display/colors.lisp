;;;; colors.lisp -- the colours of manual B.1, and how well one is to be seen on another.

(in-package :ars-magna.canvas)

(export '(color shade color-called mix +least-contrast+ primaries color-of-primaries luminance
          contrast ink-on tinted))

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

;;; Contrast.

;;; Luminance and contrast are those of the Web Content Accessibility Guidelines 2.1: what is less
;;; than 3 to 1 is hard to make out.

(define-constant +least-contrast+ 3
  :documentation "How much contrast what is drawn has at least to what it lies on.")

(defun linear-light (byte)
  "Return how much light, from 0 to 1, the value BYTE of one of the three primaries means."
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
  "Return the light of red, green and blue in COLOR, as a list."
  (loop for position in '(16 8 0) collect (linear-light (ldb (byte 8 position) color))))

(defun color-of-primaries (primaries)
  "Return the colour that has PRIMARIES, a list of the light of red, green and blue."
  (reduce (lambda (color light) (logior (ash color 8) (byte-of-light light)))
          primaries :initial-value 0))

(defun luminance (color)
  "Return the relative luminance of COLOR, from 0 to 1."
  (reduce #'+ (mapcar #'* '(0.2126d0 0.7152d0 0.0722d0) (primaries color))))

(defun contrast (color other)
  "Return the contrast of COLOR to OTHER, from 1 to 21."
  (let ((a (+ 0.05d0 (luminance color))) (b (+ 0.05d0 (luminance other))))
    (/ (max a b) (min a b))))

(defun ink-on (color)
  "Return that of black and white which is seen better on COLOR; its contrast is at least 4.5."
  (if (< (contrast white* color) (contrast black* color)) black* white*))

(defun tinted (grey hue fraction)
  "Return GREY, a colour, with as much of HUE, a colour, as FRACTION says, 0 to 1, and of the same
luminance as before; so it looks the same on a print in grey."
  (let* ((light (luminance grey)) (strength (luminance hue)))
    (color-of-primaries
     (loop for primary in (primaries hue)
           collect (* light (+ (- 1 fraction) (* fraction (/ primary strength))))))))
