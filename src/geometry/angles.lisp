;;;; angles.lisp -- angles and directions: radians, 0 along x, growing clockwise (manual 3.2).

(in-package :ars-magna.geometry)

;;; With y down, the heading of angle a is (cos a, sin a), and a left turn is -pi/2. Angles are
;;; never normalised; only differences are reduced, to (-pi, pi].

(public (2pi :ars :nisp))
;; As reading 35 says.
(defconstant 2pi (* 2 pi)
  "Two pi, a full turn in radians (manual 3.2).")

;;; The manual names PI too; SBCL leaves it undocumented.
(unless (documentation 'pi 'variable)
  (setf (documentation 'pi 'variable) "Half a turn in radians."))

(public (origin* :ars :nisp))
(defvar origin* (make-pt 0 0)
  "The point (0, 0), where an odometer starts (manual, Figure D.8).")

(public (atan2 :ars :nisp))
(defun atan2 (y x)
  "Return the angle of (X, Y), from -pi to pi radians (manual, Figure D.8). Signals WRONG-ARGUMENT."
  (check-finite atan2 y)
  (check-finite atan2 x)
  (arctangent (double y) (double x)))

;; Beyond that, the part of a turn is too imprecise.
(defmacro check-angle (operator place)
  `(check-argument ,operator ,place (sane-number-p ,place)
                   "an angle in radians, from -1e9 to 1e9"))

(declaim (inline reduced-angle))
(defun reduced-angle (angle)
  "Return ANGLE without full turns, in the range (-pi, pi]."
  (declare (type double-float angle))
  (if (and (< #.(- pi) angle) (<= angle pi))
      angle
      (let ((turns (ceiling (the (double-float -4d18 4d18) (- (/ angle 2pi) 0.5d0)))))
        (- angle (* 2pi turns)))))

(addition angle-difference)
(defun angle-difference (a b)
  "Return the angle A minus the angle B without full turns: the signed turn, in (-pi, pi] radians,
that leads from B to A (reading 50). Signals WRONG-ARGUMENT unless A and B are from -1e9 to 1e9."
  (check-angle angle-difference a)
  (check-angle angle-difference b)
  (reduced-angle (- (double a) (double b))))

(addition nearest-angle)
(defun nearest-angle (angle candidate &rest more)
  "Return the candidate, among CANDIDATE and MORE, from which the turn to ANGLE is smallest. All
angles are in radians. If several are equally near, return the first. Signals WRONG-ARGUMENT."
  (declare (dynamic-extent more))
  (let ((least (abs (angle-difference candidate angle))))
    (dolist (other more candidate)
      (let ((turn (abs (angle-difference other angle))))
        (when (< turn least)
          (setf candidate other least turn))))))
