;;;; own-lines.lisp -- ALIAS, EVAL, ECHO, REPEAT and QUIT: lines about lines.

(in-package :ars-magna.cli)

(defun alias-cycle (name text)
  "Return the cycle of aliases that arises if NAME becomes an alias of TEXT: a list that begins and
ends with NAME. Return NIL if there is no cycle."
  (loop with aliases = (acons name (list text) *aliases*)
        for word = name then (split-first-word (second alias))
        for alias = (assoc word aliases :test #'string-equal)
        while alias
        collect (first alias) into names
        when (and (rest names) (string= name (first alias))) return names
        when (< (length aliases) (length names)) return nil))

(defun define-alias (name text)
  "Make NAME an alias of TEXT. Signals BAD-LINE if NAME is a command, if TEXT does not begin with a
command, or if aliases would form a cycle."
  (let ((circle (alias-cycle name text)) (expansion (expand-alias text)))
    (cond ((find name (all-line-command-names) :test #'string=)
           (reject-line "~A is a command already; choose another name for the alias." name))
          (circle
           (reject-line "The alias ~A would stand for itself: ~{~A~^ = ~}. Give a command after ~
                         its name."
                        name circle))
          ((not (lisp-p expansion)) (find-line-command (values (split-first-word expansion))))))
  (setf *aliases* (cons (list name text) (remove name *aliases* :key #'first :test #'string=))))

(define-line "ALIAS" (session (alias :token "a name" :optional)
                              (cmd :line "a command, with arguments if you like" :optional))
    (:general)
    "List the aliases, or make ALIAS an alias of CMD."
  (let ((name (and alias (string-upcase alias))))
    (cond ((and (null name) (null *aliases*))
           (format t "No aliases. ALIAS name command defines an alias.~%"))
          ((null name)
           (format t "~:{~A = ~A~%~}" (sort (copy-list *aliases*) #'string< :key #'first)))
          (cmd (define-alias name cmd))
          (t (let ((known (assoc name *aliases* :test #'string=)))
               (unless known (reject-line "There is no alias ~A. ALIAS lists all." name))
               (format t "~{~A = ~A~}~%" known))))))

(define-line "EVAL" (session (exp :form "a Lisp form"))
    (:general)
    "Evaluate EXP as Lisp and print its values. A line that begins with ( is evaluated, too."
  (let ((*asker* (asker-for (session-account session)))) (evaluate-text session exp)))

(defun parse-switch (name word)
  "True if WORD is ON, NIL if WORD is OFF. Otherwise signals BAD-LINE about the line NAME."
  (cond ((string-equal word "on") t)
        ((string-equal word "off") nil)
        (t (reject-line "~A takes ON or OFF, not ~A." name word))))

(define-line "ECHO" (session (setting :switch "on or off" :optional))
    (:general)
    "Show messages from commands issued by plans and programs, too; with OFF, only messages from
your own commands. Without SETTING, tell whether ECHO is on."
  (when setting (setf (session-quiet-p session) (not (parse-switch "ECHO" setting))))
  (format t "Messages from commands of plans and programs are ~:[~;not ~]shown.~%"
          (session-quiet-p session)))

(defun check-not-waiting-for-resume (session cmd jobs inbox)
  "Signal BAD-LINE if a command from the line CMD of SESSION waits for RESUME. Commands from CMD are
JOBS and the waiting requests that are not in the list INBOX."
  (when (and (waits-for-resume-p session)
             (or (notevery #'job-over-p jobs)
                 (some #'issued-outside-plans-p (set-difference (waiting-requests) inbox))))
    (reject-line "Time stands still: ~A runs once, after RESUME, and is not repeated." cmd)))

(defun await-repeated-line (session cmd jobs inbox)
  "Wait until the commands of the line CMD have ended: JOBS of SESSION, and commands issued by Lisp.
Signals BAD-LINE if the line waits for RESUME. INBOX lists the requests that waited before CMD."
  (check-not-waiting-for-resume session cmd jobs inbox)
  (await-jobs session jobs)
  ;; For what Lisp has issued, too.
  (unless (waits-for-resume-p session)
    (await-requests (lambda (request) (lisp-asker-p (request-asker request)))))
  (check-not-waiting-for-resume session cmd jobs inbox))

(defun run-repeated-line (session cmd)
  "Run the line CMD, and wait for the commands that the line issues, unless SESSION is in a trial."
  (let ((before (session-jobs session)) (inbox (waiting-requests)))
    (run-typed-line session cmd)
    (unless (session-trial session)
      (await-repeated-line session cmd
                           (remove-if (lambda (job) (member job before))
                                      (session-jobs session))
                           inbox))))

;; As reading 204 says.
(define-line "REPEAT" (session (num count "how often") (cmd :line "a command, with its arguments"))
    (:general)
    "Run the command CMD NUM times, each time after the previous run has completed. In a trial,
commands do not wait for each other."
  (loop repeat num
        until (session-over-p session)
        do (run-repeated-line session cmd)))

(define-line "QUIT" (session)
    (:general)
    "Leave the prompt. If the prompt was called from Lisp, the simulator continues."
  (setf (session-over-p session) t))
