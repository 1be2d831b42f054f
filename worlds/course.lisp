;;;; course.lisp -- programs of continuations notice that somebody else has taken their robot over.

;;; A command that is taken over tells its continuation :INTERRUPT. But a program may be waiting for
;;; a camera when somebody commands the robot, as STOP does. So it counts how often the robot is
;;; asked for.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun asked-so-far (robot) (ars-magna.time:resource-asked robot))

(defstruct (course (:constructor make-course (robot &aux (asked (asked-so-far robot))))
                   (:copier nil))
  "A robot that is given one command after the other, and how often it should have been asked for by
now: if it was more often, somebody else has taken it over."
  (robot nil :type robot :read-only t)
  (asked 0 :type integer))

(defun own (course)
  "Return the robot of COURSE, to which that is just about to give a command."
  (incf (course-asked course))
  (course-robot course))

(defun taken-p (course)
  "True if somebody else has taken the robot of COURSE over."
  (/= (course-asked course) (asked-so-far (course-robot course))))

(defun over-p (course err)
  "True if COURSE is over, as its last command has ended with the error code ERR, or somebody else
has taken its robot over."
  (or (eq err :interrupt) (taken-p course)))
