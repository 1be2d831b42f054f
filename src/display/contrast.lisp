;;;; contrast.lisp -- how well a colour is to be seen on another.

(in-package :ars-magna.canvas)

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
  "Return the value of a primary that means LIGHT."
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
