;;;; stopping.lisp -- ending the thread that passes ticks, though it may be in users' code.

(in-package :ars-magna.time)

(export '(stop-pacing claim-pacing claimed-p unclaim-pacing call-alone users-code-under-way
          users-code-broken-p abort-hog))

;;; The thread ends by itself after its tick. Users' code that keeps it from ending is aborted, but
;;; only if whoever stops the run says so.

(defun ended-p (pacing seconds)
  "Wait for the thread of PACING to end, for SECONDS. True if it has."
  (loop with due = (+ (seconds-now) seconds)
        ;; A thread that was woken may have been interrupted before it could wake the next one.
        when (or (pacing-over-p pacing)
                 (wait-for-other (pacing-ended pacing) (min seconds 0.2)))
          ;; Others may be waiting too.
          do (signal-semaphore (pacing-ended pacing))
             (return t)
        until (> (seconds-now) due)))

(defun interrupt-hog (pacing)
  "Abort the users' code that the thread of PACING is in, if it is in any. True if so."
  (let* ((calls (pacing-calls pacing)) (count (user-calls-count calls)))
    (when (user-calls-origin calls)
      (interrupt-thread (pacing-thread pacing) (lambda () (abort-user-code count)))
      t)))

(defun await-end (pacing)
  "Wait for the thread of PACING to end. Users' code that keeps it from that is interrupted, and
again if it does not go. Signals MISUSE if that does not help either."
  (loop repeat 10
        when (ended-p pacing (hog-seconds))
          return t
        do (interrupt-hog pacing)
        finally (let ((origin (user-calls-origin (pacing-calls pacing))))
                  (reject-use "The simulator of ~A does not stop~@[: ~A does not let itself be ~
                               interrupted~]."
                              (timeline-name (pacing-timeline pacing))
                              (and origin (text-of-origin origin))))))

(defun stop (pacing)
  "End the thread of PACING after its current tick, and wait for that if it is another than this."
  (swap-if (pacing-stopping-p pacing) nil t)
  (wake pacing)
  (unless (eq (pacing-thread pacing) (current-thread))
    (await-end pacing)))

(defun claim-pacing (timeline)
  "Tell the thread that paces TIMELINE to end after its current tick, as this thread is to replace
the run. True if it was live, and nobody else had told it to end."
  (if-paced (pacing timeline) (swap-if (pacing-stopping-p pacing) nil :replaced)))

(defun claimed-p (timeline)
  "True if CLAIM-PACING has returned true for TIMELINE, and UNCLAIM-PACING was not called since."
  (if-paced (pacing timeline) (eq :replaced (pacing-stopping-p pacing))))

(defun unclaim-pacing (timeline)
  "Let what may be about to replace the run of TIMELINE not be live: somebody has stopped that."
  (if-paced (pacing timeline) (swap-if (pacing-stopping-p pacing) :replaced t)))

(defun stop-pacing (timeline)
  "End the thread that paces TIMELINE after its current tick, and wait for that if it is another
than this. Return TIMELINE. Signals MISUSE if it is in users' code that does not let itself be
interrupted."
  (if-paced (pacing timeline) (stop pacing))
  timeline)

(defun call-alone (timeline function)
  "Stop whoever paces the world of TIMELINE, and call FUNCTION with that in custody. Return the
values."
  (let ((custody (timeline-custody timeline)))
    (flet ((make-free ()
             (let ((pacing (custody-pacing custody)))
               (if pacing
                   (stop pacing)
                   (ask-holder custody (constantly nil))))))
      (loop
        (block busy
          (return (call-with-custody custody function (lambda ()
                                                        (make-free)
                                                        (return-from busy)))))))))

;;; Users' code that keeps a live simulation waiting is named while it does.

;;; A thread beside that of the simulation looks twice in *HOG-SECONDS* where that is. What it sees
;;; three times on end has been there for so long.

(defun watch-for-hogs (pacing)
  "Warn of what users' code the thread of PACING does not get out of, until that ends."
  (loop with calls = (pacing-calls pacing) and seen = nil and looks = 0
        until (ended-p pacing (/ (hog-seconds) 2))
        do (let ((origin (user-calls-origin calls)) (count (user-calls-count calls)))
             (cond ((or (null origin) (/= count (or seen -1)) (user-calls-waiting-p calls))
                    (setf seen (and origin count) looks 1))
                   ((= 3 (incf looks))
                    (setf (pacing-hog pacing) count)
                    (warn-at-once (format nil "~A has kept the simulator waiting for ~,1F s and ~
                                               goes on; (stop-simulator) interrupts it"
                                          (text-of-origin origin) (hog-seconds))))))))

(defun users-code-under-way (simulation)
  "Return in words whose code the thread of the live SIMULATION is in, and how many calls of such
code it has begun; NIL if it is in none, or one that waits in a debugger."
  (if-paced (pacing simulation)
    (let* ((calls (pacing-calls pacing))
           (origin (and (not (user-calls-waiting-p calls)) (user-calls-origin calls))))
      (and origin (values (text-of-origin origin) (user-calls-count calls))))))

(defun users-code-broken-p (simulation)
  "True if the thread of the live SIMULATION is in users' code that waits in a debugger."
  (if-paced (pacing simulation)
    (let ((calls (pacing-calls pacing)))
      (and (user-calls-origin calls) (user-calls-waiting-p calls) t))))

(defun abort-hog (simulation)
  "Abort the users' code that keeps the live SIMULATION waiting, if it has been named for that. True
if there is such."
  (if-paced (pacing simulation)
    (and (eql (pacing-hog pacing) (user-calls-count (pacing-calls pacing)))
         (interrupt-hog pacing))))
