;;;; svg.lisp -- a canvas that writes Scalable Vector Graphics.

(in-package :ars-magna.canvas)

(export '(svg-canvas svg-stream call-with-svg with-svg write-svg number-text write-number
          write-escaped-text))

;;; Elements are written as they are drawn, numbers with at most two decimals. What is drawn with
;;; clipping is collected first. It gets a clipping element only if it reaches beyond its box.

(defclass svg-canvas (canvas)
  ((stream :initarg :stream :accessor svg-stream)
   ;; The box of what has been drawn with clipping, (left top right bottom); NIL if not needed.
   (reach :initform nil :accessor svg-reach))
  (:documentation "A canvas that writes Scalable Vector Graphics to a stream."))
(setf (documentation 'svg-stream 'function) "Return the stream that the canvas writes to.")

;;; Numbers and attributes.

(defvar *numerals* (coerce (loop for n below 4096 collect (princ-to-string n)) 'simple-vector)
  "The integers from 0 to 4095 as strings, because most coordinates are such integers.")

(defun write-natural (integer stream)
  (if (< integer 4096)
      (write-string (the simple-string (svref *numerals* integer)) stream)
      (printing-plainly () (princ integer stream))))

(defun write-hundredths (hundredths stream)
  "Write the number HUNDREDTHS / 100 to STREAM with as few decimals as possible."
  (when (minusp hundredths) (write-char #\- stream))
  (multiple-value-bind (whole rest) (truncate (abs hundredths) 100)
    (write-natural whole stream)
    (unless (zerop rest)
      (multiple-value-bind (tenths hundredths) (truncate rest 10)
        (write-char #\. stream)
        (write-natural tenths stream)
        (unless (zerop hundredths) (write-natural hundredths stream))))))

(defun write-number (number stream)
  "Write NUMBER to STREAM with at most two decimals, limited to the range from -10^9 to 10^9."
  (if (typep number '(integer 0 4095))
      (write-natural number stream)
      (write-hundredths (round (* 100 (clamp number -1000000000 1000000000))) stream)))

(defun number-text (number)
  "Return NUMBER as a string with at most two decimals."
  (with-output-to-string (stream) (write-number number stream)))

(defun write-svg (canvas &rest parts)
  "Write PARTS, strings and numbers, to the stream of CANVAS."
  (declare (dynamic-extent parts))
  (let ((stream (svg-stream canvas)))
    (dolist (part parts)
      (if (stringp part) (write-string part stream) (write-number part stream)))))

(defun write-color (canvas gcontext attribute)
  "Write ATTRIBUTE of an element, with the foreground colour of GCONTEXT as its value."
  (write-svg canvas " " attribute "=\"#")
  (loop for position from 20 downto 0 by 4
        do (write-char (char "0123456789abcdef"
                             (ldb (byte 4 position) (gcontext-foreground gcontext)))
                       (svg-stream canvas)))
  (write-svg canvas "\""))

(defun write-stroke (canvas gcontext)
  (write-svg canvas " fill=\"none\"")
  (write-color canvas gcontext "stroke")
  (let ((width (gcontext-line-width gcontext)))
    (unless (<= width 1) (write-svg canvas " stroke-width=\"" width "\"")))
  (unless (eq (gcontext-line-style gcontext) :solid)
    (write-svg canvas " stroke-dasharray=\"")
    (loop for (dash . more) on (ensure-list (gcontext-dashes gcontext))
          do (write-svg canvas dash (if more "," "")))
    (write-svg canvas "\""))
  (write-svg canvas "/>
"))

(defun write-shape-element-end (canvas gcontext fill-p)
  "Write the end of an element that is filled if FILL-P, else outlined."
  (cond (fill-p (write-color canvas gcontext "fill")
                (write-svg canvas "/>
"))
        (t (write-stroke canvas gcontext))))

(defun write-escaped-text (text stream)
  "Write TEXT to STREAM with the special characters of SVG escaped."
  (write-xml-text (substitute-if-not #\Space #'graphic-char-p (string text)) stream))

(defun write-text-element-end (canvas gcontext string)
  (write-color canvas gcontext "fill")
  (write-svg canvas ">")
  (write-escaped-text string (svg-stream canvas))
  (write-svg canvas "</text>
"))

;;; Painting.

(defun extend-svg-reach (canvas left top right bottom)
  (let ((reach (svg-reach canvas)))
    (when reach
      (setf (svg-reach canvas)
            (list (min left (first reach)) (min top (second reach))
                  (max right (third reach)) (max bottom (fourth reach)))))))

(defun pen-reach (gcontext)
  "Return half the width of lines of GCONTEXT, in pixels: how far a line reaches beyond its path."
  (/ (max 1 (gcontext-line-width gcontext)) 2))

(defmethod paint-rectangles ((canvas svg-canvas) gcontext rectangles fill-p)
  (let* ((numbers (coerce rectangles 'list))
         (shift (if fill-p 0 1/2))
         (pen (if fill-p 0 (pen-reach gcontext))))
    (flet ((reach (x y width height)
             (extend-svg-reach canvas (- x pen) (- y pen) (+ x width pen) (+ y height pen))))
      (if (= (length numbers) 4)
          (destructuring-bind (x y width height) numbers
            (let ((x (+ x shift)) (y (+ y shift)))
              (reach x y width height)
              (write-svg canvas "<rect x=\"" x "\" y=\"" y "\" width=\"" width
                         "\" height=\"" height "\"")))
          (loop initially (write-svg canvas "<path d=\"")
                for (x y width height) on numbers by #'cddddr
                do (let ((x (+ x shift)) (y (+ y shift)))
                     (reach x y width height)
                     (write-svg canvas "M" x " " y "h" width "v" height "h" (- width) "z"))
                finally (write-svg canvas "\"")))))
  (write-shape-element-end canvas gcontext fill-p))

(defun write-arc-start (canvas x y width height start extent fill-p)
  "Write the beginning of a path element for an arc of less than a full turn."
  (let* ((across (/ width 2)) (down (/ height 2))
         (center-x (+ x across)) (center-y (+ y down)))
    (flet ((spot (angle)
             (write-svg canvas (+ center-x (* across (cosine angle))) " "
                        (- center-y (* down (sine angle))))))
      (write-svg canvas "<path d=\"M")
      (when fill-p (write-svg canvas center-x " " center-y "L"))
      (spot start)
      (write-svg canvas "A" across " " down " 0 "
                 (if (> (abs extent) pi) 1 0) " " (if (minusp extent) 1 0) " ")
      (spot (+ start extent))
      (write-svg canvas (if fill-p "z\"" "\"")))))

(defun write-ellipse-start (canvas x y width height pen)
  "Write the start of an ellipse element. Its line, 2 PEN wide, touches the box from inside."
  (extend-svg-reach canvas x y (+ x width) (+ y height))
  (write-svg canvas "<ellipse cx=\"" (+ x (/ width 2)) "\" cy=\"" (+ y (/ height 2))
             "\" rx=\"" (max 0 (- (/ width 2) pen)) "\" ry=\"" (max 0 (- (/ height 2) pen)) "\""))

(defmethod paint-arc ((canvas svg-canvas) gcontext x y width height start extent fill-p)
  (let ((pen (if fill-p 0 (pen-reach gcontext))))
    (cond ((>= (abs extent) (- (* 2 pi) 1d-9))
           (write-ellipse-start canvas x y width height pen))
          (t (extend-svg-reach canvas (- x pen) (- y pen) (+ x width pen) (+ y height pen))
             (write-arc-start canvas x y width height start extent fill-p))))
  (write-shape-element-end canvas gcontext fill-p))

(defun write-points (canvas gcontext numbers shift)
  "Write NUMBERS, a list x y x y ..., as x,y x,y ... with SHIFT added to each coordinate."
  (loop with pen = (pen-reach gcontext)
        for (x y) on numbers by #'cddr
        do (let ((x (+ x shift)) (y (+ y shift)))
             (extend-svg-reach canvas (- x pen) (- y pen) (+ x pen) (+ y pen))
             (write-svg canvas x "," y " "))))

(defmethod paint-path ((canvas svg-canvas) gcontext points fill-p)
  (write-svg canvas (if fill-p "<polygon points=\"" "<polyline points=\""))
  (write-points canvas gcontext (coerce points 'list) (if fill-p 0 1/2))
  (write-svg canvas "\"")
  (write-shape-element-end canvas gcontext fill-p))

(defmethod paint-segments ((canvas svg-canvas) gcontext segments)
  (write-svg canvas "<path d=\"")
  (loop for (x1 y1 x2 y2) on (coerce segments 'list) by #'cddddr
        do (write-svg canvas "M")
           (write-points canvas gcontext (list x1 y1) 1/2)
           (write-svg canvas "L")
           (write-points canvas gcontext (list x2 y2) 1/2))
  (write-svg canvas "\"")
  (write-stroke canvas gcontext))

(defmethod paint-string ((canvas svg-canvas) gcontext x y string)
  (extend-svg-reach canvas x (- y 10) (+ x (* +character-width+ (length string))) (+ y 3))
  (write-svg canvas "<text x=\"" x "\" y=\"" y "\"")
  (write-text-element-end canvas gcontext string))

;;; Where.

(defun collect-output (canvas function)
  "Call FUNCTION. Return two values: the text that FUNCTION has written to CANVAS, and the box (left
top right bottom) of what it has drawn."
  (let ((stream (svg-stream canvas)) (reach (svg-reach canvas)))
    (setf (svg-reach canvas) (list 1d9 1d9 -1d9 -1d9))
    (unwind-protect
         (values (with-output-to-string (scratch)
                   (setf (svg-stream canvas) scratch)
                   (funcall function))
                 (svg-reach canvas))
      (setf (svg-stream canvas) stream (svg-reach canvas) reach))))

(defmethod call-with-clipping (function (canvas svg-canvas) x y width height)
  (multiple-value-bind (text reach) (collect-output canvas function)
    (destructuring-bind (left top right bottom) reach
      (extend-svg-reach canvas (max x left) (max y top)
                        (min (+ x width) right) (min (+ y height) bottom))
      (if (or (string= text "")
              (and (<= x left) (<= y top) (<= right (+ x width)) (<= bottom (+ y height))))
          (write-svg canvas text)
          (write-svg canvas "<svg x=\"" x "\" y=\"" y "\" width=\"" width "\" height=\"" height
                     "\" viewBox=\"" x " " y " " width " " height "\" overflow=\"hidden\">
" text "</svg>
")))))

(defmethod call-with-origin (function (canvas svg-canvas) x y)
  (multiple-value-bind (text reach) (collect-output canvas function)
    (destructuring-bind (left top right bottom) reach
      (extend-svg-reach canvas (+ x left) (+ y top) (+ x right) (+ y bottom)))
    (write-svg canvas "<g transform=\"translate(" x "," y ")\">
" text "</g>
")))

(defmethod paint-text ((canvas svg-canvas) gcontext x y string size anchor upward-p bold-p)
  (let ((reach (text-width string size bold-p)))
    (extend-svg-reach canvas (- x reach) (- y reach) (+ x reach) (+ y reach)))
  (write-svg canvas "<text x=\"" x "\" y=\"" y "\" font-size=\"" size "\" text-anchor=\""
             (string-downcase anchor) "\"" (if bold-p " font-weight=\"bold\"" ""))
  (when upward-p (write-svg canvas " transform=\"rotate(-90," x "," y ")\""))
  (write-text-element-end canvas gcontext string))

(defmethod character-width ((canvas svg-canvas) size)
  (* 61/100 size))

(defmethod call-with-opacity (function (canvas svg-canvas) opacity)
  (write-svg canvas "<g opacity=\"" opacity "\">
")
  (multiple-value-prog1 (funcall function)
    (write-svg canvas "</g>
")))

(defmethod call-with-subject (function (canvas svg-canvas) subject)
  (write-svg canvas "<g><title>")
  (write-escaped-text (subject-title subject) (svg-stream canvas))
  (write-svg canvas "</title>
")
  (multiple-value-prog1 (funcall function)
    (write-svg canvas "</g>
")))

(defun write-document (body width height stream font zoom)
  (let ((canvas (make-instance 'svg-canvas :stream stream)))
    (write-svg canvas "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" (* zoom width)
               "\" height=\"" (* zoom height) "\" viewBox=\"0 0 " width " " height
               "\" font-family=\"" font "\" font-size=\"11.6\""
               " xml:space=\"preserve\">
<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>
" body "</svg>
")))

(defun call-with-svg (function stream &key (color-p t) (font "DejaVu Sans Mono, monospace")
                                        (zoom 1))
  "Call FUNCTION with a canvas. Then write the drawing to STREAM as an SVG document on white, with
text in the font family FONT. FUNCTION must return the width and height of the drawing in pixels, as
two values. The document is ZOOM times as large as the drawing."
  (let* ((width 0) (height 0)
         (body (with-output-to-string (scratch)
                 (setf (values width height)
                       (printing-plainly ()
                         (funcall function (make-instance 'svg-canvas :stream scratch
                                                                      :color-p color-p)))))))
    (printing-plainly () (write-document body width height stream font zoom))))

(defmacro with-svg ((canvas stream &rest options) &body body)
  "Run BODY, which draws on CANVAS and returns the width and height of the drawing in pixels, as two
values. Then write the drawing to STREAM as an SVG document. OPTIONS: :color-p, :font, :zoom."
  `(call-with-svg (lambda (,canvas) ,@body) ,stream ,@options))
