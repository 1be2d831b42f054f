;;;; failures.lisp -- which command a robot carries out for whom, and which failed last.

(in-package :ars-magna.command)

(export '(command-failure under-way-text interruption-text failure-sentences))

(defstruct (command-failure (:conc-name failure-)
                            (:constructor make-failure
                                (tick asked command resource arguments asker code text
                                 interrupter))
                            (:copier nil))
  "COMMAND, issued by ASKER after the tick ASKED, ended in TICK with the error CODE and the message
TEXT. INTERRUPTER is a list (name asker) for the command that interrupted COMMAND, if known."
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
  "Return the record of an interruption of REQUEST in TICK, or NIL. The interruption may have the
number of the next tick, because a tick is counted after its requests are performed."
  (let ((interruption (resource-interruption (event-resource request))))
    (and interruption
         (<= tick (interruption-tick interruption) (1+ tick))
         (eq (request-name request) (interruption-what interruption))
         interruption)))

(defun record-failure (operation code text)
  (let* ((tick (timeline-tick (operation-timeline operation)))
         (interruption (and (eq code :interrupt) (interruption-of operation tick))))
    (setf (robot-failure (resource-robot (operation-resource operation)))
          (make-failure (if interruption (interruption-tick interruption) tick)
                        (operation-asked operation) (request-name operation)
                        (resource-for-users operation) (operation-arguments operation)
                        (request-asker operation) code text
                        (and interruption
                             (list (interruption-by interruption)
                                   (interruption-by-asker interruption)))))))

;;; The newest request always wins, whether it comes from the prompt, a plan, a continuation or a
;;; program. If several of them drive one robot, these functions show which one does so now.

(defmethod request-name ((operation operation))
  (command-name (operation-command operation)))

(defun current-request (resource)
  "Return the request that RESOURCE, a robot or part, carries out, or NIL. A track counts only if
the camera carries out nothing else."
  (let ((event (resource-event resource))
        (track (and (camera-p resource) (camera-tracking resource))))
    (cond ((typep event 'request) event)
          (track (track-operation track))
          (t (some #'current-request (inner-resources resource))))))

(defun newest-interruption-record (resource)
  "Return the last interruption of a command of RESOURCE or, for a robot, of its mind or radio;
or NIL."
  (first (stable-sort (loop for each in (cons resource (inner-resources resource))
                            when (resource-interruption each) collect it)
                      #'> :key #'interruption-tick)))

(defun check-resource (operator resource)
  (unless (typep resource '(or robot part))
    (reject-argument operator 'resource resource "a robot, or a part of one")))

(addition under-way)
(defun under-way (resource)
  "Return two values: the name of the command that RESOURCE, a robot or part, executes or is about
to begin; and who issued the command, a string such as \"the prompt\", \"the plan fetch\", \"the
continuation of robot-turn\" or \"Lisp (main thread)\". A camera that only tracks executes
CAMERA-TRACK, and a robot that only thinks or sends executes THINK or
ROBOT-SEND. Return NIL if RESOURCE executes no
command. A newer command always interrupts an older command."
  (check-resource 'under-way resource)
  (let ((occupant (current-request resource)))
    (when occupant
      (values (request-name occupant) (asker-note-text (request-asker occupant))))))

(addition last-interruption)
(defun last-interruption (resource)
  "Return the last interruption of a command of RESOURCE, a robot or a part, or NIL: a list (what
asker by-what by-asker tick) with the names of the interrupted and the interrupting command, each
with a string that says who issued it, and the tick. THINK and ROBOT-SEND count as commands of
the robot."
  (check-resource 'last-interruption resource)
  (let ((interruption (newest-interruption-record resource)))
    (when interruption
      (list (interruption-what interruption)
            (asker-note-text (interruption-asker interruption))
            (interruption-by interruption)
            (asker-note-text (interruption-by-asker interruption))
            (interruption-tick interruption)))))

(defun under-way-text (resource)
  "Return a text on the command that RESOURCE executes, and who issued it; NIL if there is none."
  (multiple-value-bind (name asker) (under-way resource)
    (when name (format nil "~(~A~), for ~A" name asker))))

(defun interruption-text (resource)
  "Return a text on the last interruption of a command of RESOURCE; NIL if there was none."
  (let ((interruption (last-interruption resource)))
    (when interruption
      (format nil "~(~A~), for ~A, by ~(~A~), for ~A, at tick ~D"
              (first interruption) (second interruption) (third interruption)
              (fourth interruption) (fifth interruption)))))

;;; Texts about the command that failed last.

(defun argument-as-typed (argument)
  "Return ARGUMENT of a command as you would type it in Lisp, if possible."
  (typecase argument
    ((or robot part) (resource-form argument))
    (designator `(find-designator ,(robot-name (designator-robot argument))
                                  ,(designator-number argument)))
    ((or symbol cons) (if (constantp argument) argument `',argument))
    (t argument)))

(defun call-text (failure)
  (let ((*print-case* :downcase) (*read-default-float-format* 'double-float))
    (safe-text (list* (failure-command failure)
                     (mapcar #'argument-as-typed
                             (cons (failure-resource failure) (failure-arguments failure)))))))

(addition last-failure)
(defun last-failure (resource)
  "Return the last failure or interruption of a command to RESOURCE, a robot or part, or to another
part of the same robot, as a property list:
- :COMMAND, the command's name; :CALL, the call, a string
- :FOR, who issued the command; :ASKED, the tick after which it was issued
- :TICK, the tick in which the command ended; :ERROR, the error code; :TEXT, the message
- :BY, the name of the interrupting command, if known; :BY-FOR, who issued the interrupting command
Return NIL if no command has failed. See WHY."
  (check-resource 'last-failure resource)
  (let ((failure (robot-failure (resource-robot resource))))
    (when failure
      (destructuring-bind (&optional by by-asker) (failure-interrupter failure)
        (list :command (failure-command failure) :call (call-text failure)
              :for (asker-note-text (failure-asker failure))
              :asked (failure-asked failure) :tick (failure-tick failure)
              :error (failure-code failure) :text (failure-text failure)
              :by by :by-for (and by (asker-note-text by-asker)))))))

(defun failure-sentences (resource)
  "Return a list of sentences about the LAST-FAILURE of RESOURCE: the call and its tick, the result,
the meaning of the result and what to try."
  (destructuring-bind (&key call for asked tick error text by by-for &allow-other-keys)
      (last-failure resource)
    (if (null error)
        (list (format nil "No command of ~A has failed." (resource-robot resource)))
        (remove nil
                (list (format nil "~A, issued by ~A after tick ~D, ended at tick ~D with ~S: ~A."
                              call for asked tick error text)
                      (and by (format nil "The command was interrupted by ~(~A~), issued by ~
                                           ~A." by by-for))
                      (error-code-meaning error)
                      (error-code-remedy error))))))
