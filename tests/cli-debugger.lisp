;;;; cli-debugger.lisp -- breaks, with a user at the prompt and without one.

(in-package :ars-magna.tests)

(def-suite* cli-debugger :in ars-magna)

(defun type-at-terminal (&rest lines)
  "Type LINES as a user at a terminal would. Return the output, a list of lines."
  (let* ((output (make-string-output-stream))
         (input (make-instance 'cli::typed-text :by-hand-p t
                               :octets (make-string-input-stream (joined lines))))
         (session (cli:make-session :input input :output output)))
    (run:call-with-simulation (lambda () (cli:run-session session)) '(ars-user::butler) :clean t)
    (cli::release-streams session output) ; other threads may have something to say
    (lines-of (get-output-stream-string output))))

(defun without-prompts (line)
  (if (or (eql 0 (search "Robot> " line)) (eql 0 (search "Break> " line)))
      (without-prompts (subseq line 7))
      line))

(defun written-p (line written)
  "True if LINE begins one of the lines WRITTEN, perhaps after prompts."
  (find-if (lambda (other) (eql 0 (search line (without-prompts other)))) written))

;;; Without a user.

(test break.is-a-message-where-nobody-sits
  (is (equal '("*ERROR* -> Break: oh" "4" "5")
             (type-batch "(progn (break \"oh\") 4)" "(+ 2 3)")))
  (is (equal '("*ERROR* -> Break: no" "5")
             (type-batch "(invoke-debugger (make-condition 'simple-error :format-control \"no\"))"
                         "(+ 2 3)"))))

(test break.on-errors-is-a-message-where-nobody-sits
  (let ((base:*break-on-user-error* t))
    (is (equal '("*ERROR* -> no" "5") (type-batch "(error \"no\")" "(+ 2 3)")))))

(test break.of-another-thread-ends-that-thread
  (is (equal '("*ERROR* -> Break: no" "5")
             (remove "NIL" (type-batch "(ars-magna.base:join-thread (ars-magna.base:start-thread
                                          (lambda () (error \"no\")) \"failing\"))"
                                       "(+ 2 3)")
                     :test #'string=))))

(test hook.is-as-before-afterwards
  (let ((hook (base:debugger-hook)))
    (type-batch "(+ 1 2)")
    (is (eq hook (base:debugger-hook)))))

(test hook.that-threads-share-follows-from-the-prompts-at-work
  "Whichever comes first: that of a window may, and go before the terminal's does."
  (let ((before (base:global-debugger-hook)))
    (cli::add-prompt-hook 'cli::enter-debugger)
    (cli::add-prompt-hook 'cli::enter-debugger)
    (cli::remove-prompt-hook 'cli::enter-debugger)
    (is (eq 'cli::enter-debugger (base:global-debugger-hook)))
    (cli::add-prompt-hook 'cli::debugger-disabled-hook)
    (is (eq 'cli::enter-debugger (base:global-debugger-hook)))
    (cli::remove-prompt-hook 'cli::enter-debugger)
    (is (host:disabled-hook-p (base:global-debugger-hook)))
    (cli::remove-prompt-hook 'cli::debugger-disabled-hook)
    (is (eq before (base:global-debugger-hook)))))

;;; Where somebody does.

(test break.asks-how-to-go-on
  (let ((written (type-at-terminal "(progn (break \"oh\") (+ 2 2))" "nonsense" "(* 6 7)" "0"
                                   "(+ 2 3)")))
    (is-true (written-p "*BREAK* -> oh" written))
    (is-true (find-if (lambda (line) (has-words-p line "0" "continue" "Return from")) written))
    (is-true (find-if (lambda (line) (has-words-p line "nonsense" "one of the restarts")) written))
    (dolist (line '("42" "4" "5"))
      (is-true (written-p line written) "~A is not in ~S" line written))))

(test break.can-end-its-line
  (let ((written (type-at-terminal "(progn (break) (print 77))" "end-line" "(+ 2 3)")))
    (is-false (written-p "77" written))
    (is-true (written-p "5" written))))

(test break.shows-where-it-is
  (is-true (find-if (lambda (line) (has-words-p line "  (break \"oh\")"))
                    (type-at-terminal "(break \"oh\")" "backtrace" "0"))))

(test break.tells-after-an-interrupt-how-to-go-on
  (let ((session (cli:make-session)))
    (with-simple-restart (continue "Go on.")
      (setf (cli::break-state-others (cli::session-break-state session))
            (list (cli::make-break-request (make-condition 'simple-condition :format-control "oh")
                                           (list (find-restart 'continue))
                                           (base:current-thread) (list session))))
      (is (equal " Answer the break by one of 0 continue." (cli::ongoing-work-text session))))))

(test break.can-be-left-with-the-prompt
  (is-false (written-p "5" (type-at-terminal "(break)" "quit" "(+ 2 3)")))
  (is-true (written-p "*BREAK* -> break" (type-at-terminal "(break)"))))

(test errors.of-a-continuation-are-answered-in-its-name
  (let* ((base:*break-on-user-error* t)
         (written (type-at-terminal
                   "(robot-turn butler 1 (lambda (&rest results) (error \"mine ~A\" results)))"
                   "(run-ticks 9)" "abort" "(+ 2 3)")))
    (dolist (line '("*BREAK* -> mine" "Report it and leave the continuation of robot-turn."
                    "Try the continuation of robot-turn again." "5"))
      (is-true (find-if (lambda (written) (search line written)) written)
               "~A is not in ~S" line written))))

(test break.on-a-full-stack-is-a-message
  (let* ((base:*break-on-user-error* t)
         (written (type-at-terminal
                   "(robot-turn butler 1 (lambda (&rest r) (labels ((f (n) (1+ (f n)))) (f r))))"
                   "(run-ticks 9)" "(robot-turn butler 1)" "(run-ticks 9)" "(+ 2 3)")))
    (is-false (find-if (lambda (line) (search "*BREAK*" line)) written))
    (is-true (written-p "*ERROR* -> Error in the continuation of robot-turn" written))
    (is-true (written-p "5" written))))

(test errors.break-only-when-that-is-wanted
  (is-true (written-p "*ERROR* -> no" (type-at-terminal "(error \"no\")")))
  (let* ((base:*break-on-user-error* t)
         (written (type-at-terminal "(error \"no\")" "end" "turn fast" "(+ 2 3)")))
    (is-true (written-p "*BREAK* -> no" written))
    (is-true (written-p "5" written))
    (is (= 1 (count-if (lambda (line) (search "*BREAK*" line)) written))
        "a line that makes no sense is no break")))

;;; What is typed to answer a break.

(test break.in-a-break-is-a-message
  (let ((written (type-at-terminal "(break \"outer\")" "(progn (break \"inner\") 7)"
                                   "(error \"no\")" "(invoke-debugger (make-condition 'error))"
                                   "0" "(+ 2 3)")))
    (dolist (line '("*BREAK* -> outer" "*ERROR* -> Break: inner" "7" "*ERROR* -> no"
                    "*ERROR* -> Break: Condition ERROR" "5"))
      (is-true (written-p line written) "~A is not in ~S" line written))
    (is (= 1 (count-if (lambda (line) (search "*BREAK*" line)) written)))))

(test break.reads-values-and-answers
  (let* ((base:*break-on-user-error* t)
         (written (type-at-terminal "(list (y-or-n-p \"sure?\"))" "y"
                                    "(+ 1 ars-user::no-such-variable)" "use-value" "41" "(+ 2 3)")))
    (dolist (line '("42" "5"))
      (is-true (written-p line written) "~A is not in ~S" line written))
    (is-true (find-if (lambda (line) (search "(T)" line)) written))))

(test break.offers-first-what-is-expected
  (flet ((names (condition)
           (mapcar #'restart-name (cli::restarts-to-offer condition))))
    (restart-case
        (with-simple-restart (retry "Again.")
          (with-simple-restart (abort "Report it.")
            (with-simple-restart (continue "Go on.")
              (restart-case
                  (progn
                    (is (equal '(abort retry)
                               (subseq (names (make-condition 'error)) 0 2)))
                    (is (eq 'continue (first (names (make-condition 'simple-condition)))))
                    (is-true (member 'use-value (names (make-condition 'error)))))
                (use-value (value) value)))))
      (end-line ()))))

;;; In another thread.

(defvar *breaking* nil "The thread of BREAK-ELSEWHERE.")
(defvar *went-on* nil "What that has done.")
(defvar *breaking-said* nil "The queue of its messages.")

(defun break-elsewhere ()
  "Break in another thread, and wait until it asks how to continue."
  (setf *went-on* '()
        *breaking-said* (base:make-message-queue)
        *breaking* (base:start-thread (lambda ()
                                        (let ((base:*message-queue* *breaking-said*))
                                          (push (restart-case (progn (break "there") :went-on)
                                                  (turn-back () :turned-back))
                                                *went-on*)))
                                      "breaking"))
  (loop until (cli::session-other-breaks cli::*session*) do (base:yield-thread)))

(test break.of-another-thread-reads-the-prompts-lines
  (let ((written (type-at-terminal "(ars-magna.tests::break-elsewhere)"
                                   "(push 42 ars-magna.tests::*went-on*)" "turn"
                                   "(ars-magna.base:join-thread ars-magna.tests::*breaking*)"
                                   "(+ 2 3)")))
    (is (equal '(:turned-back 42) *went-on*))
    (is-true (find-if (lambda (line) (has-words-p line "*BREAK* -> there" "another thread"))
                      written))
    (is-true (written-p "5" written))))

(defun want-value-elsewhere ()
  "Break in another thread, with a restart that takes a value, and wait until it asks."
  (setf *went-on* '()
        *breaking* (base:start-thread
                    (lambda ()
                      (push (restart-case (break "there")
                              (use-value (value)
                                :interactive (lambda () (list (eval (read *query-io*))))
                                value))
                            *went-on*))
                    "breaking"))
  (loop until (cli::session-other-breaks cli::*session*) do (base:yield-thread)))

(test break.of-another-thread-takes-a-value
  "It is typed after the choice, or in the next line."
  (flet ((goes-on-with (&rest answer)
           (let ((written (apply #'type-at-terminal "(ars-magna.tests::want-value-elsewhere)"
                                 (append answer '("(+ 2 3)")))))
             (base:join-thread *breaking*)
             (is-true (find-if (lambda (line) (search "5" line)) written))
             *went-on*)))
    (is (equal '(42) (goes-on-with "use-value (* 6 7)")))
    (is (equal '(43) (goes-on-with "use-value" "43")))
    (is (equal '(44) (goes-on-with "(invoke-restart 'use-value 44)")))))

(defun menus-and-waits (written)
  "Return the lines of WRITTEN that report a break, shortened."
  (loop for line in written
        when (search "*BREAK* -> " line)
          collect (list (if (search "there" line) :there :typed)
                        (if (search "waits until" line) :waits :menu))))

(test break.waits-until-those-before-are-answered
  (let ((written (type-at-terminal "(progn (ars-magna.tests::break-elsewhere) (break \"typed\") 7)"
                                   "turn" "0" "(+ 2 3)")))
    (base:join-thread *breaking*)
    (is (equal '(:turned-back) *went-on*))
    ;; Both threads may tell at the same time.
    (is (null (set-exclusive-or '((:there :menu) (:typed :waits) (:typed :menu))
                                (remove '(:there :waits) (menus-and-waits written) :test #'equal)
                                :test #'equal)))
    (is (equal '(:typed :menu) (first (last (menus-and-waits written)))))
    (is-true (written-p "7" written))
    (is-true (written-p "5" written))))

(defun break-twice-elsewhere ()
  "Break in two other threads, one after the other."
  (break-elsewhere)
  (let ((first *breaking*))
    (setf *breaking* (base:start-thread
                      (lambda ()
                        (restart-case (break "there too")
                          (go-back () (base:join-thread first) (push 2 *went-on*))))
                      "breaking, too")))
  (loop until (rest (cli::session-other-breaks cli::*session*)) do (base:yield-thread)))

(test break.of-other-threads-is-answered-in-order
  (let ((written (type-at-terminal "(ars-magna.tests::break-twice-elsewhere)" "go-b" "turn" "go-b"
                                   "(+ 2 3)")))
    (base:join-thread *breaking*)
    (is (equal '(2 :turned-back) *went-on*))
    ;; Both threads may tell at the same time.
    (is (member (menus-and-waits written)
                '(((:there :menu) (:there :waits) (:there :menu))
                  ((:there :waits) (:there :menu) (:there :menu)))
                :test #'equal))
    (is-true (find-if (lambda (line) (search "go-b is not one of the restarts" line)) written))
    (is-true (written-p "5" written))))

(defun break-elsewhere-and-wait ()
  "Break in another thread, and wait until it has continued, as RUN-PLAN waits for a plan."
  (break-elsewhere)
  (loop with never = (base:make-semaphore "never")
        repeat 6000                     ; a minute, which only a hang reaches
        until *went-on*
        do (base:serve-and-wait-once never 0.01)))

(test break.of-another-thread-is-answered-in-a-line-that-waits-for-it
  (let ((written (type-at-terminal "(ars-magna.tests::break-elsewhere-and-wait)" "nonsense" "turn"
                                   "(+ 2 (length ars-magna.tests::*went-on*))")))
    (is (equal '(:turned-back) *went-on*))
    (is-true (written-p "*ERROR* -> nonsense is not one of the restarts" written))
    (is-true (written-p "3" written))))

(test break.in-a-break-of-another-thread-is-a-message
  (let ((written (type-at-terminal "(ars-magna.tests::break-elsewhere)" "(break \"inner\")"
                                   "(error \"no\")" "(invoke-debugger (make-condition 'error))"
                                   "turn"
                                   "(ars-magna.base:join-thread ars-magna.tests::*breaking*)")))
    (dolist (line '("*ERROR* -> Break: inner" "*ERROR* -> no" "*ERROR* -> Break: Condition ERROR"))
      (is-true (written-p line written) "~A is not in ~S" line written))
    (is (equal '(:turned-back) *went-on*))))

(test break.of-another-thread-goes-on-when-the-prompt-is-left
  (type-at-terminal "(ars-magna.tests::break-elsewhere)" "quit")
  (base:join-thread *breaking*)
  (is (equal '(:went-on) *went-on*))
  (is (mentions-p (base:message-text (first (base:take-messages *breaking-said*)))
                  "continue was chosen")))

(test break.that-only-windows-ask-about-is-told-in-lisps-own-repl
  "Who waits there would see nothing else."
  (let ((cli::*own-process-p* nil)
        (window (cli:make-session :place (constantly nil)))
        (request (cli::make-break-request (make-condition 'simple-condition :format-control "look")
                                          '() (base:current-thread) '())))
    (is (mentions-p (cli::repl-break-message (list window) request) "look"))
    (is (null (cli::repl-break-message (list window (cli:make-session)) request)))
    (setf cli::*own-process-p* t)
    (is (null (cli::repl-break-message (list window) request)))))

;;; Whose matter a break is.

(test breaks.wait-for-the-last-prompt-that-can-answer
  (let* ((sessions (loop repeat 2 collect (cli:make-session)))
         (restart (restart-case (first (compute-restarts)) (go-on () nil)))
         (break-request (cli::make-break-request (make-condition 'simple-condition) (list restart)
                                                 (base:current-thread) (copy-list sessions))))
    (dolist (session sessions)
      (setf (cli::break-state-others (cli::session-break-state session)) (list break-request)))
    (cli::continue-orphaned-breaks (first sessions))
    (is (null (cli::break-request-call break-request)) "the other one has not answered yet")
    (cli::continue-orphaned-breaks (second sessions))
    (is-true (cli::break-request-call break-request))))

(test breaks.of-a-users-own-thread-are-for-lisps-debugger
  "Unless this Lisp does nothing but the program of the prompt."
  (flet ((there-p (start)
           (let ((answer '()) (session cli::*session*) (own-p cli::*own-process-p*))
             (setf cli::*session* nil cli::*own-process-p* nil)
             (unwind-protect
                  (base:join-thread (funcall start (lambda ()
                                                     (push (cli::break-ignored-p) answer))))
               (setf cli::*session* session cli::*own-process-p* own-p))
             answer)))
    (is (equal '(t) (there-p (lambda (function) (bordeaux-threads:make-thread function)))))
    (is (equal '(nil) (there-p (lambda (function) (base:start-thread function "ours")))))))

(test threads.wait-for-no-time-at-all
  (let ((semaphore (base:make-semaphore "none")))
    (is (null (base:wait-on-semaphore semaphore 0)))
    (base:signal-semaphore semaphore)
    (is-true (base:wait-on-semaphore semaphore 0))))

;;; Lisp's own debugger, or an editor's.

(test debuggers.keep-slips-that-are-typed-there
  "They come up in the debugger, as in any Lisp, not in the handlers around the break."
  (let ((base:*break-on-user-error* t) (seen '()))
    (labels ((ask (condition hook)
               (declare (ignore hook))
               (push (princ-to-string condition) seen)
               (when (cddr seen) (throw 'slipped nil))
               (base:with-debugger-hook (#'ask) (error "Typed wrongly."))))
      (catch 'slipped
        (handler-case (base:with-debugger-hook (#'ask)
                        (base:call-user-code (lambda () (error "Slipped.")) "a test"))
          (error () (fail "The slip has left the debugger.")))))
    (is (equal '("Typed wrongly." "Typed wrongly." "Slipped.") seen))))

(defun check-gone (outer inner)
  "Let what has broken be asked about by the debuggers' hooks OUTER, SBCL's, and INNER, Common
Lisp's, functions of a semaphore to be signalled then; and hold what becomes of it when who has been
asked goes."
  (let* ((asked (base:make-semaphore "asked")) (queue (base:make-message-queue))
         (thread (base:start-thread
                  (lambda ()
                    (let ((base:*break-on-user-error* t) (base:*message-queue* queue)
                          (*debugger-hook* (and inner (hook-that inner asked))))
                      (base:with-debugger-hook ((hook-that outer asked))
                        (base:call-user-code (lambda () (error "Slipped.")) "a test"))))
                  "breaking")))
    (is-true (base:wait-on-semaphore asked 60))
    (is (equal "the editor's debugger" (base:waiting-debugger-name thread)))
    (base:end-inquiries (constantly t))
    (base:join-thread thread)
    (is (null (base:waiting-debugger-name thread)))
    (let ((texts (mapcar #'base:message-text (base:take-messages queue))))
      (is-true (find-if (lambda (text) (mentions-p text "disconnected; abort was chosen")) texts)
               "~A" texts)
      (is-true (find-if (lambda (text) (mentions-p text "Error in a test: Slipped")) texts)))))

(defun hook-that (function asked)
  (lambda (condition hook)
    (declare (ignore condition hook))
    (funcall function asked)))

(defun ask-for-ever (asked)
  (base:signal-semaphore asked)
  (base:wait-on-semaphore (base:make-semaphore "never")))

(test debuggers.that-go-unanswered-let-programs-go-on
  "An editor's connection is closed while its debugger asks: a warning says what was chosen."
  (check-gone #'ask-for-ever nil))

(test debuggers.may-leave-it-to-the-hook-of-common-lisp
  "SWANK sets both; the function in SBCL's returns if there is another in Common Lisp's."
  (check-gone #'identity #'ask-for-ever))

(test debuggers.of-an-editor-that-has-gone-ask-nobody
  "Its hooks stay: what breaks then is for the prompts that are at work, if there are any."
  (let ((base:*editor-gone-p* (constantly t)) (cli::*prompt-debugger-hooks* '(cli::enter-debugger)))
    (base:with-debugger-hook ((constantly nil))
      (is (eq 'cli::enter-debugger (base:debugger-hook))))
    (base:with-debugger-hook ('cli::debugger-disabled-hook)
      (is (host:disabled-hook-p (base:debugger-hook))))))

(test prompts.begin-in-the-package-of-who-opens-them
  (let ((*package* (find-package :ars-user)))
    (is (eq *package* (cli:package-for-new-prompt))))
  (let ((*package* (find-package :keyword)))
    (is (eq (find-package :ars-user) (cli:package-for-new-prompt)))))
