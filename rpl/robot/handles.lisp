;;;; handles.lisp -- which task of another run a task of one is, if it is there at all.

(in-package :ars-magna.rpl-robot)

(export '(interface-of))

;;; A run that goes on in the place of another has its tasks up to the tick to which that was
;;; rewound, with the numbers that they had. Later tasks of both are others, though their numbers
;;; are the same. So an interface knows of which era each task is: a symbol. Its ERAS are a list
;;; (symbol . number), the newest first; those with greater numbers are of the era. What goes on
;;; after a rewind begins an era; so does RPL-INIT-ROBOT, after which numbers begin anew.

(defun era-of (number interface)
  (car (find number (interface-eras interface) :key #'cdr :test #'>)))

(defun interface-of (robot simulation)
  "Return what runs the plans of the robot that is called like ROBOT in SIMULATION, or NIL."
  (find-if (lambda (participant)
             (and (interface-p participant)
                  (eq (robot-name robot) (robot-name (interface-robot participant)))))
           (simulation-participants simulation)))

(defun same-era-p (task interface)
  "True if a task with the number of TASK, of another run, is or was the same in INTERFACE."
  (let ((number (task-serial task)))
    (eq (era-of number (runner-client (task-runner task)))
        (era-of number interface))))

(defmethod counterpart-here ((task task))
  (let* ((client (and (task-runner task) (runner-client (task-runner task))))
         (interface (and client (interface-of (interface-robot client) *simulation*))))
    (and interface
         (same-era-p task interface)
         (task-numbered (task-serial task) (interface-runner interface)))))

(defun task-of-now (task simulation)
  "Return what TASK has become in SIMULATION, a fork of its run or what goes on since that was
rewound; itself if it is over there. Signals MISUSE if its run was rewound to a tick before it
began, or plans were begun anew since."
  (let* ((client (runner-client (task-runner task)))
         (interface (interface-of (interface-robot client) simulation)))
    (cond ((and interface (same-era-p task interface))
           (or (task-numbered (task-serial task) (interface-runner interface)) task))
          ((eq (interface-simulation client) (latest (interface-simulation client))) task)
          (t (reject-use "The task ~D, ~A, is of a run that was rewound, and not in the one that ~
                          goes on: it began after the tick to which that was rewound, or ~
                          RPL-INIT-ROBOT has begun plans anew since. (plans) lists those that are ~
                          under way."
                         (task-serial task) (task-label task))))))

;;; Where a run is rewound.

(defun eras-until (number eras)
  "Return the first of ERAS, and the others of which there are tasks up to NUMBER."
  (append (remove-if (lambda (era) (>= (cdr era) number)) (butlast eras))
          (last eras)))

(defun same-beginning-p (interface other)
  "True if one RPL-INIT-ROBOT has begun INTERFACE and OTHER, of two runs."
  (eq (car (first (last (interface-eras interface))))
      (car (first (last (interface-eras other))))))

(defun begin-era (old new)
  "Let the tasks that begin from now on in NEW, which is to go on in the place of OLD, be none of
those that have begun in OLD since."
  (dolist (interface (remove-if-not #'interface-p (simulation-participants new)))
    (let ((before (interface-of (interface-robot interface) old))
          (number (runner-serial (interface-runner interface))))
      (when (and before (same-beginning-p interface before))
        (setf (interface-eras interface) (interface-eras before)))
      (setf (interface-eras interface)
            (cons (cons (gensym "ERA") number)
                  (eras-until number (interface-eras interface)))))))

(attend *rewind-hooks* begin-era)
