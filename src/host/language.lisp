;;;; language.lisp -- compiler policy, global values, events and weak references.

(in-package :ars-magna.host)

(export '(*hot* compiler-note declaim-final assume-type form-calling global-value define-global
          weak-table-p make-similar-table make-weak weak-value define-event attend tell-listeners))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *hot* '(optimize (speed 3) (safety 1) (debug 0) (sb-ext:inhibit-warnings 3))
    "The policy for functions that a profile pointed at: (declare #.*hot*)."))

(deftype compiler-note ()
  "The condition by which the compiler reports that code will be slow."
  'sb-ext:compiler-note)

(defmacro declaim-final (&rest types)
  "Promise the compiler that the structure TYPES get no more subtypes."
  `(declaim (sb-ext:freeze-type ,@types)))

;; For values that were checked in a way that the compiler cannot see.
(defmacro assume-type (type form)
  "Return the value of FORM, which the compiler may assume to be of TYPE."
  `(sb-ext:truly-the ,type ,form))

(defun form-calling (function body &rest arguments)
  "Return a form that calls FUNCTION with a function that runs BODY, and then ARGUMENTS. That
function has dynamic extent."
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (,function #'body ,@arguments)))

;;;; Global values, regardless of bindings in a thread

(declaim (inline global-value (setf global-value)))
(defun global-value (symbol)
  "Return the global value of the variable SYMBOL, regardless of bindings in this thread. Can be
set. Signals UNBOUND-VARIABLE if it has none."
  (sb-ext:symbol-global-value symbol))

(defun (setf global-value) (value symbol)
  (setf (sb-ext:symbol-global-value symbol) value))

(defmacro define-global (name value documentation)
  "Define the variable NAME with VALUE, computed at load time. It is never bound, so it is fast to
read."
  `(sb-ext:define-load-time-global ,name ,value ,documentation))

;;;; Hash tables

(defun make-similar-table (table)
  "Return an empty hash table with the test, size and options of TABLE."
  (make-hash-table :test (hash-table-test table)
                   :size (max 7 (hash-table-count table))
                   :weakness (sb-ext:hash-table-weakness table)
                   :synchronized (sb-ext:hash-table-synchronized-p table)))

(defun weak-table-p (table)
  "True if the hash TABLE is weak."
  (and (sb-ext:hash-table-weakness table) t))

;;;; Weak references

(defun make-weak (object)
  "Return a weak reference to OBJECT."
  (sb-ext:make-weak-pointer object))

(defun weak-value (weak)
  "Return the object of WEAK, of MAKE-WEAK, or NIL if it was collected."
  (values (sb-ext:weak-pointer-value weak)))

;;;; Events

;;; An event is a variable with a list of function names, its listeners. The newest is called first.
;;; Because they are names, loading a file again adds none twice, and a redefined function takes
;;; effect.

(defmacro define-event (name documentation)
  "Define NAME, a variable, as an event. DOCUMENTATION says what listeners are called with."
  `(defvar ,name '() ,documentation))

(defmacro attend (event listener)
  "Add the function named LISTENER to EVENT, to be called before those added earlier."
  `(pushnew ',listener ,event))

(defun tell-listeners (listeners &rest arguments)
  "Call LISTENERS, the value of an event, with ARGUMENTS."
  (dolist (listener listeners)
    (apply listener arguments)))
