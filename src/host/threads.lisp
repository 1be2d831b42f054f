;;;; threads.lisp -- threads, locks and atomic operations. The only file that uses bordeaux-threads.

(in-package :ars-magna.host)

(export '(atomic-count swap-if-eq memory-barrier make-lock with-lock call-if-free make-semaphore
          wait-on-semaphore serve-and-wait-once wait-while-serving call-when-free *exiting-p*
          call-at-exit start-thread own-thread-p join-thread interrupt-thread current-thread
          users-thread-p yield-thread function-with-specials call-recording-robot-names
          other-thread-robot-text other-thread-run-text))

;;; A PLACE here is a structure's slot, by its accessor, a CAR or CDR, or a symbol's value.

(deftype atomic-count ()
  "The type of structure slots that ATOMIC-INCF and ATOMIC-DECF can change."
  'sb-ext:word)

(defmacro swap-if-eq (place old new)
  "Atomically set PLACE to NEW if the value of PLACE is EQ to OLD. Return true if PLACE was set."
  (with-gensyms (before)
    `(let ((,before ,old))
       (eq ,before (compare-and-swap ,place ,before ,new)))))

(defmacro memory-barrier ()
  "Order memory accesses: other threads see this thread's earlier writes before its later accesses."
  '(sb-thread:barrier (:memory)))

;;;; Threads and locks

;;; No thread is killed. Threads are asked to end, and then joined. One in users' code that does not
;;; return may be interrupted, when the user asks for it.

(defun make-lock (name)
  "Return a new lock named NAME."
  (bordeaux-threads:make-lock name))

(defmacro with-lock ((lock) &body body)
  "Run BODY while holding LOCK."
  `(bordeaux-threads:with-lock-held (,lock) ,@body))

(defun call-if-free (lock function)
  "Call FUNCTION holding LOCK, and return its value and true; NIL if another thread holds LOCK."
  (sb-thread:with-mutex (lock :wait-p nil)
    (return-from call-if-free (values (funcall function) t)))
  (values nil nil))

(defun make-semaphore (name)
  "Return a new semaphore named NAME with a count of 0."
  (bordeaux-threads:make-semaphore :name name))

(defun wait-on-semaphore (semaphore &optional seconds)
  "Wait at most SECONDS (NIL: no limit) to decrement SEMAPHORE. Return true if it was decremented."
  (with-interruptible-wait
    (if seconds
        ;; SBCL accepts no timeout of 0.
        (bordeaux-threads:wait-on-semaphore semaphore :timeout (max seconds 1d-6))
        (bordeaux-threads:wait-on-semaphore semaphore))))

(defun serve-and-wait-once (semaphore seconds)
  "Wait on SEMAPHORE for at most SECONDS, but first serve the front end and other threads that need
the terminal. Return true if SEMAPHORE was decremented. Call this function in a loop."
  (yield-foreground)
  (serve-while-waiting *front-end*)
  (wait-on-semaphore semaphore seconds))

(defun wait-while-serving (semaphore seconds)
  "Wait on SEMAPHORE for SECONDS in all, in short waits. Between them, this thread serves others.
The time for serving others does not count. Return true if SEMAPHORE was decremented."
  (loop for left = seconds then (- left 0.2)
        thereis (serve-and-wait-once semaphore (min left 0.2))
        while (< 0.2 left)))

(defun call-when-free (lock function &optional (serve (constantly nil)) (seconds 0.2))
  "Wait until no other thread holds LOCK. Then call FUNCTION while holding LOCK, and return its
values. While this thread waits, it serves the front end and allows interrupts, and each SECONDS it
calls the function SERVE."
  (loop
    (sb-thread:with-mutex (lock :timeout seconds)
      (return-from call-when-free (funcall function)))
    (funcall serve)
    (allowing-interrupts (serve-while-waiting *front-end*))))

(defvar *own-thread-p* nil "True in threads that START-THREAD has started.")

(defun own-thread-p ()
  "True if the simulator has started this thread: neither a REPL nor another thread of a user."
  *own-thread-p*)

(defun users-thread-p ()
  "True if a user's program started this thread: neither the simulator's nor Lisp's initial thread."
  (not (or (own-thread-p) (sb-thread:main-thread-p))))

(defun start-thread (function name)
  "Call FUNCTION in a new thread named NAME, and return the thread."
  (bordeaux-threads:make-thread (lambda () (let ((*own-thread-p* t)) (funcall function)))
                                :name name))

;; SBCL ends all threads when it exits.
(defvar *exiting-p* nil "True while this Lisp exits.")

(defun note-exiting ()
  (setf *exiting-p* t))

(defun call-at-exit (name)
  "Register the function NAME to be called when this Lisp exits, before its threads end."
  (pushnew name sb-ext:*exit-hooks*))

(call-at-exit 'note-exiting)

;; At exit, what Lisp compiles in our threads, as for generic functions, can be lost.
(defun report-unit-end (function aborted-p)
  "Call FUNCTION to report that a compilation unit has ended. ABORTED-P is true if it was aborted.
Report nothing if it was aborted because this Lisp exits."
  (unless (and aborted-p *exiting-p* (own-thread-p))
    (funcall function aborted-p)))

(wrap-unit-summaries #'report-unit-end)

(defun join-thread (thread)
  "Wait until THREAD has ended, normally or not. Return nothing."
  ;; This is an error if the thread was aborted, as from the debugger.
  (ignore-errors (bordeaux-threads:join-thread thread))
  (values))

(defun interrupt-thread (thread function)
  "Make THREAD call FUNCTION, without arguments, once THREAD allows interrupts. Return nothing."
  ;; This is an error if the thread has ended.
  (ignore-errors (bordeaux-threads:interrupt-thread thread function))
  (values))

(declaim (inline current-thread))
(defun current-thread ()
  "Return the current thread."
  sb-thread:*current-thread*)

(defun yield-thread ()
  "Let other threads run for a moment."
  (bordeaux-threads:thread-yield))

(defun function-with-specials (function &rest symbols)
  "Return a function that calls FUNCTION with the current values of the variables SYMBOLS. New
threads start with global values; such a function gives them the values bound in this thread."
  (let ((values (mapcar #'symbol-value symbols)))
    (lambda (&rest arguments)
      (progv symbols values (apply function arguments)))))

;;;; Names that other threads have bound to their own robots

;;; WITH-SIMULATION binds robots' names for the thread of its body only. Elsewhere the name is the
;;; top level's robot, which may surprise users. Code that gets a request for it can explain why.

(defvar *bound-robot-names* (list '())
  "A list of one list, with (thread number name...) for each WITH-SIMULATION in progress.")

(defvar *robot-binding-count* (list 0)
  "A list of one integer: how many times CALL-RECORDING-ROBOT-NAMES has bound names.")

(defun call-recording-robot-names (names function)
  "Call FUNCTION, in which this thread has bound NAMES to robots, and record the bindings for
messages in other threads. Return the values of FUNCTION."
  (let ((entry (list* (current-thread) (incf (car *robot-binding-count*)) names)))
    (in-any-case
      (progn (atomic-push entry (car *bound-robot-names*))
             (funcall function))
      (loop for entries = (car *bound-robot-names*)
            until (swap-if-eq (car *bound-robot-names*) entries
                              (remove entry entries :test #'eq))))))

(defun other-thread-run-text ()
  "Return a text on how this thread can use another thread's run; NIL if no thread has bound a run."
  (let ((entry (find (current-thread) (car *bound-robot-names*) :key #'first :test-not #'eq)))
    (and entry
         (format nil "The simulation of (with-simulation (~(~{~A~^ ~}~)) ...), in ~A, is known to ~
                      that thread only. Pass it on in a variable, and ask it: (let ((simulation ~
                      (current-simulation))) (make-thread (lambda () (asking (simulation) ...))))."
                 (cddr entry) (thread-name (first entry))))))

(defun other-thread-robot-text (name)
  "If another thread has bound NAME to a robot, and this thread has not, return two values: a text
on how code in this thread can use that robot, and the number of the binding; else NIL."
  (let ((entries (remove-if-not (lambda (entry) (member name (cddr entry) :test #'eq))
                                (car *bound-robot-names*)))
        (word (string-downcase name)))
    (unless (or (null entries) (find (current-thread) entries :key #'first))
      (values (format nil "In this thread (~A), ~A is the robot of the top level. The robot of ~
                           (with-simulation (~A) ...) is bound in ~A only. Pass it on in a ~
                           variable: (let ((robot ~A)) (make-thread (lambda () ... robot)))."
                      (thread-name (current-thread)) word word
                      (thread-name (first (first entries))) word)
              (second (first entries))))))
