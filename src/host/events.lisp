;;;; events.lisp -- what happens, for layers above to hear of.

(in-package :ars-magna.host)

(export '(define-event attend tell-listeners))

;;; An event is a variable that lists the names of the functions that are told of it. The newest
;;; listener is told first. As they are names, a file that is loaded again adds none twice, and what
;;; is defined anew is heard in its place.

(defmacro define-event (name documentation)
  "Define NAME, a variable, as an event; DOCUMENTATION says what listeners are called with."
  `(defvar ,name '() ,documentation))

(defmacro attend (event listener)
  "Let the function called LISTENER be told of EVENT, before those that are told already."
  `(pushnew ',listener ,event))

(defun tell-listeners (listeners &rest arguments)
  "Call LISTENERS, the value of an event, with ARGUMENTS."
  (dolist (listener listeners)
    (apply listener arguments)))
