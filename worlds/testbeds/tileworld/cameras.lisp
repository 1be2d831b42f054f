;;;; cameras.lisp -- agents of Tileworld that know only what their camera has seen.

(in-package :ars-testbeds)
(in-readtable :nisp)

;;; The law of the world is the same. A look takes some ticks, one more for each hole that it finds.
;;; Holes may open or close after it: between looks the agents are blind.

(defun look (type then)
  "Look for holes, :LOCAL or :NON-LOCAL, and call THEN with a list of lists (x y score)."
  (camera-get-all-object-designators
   (robot-camera tiler 0) type '((:score (1 10)))
   (continuation (err camera designators)
     (go-on err (lambda () (funcall then (mapcar #'seen-hole designators)))))))

(defun seen-hole (designator)
  "Return the hole that DESIGNATOR is of, a list (x y score)."
  (let ((angle (+ (robot-angle tiler) (designator-angle designator)))
        (distance (designator-distance designator)))
    (flet ((middle (metres) (+ 0.5 (floor metres))))
      (list (middle (+ (robot-x tiler) (* distance (cosine angle))))
            (middle (+ (robot-y tiler) (* distance (sine angle))))
            (second (assoc :score (designator-data designator)))))))

(defun look-round (then)
  "Call THEN with a list of all holes in sight, lists (x y score)."
  (look :non-local (lambda (far) (look :local (lambda (near) (funcall then (append near far)))))))

(defun steps-left (hole)
  (steps-between (robot-x tiler) (robot-y tiler) (first hole) (second hole)))

(defun choose-by-sight (boldness)
  "Look, choose the hole with the highest score for its distance, plan, go there, and so on."
  (flet ((again () (choose-by-sight boldness))
         (worth (hole) (/ (third hole) (max 1 (steps-left hole)))))
    (look-round (lambda (holes)
                  (if holes
                      (let ((target (first (sort holes #'> :key #'worth))))
                        (plan-move (lambda () (go-by-sight target boldness #'again))))
                      (spend-steps 1 #'again))))))

(defun go-by-sight (target left then)
  (if (or (eql 0 left) (zerop (steps-left target)))
      (funcall then)
      (take-a-step (direction-to (first target) (second target))
                   (lambda () (go-by-sight target (and left (1- left)) then)))))

(defun bold-camera () (choose-by-sight nil))
(defun cautious-camera () (choose-by-sight 1))
