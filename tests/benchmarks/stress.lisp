;;;; stress.lisp -- ten threads start, stop, rewind, redefine and interrupt live simulators.

;;; ./tests/benchmarks/run stress [SECONDS] takes two minutes by default. It prints counts of
;;; errors; the exit status is 1 if any is not 0. STRESS_SEED is the seed of the threads' choices, 1
;;; by default.

(in-package :ars-magna.benchmarks)

(ars:define-user-package :stress
  (:documentation "The maps and robots that this program defines."))

(defparameter *seconds* (parse-integer (or (uiop:getenv "BENCHMARK_NUMBER") "120"))
  "How long the threads work.")

(defparameter *seed* (parse-integer (or (uiop:getenv "STRESS_SEED") "1")))

(defparameter *threads* 10)

(defparameter *patience* 30 "Seconds after which a thread counts as hung, a robot as silent.")

;;; The worlds.

(defparameter *definitions*
  (let ((*package* (find-package :stress)))
    (mapcar #'read-from-string
            '("(defmap court (9 9) (rect (0 0) (8 8) bricks 1) (obj ball (4.5 4.5) ((size .2))))"
              "(defmap alley (12 5) (rect (0 0) (11 4) glass 5))"
              "(defrobot warden (court (2.5 2.5) 0) :cameras ((3 5)) :hands (10))"
              "(defrobot porter (court (6.5 6.5) 0) :hands (10))"
              "(defrobot courier (alley (2.5 2.5) 0) :hands (10))")))
  "Two maps and three robots.")

