;;;; world-kickers.lisp -- kickers: what they do, how often, and in what order.

(in-package :ars-magna.tests)
(in-suite world)

(defun run-world (world ticks) (dotimes (tick ticks) (world:run-kickers world)))

(defun run-without-messages (world ticks)
  (is (string= "" (with-messages (run-world world ticks) (displayed)))))

(defun counting-world (count probability &key (seed 1) test)
  "Return a world with COUNT things that count their kicks, and the vector of the counts."
  (let ((world (open-world :seed seed)) (counts (make-array count :initial-element 0)))
    (let ((kicker (world::set-kicker-code
                   (world::make-kicker 'count) "test" probability test
                   (lambda (thing) (incf (aref counts (1- (world:thing-serial thing))))))))
      (dotimes (index count)
        (thing-in world 'box 1 1 '() :kickers (list kicker))))
    (values world counts)))

(defun within-binomial-p (successes trials probability &optional (deviations 4))
  (<= (abs (- successes (* trials probability)))
      (* deviations (sqrt (* trials probability (- 1 probability))))))

;;; How often.

(test kickers.fire-as-often-as-their-probability-says
  (with-own-definitions
    (loop for (probability things ticks)
            in '((.01 200 1000) (.5 50 400) (.9 20 300) (1/1000 500 2000))
          do (multiple-value-bind (world counts) (counting-world things probability)
               (run-world world ticks)
               (is (within-binomial-p (reduce #'+ counts) (* things ticks) probability)
                   "p ~A: ~D of ~D" probability (reduce #'+ counts) (* things ticks))))))

(test kickers.certain-and-impossible
  (with-own-definitions
    (multiple-value-bind (world counts) (counting-world 7 1)
      (run-world world 10)
      (is (equalp #(10 10 10 10 10 10 10) counts)))
    (multiple-value-bind (world counts) (counting-world 7 0)
      (run-world world 100)
      (is (equalp #(0 0 0 0 0 0 0) counts)))))

(test kickers.skipping-has-the-law-of-drawing-each-tick
  "Each thing's kicks in T ticks are binomial: compare the variance over things, and the gaps
between one thing's kicks with the geometric law, as a draw per thing and tick would give."
  (with-own-definitions
    (let ((p .2d0) (ticks 50) (things 4000))
      (multiple-value-bind (world counts) (counting-world things p)
        (run-world world ticks)
        (let* ((mean (/ (reduce #'+ counts) things 1d0))
               (variance (/ (loop for count across counts sum (expt (- count mean) 2)) things)))
          (is (< (abs (- mean (* ticks p))) .2))
          (is (< (abs (- variance (* ticks p (- 1 p)))) (* .1 ticks p (- 1 p))))
          (let ((dice (base:make-dice 5)))
            (loop for kicks from 5 to 15
                  for here = (count kicks counts)
                  for there = (loop repeat things
                                    count (= kicks (loop repeat ticks
                                                         count (base:chance p dice))))
                  do (is (< (abs (- here there)) (* 4 (sqrt (+ here there 1d0))))
                         "~D kicks: ~D things, drawn ~D" kicks here there))))))))

(test kickers.gaps-are-geometric
  (with-own-definitions
    (multiple-value-bind (world counts) (counting-world 3 .25)
      (let ((gaps '()) (last 0) (kicks 0))
        (loop for tick from 1 to 20000
              do (world:run-kickers world)
                 (unless (= kicks (aref counts 1))
                   (push (- tick last) gaps)
                   (setf kicks (aref counts 1) last tick)))
        (loop for gap from 1 to 8
              do (is (within-binomial-p (count gap gaps) (length gaps)
                                        (* .25 (expt .75 (1- gap))))
                     "gap ~D: ~D of ~D" gap (count gap gaps) (length gaps)))))))

(defun kicks-by-hand (count probability ticks seed)
  "Return the vector of how often each of COUNT kickers in a new world runs in TICKS ticks."
  (let* ((dice (world:world-dice (open-world :seed seed) :kickers))
         (scale (world::gap-scale probability)) (kicks (make-array count :initial-element 0)))
    (loop with trial = (world::draw-gap scale dice)
          while (< trial (* ticks count))
          do (incf (aref kicks (mod trial count)))
             (incf trial (1+ (world::draw-gap scale dice))))
    kicks))

(test kickers.in-large-groups-run-as-the-dice-say
  "Memory is read ahead for them, whether their things lie on the floor, in a chest or nowhere."
  (with-own-definitions
    (let* ((count 6000) (world (open-world :seed 3)) (chest (thing-in world 'chest 2 2 '()))
           (kicker (world:define-kicker 'drift :prob .02
                     :body (lambda (thing) (world:kick-thing thing 1/1024 0 nil))))
           (things (loop for i below count
                         collect (thing-in world 'box (+ 1 (mod i 18)) (+ 1 (mod i 17)) '()
                                           :kickers (list kicker))))
           (inside (subseq things 0 9)))
      (dolist (thing inside) (world:move-thing thing chest))
      (run-without-messages world 10)
      (loop for thing in things
            for i from 0
            for kicks across (kicks-by-hand count .02d0 10 3)
            for start = (if (member thing inside) 2 (+ 1 (mod i 18)))
            do (unless (and (member thing inside) (zerop kicks))
                 (unless (= (world:thing-x thing) (+ start (/ kicks 1024)))
                   (fail "~A has not been kicked ~D times" thing kicks))))
      (mapc #'world:destroy-thing (subseq things 3000 3003))
      (run-without-messages world 10)
      (is (= (- count 3) (world::group-count (first (world::world-kicker-groups world)))))
      (is-sound world))))

(test kickers.test-only-thins
  (with-own-definitions
    (multiple-value-bind (world counts)
        (counting-world 100 .2 :test (lambda (thing) (evenp (world:thing-serial thing))))
      (run-world world 500)
      (is (within-binomial-p (reduce #'+ counts) (* 50 500) .2))
      (is (loop for index from 0 below 100 by 2 always (zerop (aref counts index)))))))

(test kickers.follow-the-tick-quantum
  (with-own-definitions
    (multiple-value-bind (world counts) (counting-world 100 .1)
      (let ((base:tick-quantum* 5))
        (run-world world 1000)
        (is (within-binomial-p (reduce #'+ counts) 100000 (- 1 (expt .9 5)))))
      (fill counts 0)
      (run-world world 1000)
      (is (within-binomial-p (reduce #'+ counts) 100000 .1)))))

(test kickers.depend-on-the-seed-alone
  (with-own-definitions
    (flet ((counts (seed)
             (multiple-value-bind (world counts) (counting-world 50 .1 :seed seed)
               (run-world world 100)
               (copy-seq counts))))
      (is (equalp (counts 1) (counts 1)))
      (is (not (equalp (counts 1) (counts 2)))))))

(test kickers.of-the-destroyed-are-silent-and-the-others-unchanged
  "Things come and go during the ticks; each that lives is tried once per tick."
  (with-own-definitions
    (let* ((world (open-world)) (dice (base:make-dice 9)) (lived 0) (kicks 0))
      (world:define-kicker 'mortal :prob .3
        :body (lambda (thing)
                (unless (world:thing-alive-p thing) (fail "a dead thing kicks"))
                (incf kicks)
                (when (base:chance .3 dice)
                  (world:destroy-thing (base:roll-element (world:world-thing-list world) dice)))
                (when (and (base:chance .35 dice) (< (world:world-live-count world) 200))
                  (thing-in world 'box 1 1 '() :kickers '(mortal)))))
      (dotimes (index 100) (thing-in world 'box 1 1 '() :kickers '(mortal)))
      (dotimes (tick 2000)
        (when (< (world:world-live-count world) 50)
          (thing-in world 'box 1 1 '() :kickers '(mortal)))
        (incf lived (world:world-live-count world))
        (world:run-kickers world))
      ;; Who dies before its turn in a tick loses that trial.
      (is (< (* .27 lived) kicks (* .31 lived)) "~D kicks in ~D trials" kicks lived)
      (is-sound world))))

;;; What they do.

(test defkicker.binds-and-attaches-by-name-or-value
  (with-own-definitions
    (let* ((world (open-world)) (box (thing-in world 'box 1 5)) (cup (thing-in world 'cup 1 6)))
      (is (eq 'slide (eval '(world:defkicker slide (th) (:prob 1 :test (< (world:thing-x th) 4))
                             (world:kick-thing th 1 0 nil)))))
      (world:set-kicker box 'slide)
      (world:set-kicker cup (symbol-value 'slide))
      (run-world world 2)
      (is (equal '(3d0 5d0) (position-of box)))
      (run-world world 5)
      (is (equal '(4d0 5d0) (position-of box)) "the test stops it")
      (is (equal '(4d0 6d0) (position-of cup)))
      (eval '(world:defkicker slide (th) () (world:kick-thing th 0 1 nil)))
      (run-world world 1)
      (is (equal '(4d0 6d0) (position-of box)) "redefinition reaches what has it")
      (signals base:unknown-name (world:set-kicker box 'slyde))
      (signals base:wrong-argument (world:set-kicker 'box 'slide)))))

(test put-kicker.is-for-one-thing-and-removes
  (with-own-definitions
    (let* ((world (open-world)) (box (thing-in world 'box 1 5)) (world:*world* world))
      (eval '(world:defkicker creep (th) () (world:kick-thing th 1 0 nil)))
      (world:set-kicker box 'creep)
      (eval `(world:put-kicker creep (th ,box) (:prob (/ 2 2)) (world:kick-thing th 2 0 nil)))
      (run-world world 1)
      (is (equal '(3d0 5d0) (position-of box)) "it stands in for the global one")
      (eval `(world:put-kicker creep (th ,box)))
      (is (null (world:thing-kickers box)))
      (run-world world 1)
      (is (equal '(3d0 5d0) (position-of box)))
      (world:set-kicker box 'creep)
      (eval `(world:put-kicker creep (th ,box) () nil))
      (run-world world 1)
      (is (equal '(3d0 5d0) (position-of box)) "global ones are removed too"))))

(test defkicker.rejects-malformed-options
  (loop for (form . expected)
          in '(((world:defkicker "x" (th) () t) . "a symbol")
               ((world:defkicker :x (th) () t) . "a symbol")
               ((world:defkicker x th () t) . "one variable")
               ((world:defkicker x (th box) () t) . "one variable")
               ((world:defkicker x (7) () t) . "a variable")
               ((world:defkicker x (th) (:prob) t) . "pairs")
               ((world:defkicker x (th) (:probability 1) t) . ":prob")
               ((world:defkicker x (th) (:prob 1.5) t) . "a probability")
               ((world:put-kicker x th () t) . "(variable thing)")
               ((world:put-kicker x (th (world:new-thing a nil ())) (:prob -1) t)
                . "a probability"))
        for complaint = (complaint-about form)
        do (is (and complaint (search expected complaint)) "~S: ~A" form complaint)))

(test run-kicker.runs-once-on-the-next-tick
  (with-own-definitions
    (let* ((world (open-world)) (box (thing-in world 'box 1 1)) (runs '()) (tick 0) (asked nil))
      (world:define-kicker 'again :prob 1 :test (lambda (thing) (declare (ignore thing)) (< tick 3))
        :body (lambda (thing)
                (is (eq thing (world:attachment-thing world:self)))
                (push tick runs)
                (when (and (= tick 2) (not asked))
                  (setf asked t)
                  (world:run-kicker world:self)
                  (world:run-kicker world:self))
                (when (= tick 3) (world:run-kicker world:self))))
      (world:set-kicker box 'again)
      (loop repeat 6 do (world:run-kickers world) (incf tick))
      (is (equal '(0 1 2 3 4) (reverse runs))
          "asked at 2 and 3: it runs at 3 and 4, against the test, once each")
      (is (null world:self))
      (signals base:wrong-argument (world:run-kicker nil)))))

(test run-kicker.runs-each-kicker-in-its-tick-whatever-the-order-of-requests
  (with-own-definitions
    (let ((world (open-world)) (runs '()))
      (world:define-kicker 'note :prob 0
        :body (lambda (thing)
                (push (list (world:thing-serial thing) (world::world-kicker-tick world)) runs)))
      (let ((kickers (loop repeat 4 collect (world:set-kicker (thing-in world 'box 1 1) 'note))))
        (mapc #'world:run-kicker kickers '(9 3 7 5))
        (mapc #'world:run-kicker (subseq kickers 1 3) '(8 2)))
      (run-world world 10)
      (is (equal '((3 2) (4 5) (2 8) (1 9)) (reverse runs))))))

(test run-kicker.goes-on-as-a-trajectory
  (with-own-definitions
    (let* ((world (open-world)) (ball (thing-in world 'ball 1 1)))
      (world:define-kicker 'roll :prob 0
        :body (lambda (thing)
                (when (world:kick-thing thing 1 0 nil) (world:run-kicker world:self))))
      (world:run-kicker (world:set-kicker ball 'roll))
      (run-world world 30)
      (is (equal '(19d0 1d0) (position-of ball)) "until the map's edge"))))

(test kickers.trouble-is-queued-and-the-tick-goes-on
  (with-own-definitions
    (multiple-value-bind (world counts) (counting-world 5 1)
      (let ((bad (world:find-thing 3 world)))
        (eval `(world:put-kicker count (th ,bad) (:prob 1) (error "no more"))))
      (run-world world 2)
      (is (equalp #(2 2 0 2 2) counts))
      (is (equal '("Error in kicker COUNT of BOX#3: no more"
                   "Error in kicker COUNT of BOX#3: no more")
                 (message-texts))))))

(test kickers.copied-by-the-map-not-from-prototypes
  (with-own-definitions
    (eval '(world:defkicker jump (th) () (world:kick-thing th 1 1 nil)))
    (let ((proto (world:make-new-thing 'proto nil '() :kickers '(jump))))
      (progv '(proto) (list proto)
        (eval '(world:defmap test-map (9 9)
                (obj (a :kickers (jump)) (1 1) ())
                (obj (b :prototype (symbol-value 'proto)) (1 1) ()))))
      (let ((world (world:make-world 'test-map)))
        (run-world world 2)
        (is (equal '(3d0 3d0) (position-of (world:find-thing 'a world))))
        (is (equal '(1d0 1d0) (position-of (world:find-thing 'b world))))))))

;;; Kicking.

(test kick-thing.into-walls
  (with-own-definitions
    (let* ((world (open-world :clauses '((wall (5 0) (5 19) bricks 1))))
           (box (thing-in world 'box 4.5 4.5)))
      (is (null (world:kick-thing box 1 0 nil)))
      (is (equal '(4.5d0 4.5d0) (position-of box)))
      (is (eq t (world:kick-thing box 1 2 t)))
      (is (equal '(4.5d0 5.5d0) (position-of box)) "the opening nearest to where it was")
      (is (eq t (world:kick-thing box 2 0 nil)) "the path is not checked")
      (is (equal '(6.5d0 5.5d0) (position-of box)))
      (is (null (world:kick-thing box -100 0 t)) "far outside there is no opening")
      (signals base:wrong-argument (world:kick-thing box (/ (expt 10 400) 3) 0 t))
      (world:move-thing box 10 19.5)
      (is (eq t (world:kick-thing box 0 1 t)) "off the map is as in a wall")
      (is (equal '(10.5d0 19.5d0) (position-of box)))
      (is-sound world))))

(test kick-thing.puts-last-in-its-cell
  "Also a thing that stays in its cell; and a list that somebody has asked for stays as it was."
  (with-own-definitions
    (let* ((world (open-world))
           (a (thing-in world 'a 4.5 4.5)) (b (thing-in world 'b 4.5 4.5))
           (c (thing-in world 'c 4.5 4.5)) (d (thing-in world 'd 7.5 4.5)))
      (flet ((here () (world:things-at world 4.5 4.5)))
        (let ((before (here)))
          (dolist (thing before) (world:kick-thing thing .25d0 0 nil))
          (is (equal (list a b c) before))
          (is (equal (list a b c) (here)) "each in its turn")
          (world:kick-thing b 0 .25 nil)
          (is (equal (list a c b) (here)))
          (world:kick-thing a 3 0 nil)
          (world:kick-thing d -3d0 1/4 nil)
          (is (equal (list c b d) (here)))
          (is (equal (list a) (world:things-at world 7.5 4.5)))
          (is (equal (list a b c) before))))
      (is-sound world))))

(test kicks.cons-nothing
  "Within ticks, at random, into walls, into cells with things in them, by floats and integers."
  (with-own-definitions
    (let* ((world (open-world :clauses '((wall (5 0) (5 12) bricks 1) (circle (13 9) 4 bricks 1))))
           (dice (world:world-dice world :user)))
      (world:define-kicker 'stroll :prob .3
        :body (lambda (thing)
                (world:kick-thing thing (base:roll-within 2d0 dice) (base:roll-within 2 dice) t)))
      (world:define-kicker 'fall :prob .2
        :body (lambda (thing) (world:kick-thing thing -.25 1 nil)))
      (dotimes (index 40)
        (thing-in world 'box (base:roll-between 0 20 dice) (base:roll-between 0 20 dice)
                  '((:obsmove t)) :kickers '(stroll fall)))
      (world:permitting-changes (world)
        (run-world world 20)
        (is (> 80000 (bytes-consed-by (lambda () (run-world world 1))))))
      (is-sound world))))

(test kick-thing.out-of-containers
  (with-own-definitions
    (let* ((world (open-world)) (box (thing-in world 'box 4 4 '((:capacity 9))))
           (tin (world:make-new-thing 'tin box '((:capacity 3) (:closed t))))
           (pea (world:make-new-thing 'pea tin '())))
      (is (null (world:kick-thing pea 1 1 t)) "the tin is closed")
      (world:set-attribute tin :closed nil)
      (world:set-attribute box :closed t)
      (is (null (world:kick-thing pea 1 1 t)) "the box around it is closed")
      (world:set-attribute box :closed nil)
      (is (eq t (world:kick-thing pea 1 1 t)))
      (is (eq :floor (world:thing-location pea)))
      (is (equal '(5d0 5d0) (position-of pea)))
      (world:destroy-thing pea)
      (is (null (world:kick-thing pea 1 1 t)))
      (is-sound world))))

(defstruct (grip (:copier nil)) (contents '()) (world nil) (closed nil))
(defmethod world:location-contents ((grip grip)) (grip-contents grip))
(defmethod (setf world:location-contents) (things (grip grip)) (setf (grip-contents grip) things))
(defmethod world:location-position ((grip grip)) (values 7d0 8d0))
(defmethod world:location-world ((grip grip)) (grip-world grip))
(defmethod world:location-closed-p ((grip grip)) (grip-closed grip))
(defmethod world:location-name ((grip grip)) "GRIP")

(test kick-thing.out-of-a-hand
  "What holds things in the layer above takes part by its methods alone."
  (with-own-definitions
    (let* ((world (open-world)) (grip (make-grip :world world)) (told '())
           (cup (world:make-new-thing 'cup grip '())) (pea (world:make-new-thing 'pea cup '())))
      (is (equal (list cup) (grip-contents grip)))
      (is (equal '(7d0 8d0) (position-of pea)))
      (is-sound world)
      (push (lambda (&rest move) (push move told)) (world:world-move-watchers world))
      (setf (grip-closed grip) t)
      (is (null (world:kick-thing pea 1 0 t)))
      (setf (grip-closed grip) nil)
      (is (eq t (world:kick-thing cup 1 0 t)))
      (is (null (grip-contents grip)))
      (is (equal '(8d0 8d0) (position-of pea)))
      (is (equal (list (list cup grip :floor)) told))
      (is-sound world))))

(test kicked-world.stays-sound
  (with-own-definitions
    (let* ((world (open-world :clauses '((rect (3 3) (12 12) bricks 1) (circle (9 9) 3 bricks 1))))
           (dice (world:world-dice world :user)))
      (world:define-kicker 'hop :prob .1
        :body (lambda (thing)
                (world:kick-thing thing (base:roll-within 4 dice) (base:roll-within 4 dice)
                                  (base:chance .5 dice))))
      (dotimes (index 200)
        (thing-in world 'box (base:roll-between 0 20 dice) (base:roll-between 0 20 dice)
                  '((:obsmove t)) :kickers '(hop)))
      (loop repeat 20 do (run-world world 20) (is-sound world)))))

(test kickers.of-the-least-probability-never-run
  (with-own-definitions
    (let ((world (open-world)) (ran 0))
      (world:define-kicker 'hop :prob least-positive-double-float
        :body (lambda (thing) (declare (ignore thing)) (incf ran)))
      (thing-in world 'box 3 3 '() :kickers '(hop))
      (run-world world 100)
      (is (zerop ran)))))
