;;;; bars.lisp -- the life of a task as a bar over ticks, on any canvas.

(in-package :ars-magna.rpl-pictures)

(defconstant +label-width+ 330 "How wide the column with the names of the tasks is, in pixels.")
(defconstant +chart-width+ 900 "How wide all ticks together are, in pixels.")
(defconstant +row-height+ 19 "How high a row is, in pixels.")
(defconstant +top+ 74 "How much room there is above the rows, in pixels.")

(defparameter *looks*
  '((:parts #x9DB9DC "runs its parts") (:call #xDDD3EF "commands in a call")
    (:waiting #xE6ECF5 "waits")
    (:blocked #x8C8C94 "is blocked") (:cleaning #xF2BE6A "cleans up")
    (:failure #xF08C78 "a failure happened")
    (:command #x3C68FF "command under way") (:trouble #xE0301E "command with an error"))
  "Lists (kind color text): what the parts of a bar look like, and what the legend says.")

(defparameter *end-looks*
  '((:succeeded #x1E9632 "succeeded") (:failed #xE0301E "failed")
    (:evaporated #x606060 "evaporated"))
  "Lists (outcome color text): what the end of a bar looks like.")

(defun look (kind) (second (assoc kind *looks*)))

;;; Ticks and pixels.

(defstruct (scale (:constructor make-scale (start end &optional (left +label-width+)
                                                          (width +chart-width+)))
                  (:copier nil))
  "The ticks from START to END, which lie beside each other from LEFT on, WIDTH pixels wide."
  (start 0 :type real :read-only t)
  (end 0 :type real :read-only t)
  (left 0 :type real :read-only t)
  (width 1 :type real :read-only t))

(defun scale-span (scale)
  (max 1 (- (scale-end scale) (scale-start scale))))

(defun place (tick scale)
  "Return where TICK is, in pixels from the left."
  (+ (scale-left scale)
     (* (scale-width scale) (/ (- tick (scale-start scale)) (scale-span scale)))))

(defun tick-at (x scale)
  "Return the tick that is X pixels from the left in SCALE, a whole number; NIL if none is there."
  (let ((tick (+ (scale-start scale)
                 (round (* (scale-span scale) (- x (scale-left scale))) (scale-width scale)))))
    (and (<= (scale-left scale) x) (<= (scale-start scale) tick (scale-end scale))
         tick)))

(defun nice-step (span &optional (most 12))
  "Return how many ticks of SPAN there should be from one label to the next, for about MOST of them:
1, 2 or 5 times a power of ten."
  (loop for power = 1 then (* 10 power)
        thereis (loop for factor in '(1 2 5)
                      when (<= (/ span (* factor power)) most) return (* factor power))))

(defun box (canvas color x y width height)
  (with-color color
    (draw-rectangle canvas draw-gcontext* x y (max 1 width) height t)))

(defun write-at (canvas x y text &optional (color black*))
  (with-color color (draw-glyphs canvas draw-gcontext* x y text)))

(defun fitted (text width)
  "Return TEXT, or its beginning, if it is to be WIDTH pixels wide; NIL if nothing of use fits."
  (let ((count (floor width +character-width+)))
    (cond ((<= (length text) count) text)
          ((>= count 8) (cut text count)))))

;;; A bar.

(defun last-tick (bar)
  "Return the last tick that BAR, its parts or commands reach."
  (reduce #'max (append (mapcar #'span-end (bar-commands bar)) (mapcar #'last-tick (bar-parts bar)))
          :initial-value (bar-end bar)))

(defun draw-span (canvas span y scale)
  (let* ((x (place (span-start span) scale))
         (width (- (place (span-end span) scale) x))
         (text (and (eq :waiting (span-kind span)) (span-text span)
                    (fitted (span-text span) (- width 6)))))
    (box canvas (look (span-kind span)) x y width 14)
    (box canvas #xA8B4C8 x y 1 14)
    (when text (write-at canvas (+ x 3) (+ y 11) text #x505868))))

(defun draw-command (canvas span y scale)
  (let* ((x (place (span-start span) scale))
         (width (- (place (span-end span) scale) x)))
    (with-subject (canvas (format nil "~A, ticks ~A to ~A~@[: ~A~]" (span-text span)
                                  (span-start span) (span-end span) (span-error span)))
      (box canvas (look (if (span-error span) :trouble :command)) x (+ y 11) width 4))))

;; Also of failures that are handled where they happen.
(defun draw-failure (canvas span y scale)
  (with-subject (canvas (format nil "failed at tick ~A: ~A" (span-start span)
                                (cut (one-line (span-text span)) 200)))
    (box canvas (look :failure) (- (place (span-start span) scale) 2) y 4 6)))

(defun draw-mark (canvas outcome x y)
  "Draw how a task ended: a line, and a cross if it failed or was ended. NIL: it goes on."
  (let ((color (second (assoc outcome *end-looks*))))
    (when color
      (box canvas color (- x 1) y 2 14)
      (unless (eq :succeeded outcome)
        (with-color color
          (with-lines (:width 2)
            (draw-segments canvas draw-gcontext* (list (- x 4) (+ y 3) (+ x 4) (+ y 11)
                                                       (- x 4) (+ y 11) (+ x 4) (+ y 3)))))))))

(defmethod subject-title ((bar bar))
  (format nil "~A, ticks ~A to ~A~@[, ~(~A~)~]~@[: ~A~]" (bar-label bar) (bar-start bar)
          (bar-end bar) (bar-outcome bar)
          (and (bar-failure bar) (cut (one-line (own-text (bar-failure bar))) 200))))

(defun draw-bar (canvas bar y scale)
  "Draw BAR with its upper edge at Y."
  (let ((x (place (bar-start bar) scale)))
    (with-subject (canvas bar)
      (box canvas (look (if (bar-call-p bar) :call :parts))
           x y (- (place (bar-end bar) scale) x) 14)
      (dolist (kind '(:waiting :cleaning :blocked))
        (dolist (span (bar-spans bar))
          (when (eq kind (span-kind span)) (draw-span canvas span y scale)))))
    (dolist (span (bar-spans bar))
      (when (eq :failure (span-kind span)) (draw-failure canvas span y scale)))
    (dolist (span (bar-commands bar)) (draw-command canvas span y scale))))
