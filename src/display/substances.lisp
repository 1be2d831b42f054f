;;;; substances.lisp -- how walls are told apart by what they are made of.

(in-package :ars-magna.display)

;;; Text maps write walls in these colours, pictures tint their greys with them.

(define-constant +substance-inks+ '(:yellow :cyan :red :blue :grey :green :lightcyan :violet
                                    :lightyellow :lightviolet)
  :test #'cl:equal
  :documentation "The colours of substances, in order of definition, over and over again.")

(define-constant +tints+ '(:yellow #xC8B060 :cyan #x58B0B8 :red #xC08878 :blue #x7890D0
                           :green #x78A878 :lightcyan #x88C4B0 :violet #xA080C8
                           :lightyellow #xC0C488 :lightviolet #xC8A4D8)
  :test #'cl:equal
  :documentation "The hues of these colours; grey has none.")

(define-constant +tint-strength+ 0.55d0 :documentation "How much of its hue a wall has.")

(defun substance-ink (name)
  "Return the colour of the substance called NAME, or NIL."
  (let ((position (position name (all-substances) :key #'substance-name :test #'same-name-p)))
    (and position (nth (mod position (length +substance-inks+)) +substance-inks+))))

(defun wall-color (shade hue)
  "Return the shade of grey* with the number SHADE, tinted with HUE, a colour or NIL."
  (let ((grey (svref grey* shade)))
    (if hue (tinted grey hue +tint-strength+) grey)))

(defun hues-of (map)
  "Return a vector of the hues, colours or NIL, of the substances of MAP by their numbers."
  (cl:map 'vector (lambda (name) (and name (getf +tints+ (substance-ink name))))
          (map-substance-types map)))
