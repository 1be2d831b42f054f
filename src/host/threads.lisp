;;;; threads.lisp -- threads, locks and atomic operations. The only file that uses bordeaux-threads.

(in-package :ars-magna.host)

(export '(atomic-count swap-if memory-barrier make-lock with-lock call-if-free make-semaphore
          wait-on-semaphore wait-a-while wait-patiently call-when-free *leaving-p*
          call-when-leaving start-thread own-thread-p join-thread interrupt-thread current-thread
          users-thread-p yield-thread spread-specials call-telling-names bound-elsewhere-text
          run-elsewhere-text))

;;; A PLACE here is a structure's slot, by its accessor, the CAR or CDR of a cons, or a symbol's
;;; value.

(deftype atomic-count ()
  "The type of a structure's slot for ATOMIC-INCF and ATOMIC-DECF."
  'sb-ext:word)

(defmacro swap-if (place old new)
  "Atomically set PLACE to NEW if it is EQ to OLD. True if it was."
  (with-gensyms (before)
    `(let ((,before ,old))
       (eq ,before (compare-and-swap ,place ,before ,new)))))

(defmacro memory-barrier ()
  "Order memory accesses: what this thread wrote before is visible before it reads or writes more."
  '(sb-thread:barrier (:memory)))

;;;; Threads and locks

;;; No thread is killed. Threads are asked to end, and then joined. One in users' code that does not
;;; return may be interrupted, when the user asks for it.

(defun make-lock (name)
  "Return a new lock called NAME."
  (bordeaux-threads:make-lock name))

(defmacro with-lock ((lock) &body body)
  "Run BODY while holding LOCK."
  `(bordeaux-threads:with-lock-held (,lock) ,@body))

(defun call-if-free (lock function)
  "Call FUNCTION while holding LOCK and return its value and true; NIL and false if another thread
holds LOCK."
  (sb-thread:with-mutex (lock :wait-p nil)
    (return-from call-if-free (values (funcall function) t)))
  (values nil nil))

(defun make-semaphore (name)
  "Return a new semaphore called NAME with a count of 0."
  (bordeaux-threads:make-semaphore :name name))

(defun wait-on-semaphore (semaphore &optional seconds)
  "Decrement SEMAPHORE; true if that succeeded within SECONDS (NIL: no limit)."
  (with-interruptible-wait
    (if seconds
        ;; SBCL accepts no timeout of 0.
        (bordeaux-threads:wait-on-semaphore semaphore :timeout (max seconds 1d-6))
        (bordeaux-threads:wait-on-semaphore semaphore))))

(defun wait-a-while (semaphore seconds)
  "Wait on SEMAPHORE for at most SECONDS, within a loop of such waits; true if that succeeded."
  (yield-foreground)
  (serve-while-waiting *front-end*)
  (wait-on-semaphore semaphore seconds))

(defun wait-patiently (semaphore seconds)
  "Wait on SEMAPHORE for SECONDS in all, by repeated WAIT-A-WHILE; true if that succeeded. Time
spent serving other threads does not count."
  (loop for left = seconds then (- left 0.2)
        thereis (wait-a-while semaphore (min left 0.2))
        while (< 0.2 left)))

(defun call-when-free (lock function)
  "Call FUNCTION while holding LOCK, when no other thread holds it, and return its values. Meanwhile
this thread serves others and allows interrupts."
  (loop
    (sb-thread:with-mutex (lock :timeout 0.2)
      (return-from call-when-free (funcall function)))
    (allowing-interrupts (serve-while-waiting *front-end*))))

(defvar *own-thread-p* nil "True in threads that START-THREAD has started.")

(defun own-thread-p ()
  "True if this thread is one of ours, not a REPL or another thread of a user."
  *own-thread-p*)

(defun users-thread-p ()
  "True if a program has started this thread: it is neither ours nor Lisp's initial thread."
  (not (or (own-thread-p) (sb-thread:main-thread-p))))

(defun start-thread (function name)
  "Call FUNCTION in a new thread called NAME; return the thread."
  (bordeaux-threads:make-thread (lambda () (let ((*own-thread-p* t)) (funcall function)))
                                :name name))

;; SBCL ends all threads when it exits.
(defvar *leaving-p* nil "True while this Lisp exits.")

(defun note-leaving ()
  (setf *leaving-p* t))

(defun call-when-leaving (name)
  "Let the function NAME be called when this Lisp exits, before its threads end."
  (pushnew name sb-ext:*exit-hooks*))

(call-when-leaving 'note-leaving)

;; At exit, what Lisp compiles in our threads, as for generic functions, can be lost.
(defun report-unit-end (function left-p)
  "Let FUNCTION report that a unit ended, aborted if LEFT-P, unless it was because this Lisp exits."
  (unless (and left-p *leaving-p* (own-thread-p))
    (funcall function left-p)))

(wrap-unit-summaries #'report-unit-end)

(defun join-thread (thread)
  "Wait until THREAD has ended, normally or not. Return nothing."
  ;; This is an error if the thread was aborted, as from the debugger.
  (ignore-errors (bordeaux-threads:join-thread thread))
  (values))

(defun interrupt-thread (thread function)
  "Have THREAD call FUNCTION, without arguments, as soon as its interrupts are allowed. Return
nothing."
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

(defun spread-specials (function &rest symbols)
  "Return a function that calls FUNCTION with the current values of SYMBOLS. Threads start with
global values; this passes dynamic ones on."
  (let ((values (mapcar #'symbol-value symbols)))
    (lambda (&rest arguments)
      (progv symbols values (apply function arguments)))))

;;;; Names that other threads have bound to their own robots

;;; WITH-SIMULATION binds robots' names for the thread of its body only. In another thread the same
;;; name is the top level's robot, which may surprise its user. Code that gets a request for that
;;; robot can explain why.

(defvar *bound-names* (list '())
  "A list whose element is a list (thread number name...) for each WITH-SIMULATION in progress.")

(defvar *bindings-made* (list 0) "A list of one count: how often names have been bound so.")

(defun call-telling-names (names function)
  "Call FUNCTION with NAMES bound to robots for this thread only, recorded for other threads. Return
its values."
  (let ((entry (list* (current-thread) (incf (car *bindings-made*)) names)))
    (in-any-case
      (progn (atomic-push entry (car *bound-names*))
             (funcall function))
      (loop for entries = (car *bound-names*)
            until (swap-if (car *bound-names*) entries (remove entry entries :test #'eq))))))

(defun run-elsewhere-text ()
  "Return in words how code in this thread gets at the run of another thread, or NIL if none has
one."
  (let ((entry (find (current-thread) (car *bound-names*) :key #'first :test-not #'eq)))
    (and entry
         (format nil "That of (with-simulation (~(~{~A~^ ~}~)) ...), in ~A, is there only. Hand it ~
                      over in a variable: (let ((simulation (current-simulation))) (make-thread ~
                      (lambda () ... simulation)))."
                 (cddr entry) (thread-name (first entry))))))

(defun bound-elsewhere-text (name)
  "Return in words how code in this thread gets at the robot that another thread has bound NAME to,
and a number for that binding; NIL if there is none, or this thread has bound NAME too."
  (let ((entries (remove-if-not (lambda (entry) (member name (cddr entry) :test #'eq))
                                (car *bound-names*)))
        (word (string-downcase name)))
    (unless (or (null entries) (find (current-thread) entries :key #'first))
      (values (format nil "In this thread, ~A, ~A is the robot of the top level. That of ~
                           (with-simulation (~A) ...), in ~A, is bound there only. Hand it over in ~
                           a variable: (let ((robot ~A)) (make-thread (lambda () ... robot)))."
                      (thread-name (current-thread)) word word
                      (thread-name (first (first entries))) word)
              (second (first entries))))))
