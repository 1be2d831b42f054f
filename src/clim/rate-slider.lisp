;;;; rate-slider.lisp -- the slider in the tool bar for the rate of ticks.

(in-package :ars-magna.clim)

;;; The scale is logarithmic. Its last position, after a gap, is "as fast as possible". A rate
;;; outside the scale, as the line RATE can set, is shown at the nearer end. The number beside the
;;; slider is always the true rate.

(defconstant +lowest-rate+ 1/2 "The lowest rate on the slider, in ticks per second.")
(defconstant +highest-rate+ 1000 "The highest rate on the slider, in ticks per second.")

(define-constant +slider-rates+
    (append '(1/2 7/10)
            (loop for power in '(1 10 100)
                  append (loop for digit in '(1 3/2 2 3 4 5 7) collect (* power digit)))
            (list +highest-rate+))
  :test #'equal
  :documentation "The rates that dragging the slider can set, in ticks per second, besides :FREE.")

(define-constant +marked-rates+ '(1 10 100 1000)
  :test #'equal
  :documentation "The rates that have a mark on the slider.")

(defconstant +gap-before-free+ 14
  "The distance on the slider from the highest rate to as fast as possible, in pixels.")
(defconstant +rate-text-width+ 54 "The width of the rate beside the slider, in pixels.")
(defconstant +least-track-width+ 80 "The least width of the slider's track, in pixels.")
(defconstant +greatest-track-width+ 240 "The greatest width of the slider's track, in pixels.")

(defun track-offset-of-rate (rate width)
  "Return how far from the left end of a track WIDTH pixels wide RATE is, in pixels."
  (if (eq rate :free)
      width
      (flet ((height (rate) (logarithm (/ rate +lowest-rate+))))
        (round (* (- width +gap-before-free+)
                  (/ (height (clamp rate +lowest-rate+ +highest-rate+))
                     (height +highest-rate+)))))))

(defun rate-at-track-offset (offset width)
  "Return the rate OFFSET pixels from the left end of a track WIDTH pixels wide."
  (flet ((distance (rate) (abs (- offset (track-offset-of-rate rate width)))))
    (reduce (lambda (best rate) (if (< (distance rate) (distance best)) rate best))
            (append +slider-rates+ '(:free)))))

(defun rate-of-next-step (rate factor)
  "Return RATE, a number or :FREE, times FACTOR. The step above +HIGHEST-RATE+ is :FREE. A FACTOR
below 1 gives no rate below +LOWEST-RATE+."
  (cond ((and (eq rate :free) (< factor 1)) +highest-rate+)
        ((or (eq rate :free) (and (> factor 1) (>= rate +highest-rate+))) :free)
        ((> factor 1) (min +highest-rate+ (* rate factor)))
        (t (max (min rate +lowest-rate+) (* rate factor)))))

;;; Texts.

(defun short-rate-text (rate)
  "Return RATE, a number, :FREE or NIL, as a text for the tool bar."
  (cond ((eq rate :free) "free")
        (rate (format nil "~A/s" (number-text rate)))
        (t "no rate")))

(define-constant +no-rate-text+
    "Time passes in this run only while commands need it, so there is no tick rate."
  :test #'equal
  :documentation "The message that a run has no tick rate.")

(defun rate-hover-text (rate)
  (if rate
      (format nil "Rate: ~:[~A ticks per second~;as fast as possible, while a command or plan is ~
                   under way~*~]. Drag, click or turn the mouse wheel to change it (keys: - and +)"
              (eq rate :free) (and (realp rate) (number-text rate)))
      +no-rate-text+))

;;; Painting.

(defstruct (rate-slider (:constructor make-rate-slider (buttons)) (:copier nil))
  "The slider of the tool bar. BUTTONS are the buttons whose keys step it; they are not drawn."
  (buttons '() :type list :read-only t))

(defun draw-track (canvas rate left width y)
  "Draw a track WIDTH pixels wide from LEFT on around Y, with its thumb at RATE unless that is NIL."
  (with-gcontext (draw-gcontext* :foreground +border-color+)
    (draw-segments canvas draw-gcontext* (list left y (+ left width (- +gap-before-free+)) y))
    (dolist (mark (append +marked-rates+ '(:free)))
      (let ((x (+ left (track-offset-of-rate mark width))))
        (draw-segments canvas draw-gcontext* (list x (- y 3) x (+ y 3))))))
  (when rate
    (let ((x (+ left (track-offset-of-rate rate width) -4)))
      (with-gcontext (draw-gcontext* :foreground +lit-color+)
        (draw-rectangle canvas draw-gcontext* x (- y 8) 8 16 t))
      (with-gcontext (draw-gcontext* :foreground +border-color+)
        (draw-rectangle canvas draw-gcontext* x (- y 8) 8 16)))))

(defun draw-rate-slider (canvas slider rate x width height)
  "Draw SLIDER at RATE from X on, WIDTH pixels wide and HEIGHT high. Return two values: the left end
and the width of its track."
  (let* ((left (+ x 8)) (track (- width 16 +rate-text-width+)))
    (with-subject (canvas slider)
      (with-gcontext (draw-gcontext* :foreground +bar-color+)
        (draw-rectangle canvas draw-gcontext* x 0 width height t))
      (draw-track canvas rate left track (floor height 2))
      (draw-label canvas (+ left track 10) (+ (floor height 2) 4) (short-rate-text rate)))
    (values left track)))
