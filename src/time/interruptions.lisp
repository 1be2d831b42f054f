;;;; interruptions.lisp -- whose request was interrupted last on a resource, and by whose.

(in-package :ars-magna.time)

(export '(request-name note-interruption interruption interruption-tick interruption-what
          interruption-asker interruption-by interruption-by-asker))

(defgeneric request-name (request)
  (:documentation "Return what REQUEST asks for, as people call it.")
  (:method ((request request)) (request-operator request)))

(defstruct (interruption (:constructor make-interruption (tick what asker by by-asker))
                         (:copier nil))
  "That WHAT, asked for by ASKER, was interrupted in TICK by BY, which BY-ASKER asked for."
  (tick 0 :type tick-count :read-only t)
  (what nil :read-only t)
  (asker nil :read-only t)
  (by nil :read-only t)
  (by-asker nil :read-only t))

(document-functions
  interruption-tick "Return the tick in which it was."
  interruption-what "Return the name of what was interrupted."
  interruption-asker "Return a note of who had asked for that."
  interruption-by "Return the name of what interrupted it."
  interruption-by-asker "Return a note of who had asked for that.")

(defun note-interruption (request rival tick)
  "Remember, for people to read, that RIVAL interrupts REQUEST on the resource of that in TICK."
  (let ((resource (event-resource request)))
    (when (resource-p resource)
      (setf (resource-interruption resource)
            (make-interruption tick
                               (request-name request) (request-asker request)
                               (request-name rival) (request-asker rival))))))

(define-shared interruption)
