;;;; threads.lisp -- threads, locks and atomic changes: the one door to bordeaux-threads.

(in-package :ars-magna.host)

(export '(atomic-count swap-if memory-barrier make-lock with-lock call-if-free make-semaphore
          wait-on-semaphore wait-a-while wait-patiently call-when-free *leaving-p*
          call-when-leaving start-thread own-thread-p join-thread interrupt-thread current-thread
          users-thread-p yield-thread spread-specials call-telling-names bound-elsewhere-text
          run-elsewhere-text))

;;; A PLACE here is the slot of a structure, by its accessor, the CAR or CDR of a cons, or the value
;;; of a symbol.

(deftype atomic-count ()
  "The type of a structure's slot that ATOMIC-INCF and ATOMIC-DECF can change."
  'sb-ext:word)

(defmacro swap-if (place old new)
  "Set PLACE to NEW if it is OLD, the same object. True if it was."
  (with-gensyms (before)
    `(let ((,before ,old))
       (eq ,before (compare-and-swap ,place ,before ,new)))))

(defmacro memory-barrier ()
  "Let other threads see what this one has written so far before it reads or writes any more."
  '(sb-thread:barrier (:memory)))

;;;; Threads and locks

;;; No thread is killed: threads are asked to end, and then joined. One that is in users' code which
;;; does not return may be interrupted, at the user's word.

(defun make-lock (name)
  "Return a new lock called NAME."
  (bordeaux-threads:make-lock name))

(defmacro with-lock ((lock) &body body)
  "Run BODY while holding LOCK."
  `(bordeaux-threads:with-lock-held (,lock) ,@body))

(defun call-if-free (lock function)
  "Call FUNCTION while holding LOCK, and return its value and true; NIL and false if another thread
holds that."
  (sb-thread:with-mutex (lock :wait-p nil)
    (return-from call-if-free (values (funcall function) t)))
  (values nil nil))

(defun make-semaphore (name)
  "Return a new semaphore called NAME with a count of 0."
  (bordeaux-threads:make-semaphore :name name))

(defun wait-on-semaphore (semaphore &optional seconds)
  "Take one from SEMAPHORE; true if that succeeded within SECONDS (NIL: however long)."
  (waiting
    (if seconds
        ;; SBCL takes no 0 for a time.
        (bordeaux-threads:wait-on-semaphore semaphore :timeout (max seconds 1d-6))
        (bordeaux-threads:wait-on-semaphore semaphore))))

(defun wait-a-while (semaphore seconds)
  "Wait on SEMAPHORE for SECONDS at most, as one of many times; true if that succeeded."
  (yield-foreground)
  (serve-while-waiting *front-end*)
  (wait-on-semaphore semaphore seconds))

(defun wait-patiently (semaphore seconds)
  "Wait on SEMAPHORE for SECONDS in all, again and again as WAIT-A-WHILE does; true if that
succeeded. What others need this thread for meanwhile does not count."
  (loop for left = seconds then (- left 0.2)
        thereis (wait-a-while semaphore (min left 0.2))
        while (< 0.2 left)))

(defun call-when-free (lock function)
  "Call FUNCTION while holding LOCK, when no other thread holds that, and return its values. What
others need this thread for meanwhile is done, and what interrupts this thread is let in."
  (loop
    (sb-thread:with-mutex (lock :timeout 0.2)
      (return-from call-when-free (funcall function)))
    (allowing-interrupts (serve-while-waiting *front-end*))))

(defvar *own-thread-p* nil "True in threads that START-THREAD has started.")

(defun own-thread-p ()
  "True if this thread is one of ours, not a REPL or another one of a user's."
  *own-thread-p*)

(defun users-thread-p ()
  "True if this thread is one that a program has started: not ours, nor the one that this Lisp began
with."
  (not (or (own-thread-p) (sb-thread:main-thread-p))))

(defun start-thread (function name)
  "Call FUNCTION in a new thread called NAME; return the thread."
  (bordeaux-threads:make-thread (lambda () (let ((*own-thread-p* t)) (funcall function)))
                                :name name))

;; SBCL ends all threads when it is left.
(defvar *leaving-p* nil "True when this Lisp is being left.")

(defun note-leaving ()
  (setf *leaving-p* t))

(defun call-when-leaving (name)
  "Let the function called NAME be called when this Lisp is left, before its threads end."
  (pushnew name sb-ext:*exit-hooks*))

(call-when-leaving 'note-leaving)

;; What Lisp compiles in a thread of ours, as for generic functions, is no loss then.
(defun tell-of-unit (function left-p)
  "Let FUNCTION tell of the end of a compilation unit, LEFT-P before its end, unless that is so
since this Lisp is being left."
  (unless (and left-p *leaving-p* (own-thread-p))
    (funcall function left-p)))

(wrap-unit-summaries #'tell-of-unit)

(defun join-thread (thread)
  "Wait until THREAD has ended, in whatever way. Return nothing."
  ;; One that was aborted, as from the debugger, makes this an error.
  (ignore-errors (bordeaux-threads:join-thread thread))
  (values))

(defun interrupt-thread (thread function)
  "Have THREAD call FUNCTION, with no arguments, as soon as it lets that happen. Return nothing."
  ;; One that has ended makes this an error.
  (ignore-errors (bordeaux-threads:interrupt-thread thread function))
  (values))

(declaim (inline current-thread))
(defun current-thread ()
  "Return the thread that asks."
  sb-thread:*current-thread*)

(defun yield-thread ()
  "Let other threads run for a moment."
  (bordeaux-threads:thread-yield))

(defun spread-specials (function &rest symbols)
  "Return a function that calls FUNCTION with the values that SYMBOLS have here and now.
Threads start with global values; this carries the dynamic ones over."
  (let ((values (mapcar #'symbol-value symbols)))
    (lambda (&rest arguments)
      (progv symbols values (apply function arguments)))))

;;;; Names that code of other threads has bound to robots of its own

;;; WITH-SIMULATION binds robots' names, and only the thread of its body sees that. Another thread
;;; finds the robot of the top level under such a name, perhaps without knowing. Who notices that
;;; something is asked of that one can tell why.

(defvar *bound-names* (list '())
  "A list whose element is a list (thread number name...) for each WITH-SIMULATION under way.")

(defvar *bindings-made* (list 0) "A list of how often names have been bound so.")

(defun call-telling-names (names function)
  "Call FUNCTION, in whose extent NAMES are bound to robots for this thread only, and let others
know. Return its values."
  (let ((entry (list* (current-thread) (incf (car *bindings-made*)) names)))
    (in-any-case
      (progn (atomic-push entry (car *bound-names*))
             (funcall function))
      (loop for entries = (car *bound-names*)
            until (swap-if (car *bound-names*) entries (remove entry entries :test #'eq))))))

(defun bound-elsewhere (name)
  "Return the thread that has bound NAME last, and a number for when, if it is not this one, and
this one has not bound NAME itself; or NIL."
  (let ((entries (remove-if-not (lambda (entry) (member name (cddr entry) :test #'eq))
                                (car *bound-names*))))
    (if (find (current-thread) entries :key #'first)
        nil
        (values (first (first entries)) (second (first entries))))))

(defun run-elsewhere-text ()
  "Return in words how code here gets at the run of another thread, or NIL if none has one."
  (let ((entry (find (current-thread) (car *bound-names*) :key #'first :test-not #'eq)))
    (and entry
         (format nil "That of (with-simulation (~(~{~A~^ ~}~)) ...), in ~A, is there only. Hand it ~
                      over in a variable: (let ((simulation (current-simulation))) (make-thread ~
                      (lambda () ... simulation)))."
                 (cddr entry) (thread-name (first entry))))))

(defun bound-elsewhere-text (name)
  "Return in words how code here gets at the robot that another thread has bound NAME to, or NIL if
none has; and a number for that binding."
  (multiple-value-bind (thread number) (bound-elsewhere name)
    (values (and thread
                 (let ((name (string-downcase name)))
                   (format nil "In this thread, ~A, ~A is the robot of the top level. That of ~
                                (with-simulation (~A) ...), in ~A, is bound there only. Hand it ~
                                over in a variable: (let ((robot ~A)) (make-thread (lambda () ~
                                ... robot)))."
                           (thread-name (current-thread)) name name (thread-name thread) name)))
            number)))
