;;;; thinking.lisp -- the thinking mode of a run: what it is, and that it changes.

(in-package :ars-magna.run)

(defun begin-thinking (simulation mode)
  "Let thinking in SIMULATION, which has passed no tick, cost from the beginning what MODE says."
  (set-timeline-thinking (simulation-timeline simulation) mode)
  (when (simulation-journal simulation)
    (setf (getf (journal-header (simulation-journal simulation)) :thinking)
          (simulation-thinking simulation))))

(addition set-thinking)
(defun set-thinking (mode &optional (simulation (current-simulation)))
  "Let thinking in SIMULATION, also if that is under way, cost from now on what MODE says (manual
1.2), and return it:
  :FREE                      no ticks: plans react after each tick, as long as it takes them
  :CHARGED                   the ticks that THINK and WITH-CHARGE say
  (:CHARGED :BUDGET steps)   these, and a tick for each STEPS of plans: what is not done waits
  :REAL                      no ticks: where a clock runs, plans have a thread and the clock goes on
A plan that says so hears of it in its next reaction, mostly in the next tick.
Free and charged runs are the same on every machine. Without a clock :REAL is as :FREE. The journal
notes it. Signals WRONG-ARGUMENT."
  (check-thinking 'set-thinking mode)
  (let ((simulation (simulation-meant simulation 'set-thinking)))
    (changing ((simulation-world simulation) set-thinking mode)
      (set-timeline-thinking (simulation-timeline simulation) mode)))
  mode)

(define-operator 'set-thinking '(datum) #'set-thinking)
