;;;; interruptions.lisp -- whose request was interrupted last on a resource, and by whose.

(in-package :ars-magna.time)

(export '(request-name note-interruption interruption))

(defgeneric request-name (request)
  (:documentation "Return what REQUEST asks for, as people call it.")
  (:method ((request request)) (request-operator request)))

(define-record (interruption (:constructor make-interruption (tick what asker by by-asker)))
  "That WHAT, asked for by ASKER, was interrupted in TICK by BY, which BY-ASKER asked for."
  (tick 0 tick-count "the tick in which it was" :export)
  (what nil t "the name of what was interrupted" :export)
  (asker nil t "a note of who had asked for that" :export)
  (by nil t "the name of what interrupted it" :export)
  (by-asker nil t "a note of who had asked for that" :export))

(defun note-interruption (request rival tick)
  "Remember, for people to read, that RIVAL interrupts REQUEST on the resource of that in TICK."
  (let ((resource (event-resource request)))
    (when (resource-p resource)
      (setf (resource-interruption resource)
            (make-interruption tick
                               (request-name request) (request-asker request)
                               (request-name rival) (request-asker rival))))))

(define-shared interruption)
