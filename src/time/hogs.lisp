;;;; hogs.lisp -- users' code that keeps a live simulation waiting is named while it does.

(in-package :ars-magna.time)

(export '(users-code-under-way users-code-broken-p abort-hog))

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
  (let* ((pacing (timeline-pacing (timeline-of simulation)))
         (calls (and pacing (pacing-calls pacing)))
         (origin (and calls (not (user-calls-waiting-p calls)) (user-calls-origin calls))))
    (and origin (values (text-of-origin origin) (user-calls-count calls)))))

(defun users-code-broken-p (simulation)
  "True if the thread of the live SIMULATION is in users' code that waits in a debugger."
  (let* ((pacing (timeline-pacing (timeline-of simulation)))
         (calls (and pacing (pacing-calls pacing))))
    (and calls (user-calls-origin calls) (user-calls-waiting-p calls) t)))

(defun abort-hog (simulation)
  "Abort the users' code that keeps the live SIMULATION waiting, if it has been named for that. True
if there is such."
  (let ((pacing (timeline-pacing (timeline-of simulation))))
    (and pacing
         (eql (pacing-hog pacing) (user-calls-count (pacing-calls pacing)))
         (interrupt-hog pacing))))
