;;;; recordings.lisp -- films that sessions record: of which run, and from which tick.

(in-package :ars-magna.cli)

(export '(recording-text recording-film-p))

;;; A film is made from the journal of a run when the recording ends. Until then a recording is only
;;; a run and a tick, so it costs the run nothing, and a film that cannot be saved is not lost.

(defstruct (recording (:copier nil))
  "The film that a session records: the ticks of SIMULATION from START on. ROBOT is the name of the
robot that the prompt commanded. OPTIONS are options of SAVE-ANIMATION. JOURNAL is the journal up to
the end of the film while the film is being saved, else NIL."
  (simulation nil)
  (start 0 :type unsigned-byte)
  (robot nil :type symbol :read-only t)
  (options '() :type list :read-only t)
  (journal nil :type (or null journal)))

(defun recording-film-p (session)
  "True if SESSION records a film that it is not saving at present."
  (let ((recording (session-recording session)))
    (and recording (null (recording-journal recording)))))

(defun recording-text (session &optional (shown *simulation*))
  "Return a text about the film that SESSION records or saves, or NIL if there is none. The text
names the run of the film unless it is the run SHOWN."
  (let ((recording (session-recording session)))
    (when recording
      (let ((simulation (recording-simulation recording)) (journal (recording-journal recording)))
        (format nil "~:[recording~;saving~] a film~@[ of ~A~] ~:[since~;from~] tick ~D~@[ to ~D~]"
                journal
                (and (not (eq simulation shown)) (run-description simulation))
                journal
                (recording-start recording)
                (and journal (journal-end journal)))))))

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

(defun stop-recording (recording)
  "Let the film of RECORDING end at the present tick, if it is not stopped yet. Return its last
tick. Signals BAD-LINE if there is no film."
  (journal-end (or (recording-journal recording)
                   (setf (recording-journal recording) (recorded-journal recording)))))

(defun film-text-for-user (start end path)
  (format nil "Film of tick~P ~D~@[ to ~D~]: ~A~%Open this file in a web browser to play the film."
          (1+ (- end start)) start (and (/= end start) end) (native-name path)))

(defun save-recording (recording file hook)
  "Save the film of RECORDING, which is stopped, in FILE. Call HOOK with ticks to report progress.
Return a text that says where the film is."
  (let* ((journal (recording-journal recording))
         (start (recording-start recording)) (end (journal-end journal))
         (path (path-of-name (or file (unused-film-name recording end)))) (*frame-hook* hook))
    (film-text-for-user start end (apply #'save-animation journal path
                                         :from start :until end
                                         ;; A remark in the title says so if definitions have
                                         ;; changed since.
                                         :anyway t
                                         (recording-options recording)))))

(defun end-recording (session &optional file (hook (constantly nil)))
  "Save the film that SESSION records in FILE or a new file. Return a text that says where it is.
SESSION continues to record if the film cannot be saved. Call HOOK with ticks to report progress."
  (let ((recording (session-recording session)))
    (stop-recording recording)
    (unwind-protect (prog1 (save-recording recording file hook)
                      (setf (session-recording session) nil))
      ;; A session that has ended meanwhile does not continue to record: it saves this film.
      (unless (session-over-p session) (setf (recording-journal recording) nil)))))

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
