;;;; failing.lisp -- which command failed last on a robot: what is remembered of it.

(in-package :ars-magna.command)

(export '(command-failure))

(defstruct (command-failure (:conc-name failure-)
                            (:constructor make-failure
                                (tick asked command resource arguments asker code text
                                 interrupter))
                            (:copier nil))
  "That COMMAND, asked for after the tick ASKED by ASKER, ended in TICK with the error CODE, of
which TEXT was the message. INTERRUPTER is a list (name asker) of what interrupted it, if that is
known."
  (tick 0 :type fixnum :read-only t)
  (asked 0 :type fixnum :read-only t)
  (command nil :type symbol :read-only t)
  (resource nil :read-only t)
  (arguments '() :type list :read-only t)
  (asker nil :read-only t)
  (code nil :read-only t)
  (text "" :type string :read-only t)
  (interrupter '() :type list :read-only t))

(defun interruption-of (request tick)
  "Return what is known of the interruption of REQUEST just now, when TICK has been counted; or NIL.
Where requests are carried out, the tick that they begin has not been counted yet."
  (let ((interruption (resource-interruption (event-resource request))))
    (and interruption
         (<= tick (interruption-tick interruption) (1+ tick))
         (eq (request-name request) (interruption-what interruption))
         interruption)))

(defun note-failure (robot request code text &key tick asked resource)
  "Let ROBOT remember that REQUEST, which was asked of RESOURCE after the tick ASKED, ends in TICK
with the error CODE and the message TEXT."
  (let ((interruption (and (eq code :interrupt) (interruption-of request tick))))
    (setf (robot-failure robot)
          (make-failure (if interruption (interruption-tick interruption) tick)
                        asked (request-name request) resource (request-arguments request)
                        (request-asker request) code text
                        (and interruption
                             (list (interruption-by interruption)
                                   (interruption-by-asker interruption)))))))
