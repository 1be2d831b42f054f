;;;; moments.lisp -- events shown with the ways of a run: plans, errors, trails.

(in-package :ars-magna.tests)
(in-suite display)

;;; What becomes of plans, and errors in users' code.

(test moments.tell-of-plans-and-errors
  "Also those in a file."
  (run:with-simulation (ars-worlds:dot :seed 1 :journal t)
    (driver:run-plan (rpl:interp-lambda () (rpl:fail :class 'doom)))
    (driver:end-plan (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 50))))
    (command:robot-turn ars-worlds:dot 1 (lambda (&rest results)
                                           (declare (ignore results))
                                           (error "bad code")))
    (run:run-ticks 60)
    (flet ((seen (journal)
             (mapcar #'display:moment-kind (display:journal-moments journal))))
      (is (equal '(:plan :plan :error) (seen nil)))
      (is (mentions-p (display:moment-text (first (display:journal-moments nil))) "DOOM"))
      (with-scratch-file (file "journal")
        (run:save-journal file)
        (is (equal '(:plan :plan :error) (seen file)))
        (is (= (run:state-digest) (nth-value 1 (run:replay file))))))))

(defun moments-of-plan (plan)
  "Return pairs of kind and text of the moments of a run of PLAN."
  (run:with-simulation (ars-worlds:dot :seed 1 :journal t)
    (driver:run-plan plan)
    (mapcar (lambda (moment) (cons (display:moment-kind moment) (display:moment-text moment)))
            (display:journal-moments nil))))

(test moments.tell-of-failures-that-a-plan-takes-care-of
  "Each once, where it happened; the failure that ends a plan at once is told of as that alone."
  (let ((seen (moments-of-plan (rpl:interp-lambda ()
                                 (rpl:try-all
                                   (rpl:seq (rpl:wait-time 2) (rpl:fail :class 'slip))
                                   (rpl:wait-time 9))))))
    (is (equal '(:part) (mapcar #'car seen)))
    (is (mentions-p (cdr (first seen)) "SLIP")))
  (is (equal '(:plan) (mapcar #'car (moments-of-plan
                                     (rpl:interp-lambda () (rpl:fail :class 'slip)))))))

(test moments.tell-of-parts-of-plans-that-somebody-ends
  "But not of branches that are no longer needed."
  (let ((seen (moments-of-plan
               (rpl:interp-lambda ()
                 (rpl:par (:tag victim (rpl:wait-time 20))
                          (rpl:seq (rpl:wait-time 2) (rpl:evaporate victim)))))))
    (is (equal '(:part) (mapcar #'car seen)))
    (is (mentions-p (cdr (first seen)) "was ended")))
  (is (null (moments-of-plan (rpl:interp-lambda ()
                               (rpl:try-all (rpl:wait-time 2) (rpl:wait-time 9)))))))

(test moments.of-parts-leave-room-for-others
  "However often a plan tries again, what becomes of plans is told of."
  (run:with-simulation (ars-worlds:dot :seed 1 :journal t)
    (let ((simulation (time:current-simulation)))
      (dotimes (count 2000) (run:add-remark simulation :part "tried again"))
      (run:add-remark simulation :plan "failed"))
    (let ((kinds (mapcar #'display:moment-kind (display:journal-moments nil))))
      (is (= 1 (count :plan kinds)))
      (is (< 100 (count :part kinds) 1000)))))

;;; Trails.

(test trails.are-known-in-forks-and-after-rewinding
  (run:with-simulation (ars-worlds:dot :seed 1 :clean t :keep t)
    (display:keep-history)
    (command:robot-go-forward ars-worlds:dot 8)
    (run:run-ticks 7)
    (let ((middle (display::robot-trail-points ars-worlds:dot)))
      (is (< 9 (length middle)))
      (run:with-fork ()
        (is (equal middle (display::robot-trail-points ars-worlds:dot)))
        (is (find #\+ (display:text-map ars-worlds:dot :radius 6 :layers '(:way)))))
      (run:run-ticks 2)
      (is (< (length middle) (length (display::robot-trail-points ars-worlds:dot))))
      (run:rewind 2)
      (is (equal middle (display::robot-trail-points ars-worlds:dot)))
      (run:run-ticks 2)
      (is (< (length middle) (length (display::robot-trail-points ars-worlds:dot)))))))

