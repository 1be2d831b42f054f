;;;; failures.lisp -- whose command a robot carries out, and which failed last: for people.

(in-package :ars-magna.command)

(export '(command-failure under-way-text interruption-text failure-sentences))

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

(defun note-failure (operation code text)
  "Let the robot of OPERATION remember that it ends with the error CODE and the message TEXT."
  (let* ((tick (timeline-tick (operation-timeline operation)))
         (interruption (and (eq code :interrupt) (interruption-of operation tick))))
    (setf (robot-failure (resource-robot (operation-resource operation)))
          (make-failure (if interruption (interruption-tick interruption) tick)
                        (operation-asked operation) (request-name operation)
                        (resource-told operation) (operation-arguments operation)
                        (request-asker operation) code text
                        (and interruption
                             (list (interruption-by interruption)
                                   (interruption-by-asker interruption)))))))

;;; The newest request always wins, whoever asks: the prompt, a plan, a continuation, a program. So
;;; whoever drives a robot from several sides at once needs to see who drives it now.

(defmethod request-name ((operation operation))
  (command-name (operation-command operation)))

(defun mind-of (resource)
  (and (robot-p resource) (robot-mind resource)))

(defun occupant (resource)
  "Return the request that RESOURCE, a robot or part, carries out, also in the background; or NIL."
  (let ((event (resource-event resource))
        (track (and (camera-p resource) (camera-tracking resource))))
    (cond ((typep event 'request) event)
          (track (track-operation track))
          ((mind-of resource) (occupant (mind-of resource))))))

(defun newest-interruption (resource)
  "Return the last interruption on RESOURCE, also of thoughts if it is a robot; or NIL."
  (first (stable-sort (loop for each in (list resource (mind-of resource))
                            when (and each (resource-interruption each)) collect it)
                      #'> :key #'interruption-tick)))

(defun check-resource (operator resource)
  (unless (typep resource '(or robot part))
    (reject-argument operator 'resource resource "a robot, or a part of one")))

(addition under-way)
(defun under-way (resource)
  "Return the name of the command that RESOURCE, a robot or part of one, carries out or waits to
begin, and who asked for it, a string such as \"the prompt\", \"the plan fetch\", \"the continuation
of robot-turn\" or \"Lisp (main thread)\". A camera that does nothing else but follow something
carries out CAMERA-TRACK, a robot that does nothing else but think THINK. NIL if there is none. The
newest command takes a resource over, whoever asks for it."
  (check-resource 'under-way resource)
  (let ((occupant (occupant resource)))
    (when occupant
      (values (request-name occupant) (note-text (request-asker occupant))))))

(addition last-interruption)
(defun last-interruption (resource)
  "Return what was interrupted last on RESOURCE, a robot or part of one, by a newer request: a list
(what asker by-what by-asker tick), the names of both, strings that say who asked for them, and the
tick in which it was. A robot's thoughts count. NIL if nothing ever was."
  (check-resource 'last-interruption resource)
  (let ((interruption (newest-interruption resource)))
    (when interruption
      (list (interruption-what interruption)
            (note-text (interruption-asker interruption))
            (interruption-by interruption)
            (note-text (interruption-by-asker interruption))
            (interruption-tick interruption)))))

(defun under-way-text (resource)
  "Return in words what RESOURCE is doing, and for whom; NIL if nothing."
  (multiple-value-bind (name asker) (under-way resource)
    (when name (format nil "~(~A~), for ~A" name asker))))

(defun interruption-text (resource)
  "Return in words what was interrupted last on RESOURCE; NIL if nothing ever was."
  (let ((interruption (last-interruption resource)))
    (when interruption
      (format nil "~(~A~), for ~A, by ~(~A~), for ~A, at tick ~D"
              (first interruption) (second interruption) (third interruption)
              (fourth interruption) (fifth interruption)))))

;;; Which command failed last, in words.

(defun argument-as-typed (argument)
  "Return ARGUMENT of a command as one would type it in Lisp, as far as one can."
  (let ((index (and (part-p argument) (part-index argument))))
    (typecase argument
      (robot (robot-name argument))
      (camera `(robot-camera ,(robot-name (part-robot argument)) ,index))
      (hand `(robot-hand ,(robot-name (part-robot argument)) ,index))
      (storage-bin `(robot-storage-bin ,(robot-name (part-robot argument)) ,index))
      (designator `(find-designator ,(robot-name (designator-robot argument))
                                    ,(designator-number argument)))
      ((or symbol cons) (if (constantp argument) argument `',argument))
      (t argument))))

(defun call-text (failure)
  (let ((*print-case* :downcase) (*read-default-float-format* 'double-float))
    (safe-text (list* (failure-command failure)
                     (mapcar #'argument-as-typed
                             (cons (failure-resource failure) (failure-arguments failure)))))))

(addition last-failure)
(defun last-failure (resource)
  "Return, as a property list, what failed or was interrupted last of the commands given to
RESOURCE, a robot or part of one, or to another part of that robot: :COMMAND, its name; :CALL, what
was asked for, a string; :FOR, who asked; :ASKED, the tick after which that was; :TICK, the one in
which it ended; :ERROR, the code; :TEXT, the message; :BY, what interrupted it, if that is known,
and :BY-FOR, who asked for that. NIL if none has failed. See WHY."
  (check-resource 'last-failure resource)
  (let ((failure (robot-failure (resource-robot resource))))
    (when failure
      (destructuring-bind (&optional by by-asker) (failure-interrupter failure)
        (list :command (failure-command failure) :call (call-text failure)
              :for (note-text (failure-asker failure))
              :asked (failure-asked failure) :tick (failure-tick failure)
              :error (failure-code failure) :text (failure-text failure)
              :by by :by-for (and by (note-text by-asker)))))))

(defun failure-sentences (resource)
  "Return a list of sentences about the LAST-FAILURE of RESOURCE: what was asked for and when, what
came of it, what that means and what to try."
  (destructuring-bind (&key call for asked tick error text by by-for &allow-other-keys)
      (last-failure resource)
    (if (null error)
        (list (format nil "No command of ~A has failed." (resource-robot resource)))
        (remove nil
                (list (format nil "~A, asked for by ~A after tick ~D, ended at tick ~D with ~S: ~A."
                              call for asked tick error text)
                      (and by (format nil "What took over was ~(~A~), asked for by ~A." by by-for))
                      (error-code-meaning error)
                      (error-code-remedy error))))))
