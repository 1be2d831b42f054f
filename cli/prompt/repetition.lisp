;;;; repetition.lisp -- what comes again and again, or is more than anybody reads.

(in-package :ars-magna.cli)

;;; An error is shown three times, then at the tenth, the hundredth time and so on. A transcript has
;;; it all. What a line asks for fails once for each line, so the count begins anew with the next;
;;; what runs by itself is counted on, until its code is another, or it is in another run.

(defstruct (tally (:copier nil))
  "How often an error was told, in CODE, a function that runs by itself, or NIL, last at TICK."
  (count 0 :type (integer 0))
  (code nil)
  (tick 0 :type integer))

(defun item-at-fault (message)
  "Return the item of MESSAGE that says whose code that runs by itself is at fault, or NIL."
  (find-if #'recurring-code (message-items message)))

(defun tick-of (message)
  (let ((run (message-run message)))
    (if run (simulation-tick run) 0)))

(defun tally-for (message told)
  (let* ((text (message-text message))
         (code (let ((item (item-at-fault message)))
                 (and item (recurring-code item))))
         (tally (gethash text told)))
    (cond ((and tally (eq code (tally-code tally)) (<= (tally-tick tally) (tick-of message)))
           tally)
          (t (when (< *message-limit* (hash-table-count told)) (clrhash told))
             (setf (gethash text told) (make-tally :code code))))))

(defun power-of-ten-p (number)
  (or (= 1 number)
      (and (zerop (mod number 10)) (power-of-ten-p (/ number 10)))))

(defun repeated-often-p (message told)
  "Count MESSAGE in TOLD. True if it is one of many alike that is not shown."
  (let* ((tally (tally-for message told)) (count (incf (tally-count tally))))
    (setf (tally-tick tally) (tick-of message))
    (and (< 3 count) (not (power-of-ten-p count)))))

(defun repetition-text (message told)
  "Return what is to be said of how often MESSAGE, which is shown, was told by TOLD, or NIL."
  (let* ((tally (and (eq :error (message-kind message)) (gethash (message-text message) told)))
         (count (if tally (tally-count tally) 0))
         (item (item-at-fault message)))
    (when (<= 3 count)
      (format nil "That has come up ~D times; it is shown again after ~D.~@[ ~A~] PAUSE stops ~
                   time.~%"
              count
              (loop for next = 10 then (* 10 next) when (< count next) return next)
              (and item (recurring-remedy item))))))

(defun count-anew (told)
  "Forget how often was told by TOLD what a line has asked for."
  (maphash (lambda (text tally) (unless (tally-code tally) (remhash text told))) told))

(defun take-counts (told others)
  "Let TOLD count on from what the table OTHERS has."
  (maphash (lambda (text tally)
             (let ((own (gethash text told)))
               (when (or (null own) (< (tally-count own) (tally-count tally)))
                 (setf (gethash text told)
                       (make-tally :count (tally-count tally) :code (tally-code tally)
                                   :tick (tally-tick tally))))))
           others))

;;; What comes of the commands of plans may be more than anybody reads.

(define-constant +flood+ 50
  :documentation "After how many messages of others' commands, with no line between them, it is
said how they can be hushed.")

(defstruct (flood (:copier nil))
  "How many messages of others' commands have been SHOWN since a line was read, or, once they were a
flood, in all."
  (shown 0 :type fixnum))

(defun flood-text (flood count)
  "Count COUNT more messages in FLOOD. Return, once, what is to be said where they are a flood; else
NIL."
  (let* ((before (flood-shown flood)) (now (+ before count)))
    (setf (flood-shown flood) now)
    (and (< before +flood+)
         (<= +flood+ now)
         (format nil "ECHO OFF hushes what comes of the commands that plans and programs ~
                      give.~%"))))

(defun begin-flood-anew (flood)
  "Begin to count anew in FLOOD, unless that was one."
  (when (< (flood-shown flood) +flood+)
    (setf (flood-shown flood) 0)))
