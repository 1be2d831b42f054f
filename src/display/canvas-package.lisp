;;;; canvas-package.lisp -- the package that users know as XLIB.

(defpackage :ars-magna.canvas
  (:documentation "Drawing on anything: the part of CLX that the bodies of :graphics and of
:draw-function need, its colours, and the protocol of canvases. Manual B.1.")
  (:use :cl :ars-magna.base)
  ;; colours
  (:export #:color #:black* #:white* #:grey* #:red* #:green* #:blue* #:violet* #:lightred*
           #:lightgreen* #:lightblue* #:lightviolet* #:shade #:color-called #:mix)
  ;; contrast
  (:export #:+least-contrast+ #:primaries #:color-of-primaries #:luminance #:contrast #:ink-on
           #:tinted)
  ;; gcontext
  (:export #:gcontext #:gcontext-p #:create-gcontext #:gcontext-foreground
           #:gcontext-background #:gcontext-line-width #:gcontext-line-style
           #:gcontext-dashes #:with-gcontext
           #:draw-gcontext* #:graphics-scale* #:in-color* #:with-color #:with-lines)
  ;; canvas
  (:export #:canvas #:canvas-p #:canvas-color-p #:paint-rectangles #:paint-arc #:paint-path
           #:paint-segments #:paint-string #:call-with-clipping #:with-clipping
           #:call-with-origin #:with-origin #:call-with-subject #:with-subject
           #:subject-title #:call-on-canvas #:with-canvas #:+character-width+ #:+line-height+)
  ;; blank-canvas
  (:export #:blank-canvas)
  ;; drawing
  (:export #:*calls-left*)
  (:export #:draw-rectangle #:draw-rectangles #:draw-arc #:draw-arcs #:draw-line #:draw-lines
           #:draw-segments #:draw-point #:draw-points #:draw-glyph #:draw-glyphs
           #:draw-image-glyph #:draw-image-glyphs #:clear-area)
  ;; textures
  (:export #:+textures+ #:draw-texture)
  ;; text
  (:export #:+text-font+ #:text-width #:paint-text #:character-width #:draw-words
           #:call-with-opacity #:with-opacity)
  ;; svg
  (:export #:svg-canvas #:svg-stream #:call-with-svg #:with-svg #:write-svg #:number-text
           #:write-number #:write-text))
