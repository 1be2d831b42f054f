;;;; plots.lisp -- plots that threads read while ticks take samples, and while they are hidden.

(in-package :ars-magna.benchmarks)

(asdf:load-system "ars-magna/cli")

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :cli :ars-magna.cli)
  (sb-ext:add-package-local-nickname :plots :ars-magna.plots))

(world:defmap hall (20 20) (rect (0 0) (20 20) bricks 1))
(robot:defrobot dancer (hall (10.5 10.5) 0))

;;; The plotted value is the tick itself, so each range of a chart says which ticks it is of.

(defun make-plotting-session ()
  (let ((session (cli:make-session :input (make-string-input-stream "")
                                   :output (make-broadcast-stream))))
    (setf (cli:session-plotter session)
          (cli::make-plotter
           :quantities (list (cli::make-quantity "tick" ""
                                                 (cli::stateless-maker
                                                  (lambda (robot tick)
                                                    (declare (ignore robot))
                                                    (coerce tick 'double-float)))))))
    session))

(defun right-ranges-p (ranges)
  "True if each of RANGES has the values of its own ticks, and their ticks ascend."
  (loop with before = -1
        for range in ranges
        for tick = (plots::sample-range-tick range)
        always (and (< before tick)
                    (= tick (plots::sample-range-low range))
                    (<= tick (plots::sample-range-high range) (plots::sample-range-end range)))
        do (setf before tick)))

(defun count-wrong-charts (session simulation count)
  "Collect COUNT charts; return how many are wrong."
  (loop repeat count
        sum (count-if-not #'right-ranges-p (cli:plotted-charts session simulation 'dancer 400)
                          :key #'plots::time-chart-ranges)))

(defun hide-and-show (session simulation)
  "Hide the plots of SESSION and show them again, as a window does that is folded and unfolded."
  (cli:set-plots-shown session nil)
  (cli:set-plots-shown session t)
  (cli:follow-plots session simulation 'dancer))

(defun keep-dancing (robot)
  (command:robot-turn robot 3 (lambda (err robot angle)
                                (declare (ignore angle))
                                (unless err (keep-dancing robot)))))

(defun read-from-threads (session simulation threads each)
  "Collect EACH charts in each of THREADS threads, while this one hides and shows the plots of
SESSION. Return two values: how many charts are wrong, and how often plots were hidden."
  (let* ((wrong (make-array threads :initial-element nil))
         (readers (loop for thread below threads
                        collect (let ((thread thread))
                                  (base:start-thread
                                   (lambda ()
                                     (setf (aref wrong thread)
                                           (count-wrong-charts session simulation each)))
                                   "reader of charts"))))
         (hidden (loop while (some #'base:thread-alive-p readers)
                       do (hide-and-show session simulation)
                       count t)))
    (mapc #'base:join-thread readers)
    (values (reduce #'+ wrong) hidden)))

(let* ((threads 3) (each 3000)
       (simulation (run:fresh-simulation '(dancer) :seed 1))
       (session (make-plotting-session)))
  (run:start-clock simulation :rate :free)
  (keep-dancing (first (run:simulation-robots simulation)))
  (cli:follow-plots session simulation 'dancer)
  (multiple-value-bind (wrong hidden) (read-from-threads session simulation threads each)
    (run:stop-clock simulation)
    (say "ticks that passed while 3 threads read 9,000 charts"
         (run:simulation-tick simulation) "ticks")
    (say "  times that the plots were hidden and shown" hidden "times")
    (say "  charts with wrong samples" wrong "charts")))
