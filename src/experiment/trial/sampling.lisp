;;;; sampling.lisp -- what the clause :each-tick records of a trial, from tick to tick.

(in-package :ars-magna.experiment)

;;; A sample is taken before the first tick and right after each tick, before :run or a plan's
;;; caller goes on. The gate, which lets one tick pass at a time, leaves a question that is answered
;;; once the tick is over, plans included. An observer would not do: it is called before plans act,
;;; and where there is one, a plan that waits in vain might still be helped, so it is no deadlock.

(defstruct (sampler (:constructor make-sampler (experiment result)) (:copier nil))
  "What takes the samples of a trial."
  (experiment nil :type experiment :read-only t)
  (result nil :type result :read-only t)
  ;; Lists (tick text...), the newest first.
  (samples '() :type list)
  ;; What CL:RANDOM rolls meanwhile.
  (dice (seeded-lisps-dice 0) :read-only t)
  ;; What is to be said of the first error, or NIL.
  (trouble nil :type (or null string)))

(defvar *sampler* nil "The sampler of the trial under way in this thread, or NIL.")

;;; One sample.

(defun call-with-other-dice (function tick world)
  "Call FUNCTION. What the dice of WORLD roll in it depends on what they were and on TICK. They are
then as before."
  (let* ((all (world-dice-set world))
         (states (loop for dice across all collect (dice-state dice))))
    (loop for dice across all
          for state in states
          do (setf (dice-state dice) (dice-state (make-dice (logxor state tick) "each tick"))))
    (unwind-protect (funcall function)
      (loop for dice across all
            for state in states
            do (setf (dice-state dice) state)))))

(defun call-rolling-apart (function sampler tick world)
  "Call FUNCTION, which is to roll neither the dice of WORLD nor those of the trial's programs."
  ;; The seed alone is that of the trial's programs.
  (reseed-lisps-dice (+ (result-seed (sampler-result sampler)) (ash (1+ tick) 32))
                     (sampler-dice sampler))
  (rolling ((sampler-dice sampler))
    (call-with-other-dice function tick world)))

(defun sampled-text (sampler name function tick)
  "Return the text of what FUNCTION, called NAME, returns at TICK. If it breaks off, return an empty
one; of the first time SAMPLER keeps the error."
  (let* ((text "")
         (condition (result-condition (sampler-result sampler)))
         (trouble (trouble-text
                   (lambda ()
                     (setf text (text-of-measure "each-tick" name function condition))))))
    (when (and trouble (null (sampler-trouble sampler)))
      (setf (sampler-trouble sampler)
            (format nil "Error in :each-tick ~(~A~) at tick ~D: ~A" name tick trouble)))
    text))

;; A form may be left, as by THROW. Then the rest of its sample is empty.
(defun take-sample (sampler simulation)
  (let* ((functions (experiment-series (sampler-experiment sampler)))
         (tick (simulation-tick simulation))
         (texts (make-list (length functions) :initial-element "")))
    (push (cons tick texts) (sampler-samples sampler))
    (call-rolling-apart (lambda ()
                          (loop for (name function) in functions
                                for place on texts
                                do (setf (first place)
                                         (sampled-text sampler name function tick))))
                        sampler tick (simulation-world simulation))))

(defun drop-later-samples (sampler tick)
  "Let SAMPLER forget samples of ticks after TICK: those that the trial has been rewound over."
  (loop while (and (sampler-samples sampler)
                   (> (first (first (sampler-samples sampler))) tick))
        do (pop (sampler-samples sampler))))

(defun sample-once (sampler simulation)
  "Let SAMPLER have a sample of SIMULATION, unless it has one of this tick already or the tick is
not over."
  (let ((tick (simulation-tick simulation)))
    (when (zerop (timeline-phase (simulation-timeline simulation)))
      (drop-later-samples sampler tick)
      (unless (eql tick (first (first (sampler-samples sampler))))
        (take-sample sampler simulation)))))

;;; All of them.

(defun sampling-gate (sampler gate)
  "Return a gate that lets one tick pass at a time, as far as GATE does, between samples."
  (lambda (simulation)
    (sample-once sampler simulation)
    (let ((count (funcall gate simulation))
          (custody (timeline-custody (simulation-timeline simulation))))
      (atomic-push (lambda () (sample-once sampler simulation)) (custody-questions custody))
      (min 1 count))))

(defun call-sampling (function experiment result)
  "Call FUNCTION, which runs the trial of RESULT in the current simulation. What EXPERIMENT wants is
recorded at each tick, for NOTE-SERIES."
  (let ((*sampler* (and (experiment-series experiment) (make-sampler experiment result)))
        (simulation (current-simulation)))
    (when *sampler*
      (setf (simulation-gate simulation) (sampling-gate *sampler* (simulation-gate simulation))))
    (funcall function)))

(defun note-series (result)
  "Enter into RESULT what has been recorded of its trial, and the first error, if none came before."
  (when *sampler*
    (sample-once *sampler* (current-simulation))
    (setf (result-series result) (reverse (sampler-samples *sampler*)))
    (when (sampler-trouble *sampler*) (add-error result (sampler-trouble *sampler*)))))
