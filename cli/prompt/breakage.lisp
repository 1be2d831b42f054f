;;;; breakage.lisp -- a program that has broken, what it offers, and what is said of it.

(in-package :ars-magna.cli)

(defstruct (breakage (:constructor make-breakage (condition restarts thread sessions))
                     (:copier nil))
  "A program that has broken and waits in THREAD, until the user of one of SESSIONS says how to go
on. ORDER is what it is to do next, a function."
  (condition nil :type condition :read-only t)
  (restarts '() :type list :read-only t)
  (thread nil :read-only t)
  (sessions '() :type list)
  (order nil :type (or null function))
  ;; How to go on has been shown.
  (told-p nil :type boolean)
  (ordered (make-semaphore "order") :read-only t)
  (done (make-semaphore "order done") :read-only t))

(defvar *session* nil "The session that the debugger asks, in whatever thread; the newest.")

(defvar *asking-p* nil "True in a thread that has broken and asks how to go on.")

(defun restarts-within (condition)
  "Return the restarts for CONDITION up to the one that ends the line, of each name the innermost."
  (let* ((all (remove nil (compute-restarts condition) :key #'restart-name))
         (last (position 'end-line all :key #'restart-name)))
    (remove-duplicates (subseq all 0 (and last (1+ last))) :test #'string=
                       :key #'restart-name :from-end t)))

(defun rank (restart condition)
  "Return a number for RESTART, a lower one the more likely it is what the user wants."
  (let ((first-names (if (typep condition 'serious-condition)
                         '("ABORT" "RETRY" "STOP-SIMULATOR")
                         '("ANSWER" "CONTINUE"))))
    (or (position (restart-name restart) first-names :test #'string=) (length first-names))))

(defparameter *asking-restarts*
  '("USE-VALUE" "STORE-VALUE" "RETURN-VALUE" "CALL-FORM" "REPLACE-FUNCTION" "SPECIFY-PACKAGE"
    "USE-PACKAGE" "RENAME" "ANSWER")
  "The names of restarts that ask for what they need.")

(defun asks-p (restart)
  (member (restart-name restart) *asking-restarts* :test #'string=))

(defun restarts-to-offer (condition)
  "Return the ways to go on after CONDITION that a user can choose, those first that he may be
expected to."
  (stable-sort (restarts-within condition)
               #'< :key (lambda (restart) (rank restart condition))))

(defun here-p (breakage)
  (eq (breakage-thread breakage) (current-thread)))

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

(defun break-words (condition)
  "Return what CONDITION says: on a line, unless it is that a plan has stopped, with its stack."
  (if (plan-break-p condition)
      (visible (condition-text condition))
      (complaint-text (condition-text condition))))

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
    (write-fresh (fitted (break-text session breakage) console) console)
    (if (console-prompt console)
        (show-prompt console "Break> ")
        (finish-output console))))

(defun tell-waiting (session breakage)
  "Show that BREAKAGE has come while another is being answered."
  (let ((console (session-console session)))
    (write-fresh (fitted (format nil "*BREAK* -> ~A~@[ (in ~A)~]. It waits until the one before is ~
                                      answered.~%"
                                 (break-words (breakage-condition breakage))
                                 (whereabouts session breakage))
                         console)
                 console)
    (restore-prompt console)
    (finish-output console)))

(defun breaks-awaiting (session)
  "Return what waits for the user of SESSION to say how it goes on, what is asked about now first."
  (let ((own (session-debugging session)) (others (session-breaks session)))
    (cond ((null own) others)
          ((breakage-told-p own) (cons own others))
          (t (append others (list own))))))

(defun break-line (session breakage)
  "Return on one line what has broken and where, if not in the thread of SESSION."
  (let ((words (break-words (breakage-condition breakage))))
    (format nil "~A~@[ (in ~A)~]" (subseq words 0 (position #\Newline words))
            (whereabouts session breakage))))

(defun awaited-answers (session)
  "Return a list of what waits for the user of SESSION to say how it goes on, in words, what is
asked about now first. Any thread may ask."
  (mapcar (lambda (breakage) (break-line session breakage)) (breaks-awaiting session)))

(defun ways-awaited (session)
  "Return in words the ways to go on that the user of SESSION can choose from now, or NIL if he is
not asked. Any thread may ask."
  (let ((breakage (first (breaks-awaiting session))))
    (and breakage
         (format nil "~{~A~^, ~}"
                 (loop for restart in (breakage-restarts breakage)
                       for number from 0
                       collect (format nil "~D ~A" number (plain-name (restart-name restart))))))))

(defun simulator-broken-p (session)
  "True if the user of SESSION is asked how the simulator's thread goes on. Any thread may ask."
  (some (lambda (breakage) (simulator-p session (breakage-thread breakage)))
        (breaks-awaiting session)))

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
