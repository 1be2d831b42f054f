;;;; manual-3-2-odometry.lisp -- section 3.2.2 of the manual: odometers.

(in-package :ars-test-manual)
(in-readtable :nisp)

(in-suite manual-3-2)

(defun main () (robot-main-odometer scout))

(defun estimates (&optional (odometer (main)))
  "Return the centres of what ODOMETER says: x, y and angle."
  (let ((p (nominal (get-odometer-pos odometer))))
    (list !>p.x !>p.y (nominal (get-odometer-ang odometer)))))

(defun widths (&optional (odometer (main)))
  (list (interval-width (get-odometer-pos odometer))
        (interval-width (get-odometer-ang odometer))))

(defun drive-about ()
  "Drive and turn SCOUT: 8 ticks ahead, 1 to the right, 6 ahead, 2.5 to the left, 5 ahead."
  (loop for (command amount) in '((robot-go-forward 8) (robot-turn 1) (robot-go-forward 6)
                                  (robot-turn -2.5) (robot-go-forward 5))
        do (funcall command scout amount)
           (run-ticks 25)))

(defun holds-truth-p (odometer x y heading)
  "True if what ODOMETER says contains how SCOUT stands to one at (X,Y) with HEADING."
  (let ((dx (- (robot-x scout) x)) (dy (- (robot-y scout) y))
        (c (cos (* 1d0 heading))) (s (sin (* 1d0 heading))))
    (and (in-interval (make PT (+ (* dx c) (* dy s)) (- (* dy c) (* dx s)))
                      (grow-interval (get-odometer-pos odometer) 1d-11))
         (in-interval (- (robot-angle scout) heading)
                      (grow-interval (get-odometer-ang odometer) 1d-11)))))

;;; Which there are.

