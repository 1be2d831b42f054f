;;;; manual-reach.lisp -- what the manual claims in 2.1 to 3.4.3 of things within reach.

(in-package :ars-test-manual)
(in-readtable :nisp)

;;; The suites are those of the sections.

(in-suite manual-2)

(test manual-2-1.a-step-of-a-metre-leads-into-the-next-cell
  "2.1 and 3.5: from whole coordinates, too."
  (with-scout (:clean t)
    (place-robot scout 10 10 0)
    (robot-set-speed scout 1)
    (answer 'robot-go-forward scout 3)
    (is (= 13 (cell-x (map-cell yard (robot-x scout) (robot-y scout)))))))

(test manual-2-1.what-one-stands-at-is-local
  "2.1, reading 108: a thing in a cell that blocks the robot, when it stands at that."
  (loop for (x y) in '((15.9 10.4) (15.1 10.9) (15.5 10.5) (15 10))
        do (at-each-spot (:clean t)
             (put 'crate (list x y) :obsmove #t)
             (is (eq :robot-blocked (end-code 'robot-go-forward scout 15)))
             (is (equal '(crate) (seen :type :local)))
             (is (equal '() (seen))))))

(test manual-2-2.non-local-designators-serve-to-approach-from-anywhere
  "2.2 and 3.5: from whole and odd coordinates to whole and odd ones."
  (dolist (target '((5 0) (5 1) (4.63 -2.41) (0.0 4.5) (7 3)))
    (at-each-spot (:clean t)
      (apply #'put-beside 'ball target)
      (answer 'camera-turn (eye) (apply #'atan2 (reverse target)))
      (tracking (record (look '()))
        (robot-goto-designator scout (eye) (record :goto))
        (run-ticks 60)
        (is (equal '((:track nil) (:goto nil) (:track :lost-track))
                   (loop for (name code) in (record) collect (list name code))))
        (is (equal '(ball) (seen :type :local)))))))

(in-suite manual-3-4-1)

(test manual-3-4-1.untracked-angles-stay-relative-to-the-heading
  "3.4.1: when the robot turns, what it has seen is elsewhere relative to its heading."
  (at-each-spot (:clean t)
    (let* ((ball (put-beside 'ball 6 2)) (designator (look '())))
      (dolist (turn '(1 -2.5 4))
        (answer 'robot-turn scout turn)
        (is (near (bearing-of ball) !>designator.angle 1d-6))))))

(test manual-3-4-1.places-are-approached-from-anywhere
  "3.4.1: the doorway."
  (at-each-spot (:clean t)
    (tracking (record (look-for-place 'doorway))
      (is (null (second (first (call-times 60 'robot-goto-designator scout (eye))))))
      (is (= 30 (cell-x (map-cell yard (robot-x scout) (robot-y scout))))))))

(in-suite manual-3-4-3)

(test manual-3-4-3.an-interrupted-track-tells-its-designator
  "3.4.3, reading 85: also before it has begun."
  (at-each-spot (:clean t)
    (put-beside 'ball 6 0)
    (let ((designator (look '())))
      (tracking (record designator :ticks 2)
        (grab-resource (eye))
        (run-ticks 2)
        (is (equal (list (list :track :interrupt (eye) designator)) (record)))))))

(test manual-3-4-3.what-is-within-reach-is-never-too-fast
  "Readings 108 and 141: a non-local track of what is within a metre is not lost by that."
  (with-scout (:clean t)
    (place-robot scout 10.5 10.5 0)
    (let ((ball (put-beside 'ball 1.5 0)))
      (tracking (record (look '()))
        (move-thing ball '(11.1 11.2))
        (run-ticks 1)
        (move-thing ball '(11.1 9.8))
        (run-ticks 1)
        (is (equal '(nil) (codes (record))))))))

(test manual-3-4-3.long-lists-are-valid
  "3.4.3: of more than a thousand objects, none is invalid when the list is told."
  (with-scout (:clean t)
    (dotimes (i 1100) (put-beside 'ball 5 (+ -2 (* i 1/300))))
    (let ((found (fourth (first (call-times 1200 'camera-get-all-object-designators
                                            (eye) :non-local '())))))
      (is (plusp (length found)))
      (is (every #'designator-valid-p found)))))
