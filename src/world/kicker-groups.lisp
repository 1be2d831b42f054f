;;;; kicker-groups.lisp -- the trials of kickers, at the cost of those that succeed.

(in-package :ars-magna.world)

(export '(seed-world world-has-kickers-p some-kicker-p run-kickers))

;;; Each kicker on each thing is tried with its probability on every tick. Kickers of equal
;;; probability form a group: a row of trials, tick after tick. Instead of drawing for each trial we
;;; draw how many fail before the next success (a geometric distribution) and skip them. A :test is
;;; evaluated only if the trial succeeds; the distribution is the same. A removed member stays in
;;; the row, dead, until the end of the tick. Manual 5.3.1.
;;;
;;; A row is a vector with three elements for each member: attachment, its thing (NIL when dead),
;;; its kicker. They lie side by side because a kick costs mostly memory access (25 ns).

(define-kind (group :constructor (make-group (probability)))
    "A group of attached kickers with the same PROBABILITY. Each member has a trial in each tick."
  (:fixed
   (probability 0d0 double-float "the probability per unit of time of the group's kickers"))
  (:state
   (quantum 0 real "the value of TICK-QUANTUM* for which the trials were drawn")
   (scale 0d0 double-float "the factor that turns the logarithm of a roll into a gap")
   (skip 0 fixnum "how many trials fail before the next that succeeds")
   (row (make-array 12 :initial-element nil) simple-vector "the members: attachment, thing, kicker")
   (count 0 fixnum "how many members the row has")
   (dead '() list "members that have left since the last tick"))
  (:scratch
   (outlook nil (or null outlook) "the next trials' results, drawn ahead in a large group, or NIL"))
  (:link
   (origin (make-origin) origin "the attachment that is running, for errors")))

(defstruct (origin (:constructor make-origin ()) (:copier nil))
  "The origin of an error in a kicker: it prints as the attachment that was running."
  ;; Checking a type would read the attachment, which is distant memory, each time one runs.
  (attachment nil :type t))

(defmethod reference ((group group))
  (list :group (group-probability group)))

(defmethod print-object ((origin origin) stream)
  (princ (origin-attachment origin) stream))

;;; Chance.

(defun resample-gap-if-needed (group dice)
  "Draw the next gap of GROUP again if TICK-QUANTUM* has changed."
  (unless (eql (group-quantum group) tick-quantum*)
    (let ((p (per-tick-probability (group-probability group))))
      (setf (group-quantum group) tick-quantum*
            (group-scale group) (gap-scale p)
            (group-skip group) (draw-gap (group-scale group) dice)))))

;;; Membership.

(defun ensure-group (world probability)
  (or (find probability (world-kicker-groups world) :key #'group-probability :test #'=)
      (let ((group (make-group probability)))
        (setf (world-kicker-groups world) (append (world-kicker-groups world) (list group)))
        group)))

(defun join-group (attachment world)
  "Add ATTACHMENT to the trials of WORLD, from the next tick on."
  (let ((probability (kicker-prob (attachment-kicker attachment))))
    (when (plusp probability)
      (let* ((group (ensure-group world probability))
             (index (group-count group)))
        (when (= (* 3 index) (length (group-row group)))
          (setf (group-row group) (enlarge-vector (group-row group) (* 6 index))))
        (incf (group-count group))
        (setf (attachment-group attachment) group)
        (put-member group index attachment)))))

(defun put-member (group index attachment)
  (let ((row (group-row group)) (place (* 3 index)))
    (setf (attachment-index attachment) index
          (svref row place) attachment
          (svref row (+ place 1)) (and (attachment-alive-p attachment)
                                       (attachment-thing attachment))
          (svref row (+ place 2)) (attachment-kicker attachment))))

(defun leave-group (attachment)
  (let ((group (attachment-group attachment)))
    (setf (attachment-alive-p attachment) nil)
    (when group
      (put-member group (attachment-index attachment) attachment)
      (push attachment (group-dead group)))))

(defun remove-dead-members (group)
  "Fill the gaps that removed members leave in the row of GROUP with members from its end."
  (dolist (attachment (shiftf (group-dead group) '()))
    (let* ((last (decf (group-count group))) (row (group-row group)))
      (put-member group (attachment-index attachment) (svref row (* 3 last)))
      (fill row nil :start (* 3 last) :end (* 3 (1+ last))))))

(defun regroup-kickers (world)
  (setf (world-kicker-groups world) '()
        (world-kicker-generation world) *kicker-generation*)
  (do-things (thing world)
    (dolist (attachment (thing-kickers thing))
      (setf (attachment-group attachment) nil)
      (join-group attachment world))))

;;; Running.

(declaim (inline kicker-test-true-p))
(defun kicker-test-true-p (kicker test thing)
  "Call TEST, the test of KICKER, with THING. Record the result in KICKER and return it."
  (cond ((funcall (the function test) thing)
         (or (eq t (kicker-test-outcome kicker)) (setf (kicker-test-outcome kicker) t)))
        ;; Another thread may record true at this moment.
        ((null (kicker-test-outcome kicker))
         (compare-and-swap (kicker-test-outcome kicker) nil :no)
         nil)))

(defun run-member (kicker thing)
  (let ((test (kicker-test kicker)))
    (when (or (null test) (kicker-test-true-p kicker test thing))
      (funcall (the function (kicker-body kicker)) thing))))

(defun rerun-member (origin)
  (let ((attachment (origin-attachment origin)))
    (setf self attachment)
    (run-member (attachment-kicker attachment) (attachment-thing attachment))))

;; Distant memory is read ahead. In a large world a move then takes 420 ns instead of 750. Kickers
;; that move nothing would not benefit, and would pay for it.
(defconstant +large-group-size+ 5000
  "A group with at least so many members needs more memory than a processor caches.")

(defun read-group-ahead (group end dice)
  "Read the memory of things in GROUP into the cache: those whose trials succeed next, before the
index END. Return the index of the first success for which nothing was read."
  (declare #.*hot* (type group group) (type (unsigned-byte 50) end) (type dice dice))
  (let* ((row (group-row group))
         (outlook (or (group-outlook group) (setf (group-outlook group) (make-outlook))))
         (gaps (outlook-gaps outlook))
         (index (group-skip group)) (batch (make-array +moves-per-batch+))
         (ahead (draw-next-gaps outlook index end (group-scale group) dice)))
    (declare (dynamic-extent batch) (type (unsigned-byte 50) index) (type outlook outlook))
    (dotimes (i (outlook-count outlook))
      (let ((place (* 3 index)))
        (setf (svref batch i) (and (svref row place) (svref row (+ place 2))
                                   (svref row (+ place 1))))
        (incf index (1+ (aref gaps i)))))
    (read-ahead batch (outlook-count outlook) *world*)
    ahead))

(defun run-member-noting-move (kicker thing)
  (let ((x (thing-x thing)) (y (thing-y thing)))
    (run-member kicker thing)
    (not (and (= x (thing-x thing)) (= y (thing-y thing))))))

(defun run-members (group end dice tick)
  "Run the members of GROUP before END whose trials succeed, except those already run in TICK if
TICK is not 0. The next success is drawn before a member runs, so an error skips the member unless
it is retried. In a large group, memory is read ahead if the first member to run moves its thing."
  (declare #.*hot* (type group group) (type (unsigned-byte 50) end) (type dice dice)
           (type tick-count tick))
  (let ((origin (group-origin group)) (curious (>= end +large-group-size+)) (ahead end)
        (outlook nil))
    (declare (type (unsigned-byte 50) ahead))
    (when (origin-attachment origin) (rerun-member origin))
    (loop for index of-type (unsigned-byte 50) = (group-skip group)
          while (< index end)
          do (when (>= index ahead)
               (setf ahead (read-group-ahead group end dice)
                     outlook (group-outlook group)))
             (setf (group-skip group)
                   (+ index 1 (draw-gap-from-outlook outlook (group-scale group) dice)))
             (let* ((row (group-row group))
                    (attachment (svref row (* 3 index)))
                    (thing (svref row (+ 1 (* 3 index))))
                    (kicker (svref row (+ 2 (* 3 index)))))
               (declare (type kicker kicker))
               (when (and thing (or (zerop tick) (/= tick (attachment-ran attachment))))
                 (setf (origin-attachment origin) attachment
                       self attachment)
                 (if (shiftf curious nil)
                     (when (run-member-noting-move kicker thing) (setf ahead 0))
                     (run-member kicker thing)))))
    (setf (origin-attachment origin) nil))
  t)

(defun run-members-despite-errors (group end dice tick)
  "Run the members of GROUP before END whose trials succeed, even after a member with an error."
  (unwind-protect
       (loop while (< (group-skip group) end)
             do (unless (call-user-code #'run-members (group-origin group) group end dice tick)
                  (setf (group-origin group) (make-origin))))
    (when (< (group-skip group) end)
      ;; A member has exited, as by THROW.
      (setf (group-origin group) (make-origin))
      (run-members-despite-errors group end dice tick))))

(defun run-group (group dice tick)
  (resample-gap-if-needed group dice)
  (let ((end (group-count group)))
    (unwind-protect (run-members-despite-errors group end dice tick)
      (decf (group-skip group) end)
      (when (group-dead group) (remove-dead-members group)))))

(declaim (inline skip-group))
(defun skip-group (group)
  "If no trial in GROUP succeeds in this tick (the usual case), count this tick and return true."
  (declare (type group group))
  (let ((left (- (group-skip group) (group-count group))))
    (when (and (>= left 0)
               (null (group-dead group))
               (eql (group-quantum group) tick-quantum*))
      (setf (group-skip group) left)
      t)))

(defun run-due-kicker (attachment world)
  (when (attachment-alive-p attachment)
    (setf (attachment-ran attachment) (world-kicker-tick world))
    (call-user-code (lambda () (setf self attachment)
                      (funcall (kicker-body (attachment-kicker attachment))
                               (attachment-thing attachment)))
                    attachment)))

(defun take-due-kickers (world tick)
  "Remove from WORLD, and return, the attachments due in TICK, in the order of the requests."
  (let ((later '()) (due '()) (next 0))
    (dolist (attachment (world-due-kickers world))
      (let ((time (attachment-due attachment)))
        (cond ((= tick time) (push attachment due))
              (t (setf next (if later (min next time) time))
                 (push attachment later)))))
    (setf (world-due-kickers world) (nreverse later)
          (world-next-due world) next)
    due))

(defun run-all-kickers (world)
  (let* ((*world* world) (self nil)
         (dice (world-dice world :kickers))
         (tick (1+ (world-kicker-tick world)))
         (due (take-due-kickers world tick)))
    (unless (= (world-kicker-generation world) *kicker-generation*) (regroup-kickers world))
    (setf (world-kicker-tick world) tick)
    (flet ((run-due (attachment) (run-due-kicker attachment world))
           (run-chance (group)
             (unless (skip-group group) (run-group group dice (if due tick 0)))))
      (declare (dynamic-extent #'run-due #'run-chance))
      (unwind-protect (call-each #'run-due due)
        (call-each #'run-chance (world-kicker-groups world))))))

(declaim (inline only-later-kickers-p run-kickers))
(defun only-later-kickers-p (world)
  "True if the only kickers of WORLD that may run are requested for later ticks than the next."
  (and (null (world-kicker-groups world))
       (= (world-kicker-generation world) *kicker-generation*)
       (< (1+ (world-kicker-tick world)) (world-next-due world))))

(defun run-kickers (world)
  "Run the kickers of all things in WORLD for one tick: first those that RUN-KICKER has requested,
then those whose trials succeed. Errors in a kicker are queued as error messages. Return nothing."
  (when (or (world-kicker-groups world) (world-due-kickers world))
    (if (only-later-kickers-p world)
        (incf (world-kicker-tick world))
        (run-all-kickers world)))
  (values))

(public run-kicker)
(defun run-kicker (attachment &optional (ticks 1))
  "Run ATTACHMENT, usually SELF, once more after TICKS, by default in the next tick, whatever its
probability and test. In that tick ATTACHMENT has no trial. A further request before then changes
the tick (manual 5.3.1). Return nothing. Signals WRONG-ARGUMENT. See reading 170."
  (check-argument run-kicker attachment (attachment-p attachment) "SELF, while a kicker runs")
  (check-argument run-kicker ticks (whole-p ticks 1) "a whole number of ticks, from 1 to 1e9")
  (let ((world (world-of-living-thing (attachment-thing attachment))))
    (when (and world (attachment-alive-p attachment))
      (changing (world run-kicker attachment ticks)
        (let ((requested-p (> (attachment-due attachment) (world-kicker-tick world)))
              (due (+ ticks (world-kicker-tick world))))
          (setf (attachment-due attachment) due
                (world-next-due world) (if (world-due-kickers world)
                                           (min due (world-next-due world))
                                           due))
          (unless requested-p (push attachment (world-due-kickers world)))))))
  (values))

(define-argument-type 'attachment #'attachment-p "a kicker on a thing, as SET-KICKER returns")
(define-operator 'run-kicker '(attachment) #'run-kicker :rest 'tick-span)

(defun world-has-kickers-p (world)
  "True if any kicker in WORLD may run, so that ticks can change WORLD."
  (or (world-due-kickers world)
      (some (lambda (group) (plusp (group-count group))) (world-kicker-groups world))))

(defun some-kicker-p (test world)
  "True if TEST, a function of a kicker, returns true for a kicker on some thing in WORLD."
  (loop for group in (world-kicker-groups world)
        thereis (loop with last = nil
                      for index below (group-count group)
                      for kicker = (svref (group-row group) (+ 2 (* 3 index)))
                      thereis (and (not (eq kicker last))
                                   (funcall test (setf last kicker))))))

(defun seed-world (world seed)
  "Draw all further randomness in WORLD from the integer SEED. Return WORLD."
  (check-argument seed-world seed (integerp seed) "an integer")
  (dolist (group (world-kicker-groups world)) (setf (group-quantum group) 0))
  (setf (world-seed world) seed
        (world-dice-set world) (make-dice-set seed (world-dice-names world)))
  world)

;; An origin without an attachment is a group that was read ahead.
(defmethod recurring-function ((origin origin))
  (recurring-function (origin-attachment origin)))

(defmethod stop-recurring-remedy ((origin origin))
  (stop-recurring-remedy (origin-attachment origin)))
