;;;; joining.lisp -- robots that join or leave a world in the middle of its run.

(in-package :ars-magna.run)

;;; The header of a journal lists the robots with which the run began. Robots that join or leave
;;; later are in the entries, so a replay lets them join and leave in the same ticks.

(defun journal-fresh-p (journal simulation)
  "True if nothing has happened in SIMULATION that JOURNAL, its journal, would repeat."
  (and (zerop (simulation-tick simulation)) (null (journal-newest-first journal))))

(defun set-variable-of-robot (robot simulation)
  "Set the variable that the name of ROBOT is, if SIMULATION has bound it."
  (when (assoc (robot-name robot) (simulation-environment simulation))
    (setf (symbol-value (robot-name robot)) robot)))

;;; Repeating.

(defun join-again (blueprint name x y angle)
  "Make a robot from BLUEPRINT with NAME, a symbol, in the current simulation, at (X,Y)."
  (let* ((world (simulation-world *simulation*))
         (start (mapcar #'double (list x y angle)))
         (as-defined-p (and (eq name (blueprint-name blueprint))
                            (equal start (robot-entry-start-pose
                                          (make-robot-entry blueprint name '()))))))
    (when (find name (world-robots world) :key #'robot-name)
      (reject-use "~A is in this run already." name))
    (permitting-changes (world)
      (set-variable-of-robot (add-robot blueprint world :name name
                                                        :start (if as-defined-p '() start))
                             *simulation*))))

(defun leave-again (name)
  (let ((robot (robot-in *simulation* name)))
    (permitting-changes ((robot-world robot))
      (remove-robot robot "it left this run, because it was defined anew or undefined"))))

(define-operator 'robot-joined '(name name number number angle)
  (lambda (name kind x y angle)
    (join-again (find-blueprint kind) (symbol-of-robot name kind) x y angle)))

(define-operator 'robot-left '(name) #'leave-again)

;;; Recording. Forks repeat the very definition, which may have been replaced since.

(defun record-joining (robot simulation)
  (let ((journal (simulation-journal simulation))
        (blueprint (robot-blueprint robot)) (name (robot-name robot))
        (pose (list (robot-x robot) (robot-y robot) (robot-angle robot))))
    (cond ((null journal))
          ((journal-fresh-p journal simulation) (refresh-journal-robots simulation))
          (t (add-entry journal (simulation-tick simulation)
                        (list* 'robot-joined (qualified-name name)
                               (qualified-name (blueprint-name blueprint)) pose))))
    (record-act simulation #'join-again (list* blueprint name pose))))

(defun record-leaving (robot simulation)
  (let ((journal (simulation-journal simulation)) (name (robot-full-name robot)))
    (cond ((null journal))
          ((journal-fresh-p journal simulation) (refresh-journal-robots simulation))
          (t (add-entry journal (simulation-tick simulation) (list 'robot-left name))))
    (record-act simulation #'leave-again (list name))))

(defun record-change-of-robots (change robot)
  "Record in the run of ROBOT, if there is one, that ROBOT has joined or left it."
  (let* ((timeline (world-timeline (robot-world robot)))
         (simulation (and timeline (timeline-run timeline))))
    (when (and simulation (not (simulation-over simulation)))
      (ecase change
        (:defined (when (simulation-journal simulation) (merge-journal-definitions simulation)))
        (:joined (record-joining robot simulation))
        (:left (record-leaving robot simulation))))))

(add-listener *robot-hooks* record-change-of-robots)

(defun bind-joining-robots (run acts)
  "Make the names of the robots that join RUN, a fork, in ACTS variables of RUN."
  (dolist (act acts)
    (when (eq #'join-again (act-operator act))
      (let ((name (second (act-arguments act))))
        (unless (assoc name (simulation-environment run))
          (push (cons name nil) (simulation-environment run)))))))
