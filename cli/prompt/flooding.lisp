;;;; flooding.lisp -- what comes of the commands of plans may be more than anybody reads.

(in-package :ars-magna.cli)

(define-constant +flood+ 50
  :documentation "After how many messages of others' commands, with no line between them, a session
says how they can be hushed.")

(defun flood-text (session messages)
  "Count those of MESSAGES, which are shown in SESSION, that are of others' commands. Return, once,
what is to be said where they are a flood; else NIL."
  (let* ((before (session-others-told session))
         (now (+ before (count-if #'others-p messages))))
    (setf (session-others-told session) now)
    (and (< before +flood+)
         (<= +flood+ now)
         (terminal-p session)
         (format nil "ECHO OFF hushes what comes of the commands that plans and programs ~
                      give.~%"))))

(defun count-others-anew (session)
  "Begin to count anew what SESSION shows of others' commands, unless that was a flood."
  (when (< (session-others-told session) +flood+)
    (setf (session-others-told session) 0)))