(test manual-3-2-2.a-robot-has-one-odometer-at-first
  "3.2.2, reading 232: robot-main-odometer returns it; it is called main."
  (with-scout ()
    (is (equal (list (main)) (robot-odometers scout)))
    (is (eq (main) (robot-odometer scout 'main)))))

(test manual-3-2-2.others-can-be-made
  "3.2.2: (make ODOMETER robot name); they are found by name, and robot-odometers lists all."
  (with-scout ()
    (let ((trip (make ODOMETER scout 'trip)) (search (make ODOMETER scout 'search)))
      (is (eq trip (robot-odometer scout 'trip)))
      (is (eq search (robot-odometer scout 'search)))
      (is (equal (list (main) trip search) (robot-odometers scout)))
      (is (null (robot-odometer scout 'nobody))))))

(test manual-3-2-2.a-name-is-that-of-one-odometer
  "3.2.2, reading 232: making one destroys what had its name, which then stands still."
  (with-scout (:clean t)
    (let* ((old (make ODOMETER scout 'trip)) (new (make ODOMETER scout 'trip)))
      (is (eq new (robot-odometer scout 'trip)))
      (is (= 2 (length (robot-odometers scout))))
      (drive-about)
      (is (equalp '(0 0 0) (estimates old)))
      (is (not (equalp '(0 0 0) (estimates new)))))))

(test manual-3-2-2.odometers-do-not-affect-each-other
  "3.2.2: each module may use its own; a reset of one leaves the others as they are."
  (with-scout (:clean t)
    (let ((trip (make ODOMETER scout 'trip)))
      (drive-about)
      (let ((before (estimates)))
        (is (equalp before (estimates trip)))
        (reset-odometer trip)
        (is (equalp before (estimates)))
        (is (equalp '(0 0 0) (estimates trip)))))))

;;; What they say.

(test manual-3-2-2.estimates-contain-the-truth
  "3.2.2, reading 97: in noise and without, from whole and odd points and any heading."
  (dolist (clean '(t nil))
    (dolist (spot *spots*)
      (dolist (heading '(0 2.5 -4))
        (with-scout (:clean clean :seed 7)
          (place-robot scout (first spot) (second spot) heading)
          (reset-odometer (main))
          (robot-go-forward scout 6 (continuation (err robot) (robot-turn robot 4)))
          (dotimes (tick 30)
            (run-ticks 1)
            (is-true (holds-truth-p (main) (first spot) (second spot) heading)))
          (drive-about)
          (is-true (holds-truth-p (main) (first spot) (second spot) heading)))))))

(test manual-3-2-2.estimates-are-intervals
  "3.2.2: positions are point intervals, angles are intervals; each answer is a new one."
  (with-scout ()
    (is (typep (get-odometer-pos (main)) 'pt-interval))
    (is (typep (get-odometer-ang (main)) 'interval))
    (is (not (eq (get-odometer-pos (main)) (get-odometer-pos (main)))))
    (is (not (eq (get-odometer-ang (main)) (get-odometer-ang (main)))))))

(test manual-3-2-2.an-interval-given-is-used
  "3.2.2: the optional argument is modified and returned."
  (with-scout (:seed 3)
    (drive-about)
    (let ((pos (make PT-INTERVAL 7 7)) (ang (make INTERVAL 7 7)))
      (is (eq pos (get-odometer-pos (main) pos)))
      (is (eq ang (get-odometer-ang (main) ang)))
      (is-true (equal pos (get-odometer-pos (main))))
      (is-true (equal ang (get-odometer-ang (main)))))))

(test manual-3-2-2.without-noise-they-are-exact
  "3.2.2: a clean world leaves no doubt of the position."
  (with-scout (:clean t)
    (drive-about)
    (is (every (lambda (width) (< width 1d-9)) (widths)))
    (is (near (- 1 2.5d0) (third (estimates)) 1d-6))))

(test manual-3-2-2.noise-makes-them-uncertain
  "3.2.2: the longer the way, the wider the estimate."
  (with-scout (:seed 5)
    (let ((before (widths)))
      (is (equalp '(0 0) before))
      (dotimes (i 4)
        (drive-about)
        (is (every #'< before (widths)))
        (!= before (widths))))))

(test manual-3-2-2.an-estimate-grows-by-a-random-interval
  "Reading 97: a tick's interval lies in the range of the noise, goes beyond the truth to either
side, and its size is random."
  (with-scout (:seed 6)
    (robot-go-forward scout 25)
    (run-ticks 4)
    (let ((slack '()))
      (loop repeat 20
            do (reset-odometer (main))
               (let ((x (robot-x scout)))
                 (run-ticks 1)
                 (let ((pos (get-odometer-pos (main))) (moved (- (robot-x scout) x)))
                   (is (< .7199 !>pos.x.min (- moved 1d-9)))
                   (is (< (+ moved 1d-9) !>pos.x.max .8801))
                   (push (- moved !>pos.x.min) slack)
                   (push (- !>pos.x.max moved) slack))))
      (is (= 40 (length (remove-duplicates slack)))))))

(test manual-3-2-2.angles-are-not-reduced
  "Reading 50: after four half turns the angle is four times pi."
  (with-scout (:clean t)
    (dotimes (i 4) (answer 'robot-about-face scout))
    (is (near (* 4 pi) (third (estimates)) 1d-6))))

;;; Resetting.

(test manual-3-2-2.reset-odometer-starts-from-zero
  "3.2.2: position and angle are 0 again, without doubt."
  (with-scout (:seed 8)
    (drive-about)
    (reset-odometer (main))
    (is (equalp '(0 0 0) (estimates)))
    (is (equalp '(0 0) (widths)))))

(test manual-3-2-2.reset-odometer-pos-resets-the-position
  "3.2.2, reading 98: and leaves the angle."
  (with-scout (:seed 8)
    (drive-about)
    (destructuring-bind (before after) (list (get-odometer-ang (main))
                                             (progn (reset-odometer-pos (main))
                                                    (get-odometer-ang (main))))
      (is-true (equal before after))
      (is (equalp '(0 0) (subseq (estimates) 0 2)))
      (is (not (zerop (third (estimates))))))))

(test manual-3-2-2.reset-odometer-ang-resets-the-angle
  "3.2.2, reading 98: and leaves the position."
  (with-scout (:seed 8)
    (drive-about)
    (let ((before (get-odometer-pos (main))))
      (reset-odometer-ang (main))
      (is-true (equal before (get-odometer-pos (main))))
      (is (= 0 (third (estimates)))))))

(test manual-3-2-2.positions-are-relative-to-the-heading-at-the-reset
  "3.2.2, reading 98: for any heading at the reset, driving straight on from there is along x."
  (dolist (heading '(0 1 -2.5 9))
    (at-each-spot (:clean t)
      (turned-to heading)
      (reset-odometer (main))
      (answer 'robot-go-forward scout 5)
      (destructuring-bind (x y angle) (estimates)
        (is (near 4 x 1d-6))
        (is (near 0 y 1d-6))
        (is (near 0 angle))))))

(test manual-3-2-2.they-lead-home
  "Figure D.8, reading 98: atan2 of the negative estimate, less the angle, is the turn home."
  (dolist (spot *spots*)
    (with-scout (:clean t)
      (place-robot scout (first spot) (second spot) .7)
      (reset-odometer (main))
      (drive-about)
      (destructuring-bind (x y angle) (estimates)
        (answer 'robot-turn scout (- (atan2 (- y) (- x)) angle))
        (robot-set-speed scout (/ (norm (make PT x y)) 20))
        (answer 'robot-go-forward scout 20)
        (is (near (first spot) (robot-x scout) 1d-6))
        (is (near (second spot) (robot-y scout) 1d-6))))))
