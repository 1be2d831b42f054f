;;;; substances.lisp -- how walls are told apart by what they are made of.

(in-package :ars-magna.display)

;;; A wall has the texture and the hue of its substance, and is the lighter the greater the
;;; parameter is. Hue and texture go by the order in which substances were defined; there is no
;;; common factor of how many there are of each, so that they do not come together again soon. If
;;; two substances of a map have the same texture, that which was defined later takes a free one.

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

(define-constant +wall-textures+ '(:lines :hatching :bricks :falling-hatching :plain :dots :posts
                                   :crosses :net :chequers :arrows)
  :test #'cl:equal
  :documentation "The textures of substances, in order of definition, over and over again.")

(defun substance-position (name)
  "Return how many substances were defined before that called NAME, or NIL."
  (position name (all-substances) :key #'substance-name :test #'same-name-p))

(defun substance-ink (name)
  (let ((position (substance-position name)))
    (and position (nth (mod position (length +substance-inks+)) +substance-inks+))))

;;; Lightness.

(define-constant +least-shade+ 8 :documentation "The shade of grey* that no wall is darker than.")
(define-constant +shade-of-zero+ 14 :documentation "The shade of grey* of the parameter 0.")
(define-constant +greatest-shade+ 36
  :documentation "The shade of grey* that no wall is lighter than; it is seen on white.")
(define-constant +middle-parameter+ 60
  :documentation "The parameter of which the shade is in the middle between the last two.")

(defun wall-shade (parameter)
  "Return the shade of grey* of walls with PARAMETER: the same in each map."
  (let ((part (/ parameter (+ (abs parameter) +middle-parameter+))))
    (+ +shade-of-zero+
       (round (* part (if (minusp part)
                          (- +shade-of-zero+ +least-shade+)
                          (- +greatest-shade+ +shade-of-zero+)))))))

(defun wall-color (shade hue)
  "Return the shade of grey* with the number SHADE, tinted with HUE, a colour or NIL."
  (let ((grey (svref grey* shade)))
    (if hue (tinted grey hue +tint-strength+) grey)))

;;; Looks.

(defstruct (material (:constructor make-material (hue texture)) (:copier nil))
  "What the walls of a substance look like: HUE is a colour or NIL."
  (hue nil :type (or null color) :read-only t)
  (texture :plain :type keyword :read-only t))

(defun free-texture (name taken)
  "Return the texture for the substance called NAME in a map in which others have TAKEN theirs."
  (let* ((count (length +wall-textures+))
         (first (mod (or (substance-position name) 0) count))
         (all (loop for step below count
                    collect (nth (mod (+ first step) count) +wall-textures+))))
    (or (find-if-not (lambda (texture) (member texture taken)) all)
        (first all))))

(defun textures-for (names)
  "Return a list (name texture) for each of NAMES, the substances of a map, those first that were
defined first."
  (let ((taken '()))
    (loop for name in (stable-sort (copy-list names) #'<
                                   :key (lambda (name)
                                          (or (substance-position name) most-positive-fixnum)))
          collect (list name (first (push (free-texture name taken) taken))))))

(defun materials-of (map)
  "Return a vector of the looks of the substances of MAP by their numbers."
  (let ((textures (textures-for (remove nil (coerce (map-substance-types map) 'list)))))
    (cl:map 'vector (lambda (name)
                      (make-material (and name (getf +tints+ (substance-ink name)))
                                     (or (second (assoc name textures)) :plain)))
            (map-substance-types map))))
