;;;; simulation.lisp -- one run: a world, its events, and what was asked of it.

(in-package :ars-magna.time)

(defstruct (simulation (:constructor %make-simulation) (:copier nil))
  "One run: a world, its events, and what was asked of it."
  (name "" :type (or symbol string))
  (world nil)
  (seed 0 :type integer)
  (agenda (make-agenda) :type agenda :read-only t)
  ;; Functions of the simulation, called in order each tick.
  (phases '() :type list)
  ;; Functions of the simulation: true while ticks are needed although no event is pending.
  (busy-tests '() :type list)
  (observers '() :type list)
  (journal nil)
  ;; The values of the parameters as the journal knows them.
  (known-parameters (parameter-values) :type simple-vector)
  (messages *message-queue* :type message-queue)
  ;; Newest first; pushed to by any thread.
  (inbox '() :type list)
  (questions '() :type list)
  ;; Functions of no arguments, newest first.
  (notifications '() :type list)
  (ticking-p nil :type boolean)
  ;; Why the run is over, a sentence without its full stop; then nothing can be asked of it.
  (over nil :type (or null string))
  ;; The live clock; see clock.lisp.
  (thread nil)
  (wake-up (make-semaphore "simulation") :read-only t)
  (asleep-p nil)
  (stopping-p nil)
  (paused-p nil)
  (steps 0 :type fixnum)
  (rate nil))

(addition simulation-p simulation-name simulation-world simulation-seed simulation-journal
          simulation-rate)
(document-functions
  simulation-inbox "Return what has been posted and waits for the next tick."
  simulation-p "True of simulations."
  simulation-name "Return what the simulation is called."
  simulation-world "Return the world that the simulation changes."
  simulation-seed "Return the integer from which all chance of the run comes."
  simulation-agenda "Return the agenda of the simulation."
  simulation-phases "Return the functions that each tick calls after its events."
  simulation-busy-tests "Return the functions that say whether ticks are needed."
  simulation-observers "Return the functions that are called after each tick."
  simulation-journal "Return the journal that the simulation keeps, or NIL."
  simulation-messages "Return the message queue that the simulation reports to."
  simulation-thread "Return the thread that runs the ticks, or NIL when headless."
  simulation-over "Return why the run is over, a string, or NIL as long as it is not."
  simulation-ticking-p "True inside a tick, while the world changes."
  simulation-rate "Return the pace of the live clock: ticks per second, or :FREE.")

(addition *simulation*)
(defvar *simulation* nil
  "The simulation that code runs for: the one of WITH-SIMULATION, of the thread, or the one last
given to SIMULATOR.")

(addition current-simulation)
(defun current-simulation ()
  "Return *SIMULATION*. Signals MISUSE when there is none."
  (or *simulation*
      (reject-use "There is no simulation here. Use (simulator ROBOT) or ~
                   (with-simulation (ROBOT) ...).")))

(defun make-simulation (&rest arguments
                        &key name world seed phases busy-tests journal messages)
  "Return a new simulation of WORLD at tick 0. It does nothing until its ticks are run."
  (declare (ignore name world seed phases busy-tests journal messages))
  (apply #'%make-simulation arguments))

(declaim (inline simulation-tick))
(addition simulation-tick)
(defun simulation-tick (&optional (simulation (current-simulation)))
  "Return how many ticks of SIMULATION have passed; inside a tick, its number."
  (agenda-tick (simulation-agenda simulation)))

(defun check-not-over (simulation &optional operator)
  "Signal MISUSE, by OPERATOR if that is one that users call, if the run of SIMULATION is over."
  (when (simulation-over simulation)
    (reject-use "~@[~(~A~): ~]The run in ~(~A~) is over, at tick ~D: ~A. (simulator ROBOT) starts ~
                 another."
                operator (simulation-name simulation) (simulation-tick simulation)
                (simulation-over simulation))))

(defmethod print-object ((simulation simulation) stream)
  (print-unreadable-object (simulation stream :type t)
    (format stream "~A at tick ~D" (simulation-name simulation) (simulation-tick simulation))))
