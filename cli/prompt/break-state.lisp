;;;; break-state.lisp -- what has broken, how it may go on, and what of it waits for an answer.

(in-package :ars-magna.cli)

(defstruct (breakage (:constructor make-breakage (condition restarts thread sessions))
                     (:copier nil))
  "A program that has broken and waits in THREAD, until the user of one of SESSIONS says how to go
on. ORDER is what it is to do next, a function."
  (condition nil :type condition :read-only t)
  (restarts '() :type list :read-only t)
  (thread nil :read-only t)
  (sessions '() :type list)
  (order nil :type (or null function))
  ;; How to go on has been shown.
  (told-p nil :type boolean)
  (ordered (make-semaphore "order") :read-only t)
  (done (make-semaphore "order done") :read-only t))

(defun restarts-within (condition)
  "Return the restarts for CONDITION up to the one that ends the line, of each name the innermost."
  (let* ((all (remove nil (compute-restarts condition) :key #'restart-name))
         (last (position 'end-line all :key #'restart-name)))
    (remove-duplicates (subseq all 0 (and last (1+ last))) :test #'string=
                       :key #'restart-name :from-end t)))

(defun rank (restart condition)
  "Return a number for RESTART, a lower one the more likely it is what the user wants."
  (let ((first-names (if (typep condition 'serious-condition)
                         '("ABORT" "RETRY" "STOP-SIMULATOR")
                         '("ANSWER" "CONTINUE"))))
    (or (position (restart-name restart) first-names :test #'string=) (length first-names))))

(defparameter *asking-restarts*
  '("USE-VALUE" "STORE-VALUE" "RETURN-VALUE" "CALL-FORM" "REPLACE-FUNCTION" "SPECIFY-PACKAGE"
    "USE-PACKAGE" "RENAME" "ANSWER")
  "The names of restarts that ask for what they need.")

(defun asks-p (restart)
  (member (restart-name restart) *asking-restarts* :test #'string=))

(defun restarts-to-offer (condition)
  "Return the ways to go on after CONDITION that a user can choose, those first that he may be
expected to."
  (stable-sort (restarts-within condition)
               #'< :key (lambda (restart) (rank restart condition))))

(defun here-p (breakage)
  (eq (breakage-thread breakage) (current-thread)))

(defun break-words (condition)
  "Return what CONDITION says: on a line, unless it is that a plan has stopped, with its stack."
  (if (plan-break-p condition)
      (visible (condition-text condition))
      (complaint-text (condition-text condition))))

(defstruct (break-state (:copier nil))
  "What waits until the user of THREAD says how it goes on: OWN has broken in that thread, which
reads lines for it, or is NIL; OTHERS have in other threads, the oldest first."
  (thread nil)
  (own nil :type (or null breakage))
  (others '() :type list))

(defun breaks-awaiting (state)
  "Return what waits in STATE, what is asked about now first."
  (let ((own (break-state-own state)) (others (break-state-others state)))
    (cond ((null own) others)
          ((breakage-told-p own) (cons own others))
          (t (append others (list own))))))
