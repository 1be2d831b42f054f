;;;; ways-users.lisp -- ways as users get them: free, short, wide, shared and copied.

(in-package :ars-magna.tests)

(in-suite ways)

(defun way-lists (way)
  (mapcar (lambda (pt) (list (geo:pt-x pt) (geo:pt-y pt))) way))

(defun points-along (way)
  "Return points of WAY, a list of PTs, five centimetres apart or less."
  (loop for ((x y) (next-x next-y)) on (way-lists way)
        while next-x
        append (let ((count (max 1 (ceiling (ars:way-length `((,x ,y) (,next-x ,next-y))) 1/20))))
                 (loop for i to count
                       collect (list (+ x (* (/ i count) (- next-x x)))
                                     (+ y (* (/ i count) (- next-y y))))))))

(defun wall-distance (map point)
  "Return how far POINT is from the nearest wall of MAP that is within two metres, or 2."
  (destructuring-bind (x y) point
    (let ((least 2))
      (loop for column from (- (floor x) 3) to (+ (floor x) 3)
            do (loop for row from (- (floor y) 3) to (+ (floor y) 3)
                     when (world:wall-at-p map (+ column 1/2) (+ row 1/2))
                       do (setf least
                                (min least
                                     (sqrt (+ (expt (max (- column x) (- x column 1) 0) 2)
                                              (expt (max (- row y) (- y row 1) 0) 2)))))))
      least)))

(defun near-end-p (point ends)
  (some (lambda (end) (< (ars:way-length (list point end)) 3/2)) ends))

(test ways.are-free-and-keep-half-a-metre-off-walls
  "But in the first and the last metre and a half; there they are free."
  (let ((dice (base:make-dice 21)) (found 0))
    (dotimes (i 20)
      (with-random-map (map 20 15 (* 1/50 i) dice)
        (dotimes (j 5)
          (let* ((ends (loop repeat 2
                             collect (mapcar #'+ (random-cell map dice)
                                             (list (base:roll-between -.49d0 .49d0 dice)
                                                   (base:roll-between -.49d0 .49d0 dice)))))
                 (way (apply #'ars:find-way map ends)))
            (when way
              (incf found)
              (is (equal (mapcar (lambda (point) (map 'list #'base:double point)) ends)
                         (list (first (way-lists way)) (first (last (way-lists way))))))
              (is (every (lambda (point)
                           (if (near-end-p point ends)
                               (not (apply #'world:wall-at-p map point))
                               (<= .499d0 (wall-distance map point))))
                         (points-along way))))))))
    (is (< 50 found))))

(defun visible-length (chart ends)
  "Return the length of the shortest way between ENDS, by all lines that are free between middles of
cells; NIL if there is none."
  (let* ((map (ars:chart-map chart))
         (points (remove-if (lambda (point) (apply #'world:wall-at-p map point))
                            (loop for x below (world:map-width map)
                                  append (loop for y below (world:map-height map)
                                               collect (list (+ x 1/2) (+ y 1/2))))))
         (known (list (list (first ends) 0))) (left (remove (first ends) points :test #'equal)))
    (loop
      (let ((best nil))
        (loop for (from length) in known
              do (dolist (to left)
                   (let ((sum (+ length (ars:way-length (list from to)))))
                     (when (and (or (null best) (< sum (second best)))
                                (ars:straight-cost chart from to))
                       (setf best (list to sum))))))
        (when (null best) (return nil))
        (when (equal (first best) (second ends)) (return (second best)))
        (push best known)
        (setf left (remove (first best) left :test #'equal))))))

(test ways.are-hardly-longer-than-the-shortest-at-any-angle
  (let ((dice (base:make-dice 22)) (longest 0) (sum 0) (count 0))
    (dotimes (i 12)
      (with-random-map (map 10 8 1/8 dice)
        (let* ((chart (ars:make-chart map :clearance 0 :costs '()))
               (ends (list (random-cell map dice) (random-cell map dice)))
               (shortest (and (not (apply #'equal ends)) (visible-length chart ends))))
          (when shortest
            (let ((ratio (/ (ars:way-length (apply #'ars:find-way chart ends)) shortest)))
              (incf count)
              (incf sum ratio)
              (setf longest (max longest ratio)))))))
    (is (< 6 count))
    (is (< .999 (/ sum count) 1.02) "~A" (/ sum count))
    (is (< longest 1.06) "~A" longest)))

(world:defmap two-doors (21 11)
  (rect (0 0) (20 10) bricks 1)
  (wall (10 0) (10 4) bricks 1)
  (wall (10 6) (10 8) bricks 1))

(test clearances.are-measured-from-the-middles-of-cells
  (let ((dice (base:make-dice 23)))
    (with-random-map (map 18 14 1/20 dice)
      (dolist (clearance '(0 3/4 5/4 2))
        (let ((chart (ars:make-chart map :clearance clearance :costs '())))
          (dotimes (i 60)
            (let ((point (random-cell map dice)))
              (is (= (if (< (wall-distance map point) clearance) 4 1)
                     (ars:crossing-cost chart point))))))))))

(test ways.keep-the-clearance-where-there-is-room
  (let ((way (ars:find-way 'office '(62 36.5) '(90 36.5))))
    (is (every (lambda (point) (<= .99d0 (wall-distance (world:find-map 'office) point)))
               (points-along way))))
  (let ((map (world:find-map 'two-doors)))
    (flet ((least (clearance)
             (reduce #'min (mapcar (lambda (point) (wall-distance map point))
                                   (points-along (ars:find-way
                                                  (ars:make-chart map :clearance clearance)
                                                  '(9.5 1.5) '(4.5 7.5)))))))
      (is (<= .49d0 (least 0) 1))
      (is (<= .49d0 (least 3/4) 1.1d0)))))

(test ways.go-through-the-middle-of-a-doorway-one-cell-wide
  (let ((way (ars:find-way 'two-doors '(3.2 4.1) '(17.3 6.7))))
    (is (some (lambda (point) (< (ars:way-length (list point '(10.5 5.5))) .03))
              (points-along way)))))

(test ways.mind-what-places-cost
  (flet ((through-p (way cell)
           (some (lambda (point) (equal cell (mapcar #'floor point))) (points-along way))))
    (is-true (through-p (ars:find-way 'two-doors '(3 5.5) '(17 5.5)) '(10 5)))
    (is-true (through-p (ars:find-way (ars:make-chart 'two-doors :costs '((world:doorway 30)))
                                      '(3 5.5) '(17 5.5))
                        '(10 9)))))

(test ways.end-where-a-cell-is-as-wanted
  (let ((seen '()))
    (let ((way (ars:find-way 'two-doors '(3 5.5) '(17 5.5)
                             :until (lambda (x y) (push (list x y) seen) (= x 10)))))
      (is (equal '(10 5) (mapcar #'floor (first (last (way-lists way))))))
      (is (equal '(10 5) (first seen)))
      (is (null (member '(3 5) seen :test #'equal))))))

(test ways.go-round-what-is-barred-and-back-again
  (let* ((chart (ars:make-chart 'two-doors)) (ends '((3 5.5) (17 5.5)))
         (first (way-lists (apply #'ars:find-way chart ends))))
    (ars:bar-cell chart '(10.5 5.5))
    (is (equal '((10 5 nil)) (ars:barred-cells chart)))
    (is (null (ars:crossing-cost chart '(10.5 5.5))))
    (let ((round (way-lists (apply #'ars:find-way chart ends))))
      (is (not (equal first round)))
      (is (equal (second round) (first (way-lists (list (apply #'ars:next-point chart ends)))))))
    (ars:bar-cell chart '(10.5 9.5))
    (is (null (apply #'ars:find-way chart ends)))
    (is (null (apply #'ars:next-point chart ends)))
    (is (null (apply #'ars:way-cost chart ends)))
    (ars:free-cell chart '(10 5))
    (is (equal first (way-lists (apply #'ars:find-way chart ends))))
    (ars:free-all-cells chart)
    (is (null (ars:barred-cells chart)))
    (is (equal first (way-lists (apply #'ars:find-way chart ends))))))

(test ways.begin-in-the-nearest-free-cell
  (is (equal '((1.5d0 4.5d0) (9d0 4.5d0))
             (way-lists (ars:find-way 'two-doors '(0.2 4.5) '(9 4.5)))))
  (is (equal '((9.5d0 5.5d0)) (way-lists (list (ars:nearest-free-point
                                                (ars:bar-cell (ars:make-chart 'two-doors)
                                                              '(10 5))
                                                '(10.2 5.5))))))
  (is (null (ars:nearest-free-point 'two-doors '(-40 0))))
  (is (equal '((3d0 5d0)) (way-lists (list (ars:nearest-free-point 'two-doors '(3 5))))))
  (is (equal '((3d0 5d0) (3.25d0 5.25d0))
             (way-lists (ars:find-way 'two-doors (geo:make-pt 3 5) '(3.25 5.25))))))

(test ways.wrong-arguments-say-what-is-right
  (dolist (call (list (lambda () (ars:find-way 'two-doors '(30 3) '(3 3)))
                      (lambda () (ars:find-way 'two-doors '(3 3) '(3 -1)))
                      (lambda () (ars:find-way 'two-doors '(3) '(3 3)))
                      (lambda () (ars:find-way 'two-doors '(3 x) '(3 3)))
                      (lambda () (ars:find-way 17 '(3 3) '(3 3)))
                      (lambda () (ars:find-way 'two-doors '(3 3) '(4 4) :until 5))
                      (lambda () (ars:make-chart 'two-doors :clearance -1))
                      (lambda () (ars:make-chart 'two-doors :costs '((doorway .5))))
                      (lambda () (ars:make-chart 'two-doors :costs '((dorway 2))))
                      (lambda () (ars:bar-cell 'two-doors '(3 3)))
                      (lambda () (ars:bar-cell (ars:make-chart 'two-doors) '(3 3) -1))
                      (lambda () (ars:bar-cell (ars:make-chart 'two-doors) '(21 3)))
                      (lambda () (ars:way-length '(3 4)))))
    (signals base:wrong-argument (funcall call)))
  (signals base:unknown-name (ars:find-way 'two-dors '(3 3) '(4 4))))

;;; Sharing.

(test terrains.are-shared-until-their-map-changes
  (base:with-own-definitions ()
    (flet ((terrain (&rest options)
             (ars:chart-terrain (apply #'ars:make-chart 'two-doors options))))
      (let ((terrain (terrain)))
        (is (eq terrain (terrain)))
        (is (eq terrain (terrain :clearance .75)))
        (is (not (eq terrain (terrain :clearance 1))))
        (is (not (eq terrain (terrain :costs '()))))
        (world:rebuild-map 'two-doors)
        (is (not (eq terrain (terrain))))
        (setf terrain (terrain))
        (world:defmap two-doors (9 5))
        (is (not (eq terrain (terrain))))))))

(defun plan-many-ways (seed)
  "Return many ways of the office, some of them round barred cells, as SEED says."
  (let* ((dice (base:make-dice seed)) (map (world:find-map 'office))
         (chart (ars:make-chart map :clearance 1)))
    (loop repeat 12
          collect (way-lists (ars:find-way chart (random-cell map dice) (random-cell map dice)))
          do (change-at-random chart dice))))

(test ways.for-which-there-is-no-room-are-refused-in-words
  "What is only kept goes first; what it said is found anew."
  (let ((cost (ars:way-cost 'office '(62 38) '(108.5 70.5))))
    (handler-case (progn (ways::ensure-memory (base:heap-bytes) 16) (fail))
      (base:misuse (condition)
        (is (search "more memory than this Lisp has; start SBCL with a larger --dynamic-space-size"
                    (princ-to-string condition)))))
    (is (= cost (ars:way-cost 'office '(62 38) '(108.5 70.5))))))

(test ways.are-the-same-when-eight-threads-plan-at-once
  (base:with-own-definitions ()
    (let ((results (make-array 8)))
      (mapc #'base:join-thread
            (loop for i below 8
                  collect (let ((i i))
                            (base:start-thread
                             (lambda () (setf (svref results i) (plan-many-ways (mod i 4))))
                             "planner"))))
      (world:rebuild-map 'office)
      (dotimes (i 8)
        (is (equal (plan-many-ways (mod i 4)) (svref results i)))))))

(test charts.are-copied-with-what-is-barred
  (let* ((chart (ars:make-chart 'two-doors)) (ends '((3 5.5) (17 5.5))))
    (ars:bar-cell chart '(10.5 5.5))
    (let* ((way (way-lists (apply #'ars:find-way chart ends)))
           (copy (base:with-copier (copier) (base:copying (copier) (base:forked chart copier)))))
      (is (not (eq copy chart)))
      (is (eq (ars:chart-terrain copy) (ars:chart-terrain chart)))
      (ars:free-cell chart '(10.5 5.5))
      (is (not (equal way (way-lists (apply #'ars:find-way chart ends)))))
      (is (equal way (way-lists (apply #'ars:find-way copy ends))))
      (ars:bar-cell chart '(10.5 9.5))
      (is (equal way (way-lists (apply #'ars:find-way copy ends)))))))
