;;;; agreement.lisp -- a run that is forked, rewound, saved or replayed goes on the same way.

(in-package :ars-magna.tests)
(in-suite agreement)

;;; A run of a random script is forked and saved at a tick, and continues to its end. Then it is
;;; rewound to that tick and continues again, and its journal is replayed. Another run of the script
;;; has neither journal nor forks. All get the same requests, and must have the same digests and the
;;; same journal.

(defun define-accord-world (script)
  "Define map and robots of SCRIPT. Return the robots' names."
  (handler-bind ((warning #'muffle-warning))
    (world:define-map 'accord-room (script-width script) (script-height script)
      :clauses (script-clauses script))
    (loop for (name position angle . parts) in (script-robots script)
          do (apply #'robot:define-robot name 'accord-room position angle parts)
          collect name)))

;;; A moment is (tick digest digest-with-plans messages). How much of it must agree depends on the
;;; way of repeating. A loaded run has no plans, and gives its warnings again. Where observers act
;;; in place of continuations, the warnings differ.

(defun accord-moment ()
  ;; Not all ways save the run, which warns of programs that go on.
  (list (tick-of-run) (run:state-digest) (run:state-digest time:*simulation* t)
        (remove-if (lambda (text) (search "is not in the saved run" text))
                   (mapcar #'base:message-text (base:take-messages)))))

(defun moments-agree-p (one other way)
  "True if as much of the moments ONE and OTHER agrees as must on WAY."
  (let ((end (ecase way
               ((:plain :fork) 4)
               ((:fork-alone :rewind) 3)
               ((:load :replay) 2))))
    (equal (subseq one 1 end) (subseq other 1 end))))

(defun next-stop (goal)
  "Return the tick up to which the run is to go now: not beyond GOAL, nor beyond a step."
  (let ((tick (tick-of-run)))
    (reduce #'min (loop for (at place) in (script-steps *script*)
                        when (and (eq place :between) (< tick at goal)) collect at)
            :initial-value (min goal (+ tick (script-stride *script*))))))

(defun go-on-by-script (goal &key done-p)
  "Let the run here go on to the tick GOAL as *SCRIPT* says. DONE-P is true if what is to be done
between ticks now has been done. Return the moments, oldest first."
  (loop while (< (tick-of-run) goal)
        do (unless (shiftf done-p nil) (perform-step-at (tick-of-run) :between))
           (run:run-ticks (- (next-stop goal) (tick-of-run)))
        collect (accord-moment)))

(defun begin-by-script ()
  "Let the run here go on to where *SCRIPT* has it forked, and do what is to be done there by then.
Return the moment before that."
  (run:add-observer #'look-on-script)
  (go-on-by-script (script-at *script*))
  (prog1 (accord-moment)
    (when (script-late-p *script*) (perform-step-at (script-at *script*) :between))))

(defun finish-by-script ()
  "Let the run here, as BEGIN-BY-SCRIPT has left it, go on to its end. Return the moments."
  (go-on-by-script (script-ticks *script*) :done-p (script-late-p *script*)))

(defun accord-entries (&optional (simulation time:*simulation*))
  "Return the entries of the journal of SIMULATION, but those that say that it was rewound."
  (let ((journal (run:simulation-journal simulation)))
    (and journal
         (remove 'run::rewound (run:journal-entries (end-journal simulation)) :key #'second))))

;;; What has gone another way.

(defun journals-alike-p (one other)
  (and (= (length one) (length other)) (every #'run::alike-across-runs-p one other)))

(defun accord-differences (way moments entries other-moments other-entries)
  "Return what is different, on the WAY with OTHER-MOMENTS and OTHER-ENTRIES, from a run with
MOMENTS and ENTRIES: a list of lists (way what where)."
  (append
   (loop for moment in moments
         for other = (assoc (first moment) other-moments)
         unless (or (null other) (moments-agree-p moment other way))
           return (list (list way :state (first moment))))
   (unless (journals-alike-p entries other-entries)
     (list (list way :journal
                 (loop for index from 0
                       for one = (nth index entries) and other = (nth index other-entries)
                       unless (run::alike-across-runs-p one other) return (list one other)))))))

(defmacro on-the-way (way &body body)
  "Return what BODY returns, a list of differences, or that there was an error on the WAY."
  `(handler-case (progn ,@body)
     (error (trouble) (list (list ,way :error (princ-to-string trouble))))))

;;; The ways. RECORD has the moments since the fork, entries and answers of the run itself.

(defstruct record moments entries answers journal)

(defun told-here (record)
  "Return the actions for observers where continuations of commands in progress are not called: all
actions since then, because order matters; NIL if there was no such continuation."
  (let* ((at (script-at *script*))
         (since (remove-if-not (lambda (answer) (> (first answer) at)) (record-answers record))))
    (and (some (lambda (answer) (<= (second answer) at)) since)
         (reverse since))))

(defun compared (way record moments)
  "Return how the run here, with MOMENTS, differs from RECORD on WAY."
  (accord-differences way (record-moments record) (record-entries record)
                      moments (accord-entries)))

(defmacro telling ((record) &body body)
  "Run BODY where an observer does what lost continuations of the run of RECORD did."
  `(let* ((*left-to-observer* (told-here ,record))
          (*following* (null *left-to-observer*))
          (*followed* '()))
     ,@body))

(defun fork-differences (record fork continuations-p)
  "Let FORK go on, with copies of continuations if CONTINUATIONS-P. Return how it differs from
RECORD."
  (let ((way (if continuations-p :fork :fork-alone)) (*followed* '()))
    (on-the-way way
      (run:call-in-fork fork
                        (lambda ()
                          (run:add-observer #'look-on-script)
                          (compared way record (finish-by-script)))))))

(defun rewind-differences (record)
  "Go back to where the run here was forked, and on again. Return how that differs from RECORD."
  (on-the-way :rewind
    (let ((*followed* '()))
      (base:take-messages)
      (rewind-to (script-at *script*)))
    (telling (record)
      (let* ((before (accord-moment))
             (moments (cons before (go-on-by-script (script-ticks *script*)))))
        (append (compared :rewind record moments)
                (loop for (tick nil nil texts) in moments
                      when (find-if (lambda (text) (search "The rewound run differs" text)) texts)
                        collect (list :rewind :strayed tick)))))))

(defun load-differences (record file)
  "Let the run that is saved in FILE go on. Return how it differs from RECORD."
  (on-the-way :load
    (telling (record)
      (run:with-loaded-simulation (file)
        (run:add-observer #'look-on-script)
        (let ((moments (finish-by-script)))
          (if (run:simulation-journal time:*simulation*)
              (compared :load record moments)
              (accord-differences :load (record-moments record) '() moments '())))))))

(defun silent-moments (record)
  "Return those moments in RECORD at whose ticks nothing was asked: all of these can be told in the
midst of a replay."
  (remove-if (lambda (moment) (find (first moment) (record-entries record) :key #'first))
             (record-moments record)))

(defun replay-differences (record)
  "Replay the journal of RECORD. Return how that differs."
  (on-the-way :replay
    (let ((moments '()))
      (run::call-with-replay
       (lambda ()
         (push (accord-moment) moments)
         (accord-differences :replay (append (silent-moments record) (last (record-moments record)))
                             (record-entries record) moments (accord-entries)))
       (record-journal record)
       :observer (lambda (simulation)
                   (when (< (run:simulation-tick simulation) (script-ticks *script*))
                     (push (list (run:simulation-tick simulation) (run:state-digest)) moments)))))))

;;; All ways of a script.

(defun saved-or-refused (file)
  "Save the run here in FILE. Return NIL, or why that is refused, a list of strings."
  (handler-case (progn (run:save-simulation file) nil)
    (run:unsavable (refusal) (mapcar #'kind-of-refusal (run:unsavable-parts refusal)))
    (base:misuse (refusal) (list (kind-of-refusal (princ-to-string refusal))))))

(defun kind-of-refusal (text)
  "Return what TEXT, why a run is not saved, has in common with others; or TEXT."
  (or (find-if (lambda (words) (search words text))
               '("is under way" "an event of SCHEDULE waits" "was requested" "withdrawn"
                 "its journal has" "has been defined anew"))
      text))

(defvar *save-refusals* '() "Why runs could not be saved, strings.")

(defun plain-differences (names record file)
  "Let a run of NAMES go by *SCRIPT* that keeps neither journal nor forks, and save it in FILE
unless that is NIL. Return how it, or what was saved, differs from RECORD."
  (on-the-way :plain
    (run:with-simulation (names :seed (script-seed *script*) :thinking (script-thinking *script*))
      (let ((refusals '()) (*followed* '()))
        (begin-by-script)
        (when file
          (setf refusals (saved-or-refused file)
                *save-refusals* (append refusals *save-refusals*)))
        (append (accord-differences :plain (record-moments record) '() (finish-by-script) '())
                (and file (null refusals) (load-differences record file)))))))

(defun recorded (beginning)
  "Let the run here go to its end. Return the record of that since the moment BEGINNING."
  (let* ((moments (cons beginning (finish-by-script)))
         (journal (end-journal time:*simulation*)))
    (make-record :moments moments :entries (accord-entries)
                 :answers *followed*
                 :journal (run::copied-journal journal (tick-of-run)))))

(defun differences-of-run (names file)
  "Return how what becomes of a run of NAMES by *SCRIPT* differs from that, its record, and whether
it was saved in FILE."
  (let ((*followed* '()) differences record saved-p)
    (run:with-simulation (names :seed (script-seed *script*) :thinking (script-thinking *script*)
                                :journal t :keep (script-keep *script*))
      (let* ((beginning (begin-by-script))
             (fork (run:fork-simulation :continuations t))
             (alone (run:fork-simulation)))
        (setf saved-p (null (saved-or-refused file))
              record (recorded beginning)
              differences (append (fork-differences record fork t)
                                  (telling (record) (fork-differences record alone nil))
                                  (rewind-differences record)))))
    (values differences record saved-p)))

(defun script-differences (*script*)
  "Return in how many ways *SCRIPT* comes to something else, a list (way what where)."
  (let ((names (define-accord-world *script*)) (*error-output* (make-broadcast-stream))
        (*standard-output* (make-broadcast-stream)) (base:*echo-output* (make-broadcast-stream))
        (rpl:*runaway-limit* 2000))
    (keeping-often
      (with-temporary-file (file)
        (multiple-value-bind (differences record saved-p) (differences-of-run names file)
          (append differences
                  (and saved-p (load-differences record file))
                  (with-temporary-file (other)
                    (plain-differences names record (if saved-p nil other)))
                  (replay-differences record)))))))

;;; The shortest script that comes to the same disagreement.

(defun without-each (list)
  "Return the lists that LIST is without one of its elements."
  (loop for tail on list collect (append (ldiff list tail) (rest tail))))

(defun with-steps (script steps)
  (let ((copy (copy-script script)))
    (setf (script-steps copy) steps)
    copy))

(defun shorter-deeds (deed)
  "Return what DEED is without one thing that its continuation does, or with only that done."
  (case (first deed)
    (command (destructuring-bind (name command resource arguments &rest deeds) deed
               (append deeds
                       (loop for fewer in (without-each deeds)
                             collect (list* name command resource arguments fewer)))))
    (do-later (fifth deed))))

(defun shorter-scripts (script)
  "Return scripts like SCRIPT that are shorter by a little."
  (let ((steps (script-steps script)))
    (append
     (mapcar (lambda (fewer) (with-steps script fewer)) (without-each steps))
     (loop for (step . others) on steps
           for (tick place deed) = step
           append (loop for shorter in (shorter-deeds deed)
                        collect (with-steps script
                                  (append (subseq steps 0 (position step steps :test #'eq))
                                          (list (list tick place shorter)) others))))
     (flet ((but (&rest slots)
              (let ((copy (copy-script script)))
                (loop for (reader value) on slots by #'cddr
                      do (funcall (fdefinition (list 'setf reader)) value copy))
                (list copy))))
       (append (and (rest (script-robots script))
                    (but 'script-robots (list (first (script-robots script)))))
               (and (rest (script-clauses script))
                    (but 'script-clauses (list (first (script-clauses script)))))
               (and (< (script-at script) (1- (script-ticks script)))
                    (but 'script-ticks (1- (script-ticks script)))))))))

(defun kinds-of-differences (differences)
  (mapcar (lambda (difference) (subseq difference 0 2)) differences))

(defun shortest-script (script)
  "Return the shortest script that can be made of SCRIPT and disagrees in a way that it does, and
how."
  (let ((kind (first (kinds-of-differences (script-differences script)))))
    (loop (let ((shorter (find-if (lambda (shorter)
                                    (member kind (kinds-of-differences (script-differences shorter))
                                            :test #'equal))
                                  (shorter-scripts script))))
            (if shorter
                (setf script shorter)
                (return (values script (script-differences script))))))))

;;; Many scripts.

(defun disagreements-of-runs (runs seed)
  "Return a list (script difference...) for each of so many RUNS, from SEED on, that does not come
to the same on all ways; and why runs could not be saved, each as often as it was so."
  (let ((*save-refusals* '()))
    (values (loop for each from seed repeat runs
                  for script = (random-script each)
                  for differences = (script-differences script)
                  when differences collect (cons script differences))
            *save-refusals*)))

(test agreement.of-random-runs
  "Forked, rewound, saved and replayed; commands, continuations, events, kickers and plans."
  (let ((disagreements (disagreements-of-runs 40 1)))
    (is (null disagreements) "~{~S~%~}" (mapcar #'rest disagreements))))

(test agreement.is-not-taken-for-granted
  "Where forks share dice with their originals that is found, and comes down to a few steps."
  (let ((method (defmethod base:copy-plan-value :around ((dice base:dice) fork)
                  (declare (ignore fork))
                  dice)))
    (unwind-protect
         (let ((found (first (disagreements-of-runs 10 1))))
           (is-true found)
           (multiple-value-bind (script differences) (shortest-script (first found))
             (is (>= 3 (length (script-steps script))))
             (is-true differences)))
      (remove-method #'base:copy-plan-value method))))
