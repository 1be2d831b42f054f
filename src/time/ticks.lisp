;;;; ticks.lisp -- what happens in a tick, and what passes ticks without a clock.

(in-package :ars-magna.time)

;;; A tick has an order: (1) the inbox, which is what programs have asked for since the last one;
;;; (2) the events that are due; (3) the phases, which the layers above add: kickers, then tracks
;;; and grips; (4) notifications, that is, the continuations of what has ended, in the order in
;;; which it ended; (5) observers. In 1 to 3 the world changes, in 4 and 5 user code runs. So
;;; whatever a program does happens between ticks, and a journal can repeat it.

(defun notify-later (simulation function)
  "Call FUNCTION at the end of this tick, after those already to be called then."
  (push function (simulation-notifications simulation)))

(defun deliver-notifications (simulation)
  (loop while (simulation-notifications simulation)
        do (mapc #'funcall (reverse (shiftf (simulation-notifications simulation) '())))))

(addition add-observer)
(defun add-observer (function &optional (simulation (current-simulation)))
  "Call FUNCTION with SIMULATION after each of its ticks. Return FUNCTION."
  (setf (simulation-observers simulation)
        (append (simulation-observers simulation) (list function)))
  function)

(addition remove-observer)
(defun remove-observer (function &optional (simulation (current-simulation)))
  "Stop calling FUNCTION after the ticks of SIMULATION."
  (setf (simulation-observers simulation) (remove function (simulation-observers simulation)))
  (values))

(defun call-observers (simulation)
  (dolist (observer (simulation-observers simulation))
    (call-user-code observer "an observer" simulation)))

(defun note-parameters (simulation)
  "Let the journal of SIMULATION know which parameters somebody has set."
  (follow-parameters (simulation-known-parameters simulation)
                     (and (simulation-thread simulation) t)
                     (lambda (symbol value) (note simulation :parameter symbol value))))

(defun tick (simulation)
  "Pass one tick of SIMULATION. To be called by its owner only."
  (declare #.*hot* (type simulation simulation))
  (setf (simulation-ticking-p simulation) t)
  (unwind-protect
       (progn
         ;; Commands read parameters, so they are looked after at least when there are any.
         (when (or (simulation-journal simulation)
                   (simulation-thread simulation)
                   (simulation-inbox simulation))
           (note-parameters simulation))
         (when (simulation-inbox simulation) (open-inbox simulation))
         (advance-agenda (simulation-agenda simulation))
         (dolist (phase (simulation-phases simulation))
           (funcall (the function phase) simulation)))
    (setf (simulation-ticking-p simulation) nil))
  (when (simulation-notifications simulation) (deliver-notifications simulation))
  (when (simulation-observers simulation) (call-observers simulation)))

(addition idle-p)
(defun idle-p (&optional (simulation (current-simulation)))
  "True if nothing can happen in SIMULATION until somebody asks for something."
  (and (zerop (agenda-pending (simulation-agenda simulation)))
       (null (simulation-inbox simulation))
       (notany (lambda (test) (funcall (the function test) simulation))
               (simulation-busy-tests simulation))))

;;; Passing ticks without a clock.

(defun check-headless (simulation operator)
  (when (simulation-thread simulation)
    (reject-use "~(~A~): this simulation runs live, its ticks pass by themselves. ~
                 Use (with-simulation (ROBOT) ...) or (stop-simulator)." operator)))

(addition run-ticks)
(defun run-ticks (count &optional (simulation (current-simulation)))
  "Pass COUNT ticks of the headless SIMULATION. Return the tick then reached. Signals
WRONG-ARGUMENT, and MISUSE if SIMULATION runs live or is inside a tick."
  (check-argument run-ticks count (typep count '(integer 0)) "a number of ticks, 0 or more")
  (check-headless simulation 'run-ticks)
  (check-not-over simulation 'run-ticks)
  (when (simulation-ticking-p simulation)
    (reject-use "run-ticks: a tick is under way; time cannot pass inside it."))
  (let ((*simulation* simulation)
        (*message-queue* (simulation-messages simulation)))
    (loop repeat count do (tick simulation)))
  (simulation-tick simulation))

(addition run-until)
(defun run-until (predicate &key (limit 100000) (simulation (current-simulation)))
  "Pass ticks of the headless SIMULATION until PREDICATE, a function of no arguments, returns
true, but at most LIMIT. Return what it returned and the tick reached; NIL means the limit."
  (check-argument run-until limit (typep limit '(integer 0)) "a number of ticks, 0 or more")
  (check-headless simulation 'run-until)
  (check-not-over simulation 'run-until)
  (let ((answer (loop for left downfrom limit
                      thereis (funcall predicate)
                      until (zerop left)
                      do (run-ticks 1 simulation))))
    (values answer (simulation-tick simulation))))
