;;;; hogs.lisp -- users' code that keeps a live simulation waiting is named while it does.

(in-package :ars-magna.time)

;;; A thread beside that of the simulation looks twice in *HOG-SECONDS* where that is. What it sees
;;; three times on end has been there for so long.

(defun warn-of-hog (origin)
  (warning-set (format nil "~A has kept the simulator waiting for ~,1F s and goes on; ~
                            (stop-simulator) interrupts it"
                       (text-of-origin origin) (hog-seconds))))

(defun watch-for-hogs (pacing)
  "Warn of what users' code the thread of PACING does not get out of, until that ends."
  (loop with calls = (pacing-calls pacing) and seen = nil and looks = 0
        until (ended-p pacing (/ (hog-seconds) 2))
        do (let ((origin (user-calls-origin calls)) (count (user-calls-count calls)))
             (cond ((not (and origin (eql count seen)))
                    (setf seen (and origin count) looks 1))
                   ((= 3 (incf looks))
                    (warn-of-hog origin))))))
