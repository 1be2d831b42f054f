;;;; replay.lisp -- a run repeated from its journal, to the bit.

(in-package :ars-magna.robot)

(defun replay-entry (entry simulation)
  (destructuring-bind (tick operation . arguments) entry
    (run-ticks (- tick (simulation-tick simulation)) simulation)
    (apply-entry operation (internalize arguments simulation) simulation)))

(defun replay-entries (journal simulation)
  (dolist (entry (journal-entries journal)) (replay-entry entry simulation))
  (run-ticks (- (journal-end journal) (simulation-tick simulation)) simulation))

(defun full-settings (settings)
  "Return SETTINGS, a list (name value), with the defaults of the parameters it leaves out."
  (loop for parameter in (all-parameters)
        collect (or (find parameter settings :key (lambda (setting)
                                                    (find-parameter (first setting))))
                    (list (parameter-name parameter) (parameter-default parameter)))))

(defun call-with-replay (function journal &key until)
  "Call FUNCTION where JOURNAL has been repeated; see WITH-REPLAY."
  (let* ((journal (if (journal-p journal) journal (read-journal journal)))
         (journal (if until (truncated-journal journal until) journal)))
    (destructuring-bind (&key robots seed parameters &allow-other-keys) (journal-header journal)
      (call-with-simulation (lambda ()
                              (replay-entries journal (current-simulation))
                              (funcall function))
                            (mapcar (lambda (name) (body-name (find-body name))) robots)
                            :seed seed :parameters (full-settings parameters) :journal t))))

(addition with-replay)
(defmacro with-replay ((journal &key until) &body body)
  "Run BODY in a fresh headless simulation in which JOURNAL (a journal or a file that holds one)
has been repeated, up to the tick UNTIL or its end, with robots and parameters bound as in
WITH-SIMULATION: a run can be rewound so, and go on differently. Commands are repeated without
their continuations. Return the values of BODY. Signals DAMAGED-JOURNAL, and UNKNOWN-NAME
when the world is not loaded."
  `(call-with-replay (lambda () ,@body) ,journal :until ,until))

(addition replay)
(defun replay (journal &key until)
  "Repeat JOURNAL as WITH-REPLAY does. Return the simulation, and its STATE-DIGEST."
  (with-replay (journal :until until)
    (values (current-simulation) (state-digest))))

(defun end-of-journal (simulation)
  "Return the journal of SIMULATION, marked as reaching to now."
  (let ((journal (or (simulation-journal simulation)
                     (reject-use "This simulation keeps no journal. Ask for one: ~
                                  (with-simulation (ROBOT :journal t) ...)."))))
    (setf (journal-end journal) (simulation-tick simulation)
          ;; Some may have been defined since it began.
          (getf (journal-header journal) :robots) (robot-names simulation))
    journal))

(addition save-journal)
(defun save-journal (file &optional (simulation (current-simulation)))
  "Write the journal of SIMULATION up to now to FILE. Return its truename. Signals MISUSE."
  (asking (simulation) (write-journal (end-of-journal simulation) file)))

(addition load-journal)
(defun load-journal (file)
  "Return the journal in FILE. Signals DAMAGED-JOURNAL."
  (read-journal file))
