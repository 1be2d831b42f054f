;;;; picture.lisp -- a map with the ways of many trials, by their outcomes.

(in-package :ars-magna.trails)

(export '(save-picture-of-ways))

(defparameter *outcome-looks*
  '(("success" 0 #x0C3C9C 3/2 nil "succeeded") ("limit" 4 #xB07000 2 (6 3) "came to the limit")
    ("failure" 1 #xC22418 5/2 nil "failed")
    ("error" 3 #x000000 5/2 (2 3) "broke off with an error"))
  "How to draw ways, by outcome: lists (outcome marker color width dashes words), in the order of
the legend. Ways are drawn in this order, too: failed trials, which matter most, above others.")

(defun outcome-look (way)
  (rest (assoc (way-outcome way) *outcome-looks* :test #'string=)))

(defun ways-of-outcome (outcome ways)
  (remove outcome ways :key #'way-outcome :test-not #'string=))

(defun way-opacity (count)
  (clamp (/ 8 (max 1 count)) 12/100 6/10))

(defun draw-way-polyline (canvas points look)
  (destructuring-bind (marker color width dashes words) look
    (declare (ignore marker words))
    (with-color color
      (with-dashes (dashes :width width)
        (draw-lines canvas draw-gcontext* points)))))

(defun draw-way (canvas way)
  (let ((look (outcome-look way)))
    (dolist (points (pieces-in-pixels (way-pieces way)))
      (when (cddr points) (draw-way-polyline canvas points look)))))

(defconstant +end-opacity+ 8/10 "The opacity of the marker at the end of a way.")

(defun draw-arrows-on-ways (canvas ways)
  (draw-way-arrows canvas (loop for way in ways
                            collect (make-way-line 0 (pieces-in-pixels (way-pieces way))
                                                   :color (second (outcome-look way))))))

(defun robot-at-p (snapshot x y)
  (find-if (lambda (robot)
             (and (< (abs (- x (robot-image-x robot))) 1/10)
                  (< (abs (- y (robot-image-y robot))) 1/10)))
           (snapshot-robots snapshot)))

(defun start-points (ways snapshot)
  "Return the points (x y), in metres, at which WAYS begin, without duplicates and without the
points at which SNAPSHOT shows a robot."
  (remove-duplicates (loop for way in ways
                           for ((piece)) = (list (way-pieces way))
                           for (x . y) = (first piece)
                           when (and (rest piece) (not (robot-at-p snapshot x y)))
                             collect (list x y))
                     :test #'equal :key (lambda (point)
                                          (mapcar (lambda (at) (round at 1/10)) point))))

(defun draw-jumps (canvas way)
  (draw-jump-dots canvas (jumps-between (pieces-in-pixels (way-pieces way)))
                  (second (outcome-look way))))

(defun draw-end-marker (canvas look x y)
  (draw-marker canvas (first look) x y 4 (if in-color* (second look) black*)))

(defun draw-end (canvas way)
  (let ((piece (first (last (way-pieces way)))))
    (when piece
      (destructuring-bind (x . y) (first (last piece))
        (draw-end-marker canvas (outcome-look way) (to-pixels x) (to-pixels y))))))

(defun draw-ways (canvas ways)
  "Draw WAYS so faintly that many of them can be distinguished, above the dots of their jumps."
  (flet ((draw (function way)
           (with-opacity (canvas (way-opacity (length (ways-of-outcome (way-outcome way) ways))))
             (funcall function canvas way))))
    (dolist (way ways)
      (when (rest (way-pieces way)) (draw #'draw-jumps way)))
    (dolist (way ways) (draw #'draw-way way))))

(defun outcome-legend-entry (look opacity text)
  (entry-with-sample (canvas x y) text
    (with-opacity (canvas opacity)
      (draw-way-polyline canvas (list (- x 8) y (+ x 8) y) look))
    (with-opacity (canvas +end-opacity+) (draw-end-marker canvas look (+ x 4) y))))

(defun outcome-legend-entries (ways what)
  "Return legend entries for the outcomes of WAYS. WHAT is the noun for a trial, such as \"trial\"."
  (loop for (outcome . look) in *outcome-looks*
        for ended = (ways-of-outcome outcome ways)
        for count = (length (remove-duplicates (mapcar #'way-trial ended)))
        when (plusp count)
          collect (outcome-legend-entry look (way-opacity (length ended))
                                        (format nil "~A: ~D ~A~P" (first (last look))
                                                count what count))))

(defun ways-legend-entries (snapshot ways what)
  "Return legend entries for WAYS in the world of SNAPSHOT. For WHAT see OUTCOME-LEGEND-ENTRIES."
  (append (outcome-legend-entries ways what)
          (and (start-points ways snapshot)
               (list (entry-with-sample (canvas x y) "start of a way"
                       (draw-way-start canvas x y black*))))
          (jump-entries (loop for way in ways collect (pieces-in-pixels (way-pieces way)))
                        snapshot black*)))

(defun map-opacity (color-p)
  "Return the opacity of the map below the ways. COLOR-P is true for a picture in colours."
  (if color-p 1/2 1))

(defun draw-world-and-ways (canvas snapshot ways layers)
  "Draw the world of SNAPSHOT and WAYS in it. In a picture in colours the map is faint. The ends of
WAYS are drawn above robots and things."
  (let ((ways (loop for (outcome) in *outcome-looks* append (ways-of-outcome outcome ways))))
    (with-opacity (canvas (map-opacity in-color*))
      (draw-terrain canvas (snapshot-map snapshot) :layers layers))
    (draw-ways canvas ways)
    (with-opacity (canvas +end-opacity+) (draw-arrows-on-ways canvas ways))
    (loop for (x y) in (start-points ways snapshot)
          do (draw-way-start canvas (to-pixels x) (to-pixels y) black*))
    (draw-movers canvas snapshot (layers-without-names layers))
    (dolist (way ways)
      (with-opacity (canvas +end-opacity+) (draw-end canvas way)))
    (when (names-shown-p layers) (draw-names canvas snapshot layers))))

(defun ways-picture-svg (snapshot ways what &rest look &key layers in-color &allow-other-keys)
  "Return an SVG document that shows SNAPSHOT and WAYS in it. For WHAT see OUTCOME-LEGEND-ENTRIES,
and for LOOK see FRAMED-PICTURE-SVG."
  (apply #'framed-picture-svg snapshot
         (lambda (canvas) (draw-world-and-ways canvas snapshot ways layers))
         :more (ways-legend-entries snapshot ways what)
         :legend (list :opacity (map-opacity in-color)) look))

(defun ways-in-part (part ways)
  "Return the WAYS that touch the map's PART (left top right bottom), in cells; all if PART is NIL."
  (if part
      (let ((graphics-scale* 8))
        (remove-if-not (lambda (way)
                         (way-visible-p (pieces-in-pixels (way-pieces way))
                                        (points-to-pixels part)))
                       ways))
      ways))

(defun not-shown-text (what all ways)
  "Return a sentence with the number of trials that have a way in the list ALL but none in WAYS; or
an empty text. WHAT is the noun for a trial."
  (flet ((count-in (ways) (length (remove-duplicates (mapcar #'way-trial ways)))))
    (let ((unseen (- (count-in all) (count-in ways))))
      (if (plusp unseen)
          (format nil " Not shown, outside of this part: the ways of ~D ~A~P." unseen what unseen)
          ""))))

(defun save-picture-of-ways (operator what file snapshot ways-of own-title subtitle
                             &key part title (layers (remove :tracks *picture-layers*))
                               (in-color t) scale)
  "Save in FILE a picture of SNAPSHOT and of the ways that the function WAYS-OF returns. Return the
truename of FILE. Errors name OPERATOR. WHAT is the noun for a trial. At the top are TITLE, by
default OWN-TITLE, and SUBTITLE. PART (left top right bottom), in cells, is the part of the map to
show, or NIL for the whole map. Signals WRONG-ARGUMENT, before WAYS-OF is called, and MISUSE."
  (let ((kind (picture-kind operator file)))
    (check-map-options operator :title title :layers layers :scale scale)
    (let* ((snapshot (snapshot-of-part snapshot part operator))
           (all (funcall ways-of))
           (ways (ways-in-part part all)))
      (save-svg (with-broken-graphics-reported
                  (ways-picture-svg snapshot ways what
                               :title (or title own-title)
                               :subtitle (concatenate 'string subtitle
                                                      (not-shown-text what all ways))
                               :layers layers :in-color in-color :scale scale))
                file kind))))
