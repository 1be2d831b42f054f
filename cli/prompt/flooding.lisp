;;;; flooding.lisp -- what comes of the commands of plans may be more than anybody reads.

(in-package :ars-magna.cli)

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
