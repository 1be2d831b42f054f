;;;; recordings.lisp -- films that sessions record: of which run, and from which tick.

(in-package :ars-magna.cli)

(export '(recording-text))

;;; A film is made from the journal of a run when the recording ends. Until then a recording is only
;;; a run and a tick, so it costs the run nothing, and a film that cannot be saved is not lost.

(defstruct (recording (:copier nil))
  "The film that a session records: the ticks of SIMULATION from START on. ROBOT is the name of the
robot that the prompt commanded. OPTIONS are options of SAVE-ANIMATION."
  (simulation nil)
  (start 0 :type unsigned-byte)
  (robot nil :type symbol :read-only t)
  (options '() :type list :read-only t))

(defun recording-text (session &optional (shown *simulation*))
  "Return a text about the film that SESSION records, or NIL if it records no film. The text names
the run of the film unless it is the run SHOWN."
  (let ((recording (session-recording session)))
    (when recording
      (let ((simulation (recording-simulation recording)))
        (format nil "recording a film~@[ of ~A~] since tick ~D"
                (and (not (eq simulation shown)) (run-description simulation))
                (recording-start recording))))))

(defun begin-recording (session options)
  "Make SESSION record a film of its run from the present tick on."
  (check-run-not-over)
  (let ((simulation (current-simulation)))
    (asking (simulation) (journal-up-to-now simulation))      ; there must be a journal
    (setf (session-recording session)
          (make-recording :simulation simulation :start (simulation-tick simulation)
                          :robot (robot-name (session-robot)) :options options))))

;;; After a rewind, the film shows the run as it then continues, without the discarded ticks.

(defun follow-rewind (old new)
  "Let films of OLD continue with NEW, which has replaced OLD, from the tick of NEW at the latest."
  (dolist (session (running-sessions))
    (let ((recording (session-recording session)))
      (when (and recording (eq old (recording-simulation recording)))
        (setf (recording-simulation recording) new
              (recording-start recording) (min (recording-start recording)
                                               (simulation-tick new)))))))

(add-listener *rewind-hooks* follow-rewind)

;;; The end.

(defun unused-film-name (recording end)
  "Return a name for the film of RECORDING up to the tick END. There is no file of this name yet."
  (loop for number = nil then (1+ (or number 1))
        for name = (format nil "~(~A~)-~6,'0D-~6,'0D~@[-~D~].html" (recording-robot recording)
                           (recording-start recording) end number)
        unless (probe-file (path-of-name name)) return name))

(defun recorded-journal (recording)
  "Return the journal for the film of RECORDING. Signals BAD-LINE if it ends before the film."
  (let* ((simulation (recording-simulation recording))
         (journal (asking (simulation) (journal-up-to-now simulation))))
    (when (< (journal-end journal) (recording-start recording))
      (reject-line "There is no film: the journal of the run is full and ends at tick ~D, before ~
                    the recording began. RECORD cancel ends the recording. *JOURNAL-LIMIT* sets ~
                    the length of the journal of the next run."
                   (journal-end journal)))
    journal))

(defun save-recording (recording journal file hook)
  "Save the film of RECORDING in FILE. Call HOOK with ticks to report progress. Return the truename
of FILE and the last tick of the film."
  (let* ((end (journal-end journal)) (*frame-hook* hook)
         (path (path-of-name (or file (unused-film-name recording end)))))
    (values (apply #'save-animation journal path
                   :from (recording-start recording) :until end
                   ;; A remark in the title says so if definitions have changed since.
                   :anyway t
                   (recording-options recording))
            end)))

(defun film-text-for-user (recording path end)
  (format nil "Film of tick~P ~D~@[ to ~D~]: ~A~%Open this file in a web browser to play the film."
          (1+ (- end (recording-start recording))) (recording-start recording)
          (and (/= end (recording-start recording)) end) (native-name path)))

(defun end-recording (session &optional file (hook (constantly nil)))
  "Save the film that SESSION records in FILE or a new file. Return a text that says where it is.
SESSION continues to record if the film cannot be saved. Call HOOK with ticks to report progress."
  (let ((recording (session-recording session)))
    (multiple-value-bind (path end)
        (save-recording recording (recorded-journal recording) file hook)
      (setf (session-recording session) nil)
      (film-text-for-user recording path end))))

(defun run-of-other-prompts (recording)
  "Return the run whose messages other prompts show when the prompt of RECORDING has ended."
  (let ((simulation (recording-simulation recording)))
    (if (live-p simulation)
        simulation
        (or (global-value '*simulation*) simulation))))

(defun save-last-film (session)
  "Save the film that SESSION still records, if any. Print where it is, or why it is not saved."
  (let ((recording (session-recording session)))
    (when recording
      (handler-case (format t "~A~%" (end-recording session))
        (error (condition)
          (format t "The film since tick ~D is not saved: ~A. While the run goes on, the line FILM ~
                     file FROM ~D saves it.~%"
                  (recording-start recording) (one-line-text condition)
                  (recording-start recording)))))))

(defun save-film-of-ended-session (session)
  "Save the film that SESSION, which is over, still records. Print where it is or, if SESSION had a
window, queue a message about it for other prompts."
  (let ((recording (session-recording session)))
    (cond ((null recording))
          ((session-place session)
           (let ((*message-queue* (simulation-messages (run-of-other-prompts recording))))
             (message-set (string-right-trim '(#\Newline)
                                             (with-output-to-string (*standard-output*)
                                               (save-last-film session))))))
          (t (save-last-film session)))))
