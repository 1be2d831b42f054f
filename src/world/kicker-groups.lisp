;;;; kicker-groups.lisp -- running kickers at the cost of those that fire.

(in-package :ars-magna.world)

;;; Each kicker on each thing is a trial of its probability on every tick. Kickers of equal
;;; probability form a group: a row of trials, tick after tick. Rather than rolling for each we
;;; draw how many fail before the next that succeeds (a geometric law) and skip them. A :test is
;;; evaluated only if the trial succeeds, which is the same law. What leaves a group stays in
;;; the row, dead, until the tick is over. Manual 5.3.1.

(defstruct (group (:constructor make-group (probability)) (:copier nil))
  "Kickers of equal PROBABILITY. SKIP trials fail before the next that succeeds."
  (probability 0d0 :type double-float :read-only t)
  (quantum 0 :type real)
  (scale 0d0 :type double-float)
  (skip 0 :type fixnum)
  (members (make-array 4 :initial-element nil) :type simple-vector)
  (count 0 :type fixnum)
  (dead '() :type list)
  (origin (make-origin) :type origin))

(defstruct (origin (:constructor make-origin ()) (:copier nil))
  "What is printed as the origin of trouble: the attachment that ran when it came."
  (attachment nil :type (or null attachment)))

(defmethod print-object ((origin origin) stream)
  (princ (origin-attachment origin) stream))

;;; Chance.

(defun per-tick-probability (probability)
  "Return the chance that something of PROBABILITY per unit of time happens in a tick."
  (if (= tick-quantum* 1)
      probability
      (- 1d0 (expt (- 1d0 probability) (double tick-quantum*)))))

(defun gap-scale (probability)
  "Return the factor that turns the logarithm of a roll into a gap, see DRAW-GAP."
  (cond ((>= probability 1d0) 0d0)
        ((< probability 1d-12) (- (/ probability)))
        (t (/ (log (- 1d0 probability))))))

(declaim (inline draw-gap))
(defun draw-gap (scale dice)
  "Return how many trials fail before the next success; SCALE is 1 / log(1 - p), 0 for p = 1."
  (declare (type double-float scale))
  (let ((u (- 1d0 (roll dice))))
    (declare (type (double-float (0d0) 1d0) u))
    (truncate (the (double-float 0d0 #.(expt 2d0 40))
                   (min #.(expt 2d0 40) (* scale (log u)))))))

(defun refresh-rate (group dice)
  "Draw anew if a tick now stands for another span of time."
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
             (members (group-members group))
             (count (group-count group)))
        (when (= count (length members))
          (setf members (replace (make-array (* 2 count) :initial-element nil) members)
                (group-members group) members))
        (setf (svref members count) attachment
              (group-count group) (1+ count)
              (attachment-index attachment) count
              (attachment-group attachment) group)))))

(defun leave-group (attachment)
  "Let ATTACHMENT run no more."
  (setf (attachment-alive-p attachment) nil)
  (when (attachment-group attachment)
    (push attachment (group-dead (attachment-group attachment)))))

(defun bury-dead (group)
  "Close the gaps in the row of GROUP, with members from its end."
  (dolist (attachment (shiftf (group-dead group) '()))
    (let* ((index (attachment-index attachment))
           (members (group-members group))
           (last (decf (group-count group)))
           (other (svref members last)))
      (setf (svref members index) other
            (attachment-index other) index
            (svref members last) nil))))

(defun regroup-kickers (world)
  "Form the groups of WORLD anew, after kickers have been redefined."
  (setf (world-kicker-groups world) '()
        (world-kicker-generation world) *kicker-generation*)
  (do-things (thing world)
    (dolist (attachment (thing-kickers thing))
      (setf (attachment-group attachment) nil)
      (join-group attachment world))))

;;; Running.

(declaim (inline run-attachment))
(defun run-attachment (attachment)
  (setf self attachment)
  (let* ((kicker (attachment-kicker attachment))
         (test (kicker-test kicker))
         (thing (attachment-thing attachment)))
    (when (or (null test) (funcall test thing))
      (funcall (kicker-body kicker) thing))))

(defun run-members (group end dice tick)
  "Run those before END in the row of GROUP whose trials succeed. The next success is drawn
before one runs, so that after an error the row goes on behind it."
  (declare #.*hot* (type group group) (type (unsigned-byte 50) end) (type dice dice)
           (type tick-count tick))
  (loop with origin = (group-origin group)
        for index of-type (unsigned-byte 50) = (group-skip group)
        while (< index end)
        do (setf (group-skip group) (+ index 1 (draw-gap (group-scale group) dice)))
           (let ((attachment (svref (group-members group) index)))
             (declare (type attachment attachment))
             (when (and (attachment-alive-p attachment) (/= tick (attachment-ran attachment)))
               (setf (origin-attachment origin) attachment)
               (run-attachment attachment))))
  t)

(defun run-group (group world dice)
  (refresh-rate group dice)
  (let ((end (group-count group)))
    (loop while (< (group-skip group) end)
          do (unless (call-user-code #'run-members (group-origin group)
                                     group end dice (world-kicker-tick world))
               (setf (group-origin group) (make-origin))))
    (decf (group-skip group) end)
    (when (group-dead group) (bury-dead group))))

(defun run-due-kickers (world)
  "Run what RUN-KICKER has asked for, in order."
  (dolist (attachment (nreverse (shiftf (world-due-kickers world) '())))
    (when (attachment-alive-p attachment)
      (setf (attachment-ran attachment) (world-kicker-tick world))
      (call-user-code (lambda () (setf self attachment)
                        (funcall (kicker-body (attachment-kicker attachment))
                                 (attachment-thing attachment)))
                      attachment))))

(defun run-kickers (world)
  "Run for one tick the kickers of all things in WORLD: first those that RUN-KICKER has asked
for, then those whose chance has come. Trouble in a kicker is queued as an error message.
Return nothing."
  (when (or (world-kicker-groups world) (world-due-kickers world))
    (let ((*world-access* 'direct-world-access) (*world* world) (self nil)
          (dice (world-dice world :kickers)))
      (unless (= (world-kicker-generation world) *kicker-generation*) (regroup-kickers world))
      (incf (world-kicker-tick world))
      (when (world-due-kickers world) (run-due-kickers world))
      (dolist (group (world-kicker-groups world))
        (run-group group world dice))))
  (values))

(defun run-kicker (attachment)
  "Run ATTACHMENT, which should be given as SELF, once more on the next tick, whatever its
probability and test say; its own trial is left out that tick (manual 5.3.1). Return nothing."
  (check-argument run-kicker attachment (attachment-p attachment) "SELF, while a kicker runs")
  (let ((world (thing-world (attachment-thing attachment))))
    (when (and world (attachment-alive-p attachment))
      (let ((next (1+ (world-kicker-tick world))))
        (unless (= next (attachment-due attachment))
          (setf (attachment-due attachment) next)
          (push attachment (world-due-kickers world))))))
  (values))

(defun world-has-kickers-p (world)
  "True if any kicker in WORLD may run, so that its ticks can matter."
  (or (world-due-kickers world)
      (some (lambda (group) (plusp (group-count group))) (world-kicker-groups world))))

(defun seed-world (world seed)
  "Let all chance in WORLD come from the integer SEED from now on. Return WORLD."
  (check-argument seed-world seed (integerp seed) "an integer")
  (dolist (group (world-kicker-groups world)) (setf (group-quantum group) 0))
  (setf (world-seed world) seed
        (world-dice-set world) (make-dice-set seed))
  world)
