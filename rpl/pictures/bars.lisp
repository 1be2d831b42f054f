;;;; bars.lisp -- a task as a bar over ticks, on any canvas.

(in-package :ars-magna.rpl-pictures)

(export '(tick-at))

(defconstant +greatest-label-width+ 480
  "The greatest width of the column with the names of the tasks, in pixels.")
(defconstant +tick-width+ 8
  "The width of a tick, in pixels, unless the timeline has very few or very many ticks.")
(defconstant +least-chart-width+ 280 "The least width of all ticks together, in pixels.")
(defconstant +greatest-chart-width+ 900 "The greatest width of all ticks together, in pixels.")
(defconstant +bar-height+ 14 "The height of a bar, in pixels.")
(defconstant +lane-height+ 12 "The height of the commands below a bar, in pixels.")
(defconstant +row-gap+ 5 "The gap between rows, in pixels.")
(defconstant +legend-line-height+ 18 "The distance between lines of the legend, in pixels.")

(defparameter *bar-looks*
  '((:parts #x5A81C2 :hatching "runs its parts") (:call #xA6BDF7 :dots "commands in a call")
    (:waiting #xEBD6FC :plain "waits")
    (:blocked #x564533 :chequers "is blocked") (:cleaning #xDA8C5A :crosses "cleans up")
    (:failure #x15091B :wedge "a failure happened")
    (:command #x19168F :solid "command under way")
    (:trouble #xC41C1A :frame "command that failed"))
  "Lists (kind color texture text): the look of each kind of part of a bar, and its text in the
legend. TEXTURE, a name of a texture or :SOLID, :FRAME or :WEDGE, is used in pictures without
colours. The colours differ for any colour vision and in grey: tests/palette.lisp measures this.")

(defparameter *end-looks*
  '((:succeeded #x1E9632 "succeeded") (:failed #xE0301E "failed")
    (:evaporated #x606060 "evaporated"))
  "Lists (outcome color text): the colour of the end of a bar, and its text in the legend.")

;;; Ticks and pixels.

(defstruct (scale (:constructor make-scale (start end &optional (left +greatest-label-width+)
                                                          (width +greatest-chart-width+)))
                  (:copier nil))
  "A horizontal axis: the ticks from START to END begin at LEFT pixels and take WIDTH pixels."
  (start 0 :type real :read-only t)
  (end 0 :type real :read-only t)
  (left 0 :type real :read-only t)
  (width 1 :type real :read-only t))

(defun scale-span (scale)
  (max 1 (- (scale-end scale) (scale-start scale))))

(defun x-of-tick (tick scale)
  (+ (scale-left scale)
     (* (scale-width scale) (/ (- tick (scale-start scale)) (scale-span scale)))))

(defun tick-at (x scale)
  "Return the tick, a whole number, at the x coordinate X on SCALE, or NIL if there is no tick."
  (let ((tick (+ (scale-start scale)
                 (round (* (scale-span scale) (- x (scale-left scale))) (scale-width scale)))))
    (and (<= (scale-left scale) x) (<= (scale-start scale) tick (scale-end scale))
         tick)))

(defun axis-tick-step (span &optional (most 12))
  "Return the number of ticks between two labels of an axis that shows SPAN ticks with at most about
MOST labels. The number is 1, 2 or 5 times a power of ten."
  (loop for power = 1 then (* 10 power)
        thereis (loop for factor in '(1 2 5)
                      when (<= (/ span (* factor power)) most) return (* factor power))))

(defun draw-box (canvas color x y width height)
  (with-color color
    (draw-rectangle canvas draw-gcontext* x y (max 1 width) height t)))

(defun draw-frame (canvas x y width height)
  "Draw a white box with a black outline, which is thicker if there is room."
  (with-color black* (draw-rectangle canvas draw-gcontext* x y width height t))
  (let ((thick (if (< width 7) 1 2)))
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-rectangle canvas draw-gcontext* (+ x thick) (+ y thick)
                      (max 0 (- width thick thick)) (- height thick thick) t))))

(defun draw-black-wedge (canvas x y width height)
  (flet ((draw (color more)
           (with-gcontext (draw-gcontext* :foreground color)
             (draw-lines canvas draw-gcontext*
                         (list (- x more) y (+ x width more) y (+ x (/ width 2)) (+ y height more))
                         :fill-p t))))
    (draw white* 2)
    (draw black* 0)))

(defun draw-textured-box (canvas texture x y width height)
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-rectangle canvas draw-gcontext* x y width height t))
  (with-color black*
    (draw-texture canvas draw-gcontext* texture (list x y width height) 6)
    (draw-rectangle canvas draw-gcontext* x y (max 0 (1- width)) (max 0 (1- height)))))

(defun draw-colourless-box (canvas texture x y width height)
  "Draw a box in black and white in the look TEXTURE, one of those in *BAR-LOOKS*."
  (case texture
    (:solid (draw-box canvas black* x y width height))
    (:frame (draw-frame canvas x y width height))
    (:wedge (draw-black-wedge canvas x y width height))
    (t (draw-textured-box canvas texture x y width height))))

(defun draw-bar-look (canvas kind x y width height)
  (destructuring-bind (color texture text) (rest (assoc kind *bar-looks*))
    (declare (ignore text))
    (if in-color*
        (draw-box canvas color x y width height)
        (draw-colourless-box canvas texture x y (max 1 width) height))))

(defun write-text-at (canvas x y text &optional (color black*))
  (with-color color (draw-glyphs canvas draw-gcontext* x y text)))

(defun cut-to-width (text width)
  "Return TEXT, cut to fit into WIDTH pixels. Return NIL if only a few characters would fit."
  (let ((count (floor width +character-width+)))
    (cond ((<= (length text) count) text)
          ((>= count 8) (cut text count)))))

;;; A bar.

(defun last-tick-of-bar (bar)
  (reduce #'max (append (mapcar #'span-end (bar-commands bar))
                        (mapcar #'last-tick-of-bar (bar-parts bar)))
          :initial-value (bar-end bar)))

(defun span-width (span scale)
  (- (x-of-tick (span-end span) scale) (x-of-tick (span-start span) scale)))

(defun draw-span (canvas span y scale)
  (let ((x (x-of-tick (span-start span) scale)))
    (draw-bar-look canvas (span-kind span) x y (span-width span scale) +bar-height+)
    (draw-box canvas #xA8B4C8 x y 1 +bar-height+)))

(defun write-wait-text (canvas span next y scale)
  "Write the text of SPAN, a wait, as far as there is room before NEXT, the next span or NIL."
  (let* ((x (x-of-tick (span-start span) scale))
         (end (if next
                  (min (x-of-tick (span-end span) scale) (x-of-tick (span-start next) scale))
                  (x-of-tick (span-end span) scale)))
         (text (and (span-text span) (cut-to-width (span-text span) (- end x 6)))))
    (when text (write-text-at canvas (+ x 3) (+ y 11) text #x505868))))

(defun draw-waits (canvas spans y scale)
  "Draw SPANS, which are waits, and then their texts on top."
  (let ((spans (stable-sort (copy-list spans) #'< :key #'span-start)))
    (dolist (span spans) (draw-span canvas span y scale))
    (loop for (span next) on spans do (write-wait-text canvas span next y scale))))

;;; Commands stand in a separate lane, so that neither they nor their names lie on others'.

(defconstant +command-size+ 9 "The height of the font of commands, in pixels.")

(defun shorten-decimals (token)
  "Return the string TOKEN. If TOKEN is a number with decimals, keep only two decimals."
  (if (and (find #\. token) (every (lambda (char) (find char "+-.0123456789def")) token)
           (find-if #'digit-char-p token))
      (let ((end (position-if (lambda (char) (find char "def")) token))
            (dot (position #\. token)))
        (subseq token 0 (min (or end (length token)) (+ dot 3))))
      token))

(defun command-text (span)
  "Return the text of the command of SPAN, without parentheses and the prefix rpl-. Numbers are cut
to two decimals, and a long text to its beginning."
  (let* ((text (string-trim "()" (span-text span)))
         (own (if (eql 0 (search "rpl-" text)) (subseq text 4) text)))
    (cut (format nil "~{~A~^ ~}" (mapcar #'shorten-decimals (uiop:split-string own))) 56)))

(defun command-ink (span)
  (if (and (failure-code-p (span-error span)) (not in-color*)) black* white*))

(defun find-command-text-place (length x width from to)
  "The box of a command begins at X and is WIDTH pixels wide. Return the x coordinate for the
command's name, LENGTH pixels wide, and whether the name is on the box. The name is on the box, or
after or before the box, between FROM and TO. Return NIL if there is no room."
  (cond ((<= (+ 4 length) width) (values (+ x 2) t))
        ((<= (+ x width 6 length) to) (+ x width 3))
        ((<= from (- x 6 length)) (- x 3 length))))

(defun clear-behind-text (canvas x y width)
  "Draw a white background for a name in a lane at Y, so that no line runs through the name."
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-rectangle canvas draw-gcontext* (- x 1) y (+ 2 width) +lane-height+ t)))

(defun write-command (canvas span x y width from to)
  "The box of the command SPAN begins at X and is WIDTH pixels wide. Write the command's name on the
box, or beside the box between FROM and TO. Without room for the name, write its beginning on the
box. Return the x coordinate where box and name end."
  (let* ((name (command-text span))
         (per-character (character-width canvas +command-size+))
         (length (* per-character (length name)))
         (fitting (floor (- width 4) per-character)))
    (flet ((words (color at text)
             (with-gcontext (draw-gcontext* :foreground color)
               (draw-words canvas draw-gcontext* at (+ y 9) text :size +command-size+))))
      (multiple-value-bind (at on-it-p) (find-command-text-place length x width from to)
        (when (and at (not on-it-p)) (clear-behind-text canvas at y length))
        (cond (at (words (if on-it-p (command-ink span) black*) at name))
              ((<= 7 fitting) (words (command-ink span) (+ x 2) (cut name fitting))))
        (max (+ x width) (if at (+ at length) 0))))))

(defun command-title (span)
  (let ((code (span-error span)))
    (format nil "~A, ticks ~A to ~A~@[: ~(~A~)~]~@[. ~A~]" (span-text span) (span-start span)
            (span-end span) code (and code (error-code-meaning code)))))

(defun draw-command (canvas span next from y scale)
  "Draw SPAN, a command, in the lane at Y, which is free from the x coordinate FROM on. NEXT is the
next command in the lane, or NIL. Return the x coordinate from which the lane is free afterwards."
  (let ((x (x-of-tick (span-start span) scale)) (width (span-width span scale))
        (to (if next
                (x-of-tick (span-start next) scale)
                (+ 40 (x-of-tick (scale-end scale) scale)))))
    (with-subject (canvas (command-title span))
      (draw-bar-look canvas (if (failure-code-p (span-error span)) :trouble :command)
                x y width +lane-height+)
      (write-command canvas span x y width from to))))

(defun draw-command-lane (canvas spans y scale)
  (loop with free = (scale-left scale)
        for (span next) on (stable-sort (copy-list spans) #'< :key #'span-start)
        do (setf free (draw-command canvas span next free y scale))))

;; Also of failures that are handled where they happen.
(defun draw-failure (canvas span y scale)
  (with-subject (canvas (format nil "failed at tick ~D: ~A" (span-start span)
                                (cut (one-line (span-text span)) 200)))
    (let ((half (if in-color* 2 4)))
      (draw-bar-look canvas :failure (- (x-of-tick (span-start span) scale) half) y
                     (* 2 half) (* 3 half)))))

(defun draw-end-mark (canvas outcome x y)
  "Draw the mark at the end of a task by its OUTCOME: a line, which is crossed out if the task
failed, and struck through if it was ended. Draw nothing if OUTCOME is NIL."
  (let ((color (second (assoc outcome *end-looks*))))
    (when color
      (draw-box canvas color (- x 1) y 2 +bar-height+)
      (with-color color
        (with-lines (:width 2)
          (unless (eq :succeeded outcome)
            (draw-segments canvas draw-gcontext* (list (- x 4) (+ y 11) (+ x 4) (+ y 3))))
          (when (eq :failed outcome)
            (draw-segments canvas draw-gcontext* (list (- x 4) (+ y 3) (+ x 4) (+ y 11)))))))))

(defmethod subject-title ((bar bar))
  (format nil "~A, ticks ~A to ~A~@[, ~(~A~)~]~@[: ~A~]" (bar-label bar #'whole-form-text)
          (bar-start bar) (bar-end bar) (bar-outcome bar)
          (and (bar-failure bar) (cut (one-line (printable-report (bar-failure bar))) 200))))

(defun spans-of-kind (bar kind)
  (remove kind (bar-spans bar) :key #'span-kind :test-not #'eq))

(defun draw-bar (canvas bar y scale)
  "Draw BAR, a task, with its upper edge at Y."
  (let ((x (x-of-tick (bar-start bar) scale)))
    (with-subject (canvas bar)
      (draw-bar-look canvas (if (bar-call-p bar) :call :parts)
                     x y (- (x-of-tick (bar-end bar) scale) x) +bar-height+)
      (draw-waits canvas (spans-of-kind bar :waiting) y scale)
      (dolist (kind '(:cleaning :blocked))
        (dolist (span (spans-of-kind bar kind)) (draw-span canvas span y scale))))
    (dolist (span (spans-of-kind bar :failure)) (draw-failure canvas span y scale))))
