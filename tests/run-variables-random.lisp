;;;; run-variables-random.lisp -- forks, rewinds, files and replays of random runs agree.

(in-package :ars-magna.tests)
(in-suite run-variables)

;;; A run does random deeds: programs, plans, continuations, kickers and events set run variables. A
;;; state is a list (tick digest variables). The states of each tick are kept, and must be the
;;; same in forks, after rewinds, in loaded runs, and in a replay of the journal. The continuations
;;; of commands in progress are not called after a rewind, nor plans in a loaded run; so there the
;;; states agree only at first, and then with those of another copy.

(defconstant +random-variable-runs+ 250)

(defvar *deeds-dice* nil)
(defvar *events-p* nil "True if events are scheduled. Such runs are not saved.")

(defun one-in (count) (zerop (base:roll-index count *deeds-dice*)))

(defun random-part-of-value (depth)
  (let ((n (base:roll-index 1000 *deeds-dice*)))
    (case (base:roll-index (if (plusp depth) 9 7) *deeds-dice*)
      (0 n)
      (1 (/ n 7))
      (2 (/ n 16d0))
      (3 (base:roll-element '(:key symbol nil t #\a #\Newline) *deeds-dice*))
      (4 (format nil "text ~D" n))
      (5 (base:roll-element (world:world-thing-list world:*world*) *deeds-dice*))
      (6 (base:roll-element (run:simulation-robots) *deeds-dice*))
      (7 (loop repeat (base:roll-index 4 *deeds-dice*) collect (random-part-of-value (1- depth))))
      (8 (coerce (loop repeat (base:roll-index 3 *deeds-dice*)
                       collect (random-part-of-value (1- depth)))
                 'simple-vector)))))

(defun keep-short (list)
  (subseq list 0 (min 12 (length list))))

(world:defkicker scribbling (thing) (:prob .3)
  (if (zerop (random 2))
      (incf *catch* (random 5))
      (setf *haul* (keep-short (cons (list thing *catch*) *haul*)))))

(rpl:def-interp-proc scribble (times step)
  (rpl:n-times times
    (rpl:wait-time (1+ (random step)))
    (incf *catch* (random 7))
    (rpl:par (setf *haul* (keep-short (cons (list (driver:rpl-robot) (rpl:plan-time)) *haul*)))
             (rpl:seq (rpl:wait-time 1) (decf *catch*)))
    (when (oddp *catch*)
      (setf *draw-of-run* (list *draw-of-run* (random 3)))
      (setf *draw-of-run* (if (consp (first *draw-of-run*)) 0 *draw-of-run*)))))

(defun scribble-and-turn-on (robot left)
  "Turn ROBOT; then set variables in the continuation, and turn LEFT times more."
  (command:robot-turn robot (/ (1+ (random 10)) 4)
                      (lambda (err robot angle)
                        (declare (ignore angle))
                        (setf *haul* (keep-short (cons (list err robot) *haul*)))
                        (when (and (null err) (plusp left))
                          (scribble-and-turn-on robot (1- left))))))

(defun do-random-deed ()
  (let ((robot (base:roll-element (run:simulation-robots) *deeds-dice*))
        (number (base:roll-index 5 *deeds-dice*)))
    (ecase (base:roll-index 8 *deeds-dice*)
      (0 (let ((value (random-part-of-value 3)))
           (setf *draw-of-run* value)
           (is (equalp value *draw-of-run*))))
      (1 (is (= (+ number *catch*) (incf *catch* number))))
      (2 (push (random-part-of-value 1) *haul*)
         (setf *haul* (keep-short *haul*)))
      (3 (scribble-and-turn-on robot number))
      (4 (let ((haul (list number robot)))
           (when *events-p* (time:schedule (nil :timer (1+ number)) (setf *haul* haul)))))
      (5 (driver:begin-plan 'scribble (1+ number) 4 :robot robot))
      (6 (when (one-in 3) (driver:end-plan :all)))
      (7 (let ((thing (base:roll-element (world:world-thing-list world:*world*) *deeds-dice*)))
           (world:kick-thing thing (- number 2) 1 nil)
           (setf *lucky-thing* thing))))))

;;; States.

(defun plainly (value)
  "Return VALUE with references in place of the objects of a run."
  (run::externalize value))

(defun state-of-variables ()
  (list (run:simulation-tick) (run:state-digest)
        (loop for (name value) in (run:run-variables) collect (list name (plainly value)))))

(defun states-of-ticks (count)
  (loop repeat count do (run:run-ticks 1) collect (state-of-variables)))

;; Reading is no state, so that a copy may know of other variables.
(defun same-states-p (ones others)
  (every (lambda (one other)
           (and (equalp (subseq one 0 2) (subseq other 0 2))
                (loop for (name value) in (third one)
                      for twin = (assoc name (third other))
                      always (or (null twin) (equalp value (second twin))))))
         ones others))

(defun check-random-forks ()
  "Check a fork of this run and its fork; and that scribbling in forks does not disturb this run."
  (let ((before (list (state-of-variables)))
        (one (run:fork-simulation :continuations t)))
    (run:with-fork (:continuations t)
      (setf *draw-of-run* 1 *catch* -100 *haul* '())
      (run:run-ticks 3))
    (is (same-states-p before (list (state-of-variables))))
    (is (same-states-p before (run:call-in-fork one (lambda () (list (state-of-variables))))))
    one))

(defun check-random-file ()
  "Save this run, if it has no plans, and check that two loaded runs go on in the same way."
  (unless (or *events-p* (driver:plans))
    (with-temporary-file (file)
      (when (handler-case (run:save-simulation file) (run:unsavable () nil))
        (flet ((loaded ()
                 (run:with-loaded-simulation (file)
                   (cons (state-of-variables) (states-of-ticks 4)))))
          (let ((one (loaded)))
            (is (same-states-p (list (state-of-variables)) one))
            (is (same-states-p one (loaded)))))))))

(defun check-random-rewind (states)
  "Rewind this run some ticks. Check it against STATES, a table of states by tick."
  (let* ((tick (run:simulation-tick)) (back (base:roll-index (min 9 (1+ tick)) *deeds-dice*)))
    (run:rewind back)
    (is (same-states-p (list (gethash (- tick back) states)) (list (state-of-variables))))))

(defun pass-random-ticks (states fork)
  "Pass ticks, and keep the last state in STATES. Check FORK, a fork at this tick, or NIL."
  (let* ((count (1+ (base:roll-index 6 *deeds-dice*))) (passed (states-of-ticks count)))
    (dolist (state passed) (setf (gethash (first state) states) state))
    (when fork
      (is (same-states-p passed (run:call-in-fork fork (lambda () (states-of-ticks count)))))
      (run:release-fork fork))))

(defun note-state-of-variables (states)
  (let ((state (state-of-variables))) (setf (gethash (first state) states) state)))

(defun check-random-run (states)
  (note-state-of-variables states)
  (driver:rpl-init-robot teal)
  (driver:rpl-init-robot otter)
  (world:set-kicker (world:find-thing 'cork) 'scribbling)
  (dotimes (n 8)
    (dotimes (deed (1+ (base:roll-index 2 *deeds-dice*))) (do-random-deed))
    (pass-random-ticks states (and (one-in 2) (check-random-forks)))
    (when (one-in 4) (check-random-file))
    (when (one-in 3) (check-random-rewind states)))
  (run:run-ticks 2)
  (let ((end (state-of-variables)) (journal (run:journal-up-to-now time:*simulation*)))
    (run:with-replay (journal)
      (is (same-states-p (list end) (list (state-of-variables)))))))

(test run-variables.agree-in-random-runs
  (dotimes (seed +random-variable-runs+)
    (let ((*deeds-dice* (base:make-dice seed "deeds")) (*events-p* (oddp seed))
          (states (make-hash-table)))
      (with-messages
        (run:with-simulation ((otter teal) :seed seed :journal t :keep t
                                           :thinking (if (zerop (mod seed 3)) :charged :free))
          (check-random-run states))))))
