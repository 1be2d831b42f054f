;;;; course.lisp -- how a program of continuations detects that another has taken over its robot.

;;; A newer command interrupts an older one, whose continuation receives :INTERRUPT. But a program
;;; may be waiting for a camera when another program, or STOP, commands the robot. So a COURSE
;;; compares how many commands the robot has received with how many the program itself has issued.

(in-package :ars-worlds)
(in-readtable :nisp)

(defun asked-so-far (robot) (ars-magna.time:resource-asked robot))

(defstruct (course (:constructor make-course (robot &aux (asked (asked-so-far robot))))
                   (:copier nil))
  "A program's hold on a robot: the robot, and how many commands it should have received by now. If
it has received more, another program has taken it over."
  (robot nil :type robot :read-only t)
  (asked 0 :type integer))

(defun own (course)
  "Return the robot of COURSE, and count the command that is about to be issued to it."
  (incf (course-asked course))
  (course-robot course))

(defun taken-p (course)
  "True if another program has taken over the robot of COURSE."
  (/= (course-asked course) (asked-so-far (course-robot course))))

(defun over-p (course err)
  "True if COURSE has to end: ERR, the error code of its last command, is :INTERRUPT, or another
program has taken over its robot."
  (or (eq err :interrupt) (taken-p course)))
