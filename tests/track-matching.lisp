;;;; track-matching.lisp -- tracks that match what they follow, and how often they err (3.4.2).

(in-package :ars-magna.tests)

(def-suite* track-matching :in ars-magna)

(defmacro with-matching ((calls designator specification &key (ticks 5)) &body body)
  "Run BODY where camera 0 of WATCHER was told to track and match DESIGNATOR with SPECIFICATION,
TICKS ago; CALLS is as in WITH-TRACK."
  `(let* ((heard '()) (start (run:simulation-tick)))
     (command:camera-track-matching (eye) ,designator ,specification
                                    (lambda (&rest call)
                                      (push (cons (- (run:simulation-tick) start) call) heard)))
     (run:run-ticks ,ticks)
     (flet ((,calls () (reverse (shiftf heard '()))))
       (declare (ignorable #',calls))
       ,@body)))

(defun ticks-and-codes (calls)
  (mapcar (lambda (call) (subseq call 0 2)) calls))

(defun reading-of (key designator)
  (second (assoc key (robot:designator-data designator))))

(defun last-code (calls) (first (last (codes calls))))

(defun denoted-name (designator)
  (let ((thing (robot:designator-denotation designator))) (and thing (world:thing-name thing))))

;;; Without noise.

(test matching.updates-the-data-at-its-interval
  "The first look is an interval after the beginning, at tick 4."
  (loop for (interval quantum . ticks) in '((10 1 4 14 24 34) (1 1 4 5 6 7) (7 1 4 11 18 25)
                                            (10 4 1 4 7 10))
        do (with-watcher (:clean t :parameters `((base:track-match-interval* ,interval)
                                                 (base:tick-quantum* ,quantum)))
             (multiple-value-bind (ball designator) (ball-at 9.5 12.5 :size 3 :color 'world:red)
               (with-matching (calls designator '((:color red) (:size (2 9))) :ticks 3)
                 (world:set-attribute ball :size 5)
                 (run:run-ticks (- (first (last ticks)) 3))
                 (let ((calls (calls)))
                   (is (equal (mapcar (lambda (tick) (list tick nil)) ticks)
                              (ticks-and-codes calls)))
                   (is (every (lambda (call) (eq designator (fourth call))) calls)))
                 (is (= 5 (reading-of :size designator)))
                 (is (eq 'red (reading-of :color designator)))
                 (is (robot:tracking-p (eye) designator))
                 (is (eq ball (robot:designator-denotation designator))))))))

(test matching.loses-what-fits-no-longer
  (loop for misses in '(1 2 3)
        do (with-watcher (:clean t :parameters `((base:track-match-misses* ,misses)))
             (multiple-value-bind (ball designator) (ball-at 9.5 12.5 :color 'world:red)
               (with-matching (calls designator '((:color red)) :ticks 16)
                 (world:set-attribute ball :color 'world:blue)
                 (calls)
                 (base:take-messages)
                 (run:run-ticks 50)
                 (is (equal `((,(+ 14 (* 10 misses)) :lost-track)) (ticks-and-codes (calls))))
                 (is (every #'string-equal
                            (list (format nil "Camera 0 lost track of Designator 0: ~
                                               nothing there fits ((:color red))")
                                  "Removing Designator 0")
                            (queued-texts)))
                 (is (not (robot:designator-valid-p designator))))))))

