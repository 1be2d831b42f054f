;;;; ways.lisp -- costs of goals, compared with slow and simple algorithms.

(in-package :ars-magna.tests)

(def-suite* ways :in ars-magna)

;;; Random maps.

(defun random-walls (width height share dice)
  "Return clauses of single walls that fill SHARE of a map, but none of its corners' cells."
  (loop for y below height
        append (loop for x below width
                     when (and (< (base:roll dice) share)
                               (not (and (member x '(0 1)) (member y '(0 1)))))
                       collect `(wall (,x ,y) (,x ,y) stone 1))))

(defmacro with-random-map ((map width height share dice) &body body)
  "Run BODY with a new MAP of WIDTH x HEIGHT cells, SHARE of which DICE made walls."
  `(base:with-own-definitions ()
     (eval (list* 'world:defmap 'random-ground (list ,width ,height)
                  (random-walls ,width ,height ,share ,dice)))
     (let ((,map (world:find-map 'random-ground)))
       ,@body)))

(defun random-cell (map dice)
  "Return the middle of a free cell of MAP."
  (loop for x = (+ 1/2 (base:roll-index (world:map-width map) dice))
        for y = (+ 1/2 (base:roll-index (world:map-height map) dice))
        unless (world:wall-at-p map x y) return (list x y)))

(defun node-in (chart point)
  (ways::node-of-point 'node-in chart point))

(defun map-nodes (chart)
  "Return the numbers of all cells of the map of CHART."
  (let ((map (ars:chart-map chart)))
    (loop for x below (world:map-width map)
          append (loop for y below (world:map-height map)
                       collect (ways::cell-node (ars:chart-terrain chart) x y)))))

;;; The slow way: drafts are made anew, all over, until none changes.

(defun slow-totals (chart goal)
  "Return what the node GOAL costs from all nodes of CHART, by iteration."
  (let* ((field (ways::make-field (ars:chart-terrain chart) goal))
         (totals (ways::field-totals field)))
    (setf (ways::field-cells field) (copy-seq (ways::field-cells field)))
    (dolist (node (map-nodes chart))
      (setf (aref (ways::field-cells field) node) (ways::cost-of-node chart node)))
    (when (< (ways::cost-of-node chart goal) ways::+barred-cost+) (setf (aref totals goal) 0d0))
    (loop for changed = nil
          do (dolist (node (map-nodes chart))
               (when (< (aref (ways::field-cells field) node) ways::+barred-cost+)
                 (let ((draft (ways::compute-draft-cost field node)))
                   (unless (= draft (aref totals node))
                     (setf (aref totals node) draft changed t)))))
          while changed)
    totals))

(defun totals-differ-p (chart goal nodes)
  "True if what is found from any of NODES to the node GOAL is not what the slow way finds."
  (let ((slow (slow-totals chart goal)))
    (some (lambda (node)
            (/= (aref slow node) (ways::cost-to-goal (ways::field-for-goal chart goal) node)))
          nodes)))

(defun shuffled-nodes (list dice)
  (mapcar #'cdr (sort (loop for each in list collect (cons (base:roll dice) each)) #'< :key #'car)))

(test totals.are-those-of-the-equations
  "To the bit, in whatever order they are asked for."
  (let ((dice (base:make-dice 11)))
    (dotimes (i 12)
      (with-random-map (map 12 9 (* 1/20 i) dice)
        (let ((chart (ars:make-chart map :clearance (* 1/2 (mod i 3)))))
          (is-false (totals-differ-p chart (node-in chart (random-cell map dice))
                                     (shuffled-nodes (map-nodes chart) dice))))))))

(defun change-at-random (chart dice)
  "Bar or free a cell of CHART, as DICE say."
  (let ((point (random-cell (ars:chart-map chart) dice)) (barred (ars:barred-cells chart)))
    (case (base:roll-index 4 dice)
      (0 (ars:bar-cell chart point))
      (1 (ars:bar-cell chart point (base:roll-between 0 50 dice)))
      (t (when barred
           (destructuring-bind (x y cost) (base:roll-element barred dice)
             (declare (ignore cost))
             (ars:free-cell chart (list x y))))))))

(test totals.leave-no-trace-of-what-was-barred-before
  "After each of many changes they are those that are found from the beginning."
  (let ((dice (base:make-dice 12)))
    (dotimes (i 8)
      (with-random-map (map 11 11 1/8 dice)
        (let* ((chart (ars:make-chart map :clearance 1))
               (goals (loop repeat 2 collect (node-in chart (random-cell map dice)))))
          (dotimes (j 12)
            (change-at-random chart dice)
            (is-false (totals-differ-p chart (base:roll-element goals dice)
                                       (loop repeat (base:roll-index 5 dice)
                                             collect (node-in chart (random-cell map dice)))))))))))

(test totals.are-found-anew-where-they-change-only
  "One cell is barred near the start: hardly a hundredth of the totals are touched."
  (let* ((chart (ars:make-chart 'office)) (goal (node-in chart '(109 24))))
    (flet ((totals ()
             (ars:find-way chart '(10 5) '(109 24))
             (copy-seq (ways::field-totals (ways::field-for-goal chart goal)))))
      (ars:bar-cell chart '(20 70))
      (let ((before (totals)))
        (ars:bar-cell chart '(10.5 10.5))
        (is (< 0 (count nil (map 'list #'= before (totals))) 100))))))

;;; Another bound: ways from cell to cell, straight and diagonally.

(defun step-costs (chart node)
  "Return a list of (node cost) for the steps from NODE to those around it."
  (let ((columns (ways::terrain-columns (ars:chart-terrain chart))))
    (flet ((cost (&rest nodes)
             (reduce #'max (mapcar (lambda (node) (ways::cost-of-node chart node)) nodes))))
      (append (loop for side in (list 1 -1 columns (- columns))
                    collect (list (+ node side) (cost node (+ node side))))
              (loop for (x y) in `((1 ,columns) (1 ,(- columns)) (-1 ,columns) (-1 ,(- columns)))
                    collect (list (+ node x y)
                                  (* (sqrt 2d0) (cost node (+ node x) (+ node y)
                                                      (+ node x y)))))))))

(defun dijkstra-total (chart start goal)
  "Return what GOAL costs from START, both nodes, by steps between nodes, or +BARRED-COST+."
  (let ((known (make-hash-table)) (open (list (cons 0d0 goal))))
    (loop while open
          do (destructuring-bind (total . node) (pop open)
               (unless (gethash node known)
                 (setf (gethash node known) total)
                 (loop for (next cost) in (step-costs chart node)
                       when (and (< cost ways::+barred-cost+) (not (gethash next known)))
                         do (setf open (merge 'list open (list (cons (+ total cost) next))
                                              #'< :key #'car))))))
    (gethash start known ways::+barred-cost+)))

(test totals.lie-between-the-straight-line-and-steps-from-cell-to-cell
  (let ((dice (base:make-dice 13)) (found 0))
    (dotimes (i 15)
      (with-random-map (map 20 15 (* 1/60 i) dice)
        (let ((chart (ars:make-chart map)))
          (dotimes (j 4)
            (destructuring-bind (start goal) (list (random-cell map dice) (random-cell map dice))
              (let ((total (ars:way-cost chart start goal))
                    (steps (dijkstra-total chart (node-in chart start) (node-in chart goal))))
                (is (eq (null total) (= steps ways::+barred-cost+)))
                (when total
                  (incf found)
                  (is (<= total (+ steps 1d-9)))
                  (is (<= (ars:way-length (list start goal)) (+ total 1d-9))))))))))
    (is (< 30 found))))

(test totals.are-the-same-on-all-machines
  "Nothing but sums, products, quotients and square roots, which IEEE 754 makes exact."
  (is (= 73.50298011613458d0 (ars:way-cost 'office '(62 38) '(109 24))))
  (is (= 94.34442405559784d0 (ars:way-cost 'office '(62 38) '(108.5 70.5)))))

;;; Queues.

(test queues.give-the-least-key-first
  (let ((queue (ways::make-queue)) (dice (base:make-dice 14)) (keys '()))
    (dotimes (i 500)
      (let ((key (base:roll-between 0 10 dice)))
        (push key keys)
        (ways::queue-push queue i key)))
    (is (equal (sort keys #'<)
               (loop until (zerop (ways::queue-count queue))
                     collect (aref (ways::queue-keys queue) 0)
                     do (ways::queue-pop queue))))))