;; If a time limit interrupts SBCL 2.5.2 while it compiles, a lock of the C library may stay locked,
;; and thread after thread hangs. This happens without this project, too. So nothing is compiled
;; here.
(defun define-anew (definition)
  "Evaluate DEFINITION, a form of *DEFINITIONS*, without its warnings and without compiling it."
  (handler-bind ((warning #'muffle-warning))
    (let ((sb-ext:*evaluator-mode* :interpret))
      (eval definition))))

;; SBCL's WAIT-ON-SEMAPHORE conses while it allows interrupts. If a time limit interrupts the
;; garbage collection that this causes, SBCL's runtime crashes. This happens without this project,
;; too (2.2.9: within seconds, with four threads and a time limit each millisecond). So garbage is
;; collected seldom here.
(setf (sb-ext:bytes-consed-between-gcs) (floor (sb-ext:dynamic-space-size) 5/2))

(mapc #'define-anew *definitions*)

(defparameter *wait*
  (let ((*package* (find-package :stress))) (nisp:make-plan (read-from-string "(wait-time 1)")))
  "A plan that waits for a tick.")

(defparameter *robots* (mapcar #'second (cddr *definitions*)) "The names of the robots.")

(defun robot-now (name)
  "Return the robot called NAME as the top level knows it."
  (symbol-value name))

(defun resident-worlds ()
  (loop for map in (world:all-maps)
        when (world:map-resident map) collect it))

;;; Counts.

(defvar *counts* '() "Conses of a text and how often that was seen.")
(defvar *counts-lock* (base:make-lock "counts"))
(defvar *examples* '() "The first of what was counted, lists of a text and words.")

(defun note (what &optional (words ""))
  "Count WHAT, a text; WORDS tell of this one."
  (base:with-lock (*counts-lock*)
    (incf (cdr (or (assoc what *counts* :test #'string=)
                   (first (push (cons what 0) *counts*)))))
    (when (< (count what *examples* :key #'first :test #'string=) 8)
      (push (list what (princ-to-string words)) *examples*))))

(defun counted (what)
  (or (cdr (assoc what *counts* :test #'string=)) 0))

;;; What threads do.

(defun start (name)
  (ars:simulator name :rate (if (zerop (random 2)) :free 500) :keep (zerop (random 2))
                      :display nil))

(defun stop (name)
  (if (zerop (random 3))
      (ars:stop-simulator)
      (ars:stop-simulator (robot-now name))))

(defun rewind-some (name)
  (ars:rewind (random 20) (ars:robot-simulation (robot-now name))))

(defun redefine (name)
  (declare (ignore name))
  (define-anew (elt *definitions* (random (length *definitions*)))))

(defun begin-waiting (name)
  "Begin plans that wait for time on the robot called NAME."
  (nisp:rpl-init-robot (robot-now name))
  (loop repeat (1+ (random 5)) do (nisp:begin-plan *wait*)))

(defun turn (name)
  (ars:robot-turn (robot-now name) 0.1d0))

(defun look (name)
  "Count robots that are in their worlds twice. Of worlds, not of the one called NAME."
  (declare (ignore name))
  (dolist (world (resident-worlds))
    (let ((names (mapcar #'robot:robot-name (world:world-robots world))))
      (unless (= (length names) (length (remove-duplicates names)))
        (note "robots twice" names)))))

(defparameter *deeds*
  #(start start start stop stop rewind-some rewind-some redefine begin-waiting begin-waiting
    begin-waiting turn turn look)
  "Functions of a robot's name, the more frequent ones several times.")

(defun act-once ()
  (funcall (aref *deeds* (random (length *deeds*)))
           (elt *robots* (random (length *robots*)))))

(defun act-in-time ()
  "Do one thing, or a part of it: in one of three cases a time limit may come in between."
  (if (zerop (random 3))
      (handler-case (sb-ext:with-timeout (/ (1+ (random 40)) 4000) (act-once))
        (sb-ext:timeout () (note "time limits that came in between")))
      (act-once)))

(defun backtrace-here (count)
  (with-output-to-string (stream) (uiop:print-backtrace :stream stream :count count)))

(defun note-unexpected (trouble)
  "Count TROUBLE, and where it came up, if it is no mistake that the simulator names."
  (unless (typep trouble 'ars:ars-magna-error)
    (note "unexpected errors" (format nil "~A~%~A" trouble (backtrace-here 40)))))

(defun act-safely ()
  "Do one thing. Mistakes that the simulator names are expected, all other errors are counted."
  (handler-case (handler-bind ((error #'note-unexpected)) (act-in-time))
    (ars:ars-magna-error () (note "calls refused"))
    (error ())))

(defun work (number due)
  "Do one thing after another until the time DUE, as thread NUMBER."
  (let ((*random-state* (sb-ext:seed-random-state (+ number (* 100 *seed*)))))
    (loop while (< (get-internal-real-time) due)
          do (note "things done")
             ;; A time limit may come where Lisp looks for the handler of another error.
             (handler-case (act-safely)
               (sb-ext:timeout () (note "time limits that came in between"))))))

;;; What is left.

(defun all-ended-p (threads)
  "Wait for THREADS to end; true if they all have."
  (loop repeat (* 10 *patience*)
        never (notany #'base:thread-alive-p threads)
        do (sleep 0.1)
        finally (return t)))

(defun threads-called (&rest beginnings)
  "Return the threads whose names begin with one of BEGINNINGS."
  (remove-if-not (lambda (thread)
                   (some (lambda (beginning)
                           (eql 0 (search beginning (base:thread-name thread))))
                         beginnings))
                 (sb-thread:list-all-threads)))

(defun none-left-p (&rest beginnings)
  "Wait for the threads whose names begin with one of BEGINNINGS to end. True if they have."
  (loop repeat (* 10 *patience*)
        while (apply #'threads-called beginnings)
        do (sleep 0.1)
        finally (return (null (apply #'threads-called beginnings)))))

(defun place-of (thread)
  "Return where THREAD is, a backtrace, or a few words if it does not say so."
  (let ((text nil) (said (base:make-semaphore "said")))
    (ignore-errors
     (sb-thread:interrupt-thread
      thread
      (lambda ()
        (setf text (backtrace-here 30))
        (base:signal-semaphore said))))
    (if (base:wait-on-semaphore said 3) text "takes no interrupts")))

(defun note-thread (what thread)
  (note what (format nil "~A, at~%~A" thread (place-of thread))))

(defun note-left (what &rest beginnings)
  "Count as WHAT each thread that is left of those whose names begin with one of BEGINNINGS."
  (unless (apply #'none-left-p beginnings)
    (dolist (thread (apply #'threads-called beginnings)) (note-thread what thread))))

(defun take-messages ()
  "Count the errors that the simulators have reported."
  (dolist (message (base:take-messages base:*message-queue*))
    (when (eq :error (base:message-kind message))
      (let ((text (format nil "~{~A~}" (base:message-items message))))
        (note (if (search "The simulator failed" text) "dead clocks" "unexpected errors")
              text)))))

(defun note-dead-clocks ()
  "Count the simulators that say that they are live and pass no ticks."
  (dolist (world (resident-worlds))
    (let* ((timeline (world:world-timeline world))
           (thread (and timeline (time:timeline-thread timeline))))
      (when (and thread
                 (or (time:clock-trouble timeline) (not (base:thread-alive-p thread))))
        (note "dead clocks" timeline)))))

(defun stop-or-note (&rest robot)
  "Stop the simulator of the only element of ROBOT, or the current one. Count it if that fails."
  (handler-case (apply #'ars:stop-simulator robot)
    (error (trouble) (note "simulators that do not stop" trouble))))

(defun stop-all ()
  "Stop whatever simulators can be found, as a user would."
  (dolist (name *robots*) (stop-or-note (robot-now name)))
  (stop-or-note))

;;; Whether robots answer.

(defun answers-p (name)
  "True if the robot called NAME, started anew, carries out a command and a plan."
  (let ((robot (ars:simulator name :rate :free :display nil))
        (answered (base:make-semaphore "answered")))
    (ars:robot-turn robot 0.5d0 (lambda (&rest ignore)
                                  (declare (ignore ignore))
                                  (base:signal-semaphore answered)))
    (nisp:rpl-init-robot robot)
    (prog1 (and (base:wait-on-semaphore answered *patience*)
                (eq :succeeded (nth-value 1 (nisp:run-plan *wait*))))
      (nisp:end-plan :all)
      (ars:stop-simulator robot))))

(defun places ()
  "Return where this thread is, and those of the simulators and of plans: backtraces."
  (format nil "here, at~%~A~:{~%~A, at~%~A~}"
          (backtrace-here 40)
          (loop for thread in (threads-called "simulator of" "plans of")
                collect (list thread (place-of thread)))))

(defun note-silent (name)
  "Count the robot called NAME if it does not answer."
  (flet ((note-silence (trouble)
           (note "robots that do not answer" (format nil "~A: ~A~%~A" name trouble (places)))
           (return-from note-silent)))
    (handler-bind ((serious-condition #'note-silence))
      (sb-ext:with-timeout (* 3 *patience*)
        (unless (answers-p name) (note-silence "no"))))))

;;; All of it.

(defparameter *wrong*
  '("dead clocks" "orphans" "robots twice" "robots that do not answer" "threads left over"
    "threads that hang" "simulators that do not stop" "unexpected errors")
  "What there should be none of.")

(defun work-all ()
  "Let the threads work, and wait for their ends."
  (let* ((due (+ (get-internal-real-time) (* *seconds* internal-time-units-per-second)))
         (threads (loop for number below *threads*
                        collect (let ((number number))
                                  (sb-thread:make-thread (lambda () (work number due))
                                                          :name "stress")))))
    (loop while (< (get-internal-real-time) due)
          do (sleep 0.2)
             (take-messages))
    (unless (all-ended-p threads)
      (dolist (thread (remove-if-not #'base:thread-alive-p threads))
        (note-thread "threads that hang" thread)))))

(defun look-at-end ()
  "Count what is wrong when the threads have done their work."
  (look nil)
  (note-dead-clocks)
  (stop-all)
  (note-left "orphans" "simulator of")
  (mapc #'note-silent *robots*)
  (stop-all)
  (look nil)
  (take-messages)
  (note-left "threads left over" "simulator of" "watcher of" "plans of"))

(defun show-counts ()
  "Print what was counted, and the first examples of what is wrong. Return how much is wrong."
  (say "10 threads, things done" (/ (counted "things done") *seconds*) "things/s")
  (say "  calls refused" (counted "calls refused") "calls")
  (say "  time limits that came in between" (counted "time limits that came in between") "calls")
  (dolist (what *wrong*) (say (format nil "  ~A" what) (counted what) ""))
  (loop for (what words) in (reverse *examples*)
        when (member what *wrong* :test #'string=)
          do (format t "~A: ~A~%" what (subseq words 0 (min 9000 (length words)))))
  (finish-output)
  (loop for what in *wrong* sum (counted what)))

(work-all)
(look-at-end)
(unless (zerop (show-counts))
  (sb-ext:exit :code 1 :abort t))
