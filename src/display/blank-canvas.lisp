;;;; blank-canvas.lisp -- a canvas on which nothing is seen: to learn how much room a drawing takes.

(in-package :ars-magna.canvas)

(defclass blank-canvas (canvas) ()
  (:documentation "A canvas that forgets what is drawn on it."))

(defmethod paint-rectangles ((canvas blank-canvas) gcontext rectangles fill-p)
  (declare (ignore gcontext rectangles fill-p)))

(defmethod paint-arc ((canvas blank-canvas) gcontext x y width height start extent fill-p)
  (declare (ignore gcontext x y width height start extent fill-p)))

(defmethod paint-path ((canvas blank-canvas) gcontext points fill-p)
  (declare (ignore gcontext points fill-p)))

(defmethod paint-segments ((canvas blank-canvas) gcontext segments)
  (declare (ignore gcontext segments)))

(defmethod paint-string ((canvas blank-canvas) gcontext x y string)
  (declare (ignore gcontext x y string)))

(defmethod call-with-clipping (function (canvas blank-canvas) x y width height)
  (declare (ignore x y width height))
  (funcall function))

(defmethod call-with-origin (function (canvas blank-canvas) x y)
  (declare (ignore x y))
  (funcall function))
