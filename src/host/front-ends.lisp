;;;; front-ends.lisp -- how a person is asked, where a program such as the prompt can ask one.

(in-package :ars-magna.host)

(export '(*front-end* serve-while-waiting hook-of-front-end ask-how-to-go-on input-of-programs))

(defvar *front-end* nil "The front end that can ask people, an object; NIL if there is none.")

(defgeneric serve-while-waiting (front-end)
  (:documentation "Do what FRONT-END has to do in this thread, which waits for another.
Called now and then.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric hook-of-front-end (front-end)
  (:documentation "Return the debugger's hook of FRONT-END, or NIL, for where an editor's has
nobody to ask.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric ask-how-to-go-on (front-end condition)
  (:documentation "Let a person choose how to go on after CONDITION, where whoever had been asked
has gone. Return if FRONT-END can ask nobody.")
  (:method (front-end condition) (declare (ignore front-end condition))))

(defgeneric input-of-programs (front-end stream)
  (:documentation "Return the stream that users' code in a run's threads reads instead of STREAM.")
  (:method (front-end stream) (declare (ignore front-end)) stream))
