;;;; language.lisp -- how code is compiled; global values, events and weak references.

(in-package :ars-magna.host)

(export '(*hot* compiler-note declaim-final surely form-calling global-value define-global
          weak-table-p like-table make-weak weak-value define-event attend tell-listeners))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *hot* '(optimize (speed 3) (safety 1) (debug 0) (sb-ext:inhibit-warnings 3))
    "How a function that a profile pointed at is compiled: (declare #.*hot*)."))

(deftype compiler-note ()
  "The condition by which the compiler says that it cannot make code fast."
  'sb-ext:compiler-note)

(defmacro declaim-final (&rest types)
  "Promise the compiler that no type will include one of the structures TYPES from here on."
  `(declaim (sb-ext:freeze-type ,@types)))

;; For what has been checked already, but in a way that the compiler does not see through.
(defmacro surely (type form)
  "Return the value of FORM, of which the compiler may believe that it is of TYPE."
  `(sb-ext:truly-the ,type ,form))

(defun form-calling (function body &rest arguments)
  "Return a form that calls FUNCTION with a function that runs BODY, forms, and then ARGUMENTS. The
function is on the stack, and ends with the call."
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (,function #'body ,@arguments)))

;;;; Values at top level, beneath whatever a thread has bound

(declaim (inline global-value (setf global-value)))
(defun global-value (symbol)
  "Return the value that the variable SYMBOL has at top level, whatever this thread has bound it to.
Can be set. Signals UNBOUND-VARIABLE if it has none."
  (sb-ext:symbol-global-value symbol))

(defun (setf global-value) (value symbol)
  (setf (sb-ext:symbol-global-value symbol) value))

(defmacro define-global (name value documentation)
  "Define the variable NAME with VALUE, once it is loaded; it is never bound, and quick to read."
  `(sb-ext:define-load-time-global ,name ,value ,documentation))

;;;; Hash tables

(defun like-table (table)
  "Return an empty hash table like TABLE."
  (make-hash-table :test (hash-table-test table)
                   :size (max 7 (hash-table-count table))
                   :weakness (sb-ext:hash-table-weakness table)
                   :synchronized (sb-ext:hash-table-synchronized-p table)))

(defun weak-table-p (table)
  "True if the hash TABLE loses entries when nothing else holds them."
  (and (sb-ext:hash-table-weakness table) t))

;;;; Knowing of something without keeping it from being forgotten

(defun make-weak (object)
  "Return what leads to OBJECT as long as anything else does."
  (sb-ext:make-weak-pointer object))

(defun weak-value (weak)
  "Return the object that WEAK, which MAKE-WEAK has returned, leads to, or NIL if it is gone."
  (values (sb-ext:weak-pointer-value weak)))

;;;; Events

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