(test matching.counts-only-misses-in-succession
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 12.5 :color 'world:red)
      (with-matching (calls designator '((:color red)))
        (loop repeat 4
              do (world:set-attribute ball :color 'world:blue)
                 (run:run-ticks 20)
                 (world:set-attribute ball :color 'world:red)
                 (run:run-ticks 10))
        (is (equal '((4 nil) (34 nil) (64 nil) (94 nil) (124 nil)) (ticks-and-codes (calls))))))))

(test matching.takes-a-look-alike-within-the-gate
  "Look-alikes at .08 and .5 radians. The clean camera takes one only if its own thing fits not."
  (loop for (gate taken) in '((.1 near-one) (.07 nil) (.7 near-one))
        do (with-watcher (:clean t :parameters `((base:track-match-gate* ,gate)))
             (multiple-value-bind (ball designator) (ball-at 9.5 10.5 :color 'world:red)
               (put 'near-one (list (+ 5.5 (* 4 (cos .08))) (+ 10.5 (* 4 (sin .08))))
                    :color 'world:red :size 7)
               (put 'far-one (list (+ 5.5 (* 4 (cos .5))) (+ 10.5 (* 4 (sin .5))))
                    :color 'world:red)
               (put 'other (list (+ 5.5 (* 4 (cos .02))) (+ 10.5 (* 4 (sin .02))))
                    :color 'world:green)
               (with-matching (calls designator '((:color red)) :ticks 25)
                 (is (eq ball (robot:designator-denotation designator)))
                 (world:set-attribute ball :color 'world:blue)
                 (run:run-ticks 10)
                 (cond (taken
                        (is (eq taken (denoted-name designator)))
                        (is (equal '(4 14 24 34) (mapcar #'first (calls))))
                        (is (near .08 (robot:camera-angle (eye)) 1d-6))
                        (is (near .08 (robot:designator-angle designator) 1d-6))
                        (is (near 4 (robot:designator-distance designator) 1d-6))
                        (world:move-thing ball '(12.5 15.5))
                        (run:run-ticks 20)
                        (is (robot:tracking-p (eye) designator)))
                       (t (is (eq ball (robot:designator-denotation designator)))
                          (run:run-ticks 20)
                          (is (eq :lost-track (last-code (calls)))))))))))

(test matching.with-two-cameras-on-one-designator
  "If one camera takes a look-alike, the designator denotes it for the other camera, too."
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 10.5 :color 'world:red)
      (put 'twin '(9.5 10.8) :color 'world:red)
      (with-matching (calls designator '((:color red)))
        (robot:start-track (eye 1) designator nil)
        (world:set-attribute ball :color 'world:blue)
        (run:run-ticks 12)
        (is (eq 'twin (denoted-name designator)))
        (is (equal (list (eye 0) (eye 1)) (robot:tracking-cameras designator)))
        (is (near (atan .3 4) (robot:camera-angle (eye 1)) 1d-6))))))

(test matching.ends-as-other-tracks-do
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 12.5 :color 'world:red)
      (with-matching (calls designator '())
        (is (eq :already-tracking
                (end-code 'command:camera-track-matching (eye) designator '())))
        (call-once 'command:camera-untrack (eye))
        (is (eq :interrupt (last-code (calls)))))
      (with-matching (calls designator '())
        (world:destroy-thing ball)
        (run:run-ticks 1)
        (is (ends-with :lost-track (calls)))))
    (let ((far (nth-value 1 (ball-at 15.5 10.5))) (box (put 'box '(5.6 10.5) :capacity 5)))
      (robot:move-part (eye) box)
      (is (eq :camera-inside (end-code 'command:camera-track-matching (eye) far '())))
      (robot:move-part (eye) nil)
      (let ((screen (put 'screen '(10.5 10.5) :obsview t)))
        (is (eq :lost-track (end-code 'command:camera-track-matching (eye) far '())))
        (world:destroy-thing screen)
        (with-matching (calls far '())
          (put 'screen '(10.5 10.5) :obsview t)
          (run:run-ticks 1)
          (is (equal '(nil :lost-track) (codes (calls)))))))))

(test matching.of-local-designators
  "In the open, in a container and in a hand. A look-alike in the container may be taken."
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 5.9 10.5 :size 1 :color 'world:red)
      (with-matching (calls designator '((:color red)) :ticks 15)
        (world:move-thing ball (robot:robot-hand watcher 0))
        (run:run-ticks 40)
        (is (every #'null (codes (calls))))
        (is (eq :local (robot:designator-type designator)))
        (is (eq ball (robot:designator-denotation designator)))
        (robot:end-track (eye) :interrupt))))
  (with-watcher (:clean t)
    (let* ((box (put 'box '(5.5 10.5) :capacity 9))
           (pen (put 'pen box :size 1 :color 'world:red)))
      (put 'pencil box :size 1 :color 'world:red)
      (robot:move-part (eye) box)
      (let ((designator (robot:add-designator watcher :type :local :denotation pen :location box)))
        (with-matching (calls designator '((:color red)) :ticks 15)
          (is (eq pen (robot:designator-denotation designator)))
          (world:set-attribute pen :color 'world:blue)
          (run:run-ticks 10)
          (is (eq 'pencil (denoted-name designator))))))))

(test matching.of-a-false-designator
  "It denotes nothing, so that nothing fits, unless a thing stands there."
  (dolist (thing-p '(nil t))
    (with-watcher (:clean t)
      (let ((designator (phantom 12.5 10.5)))
        (when thing-p (put 'ball '(14.5 10.6)))
        (with-matching (calls designator '() :ticks 40)
          (is (eq thing-p (robot:tracking-p (eye) designator)))
          (is (eq (and thing-p 'ball) (denoted-name designator))))))))

;;; Wrong arguments.

(test matching.refuses-what-it-cannot-match
  (with-watcher (:clean t)
    (let ((corner (third (call-once 'command:camera-get-place-designator (eye) 'world:concave)))
          (far (nth-value 1 (ball-at 9.5 12.5))))
      (flet ((text (&rest arguments)
               (text-of-error (lambda () (apply #'command:camera-track-matching (eye) arguments)))))
        (is (search "a place is tracked by camera-track" (text corner '())))
        (is (search "not (:color orange)" (text far '((:color orange)))))
        (is (search "(camera-get-object-designator CAMERA" (text nil '())))
        (is (null (text far '()))))
      (base:take-messages)
      (with-matching (calls far '((:colr red) (:substance clayish)))
        (let ((texts (queued-texts)))
          (is (find ":colr" texts :test #'search))
          (is (find "clayish" texts :test (lambda (word text) (search word text
                                                                      :test #'char-equal)))))))))

;;; With noise: how often a look keeps its thing, takes the other, or finds nothing.

(defun fit-probability (attribute value distance)
  "Return the probability that a search reads VALUE of ATTRIBUTE, seen from DISTANCE, as fitting."
  (let ((attribute (world:find-attribute attribute)))
    (* (- 1 base:miss-thing-prob*)
       (if (realp value)
           (let ((deviation (robot:reading-deviation attribute distance)))
             (- 1 (* 2 (normal-probability (- (/ base:standard-match-threshold* deviation))))))
           (let ((right (robot:reading-reliability attribute distance)))
             (+ right (/ (- 1 right) (length (world:attribute-domain attribute)))))))))

(defun swap-probability (angle error)
  "Return the probability that of two things, ANGLE apart, the wrong one seems nearer to the true
direction of the other, if the direction of each is off by a number uniform within ERROR."
  (let ((ratio (/ angle error)))
    (cond ((<= ratio 1) (/ (- 2 (* ratio ratio)) 4))
          ((<= ratio 2) (/ (expt (- 2 ratio) 2) 4))
          (t 0))))

(defun look-outcomes (looks angle specification &rest attributes)
  "Let camera 0 look LOOKS times at one of two things with ATTRIBUTES, 4 m away and ANGLE apart.
Return how often it kept its thing, took the other, and found nothing."
  (let* ((at (lambda (angle) (list (+ 5.5 (* 4 (cos angle))) (+ 10.5 (* 4 (sin angle))))))
         (ball (apply #'put 'ball (funcall at (/ angle -2)) attributes))
         (designator (robot:add-designator watcher :denotation ball))
         (track (robot::make-matching-track designator nil specification)))
    (apply #'put 'twin (funcall at (/ angle 2)) attributes)
    (robot:start-track (eye) designator nil track)
    (loop repeat looks
          for before = (robot:designator-denotation designator)
          do (run:run-ticks 1)
          count (plusp (robot::matching-track-misses track)) into missed
          count (not (eq before (robot:designator-denotation designator))) into taken
          finally (return (list (- looks missed taken) taken missed)))))

(defparameter *looking-only*
  '((base:track-match-interval* 1) (base:track-match-misses* 1000000) (base:prob-lose-track* 0)
    (base:standard-match-threshold* 2))
  "Parameters under which each tick is a look, and nothing ends a track.")

(test matching.errs-by-its-formula
  "P(other taken) = q (1-q) + q^2 s, P(nothing) = (1-q)^2 with q = P(seen and fits), s = P(swap)."
  (loop with looks = 2000
        for (angle attribute value seed) in '((.01 :color world:red 1) (.03 :color world:red 2)
                                              (.05 :color world:red 3) (.02 :size 3 4))
        do (with-watcher (:seed seed :parameters *looking-only*)
             (let* ((fit (fit-probability attribute value 4))
                    (swap (swap-probability angle base:camera-angle-max-error*))
                    (taken (+ (* fit (- 1 fit)) (* fit fit swap)))
                    (missed (expt (- 1 fit) 2)))
               ;; Chi-square with two degrees of freedom, at .001.
               (is (< (chi-square (look-outcomes looks angle (list (list attribute value))
                                                 attribute value)
                                  (list (* looks (- 1 taken missed)) (* looks taken)
                                        (* looks missed)))
                      13.8))))))

(test matching.takes-nothing-outside-the-gate
  (with-watcher (:seed 5 :parameters *looking-only*)
    (let ((fit (fit-probability :color 'world:red 4)))
      (destructuring-bind (kept taken missed) (look-outcomes 2000 .11 '((:color red))
                                                             :color 'world:red)
        (declare (ignore missed))
        (is (= 0 taken))
        (is (frequent-p kept 2000 fit))))))

(test matching.is-lost-by-its-formula
  "K looks without success in succession, each with probability p: on average, this takes
(1-p^K) / (p^K (1-p)) looks; it is the first K with probability p^K."
  (loop with trials = 400
        for misses in '(1 2 3)
        do (with-watcher (:seed (+ 10 misses)
                          :parameters `(,@(remove 'base:track-match-misses* *looking-only*
                                                  :key #'first)
                                        (base:track-match-misses* ,misses)))
             (let* ((ball (put 'ball '(9.5 10.5) :color 'world:red))
                    (miss (- 1 (fit-probability :color 'world:red 4)))
                    (first (expt miss misses))
                    (mean (/ (- 1 first) first (- 1 miss)))
                    (lengths (loop repeat trials
                                   collect (matching-track-length
                                            (robot:add-designator watcher :denotation ball)))))
               (is (frequent-p (count misses lengths) trials first))
               ;; The deviation of the length is less than its mean.
               (is (<= (abs (- mean (/ (reduce #'+ lengths) trials)))
                       (* 3.3 (/ mean (sqrt trials)))))))))

(defun matching-track-length (designator)
  "Return how many ticks a track of DESIGNATOR lasts that looks for red in each."
  (robot:start-track (eye) designator nil
                     (robot::make-matching-track designator nil '((:color red))))
  (loop do (run:run-ticks 1)
        count t
        while (robot:tracking-p (eye) designator)))

(test matching.describes-the-thing-as-a-search-does
  "The data are readings that fit, and attributes that were noticed."
  (with-watcher (:seed 21 :parameters *looking-only*)
    (let* ((ball (put 'ball '(9.5 10.5) :color 'world:red :size 3 :weight 2))
           (designator (robot:add-designator watcher :denotation ball))
           (sizes 0) (looks 0) (colors '()))
      (robot:start-track (eye) designator nil
                         (robot::make-matching-track designator nil '((:color (red blue)))))
      (loop repeat 2000
            for before = (robot:designator-data designator)
            do (run:run-ticks 1)
               (unless (eq before (robot:designator-data designator))
                 (incf looks)
                 (when (reading-of :size designator) (incf sizes))
                 (pushnew (reading-of :color designator) colors)))
      (is (null (set-exclusive-or '(red blue) colors)))
      (is (frequent-p sizes looks (robot:notice-probability (world:find-attribute :size)
                                                            '(:color)))))))
