;;;; own-definitions.lisp -- WITH-OWN-DEFINITIONS: definitions that are undone at the end.

(in-package :ars-magna.definitions)

(export '(*variables-to-restore* value-to-restore overwrite-object call-with-own-definitions))

(defun overwrite-object (object model)
  "Copy all slots of MODEL to OBJECT, a structure of the same type. Return OBJECT."
  (dolist (name (class-slot-names (class-of object)) object)
    (unless (eql (slot-value object name) (slot-value model name))
      (setf (slot-value object name) (slot-value model name)))))

(defun entry-snapshot (entry)
  "Return a list: ENTRY, a copy of its object, and a list of its variable's value (NIL if unbound)."
  (let ((variable (entry-variable entry)))
    (list entry
          (copy-structure (entry-object entry))
          (and variable (boundp variable) (list (global-value variable))))))

(defun restore-registry (registry kept)
  (let ((now (registry-entries registry))
        (then (mapcar #'first kept)))
    (with-lock (*registries-lock*) (set-entries registry then))
    (mapc #'undefine-entry (set-difference now then))
    (loop for (entry copy value) in kept
          do (overwrite-object (entry-object entry) copy)
             (when value
               (setf (global-value (entry-variable entry)) (first value))))
    (mapc #'redo-definition (registry-objects registry))))

(defvar *own-definitions-thread* nil "The thread that is inside WITH-OWN-DEFINITIONS, or NIL.")

(defun enter-own-definitions ()
  "Record that this thread enters WITH-OWN-DEFINITIONS. Return the value of *OWN-DEFINITIONS-THREAD*
to restore afterwards. Signals MISUSE if another thread is inside."
  (let ((other (compare-and-swap (symbol-value '*own-definitions-thread*) nil
                                 (current-thread))))
    (unless (member other (list nil (current-thread)))
      (reject-use "Another thread is inside with-own-definitions. Wait for that thread."))
    other))

(defgeneric value-to-restore (value)
  (:documentation "Return what has replaced VALUE, the value of a variable to be restored, in the
meantime; VALUE itself if nothing has.")
  (:method (value) value))

(defvar *variables-to-restore* '()
  "Variables that WITH-OWN-DEFINITIONS restores. Each layer adds its own.")

(defun call-with-own-definitions (function)
  "Call FUNCTION, then undo its definitions; see WITH-OWN-DEFINITIONS."
  (let* ((outer (enter-own-definitions))
         (variables *variables-to-restore*)
         (values (mapcar #'symbol-value variables))
         (kept (loop for registry in *registries*
                     collect (cons registry
                                   (mapcar #'entry-snapshot (registry-entries registry))))))
    (in-any-case
      (funcall function)
      (loop for (registry . entries) in kept
            do (restore-registry registry entries))
      (loop for variable in variables
            for value in values
            do (set variable (value-to-restore value)))
      (setf *own-definitions-thread* outer))))

(addition with-own-definitions)
(defmacro with-own-definitions (() &body body)
  "Run BODY. Then undo all definitions, redefinitions and undefinitions by BODY (of maps, robots,
kickers and so on), even after an error. Made for tests. Return the values of BODY. If BODY
redefines the map of a run, that run ends; start another with SIMULATOR. All threads share
definitions; so if another thread is inside this macro, it signals MISUSE."
  `(call-with-own-definitions (lambda () ,@body)))
