;;;; rewind-line.lisp -- REWIND: going back to an earlier tick.

(in-package :ars-magna.cli)

;;; The plans that go on after that are others than those that the prompt waited for: it lets these
;;; go without a word, and takes up those, also when somebody rewinds by Lisp.

(defun let-errands-go (old new)
  "Say nothing of how the plans of OLD end that prompts wait for, as NEW goes on in its place."
  (declare (ignore new))
  (dolist (errand (with-lock (*plan-errands-lock*)
                    (remove old *plan-errands* :key #'plan-errand-simulation :test-not #'eq)))
    (setf (plan-errand-let-go-p errand) t
          (session-after-rewind (plan-errand-session errand)) #'take-up-plans)))

(attend *rewind-hooks* let-errands-go)

(defun rewind-here (session ticks)
  "Let SESSION go on in a run that is TICKS ticks back."
  (rewind ticks)
  ;; The commands that are under way again are nobody's errands.
  (setf (session-after-rewind session) nil
        (session-lisp-p session) t)
  (take-up-plans session))

(defun check-rewindable (session)
  (check-run)
  (when (session-visit session)
    (reject-line "A trial is what it is. TRIAL begins it anew, at tick 0.")))

(defun rewind-and-tell (session ticks)
  (let ((tick (- (simulation-tick *simulation*) ticks)))
    (rewind-here session ticks)
    (tell-others session *simulation*
                 (format nil "Another prompt has let the run go back to tick ~D.~%" tick))
    (format t "~A~@[ Plans under way: ~{~A~^, ~}.~]~%"
            (time-text session *simulation* tick) (mapcar #'task-label (plans)))))

(define-line "REWIND" (session (n tick-span "how far"))
    (:running)
    "Go back N ticks, plans included, and go on from there; 0 undoes what was done since the last
tick. What came after has not happened; the journal says that there was something. Programs that
wait for the end of a command, such as that of GO-TO, do not go on: they are told :INTERRUPT."
  (check-rewindable session)
  (rewind-and-tell session n))

(define-line "REWIND-TO" (session (tick count "the tick to go back to"))
    (:running)
    "Go back to the end of TICK, and go on from there, as REWIND does that counts from now."
  (check-rewindable session)
  (let ((now (simulation-tick *simulation*)))
    (unless (<= tick now) (reject-line "It is only tick ~D." now))
    (rewind-and-tell session (- now tick))))
