;;;; tileworld-bare.lisp -- Tileworld with holes only, without the simulator: for comparison.

(in-package :ars-magna.tests)

;;; The rules of worlds/testbeds/tileworld/holes.lisp, played on given holes by arithmetic alone.
;;; Times are numbers of world units, not rounded. The agent is where it is only at the ends of
;;; steps and of waits, so nothing happens between them.

(defstruct (bare-game (:conc-name bare-) (:predicate nil)
                      (:constructor make-bare (coming gamma p directions)) (:copier nil))
  "A game: the holes to come and the open ones, lists (x y score begin end number), newest first."
  coming (open '()) gamma p directions (time 0) (x 8) (y 8) (score 0))

(defun bare-distance (game hole)
  (let ((dx (abs (- (first hole) (bare-x game)))) (dy (abs (- (second hole) (bare-y game)))))
    (if (= 8 (bare-directions game)) (max dx dy) (+ dx dy))))

(defun pass-bare-time (game time)
  "Let TIME pass; then fill the hole where the agent is."
  (let ((now (incf (bare-time game) time)))
    (loop while (and (bare-coming game) (<= (fourth (first (bare-coming game))) now))
          do (push (pop (bare-coming game)) (bare-open game)))
    (setf (bare-open game) (remove-if (lambda (hole) (<= (fifth hole) now)) (bare-open game)))
    (let ((here (find-if (lambda (hole) (zerop (bare-distance game hole))) (bare-open game))))
      (when here
        (incf (bare-score game) (third here))
        (setf (bare-open game) (remove here (bare-open game)))))))

(defun bare-step (game hole)
  (let ((dx (signum (- (first hole) (bare-x game)))) (dy (signum (- (second hole) (bare-y game)))))
    (when (or (/= 0 dx) (= 8 (bare-directions game))) (incf (bare-x game) dx))
    (when (or (= 0 dx) (= 8 (bare-directions game))) (incf (bare-y game) dy)))
  (pass-bare-time game (bare-gamma game)))

(defun best-bare-hole (game)
  (loop with best and most
        for hole in (bare-open game)
        for worth = (/ (third hole) (max 1 (bare-distance game hole)))
        do (when (or (null best) (> worth most)) (setf best hole most worth))
        finally (return best)))

(defun newest-bare-hole (game) (if (bare-open game) (sixth (first (bare-open game))) 0))

(defun bare-reaction-p (game reaction target seen)
  (flet ((new-p (hole) (< seen (sixth hole))))
    (and reaction
         (or (not (member target (bare-open game)))
             (case reaction
               (:nearer (some (lambda (hole)
                                (and (new-p hole)
                                     (< (bare-distance game hole) (bare-distance game target))))
                              (bare-open game)))
               (:any (some #'new-p (bare-open game))))))))

(defun follow-bare-plan (game target boldness reaction seen)
  (loop for left = boldness then (and left (1- left))
        until (or (eql 0 left)
                  (zerop (bare-distance game target))
                  (bare-reaction-p game reaction target seen))
        do (setf seen (max seen (newest-bare-hole game)))
           (bare-step game target)))

(defun bare-effectiveness (holes gamma p boldness reaction &optional (directions 4))
  "Return the effectiveness of an agent on HOLES, lists (x y score begin end), in order."
  (let ((game (make-bare (loop for hole in holes for number from 1
                               collect (append hole (list number)))
                         gamma p directions)))
    (setf (bare-time game) 1)
    (loop while (or (bare-coming game) (bare-open game))
          do (let ((target (best-bare-hole game)) (seen (newest-bare-hole game)))
               (cond ((null target) (pass-bare-time game gamma))
                     (t (unless (zerop p) (pass-bare-time game (* p gamma)))
                        (follow-bare-plan game target boldness reaction seen)))))
    (/ (bare-score game) (reduce #'+ holes :key #'third))))
