;;;; journal.lisp -- what was asked of a run, and when, so that it can be repeated exactly.

(in-package :ars-magna.run)

(export '(journal))

;;; A journal is a header, entries (tick operator argument ...) in the order in which they took
;;; effect, and the tick at which it ended. An operator is a name that DEFINE-OPERATOR has
;;; defined; robots, parts, things and designators stand in an entry as lists that name them (see
;;; references.lisp). What commands do is not in it, and need not be: a run is a function of what
;;; is.

(addition *journal-limit*)
(defparameter *journal-limit* 1000000
  "How many entries a journal holds at most (about 200 bytes each). One that is full says so, and
repeats the run up to there.")

(addition journal-p)
(define-record (journal (:constructor make-journal (header)))
  "The record of one run."
  (header '() list "the plist with which the run began: map, robots, seed, parameters, and what the
definitions were that decide it" :writable :addition)
  (newest-first '() list "its entries, the newest first" :writable)
  (length 0 fixnum "how many entries the journal has" :writable :addition)
  (end 0 tick-count "the tick at which the journal ends" :writable :addition)
  (remarks '() list "lists (tick kind text robot x y), the newest first: what is told of the run
that a replay cannot know. ROBOT is a name, a string, or NIL" :writable :export)
  (full-p nil boolean "there was something to note and no room for it" :writable))

(defmethod print-object ((journal journal) stream)
  (print-unreadable-object (journal stream :type t)
    (format stream "~D entr~:@P, to tick ~D" (journal-length journal) (journal-end journal))))

(addition journal-entries)
(defun journal-entries (journal)
  "Return the entries (tick operator argument ...) of JOURNAL, oldest first; do not alter them.
Signals WRONG-ARGUMENT."
  (check-argument journal-entries journal (journal-p journal) "a journal, as LOAD-JOURNAL returns")
  (reverse (journal-newest-first journal)))

(defun copied-journal (journal tick)
  "Return a journal that is like JOURNAL, of a run that has come to TICK, and goes on by itself."
  (let ((copy (copy-structure journal)))
    (setf (journal-header copy) (copy-list (journal-header journal)))
    (unless (journal-full-p copy) (setf (journal-end copy) tick))
    copy))

(defun truncated-journal (journal tick)
  "Return a journal that ends at TICK and until then is like JOURNAL. Signals WRONG-ARGUMENT for a
TICK that it does not reach."
  (unless (typep tick `(integer 0 ,(journal-end journal)))
    (reject-argument "replay" "until" tick
                     (format nil "a tick of the journal, from 0 to ~D" (journal-end journal))))
  (let ((copy (make-journal (journal-header journal))))
    (setf (journal-newest-first copy)
          (remove-if (lambda (entry) (>= (first entry) tick)) (journal-newest-first journal))
          (journal-length copy) (length (journal-newest-first copy))
          (journal-remarks copy) (remove-if (lambda (remark) (> (first remark) tick))
                                            (journal-remarks journal))
          (journal-end copy) tick)
    copy))
