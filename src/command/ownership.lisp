;;;; ownership.lisp -- whose command a robot or part carries out: for people to read.

(in-package :ars-magna.command)

(export '(under-way-text interruption-text))

;;; The newest request always wins, whoever asks: the prompt, a plan, a continuation, a program. So
;;; whoever drives a robot from several sides at once needs to see who drives it now.

(defmethod request-name ((operation operation))
  (command-name (operation-command operation)))

(defun mind-of (resource)
  "Return the mind of RESOURCE if that is a robot, or NIL."
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
  (let ((own (resource-interruption resource))
        (thought (and (mind-of resource) (resource-interruption (mind-of resource)))))
    (cond ((null own) thought)
          ((null thought) own)
          ((> (interruption-tick thought) (interruption-tick own)) thought)
          (t own))))

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
