;;;; worlds-moving.lisp -- the kickers of the shipped worlds.

(in-package :ars-magna.tests)

(in-suite worlds)

(defun positions-over-time (name thing-name &key (seed 3) (samples 40) (ticks 500))
  "Return where the thing was every so many TICKS, a list of lists (x y)."
  (call-in-shipped name seed
                   (lambda (world)
                     (loop with thing = (world:find-thing thing-name world)
                           repeat samples
                           collect (multiple-value-list (world:thing-position thing))
                           do (run:run-ticks ticks)))))

(defun spread (positions)
  "Return how far apart POSITIONS lie, in metres, along the longer axis."
  (loop for axis in (list #'first #'second)
        maximize (- (reduce #'max positions :key axis) (reduce #'min positions :key axis))))

(test kickers.roll-a-ball-about
  (is (< 2 (spread (positions-over-time 'watson 'ball)))))

(test kickers.a-rolling-ball-comes-to-rest
  (call-in-shipped
   'watson 3
   (lambda (world)
     (let ((ball (world:find-thing 'ball world)))
       (is (run:run-until (lambda () (world:get-attribute ball :rolling)) :limit 5000))
       (is (run:run-until (lambda () (null (world:get-attribute ball :rolling))) :limit 100))))))

(test kickers.things-are-borrowed-and-left-at-their-haunts
  (loop for (world thing) in '((watson scissors) (office cup) (office magazine) (office broom))
        for positions = (positions-over-time world thing)
        for haunts = (world:get-attribute
                      (world:find-thing thing (world:make-world (world:find-map world))) :haunts)
        do (is (subsetp positions haunts :test #'equalp) "~A ~A" thing positions)
           (is (< 2 (length (remove-duplicates positions :test #'equalp))) "~A stays" thing)))

(test kickers.what-is-held-is-not-borrowed
  (call-in-shipped
   'watson 3
   (lambda (world)
     (let ((scissors (world:find-thing 'scissors world)) (desk (world:find-thing 'desk world)))
       (world:move-thing scissors desk)
       (run:run-ticks 10000)
       (is (eq desk (world:thing-location scissors)))))))

(test kickers.a-closed-lid-keeps-papers-in
  (flet ((papers-left (closed)
           (call-in-shipped
            'watson 3
            (lambda (world)
              (let ((basket (world:thing-location (world:find-thing 'wrapper world))))
                (world:set-attribute basket :closed closed)
                (run:run-ticks 5000)
                (length (world:thing-contents basket)))))))
    (is (= 1 (papers-left t)))
    (is (= 0 (papers-left nil)))))

(test kickers.a-printer-prints-until-its-tray-is-full
  (call-in-shipped
   'office 3
   (lambda (world)
     (let ((printer (world:find-thing 'printer world)))
       (is (null (world:thing-contents printer)))
       (run:run-ticks 2000)
       (is (= 3 (length (world:thing-contents printer))))
       (world:destroy-thing (first (world:thing-contents printer)))
       (run:run-ticks 2000)
       (is (= 3 (length (world:thing-contents printer))))))))

(test kickers.a-light-changes
  (call-in-shipped
   'office 3
   (lambda (world)
     (let ((lamp (world:find-thing 'signal-lamp world)))
       (dolist (color '(lightgreen lightred))
         (is (run:run-until (lambda ()
                               (base:same-name-p color (world:get-attribute lamp :color)))
                             :limit 2000)))))))

(defun round-legs (rounds)
  "Return the pairs of points between which somebody who does ROUNDS walks again and again."
  (loop for (point next) on rounds
        collect (list point (or next (first rounds)))))

(defun obstacle-on-leg (world leg)
  "Return where the straight way of LEG, two points, is barred in WORLD, or NIL."
  (destructuring-bind ((x0 y0) (x1 y1)) leg
    (loop for share from 0 to 1 by 1/400
          for x = (+ x0 (* share (- x1 x0))) and y = (+ y0 (* share (- y1 y0)))
          when (or (world:wall-at-p (world:world-map world) x y)
                   (some (lambda (thing) (and (world:thing-obsmove-p thing)
                                              (null (world:thing-kickers thing))))
                         (world:things-at world x y)))
            return (list x y))))

(test kickers.rounds-are-clear-and-are-done
  (loop for (name walker) in '((watson aunt-agatha) (office mail-trolley) (office caretaker))
        do (call-in-shipped
            name 5
            (lambda (world)
              (let* ((thing (world:find-thing walker world))
                     (rounds (world:get-attribute thing :rounds)))
                (loop for leg in (round-legs rounds)
                      do (is (null (obstacle-on-leg world leg)) "~A on ~A" walker leg))
                (dolist (point rounds)
                  (is (run:run-until (lambda () (not (equal point (first (world:get-attribute
                                                                           thing :rounds)))))
                                      :limit 3000)
                      "~A does not get to ~A" walker point))
                (is (equal rounds (world:get-attribute thing :rounds))))))))

(test kickers.a-trolley-takes-its-load-along
  (call-in-shipped
   'office 5
   (lambda (world)
     (let* ((trolley (world:find-thing 'mail-trolley world))
            (letter (first (world:thing-contents trolley)))
            (start (world:thing-x trolley)))
       (run:run-ticks 500)
       (is (< 20 (abs (- start (world:thing-position letter)))))
       (is (= (world:thing-x trolley) (world:thing-position letter)))))))
