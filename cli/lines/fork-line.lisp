;;;; fork-line.lisp -- FORK: trying something in a copy of the run, and back as if nothing was.

(in-package :ars-magna.cli)

;;; In a fork the prompt is in a headless run: time passes as its lines need it. The run that was
;;; forked stands still meanwhile. As a trial, a fork is entered by a line that goes on until
;;; another one leads out.

(defun copied-run (seed)
  (let ((fork (if seed (fork-simulation :seed seed) (fork-simulation))))
    (keep-forks t fork)
    fork))

(defun read-in-fork (session)
  (loop until (session-over-p session)
        do (call-guarded session (lambda () (next-line-inside session)))
           (call-guarded session (lambda () (show-messages session)))))

(defun tell-fork (session)
  (format (session-console session)
          "~&In a fork, at tick ~D. STEP lets time pass, FORK OFF leads back.~@[ Plans under way: ~
           ~{~A~^, ~}.~]~%"
          (simulation-tick *simulation*) (mapcar #'task-label (plans))))

(defun enter-fork (session fork)
  "Let SESSION, which waits for nothing that it has asked for before, be in FORK until a line leads
out."
  (let ((errands (shiftf (session-errands session) '()))
        (depth (session-forks session)))
    (setf (session-forks session) (1+ depth))
    (unwind-protect (catch 'left-fork
                      (call-in-fork fork (lambda ()
                                           (tell-fork session)
                                           (read-in-fork session))))
      (drop-errands session)
      (setf (session-errands session) errands
            (session-forks session) depth))))

(defun go-to-fork (session seed)
  "Let SESSION be in a fork of the current run until a line leads out; then forget it."
  (let ((fork (copied-run seed)) (run *simulation*))
    (tell-others session run (format nil "Another prompt is in a fork of the run, which waits.~%"))
    (unwind-protect (call-with-others-paused (lambda () (enter-fork session fork)))
      (tell-others session run
                   (format nil "The fork is left; the run ~:[waits no longer~;is paused~].~%"
                           (paused-p run)))
      (stop-listening session)
      (release-fork fork)
      (unless (session-over-p session)
        (format (session-console session) "~&Back from the fork. ~A~%"
                (time-text session *simulation*))))))

(define-line "FORK" (session (seed :off "OFF, or an integer from which all its chance is to come"
                                   :optional))
    (:running)
    "Go on in a copy of the run, plans and all, which goes the way that the run would, or with SEED
as it might. The run itself waits. FORK OFF leads back to it, as it was; the copy is forgotten."
  (check-run)
  (cond ((session-visit session) (reject-line "A trial is what it is. TRIAL OFF leads out."))
        ((null seed) (go-to-fork session nil))
        ((string-equal seed "off")
         (when (zerop (session-forks session)) (reject-line "The prompt is in no fork."))
         (throw 'left-fork t))
        (t (go-to-fork session (or (ignore-errors (parse-integer seed))
                                   (reject-line "The seed of a fork is an integer, not ~A."
                                                seed))))))
