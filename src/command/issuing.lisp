;;;; issuing.lisp -- a command is issued: what is refused, and what is said of it.

(in-package :ars-magna.command)

;;; What is of another run.

(defun world-of-argument (argument)
  "Return the world that ARGUMENT, of a command, is in, or NIL if it is in none."
  (typecase argument
    (designator (and (designator-robot argument) (robot-world (designator-robot argument))))
    (part (robot-world (part-robot argument)))
    (robot (robot-world argument))
    (thing (thing-world argument))))

(defun check-of-this-run (command resource arguments)
  "Signal MISUSE if one of ARGUMENTS, of COMMAND on RESOURCE, is in another world than that."
  (let ((world (robot-world (resource-robot resource))))
    (dolist (argument arguments)
      (let ((other (world-of-argument argument)))
        (unless (or (null other) (eq other world))
          (reject-use "~(~A~): ~A is of another run than ~A. ~:[Robots' names and FIND-THING lead ~
                       to those of a run~;A robot's designators come from searches of its cameras~
                       ~]; of a fork, (counterpart OBJECT FORK) is what one is there."
                      (command-name command) argument resource (designator-p argument)))))))

(defun check-continuation (command continuation)
  "Signal WRONG-ARGUMENT if CONTINUATION cannot be called with what COMMAND tells at its end."
  (let ((results (command-results command)))
    (when (and continuation
               (or (functionp continuation) (fboundp continuation))
               (not (callable-with-p continuation (+ 2 (length results)))))
      (let ((*print-pretty* nil))
        (reject-argument (command-name command) 'continuation continuation
                         (format nil "one that takes ~(~A~), as (continuation ~:*~(~A~) ...) ~
                                      does, not ~(~:A~)"
                                 (list* 'err (spec-name (command-resource command))
                                        (mapcar #'spec-name results))
                                 (lambda-list-of continuation)))))))

;;; What is said once for each name.

(defun doubt-angles (command world arguments)
  "Say once if one of ARGUMENTS, of COMMAND in WORLD, is an angle perhaps meant in degrees."
  (loop for spec in (command-parameters command)
        for argument in arguments
        when (eq 'angle (spec-type spec))
          do (doubt-angle (command-name command) world argument)))

(defun kept-p (world)
  "True if what is asked of a robot in WORLD, one that top-level code works in, waits for a run to
begin, or to go on."
  (let ((timeline (world-timeline world)))
    (and (eq world (map-resident (world-map world)))
         (not (live-p timeline))
         (not (timeline-passing-p timeline)))))

(defun tell-if-kept (command robot)
  "Say once for ROBOT that COMMAND is kept for a later run, if so."
  (when (kept-p (robot-world robot))
    (warn-once (list :kept (robot-name robot)) (robot-world robot)
               (format nil "~(~A~) is kept for a later run, as none of ~A is under way. (simulator ~
                            '~(~A~)) begins one, and does then what was asked before."
                       (command-name command) robot (robot-name robot)))))

;;; Issuing.

(defun occupied (command resource)
  "Return what COMMAND, which is issued on RESOURCE, occupies."
  (let ((reader (command-occupies command)))
    (if reader (funcall reader resource) resource)))

(defun issue (command resource arguments continuation)
  "Issue COMMAND on RESOURCE with ARGUMENTS, which have been checked and of which lists are copied;
CONTINUATION may be NIL. Return nothing: the command takes effect in the next tick. Signals MISUSE
if the robot's run is over, or an argument is of another run; WRONG-ARGUMENT for a continuation that
takes another number of arguments."
  (check-in-run resource (command-name command))
  (check-of-this-run command resource arguments)
  (check-continuation command continuation)
  (let* ((robot (resource-robot resource))
         (world (robot-world robot))
         (timeline (world-timeline world))
         (arguments (if (some #'consp arguments)
                        (given (command-name command) "arguments" arguments)
                        arguments)))
    (note-asked (occupied command resource))
    (post (make-operation command (occupied command resource) arguments continuation timeline)
          timeline)
    (doubt-angles command world arguments)
    (tell-if-kept command robot)
    (values)))
