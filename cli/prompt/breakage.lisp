;;;; breakage.lisp -- what is said of a program that has broken.

(in-package :ars-magna.cli)

(export '(awaited-answers ways-awaited simulator-broken-p asker-of-break answers-break-p))

(defvar *session* nil "The session that the debugger asks, in whatever thread; the newest.")

(defvar *asking-p* nil "True in a thread that has broken and asks how to go on.")

;;; What the user sees.

(defun whereabouts (session breakage)
  "Return in words where BREAKAGE is, if not in the thread of SESSION."
  (words-for-thread session (breakage-thread breakage)))

(defun words-for-thread (session thread)
  "Return in words what THREAD is, if not that of SESSION."
  (cond ((eq thread (session-thread session)) nil)
        ((simulator-p session thread) "the simulator's thread")
        (t (format nil "another thread, ~A" (thread-name thread)))))

(defun simulator-p (session thread)
  "True if THREAD passes the ticks of the run that SESSION listens to."
  (let ((simulation (session-simulation session)))
    (and simulation (eq thread (simulation-thread simulation)))))

(defun break-text (session breakage)
  (format nil "*BREAK* -> ~A~@[ (in ~A)~]~%~:{  ~2D  ~16A ~A~%~}~
               A number chooses. BACKTRACE, PLAN-TREE tell where it is; (...) is Lisp.~%"
          (break-words (breakage-condition breakage))
          (whereabouts session breakage)
          (loop for restart in (breakage-restarts breakage)
                for number from 0
                collect (list number (plain-name (restart-name restart))
                              (complaint-text (own-text restart))))))

(defun tell-break (session breakage)
  "Show what has happened, and let the prompt that stands be the debugger's."
  (let ((console (session-console session)))
    (setf (breakage-told-p breakage) t)
    (write-fitted console "~A" (break-text session breakage))
    (if (console-prompt console)
        (show-prompt console "Break> ")
        (finish-output console))))

(defun tell-waiting (session breakage)
  (let ((console (session-console session)))
    (write-fitted console
                  "*BREAK* -> ~A~@[ (in ~A)~]. It waits until the one before is answered.~%"
                  (break-words (breakage-condition breakage))
                  (whereabouts session breakage))
    (restore-prompt console)))

(defun break-line (session breakage)
  "Return on one line what has broken and where, if not in the thread of SESSION."
  (let ((words (break-words (breakage-condition breakage))))
    (format nil "~A~@[ (in ~A)~]" (subseq words 0 (position #\Newline words))
            (whereabouts session breakage))))

(defun awaited-answers (session)
  "Return a list of what waits for the user of SESSION to say how it goes on, in words, what is
asked about now first. Any thread may ask."
  (mapcar (lambda (breakage) (break-line session breakage))
          (breaks-awaiting (session-break-state session))))

(defun ways-awaited (session)
  "Return in words the ways to go on that the user of SESSION can choose from now, or NIL if he is
not asked. Any thread may ask."
  (let ((breakage (first (breaks-awaiting (session-break-state session)))))
    (and breakage
         (format nil "~{~A~^, ~}"
                 (loop for restart in (breakage-restarts breakage)
                       for number from 0
                       collect (format nil "~D ~A" number (plain-name (restart-name restart))))))))

(defun simulator-broken-p (session)
  "True if the user of SESSION is asked how the simulator's thread goes on. Any thread may ask."
  (some (lambda (breakage) (simulator-p session (breakage-thread breakage)))
        (breaks-awaiting (session-break-state session))))

(defun asker-of-break (simulation)
  "Return in words, to follow others, that another debugger than that of the prompts asks how the
thread of SIMULATION, which has broken, goes on; or NIL."
  (let ((debugger (debugger-asking (simulation-thread simulation))))
    (and debugger
         (notany #'simulator-broken-p (sessions-hearing simulation))
         (format nil "and ~A waits for the answer" debugger))))

(defun answers-break-p (text)
  "True if TEXT, a line, can be typed where a break is answered, whatever has broken."
  (or (comment-p text) (lisp-p text)))
