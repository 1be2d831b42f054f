;;;; colors.lisp -- the colours that drawing code can name (manual B.1).

(in-package :ars-magna.canvas)

;;; A colour is an integer, as a pixel is to CLX: #xRRGGBB. Vectors run from dark to light. The
;;; manual names the vectors; their values are ours, chosen so that shade 9 of each is the plain
;;; colour, told apart from the others on white.

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

(defmacro define-shades (&rest definitions)
  "Define each of the variables as a vector of 12 colours between two."
  `(progn
     ,@(loop for (variable dark light hue) in definitions
             collect `(public ,variable)
             collect `(defvar ,variable (shades 12 ,dark ,light)
                        ,(format nil "A vector of 12 shades of ~A, from dark to light. ~
                                      (Manual B.1.)" hue)))))

(define-shades
  (red* #x500000 #xFF3C30 "red")
  (green* #x003810 #x2CC83C "green")
  (blue* #x000060 #x3C68FF "blue")
  (violet* #x280048 #xB458F4 "violet")
  (lightred* #xB02848 #xFFD8E0 "light red, that is pink")
  (lightgreen* #x207840 #xC8F8D0 "light green")
  (lightblue* #x2860B0 #xD4E8FF "light blue")
  (lightviolet* #x7838B0 #xECD8FF "light violet"))

(defun color-called (name)
  "Return the vector of shades that has the same name as NAME, the value of a :color attribute
(a symbol or string), or NIL if NAME is no colour."
  (and (typep name '(and (or symbol string) (not null)))
       (let ((variable (find-symbol (concatenate 'string (name-string name) "*")
                                    :ars-magna.canvas)))
         (and variable (boundp variable) (vectorp (symbol-value variable))
              (symbol-value variable)))))

(defun shade (name &optional (index 9))
  "Return shade INDEX (0, dark, to 11, light) of the colour NAME, the value of a :color
attribute. Black if NAME is none (manual B; reading 212)."
  (let ((shades (color-called name)))
    (if shades (aref shades index) black*)))
