;;;; testbeds-pursuit.lisp -- the testbed of pursuit: its rules, agents and claims.

(in-package :ars-magna.tests)

(in-suite testbeds)

(defun pursuit-symbol (name) (find-symbol (string name) :ars-pursuit))

(defmacro with-pursuit ((agent &key (seed 1) knobs) &body body)
  "Run BODY after a game of AGENT, or at the start of one if AGENT is NIL."
  `(call-with-pursuit ,agent ,seed ,knobs (lambda () ,@body)))

(defun call-with-pursuit (agent seed knobs function)
  (run:with-simulation ((mapcar #'pursuit-symbol
                                '(prey predator-1 predator-2 predator-3 predator-4 predator-5
                                  predator-6))
                        :seed seed :clean t :thinking :charged :journal t :keep t
                        :parameters (append (loop for (name value) in knobs
                                                  collect (list (pursuit-symbol name) value))
                                            '((base:max-speed* 1) (base:max-turn-angle* 4)
                                              (base:robot-turn-delay* 0) (base:step-duration* 1)
                                              (base:step-by-grid* t))))
    (when agent (ars-pursuit:play-pursuit (pursuit-symbol agent)))
    (funcall function)))

(defun pursuit-cells ()
  (loop for cell across (ars-pursuit:current-cells)
        collect (multiple-value-bind (row column) (floor cell 20)
                  (cons (1+ column) (1+ row)))))

(defun pursuit-time ()
  (run:measure-value 'ars-pursuit:capture-time))

(test pursuit.plays-as-a-program-without-the-simulator
  "The same draws, the same rules: the same moves to the end."
  (loop for (agent bare seeds knobs rules . options)
          in '((greedy :greedy (1 2 3) ((time-limit* 150)) () :limit 150)
               (random-walk 0 (1 2) ((time-limit* 60)) () :limit 60)
               (greedy :greedy (4 5) ((time-limit* 60) (order* :turns)) () :limit 60 :turns t)
               (greedy :greedy (6) ((time-limit* 60) (metric* :king)) (:metric :king) :limit 60)
               (greedy :greedy (7 8) ((time-limit* 60) (ties* :first)) (:ties :first) :limit 60)
               (level-2 2 (1) ((time-limit* 12)) () :limit 12)
               (level-2 2 (3) ((time-limit* 8) (ties* :first) (prey-stays* t))
                (:ties :first :stays t) :limit 8)
               (level-2 2 (2) ((time-limit* 6) (diagonal* :none) (prey-stays* t)
                               (quadrant-weight* 2))
                (:diagonal :none :stays t :weight 2) :limit 6)
               (level-4 4 (2) ((predators* 3) (time-limit* 30)) () :limit 30 :count 3)
               (level-4 4 (3) ((time-limit* 8)) () :limit 8))
        do (dolist (seed seeds)
             (multiple-value-bind (round cells)
                 (let ((*bare-rules* (append rules *bare-rules*)))
                   (apply #'bare-hunt bare seed options))
               (with-pursuit (agent :seed seed :knobs knobs)
                 (is (= round (pursuit-time)) "~A ~D" agent seed)
                 (is (equal cells (pursuit-cells)) "~A ~D" agent seed))))))

(defun pursuit-scores (agent &key (seeds 10) knobs (measure "capture-time"))
  (let* ((results (experiment:run-testbed 'pursuit :agents (list (pursuit-symbol agent))
                                                   :knobs knobs :seeds seeds :stream nil))
         (sample (first (experiment:results-samples results))))
    (is (every (lambda (text) (string= "" text)) (experiment:sample-errors sample)))
    (coerce (experiment:sample-measure results sample measure) 'list)))

(test pursuit.no-agent-is-quicker-than-the-bound
  (is (every #'<= (pursuit-scores 'level-4 :measure "least-time") (pursuit-scores 'level-4))))

(test pursuit.modelling-helps
  "Level 2 is quicker than greed; one level alone lets some prey escape."
  (let ((greedy (pursuit-scores 'greedy :seeds 30)) (level-2 (pursuit-scores 'level-2 :seeds 30)))
    (is (< (* 2 (reduce #'+ level-2)) (reduce #'+ greedy)))
    (is (notany (lambda (time) (= 500 time)) level-2))
    (is (some (lambda (time) (= 500 time)) (pursuit-scores 'level-1 :seeds 30)))))

(defun start-pursuit (agent)
  (ars-pursuit::place-players)
  (run:run-ticks 2)
  (ars-pursuit::start-moving ars-pursuit:prey #'ars-pursuit::prey-move)
  (experiment:start-agent (pursuit-symbol agent)))

(test pursuit.robots-never-share-a-cell
  (dolist (knobs '(((contested* :one) (time-limit* 40)) ((order* :turns) (time-limit* 20))))
    (with-pursuit (nil :knobs knobs)
      (start-pursuit 'greedy)
      (loop repeat 40
            do (run:run-ticks 2)
               (let ((cells (pursuit-cells)))
                 (is (equal cells (remove-duplicates cells :test #'equal))))))))

(test pursuit.forks-rewinds-and-replays-exactly
  (with-pursuit (nil :seed 3)
    (start-pursuit 'level-2)
    (run:run-ticks 8)
    (flet ((state () (list (pursuit-cells) (run:state-digest))))
      (let ((middle (state))
            (fork (run:with-fork (:continuations t) (run:run-ticks 9) (state)))
            (end (progn (run:run-ticks 9) (state))))
        (is (not (equal middle end)))
        (is (equal fork end))
        (is (equal end (run:with-replay ((run:simulation-journal (run::current-simulation)))
                         (state))))
        (run:rewind 9)
        (is (equal middle (state)))))))

(test pursuit.looks-ahead-by-forks
  (is (every (lambda (time) (< time 500)) (pursuit-scores 'look-ahead :seeds 2))))

(test pursuit.functions-for-agents-refuse-wrong-arguments
  (with-pursuit ('still :knobs '((time-limit* 1)))
    (let ((cells (ars-pursuit:current-cells)) (prey ars-pursuit:prey))
      (check-wrong-arguments :ars-pursuit
                             `((next-cell nil 1) (next-cell 400 1) (next-cell 3 9)
                               (distance-to nil nil) (distance-to 3 -1) (quadrants-held nil)
                               (quadrants-held #(1 2)) (hunt nil) (hunt 3) (captured-p 3)
                               (cells-after ,cells (1 1)) (cells-after nil nil)
                               (cells-after ,cells (0 1 2 3 5)) (draw-move ,prey nil)
                               (draw-move 3 (1 0)) (draw-move ,prey (0 0 0 0 0))
                               (modelled-moves ,cells nil) (modelled-moves nil 1)))
      (is (= 4 (ars-pursuit:next-cell 3 1)))
      (is (equalp cells (ars-pursuit:cells-after cells '(0 0 0 0 0)))))))
