;;;; names.lisp -- what things and robots are called, beside them or at the end of a line.

(in-package :ars-magna.display)

(export '(draw-names))

;;; A name is written where its box meets no thing, robot, number of a designator or other name. It
;;; avoids walls, marks of places and trails if it can. Without room there is no name. Other lines
;;; are interrupted below a name. Robots are named first: their names may lie on any wall, or
;;; farther off at the end of a line. Then come large things.

;;; Lines to names.

;;; In a crowd of robots, and for a thing right beside one, there may be no room for a name beside
;;; its target. Then the name stands farther off, and a thin line leads to it. The line crosses no
;;; other robot if that can be avoided.

(define-constant +leader-lengths+ '(10 18 28 40 56 76)
  :test #'cl:equal
  :documentation "The lengths of lines to names, in pixels; the shortest possible is used.")

(defun name-box-at-line-end (x y angle width)
  "Return the box of a name WIDTH pixels wide at the end X, Y of a line in direction ANGLE."
  (flet ((before (share size)
           (cond ((< share -0.33d0) size) ((< 0.33d0 share) 0) (t (* 0.5d0 size)))))
    (let ((left (- x (before (cosine angle) width)))
          (top (- y (before (sine angle) +name-height+))))
      (list left top (+ left width) (+ top +name-height+)))))

(defun leader-boxes (spot width)
  "Return boxes, nearest first, for the name of SPOT, WIDTH pixels wide, at the ends of lines."
  (loop for length in +leader-lengths+
        append (loop for turn below 16
                     for angle = (* turn (/ pi 8))
                     collect (destructuring-bind (x y)
                                 (point-at-distance (label-target-x spot) (label-target-y spot)
                                                    angle
                                                    (+ length (label-target-half spot)))
                               (name-box-at-line-end x y angle width)))))

(defun leader-ends (spot box)
  "Return the two ends of the line from SPOT to BOX, as a list x y x y."
  (let ((x (label-target-x spot)) (y (label-target-y spot)))
    (multiple-value-bind (to-x to-y) (nearest-point-in-box box x y)
      (append (point-at-distance x y (arctangent (- to-y y) (- to-x x)) (label-target-half spot))
              (list to-x to-y)))))

(defun robots-to-avoid (spot rivals)
  "Return the images of the robots in RIVALS that a line from SPOT must not cross. If SPOT is a
thing inside the ring of a robot, its line may cross this ring."
  (loop for rival in rivals
        when (and (label-target-robot rival)
                  (or (label-target-robot spot)
                      (<= 2 (distance-from-label-target rival (label-target-box spot)))))
          collect (label-target-robot rival)))

(defun leader-piece-blocked-p (spot at taken)
  "True if the box AT, a piece of a line from SPOT, is outside SPOT and overlaps a box of the index
TAKEN. If SPOT is a thing, boxes that overlap SPOT are ignored."
  (let ((own (label-target-box spot)))
    (and (not (overlap-p at own))
         (find-overlapping-item at taken (lambda (other)
                                           (or (label-target-robot spot)
                                               (not (overlap-p other own))))))))

(defun leader-clear-p (spot box taken rivals)
  "True if the line from SPOT to BOX crosses no ring of a robot in RIVALS, and no box of the index
TAKEN except the box of SPOT."
  (let ((robots (robots-to-avoid spot rivals)))
    (destructuring-bind (x y to-x to-y) (leader-ends spot box)
      (loop for step from 0 to 8
            for at-x = (+ x (* step 0.125d0 (- to-x x)))
            for at-y = (+ y (* step 0.125d0 (- to-y y)))
            always (and (every (lambda (robot) (< 2 (distance-from-ring robot at-x at-y))) robots)
                        (not (leader-piece-blocked-p spot (box-around at-x at-y 1) taken)))))))

(defconstant +name-gap+ 6 "The least distance between names on a line, in pixels.")

(defun widen-box (box by)
  (destructuring-bind (left top right bottom) box
    (list (- left by) top (+ right by) bottom)))

(defun layer-mark-boxes (snapshot layers)
  "Return the boxes of the numbers and rings that LAYERS draw of SNAPSHOT."
  (loop for (layer . arguments) in (all-shown-layers snapshot layers)
        when (%layer-boxes layer) append (apply (%layer-boxes layer) arguments)))

(defun camera-line-boxes (robots &optional shown)
  (loop for robot in robots
        append (loop for (x y to-x to-y)
                       in (camera-lines robot (drawn-radius robot robots shown))
                     collect (widen-box (list (min x to-x) (min y to-y) (max x to-x) (max y to-y))
                                        1))))

(defconstant +name-confusion-margin+ 100
  "Confusable names are searched up to this distance from a name, in pixels.")

(defun name-confusion-distance (spot width)
  "Return the distance from SPOT, in pixels, up to which confusable names are searched. The name of
SPOT is WIDTH pixels wide."
  (+ width (label-target-half spot) +name-confusion-margin+))

;;; Placing names.

(defstruct (placement (:constructor make-placement
                          (snapshot layers taken marks targets robots &optional covered))
                      (:copier nil))
  "What the places of names in a picture of SNAPSHOT with LAYERS depend on. These are indices of
boxes: TAKEN, which no name may overlap; MARKS, those of numbers and rings; TARGETS, those of all
label targets; and COVERED, names that another name overlaps only if need be, or NIL. ROBOTS lists
the targets that are robots."
  (snapshot nil :read-only t) (layers '() :type list :read-only t)
  (taken nil :type box-index :read-only t) (marks nil :type box-index :read-only t)
  (targets nil :type box-index :read-only t) (robots '() :type list :read-only t)
  (covered nil :type (or null box-index) :read-only t))

(defstruct (placed-name (:constructor make-placed-name (target box led-p)) (:copier nil))
  "The name of TARGET in BOX. A line leads to BOX if LED-P."
  (target nil :type label-target :read-only t)
  (box '() :type list :read-only t)
  (led-p nil :read-only t))

(defun best-placed-box (placement spot boxes own-p &optional (anywhere-p (label-target-robot spot)))
  "Return the best of BOXES for the name of SPOT in PLACEMENT, or NIL. See BEST-BOX."
  (best-box (placement-snapshot placement) (placement-layers placement) boxes
            (placement-taken placement)
            :anywhere-p (and anywhere-p t) :own-p own-p :covered (placement-covered placement)))

(defun unambiguous-in-placement-p (placement spot box width)
  "True if a name in BOX, WIDTH pixels wide, clearly belongs to SPOT."
  (unambiguous-name-box-p
   spot box (confusable-label-targets-near spot box (placement-targets placement)
                                           (name-confusion-distance spot width))))

(defun name-box-beside-label-target (placement spot width)
  "Return the box beside SPOT where the name of SPOT, WIDTH pixels wide, is unambiguous and hides
least. Return NIL if there is no such box."
  (best-placed-box placement spot
                   (boxes-beside-marks (label-target-x spot) (label-target-y spot)
                                       (label-target-half spot) width (placement-marks placement))
                   (lambda (box) (unambiguous-in-placement-p placement spot box width))))

(defun leader-box (placement spot width rivals)
  "Return the box at the end of a line where the name of SPOT, WIDTH pixels wide, hides least, or
NIL. If every line crosses something, the value is NIL for a thing, but a box for a robot."
  (let ((boxes (leader-boxes spot width)) (taken (placement-taken placement)))
    (flet ((best (own-p) (best-placed-box placement spot boxes own-p t)))
      (or (best (lambda (box) (leader-clear-p spot box taken rivals)))
          (and (label-target-robot spot) (best (constantly t)))))))

(defun on-other-label-target-p (spot spots)
  (and (find-overlapping-item (label-target-box spot) spots (lambda (other) (not (eq other spot))))
       t))

(defun name-box (placement spot width)
  "Return two values: the box, WIDTH pixels wide, for the name of SPOT, or NIL; and true if a line
must lead to the box."
  (let ((near (name-box-beside-label-target placement spot width)))
    (if near
        (values near nil)
        (let ((rivals (confusable-label-targets spot (placement-robots placement)
                                                (name-confusion-distance spot width))))
          (when (or (label-target-robot spot)
                    (on-other-label-target-p spot (placement-targets placement))
                    (too-near-robot-p spot rivals))
            (values (leader-box placement spot width rivals) t))))))

(defun name-width (target per-character)
  "Return the width of the box of TARGET's name, in pixels. Characters are PER-CHARACTER wide."
  (+ 2 (* per-character (name-columns (label-target-name target)))))

(defun reserve-name-box (placement box)
  "Keep other names of PLACEMENT away from BOX, that of a name."
  (let ((box (widen-box box +name-gap+))) (add-box box box (placement-taken placement))))

(defun place-name (placement target per-character &optional (test (constantly t)))
  "Return the name of TARGET, placed where PLACEMENT has room, or NIL. Its room is taken then. The
value is also NIL if the name of a thing is empty, or if the function TEST returns false for the
best box."
  (unless (and (label-target-thing target) (string= "" (label-target-name target)))
    (multiple-value-bind (box led-p) (name-box placement target (name-width target per-character))
      (when (and box (funcall test box))
        (reserve-name-box placement box)
        (make-placed-name target box led-p)))))

;;; Writing names.

(defun write-name (canvas name box)
  (destructuring-bind (left top right bottom) box
    (fill-with-white canvas left top (- right left) (- bottom top))
    (with-color black*
      (draw-words canvas draw-gcontext* (+ 1 left) (- bottom 2) name :size +name-size+))))

(defun draw-placed-name (canvas name)
  (let ((target (placed-name-target name)) (box (placed-name-box name)))
    (when (placed-name-led-p name)
      (with-halo (black*) (draw-segments canvas draw-gcontext* (leader-ends target box))))
    (write-name canvas (label-target-name target) box)))

(defun widened-target-boxes (targets)
  (loop for target in targets collect (widen-box (label-target-box target) 1)))

(defun draw-names (canvas snapshot layers &optional boxes)
  "Write the names of robots and things where they overlap neither BOXES nor what LAYERS draw. If
there is no room beside a robot, or beside a thing that overlaps or touches another target, the name
is at the end of a line. LAYERS choose the names; if they show no names, all names are written."
  (let* ((targets (label-targets snapshot))
         (marks (append boxes (layer-mark-boxes snapshot layers)))
         (taken (index-boxes (append marks (camera-line-boxes (snapshot-robots snapshot))
                                     (widened-target-boxes targets))))
         (placement (make-placement snapshot layers taken (index-boxes marks)
                                    (index-boxes (mapcar #'label-target-box targets) targets)
                                    (remove nil targets :key #'label-target-robot))))
    (loop for target in (if (names-shown-p layers) (named-targets targets layers) targets)
          for name = (place-name placement target (character-width canvas +name-size+))
          when name do (draw-placed-name canvas name))))
