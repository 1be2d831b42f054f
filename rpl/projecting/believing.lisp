;;;; believing.lisp -- a trial of a plan in a world that a robot believes in.

(in-package :ars-magna.rpl-projecting)

;;; Such a world is made by a function of the user's, WORLD, which is called with a function and a
;;; seed: it is to call that in a WITH-SIMULATION with that seed, when it has put things where they
;;; are believed to be. Nothing there leads to the true run: that is not the current one, its robots
;;; are not bound, and no object of it is taken for an argument. What global variables lead to can
;;; be read, but not changed or commanded; and fluents have a realm for each rollout.

(defun object-of-run (object)
  "Return an object that belongs to a run and is OBJECT, or in it if that is a list or vector; or
NIL."
  (let ((seen (make-hash-table :test 'eq)))
    (labels ((look (object)
               (typecase object
                 ((or number symbol character string) nil)
                 ((or cons simple-vector)
                  (unless (gethash object seen)
                    (setf (gethash object seen) t)
                    (if (consp object)
                        (or (look (car object)) (look (cdr object)))
                        (some #'look object))))
                 ((or task entity) object)
                 (procedure (and (null (procedure-name object)) object))
                 (t (and (kind-of object) object)))))
      (look object))))

(defun check-believable (question)
  "Signal WRONG-ARGUMENT if QUESTION is about an object that a world believed in cannot know."
  (let ((object (or (question-subject question)
                    (object-of-run (list (question-plan question)
                                         (question-arguments question))))))
    (when object
      (reject-argument (question-operator question)
                       (if (question-subject question) 'plan :arguments)
                       object
                       (format nil "what a plan can know in another world: :world goes with plans ~
                                    that have names, and arguments such as numbers, names and ~
                                    lists of them")))))

(defun call-without-run (function)
  "Call FUNCTION where there is no current simulation, no robot of one is bound, other runs than
those that FUNCTION makes cannot be changed, and fluents of outside are as in a fork."
  (let ((robots (and *simulation* (simulation-robots *simulation*))))
    (progv (mapcar #'robot-name robots) '()
      (progv *simulation-variables* (mapcar #'symbol-value *simulation-variables*)
        (let ((*simulation* nil) (*world* nil) (*interface* nil) (*realm* (fork-realm *realm*)))
          (secluded (funcall function)))))))

(defun run-in-belief (scene trial seed)
  (unless *simulation*
    (reject-use "project: the function :world is to call what it is given inside of ~
                 (with-simulation ...)."))
  (let ((question (scene-question scene)) (interface (ensure-interface)))
    (run-rollout scene trial seed question interface
                 (lambda ()
                   (begin-in interface (question-plan question) (question-arguments question)
                             #'identity)))))

(defun no-rollout (scene trial seed condition)
  (multiple-value-bind (how result cost broken) (broken-off condition :world)
    (make-rollout scene trial seed how result 0 cost 0 '() broken)))

(defun roll-out-in-belief (scene trial seed then)
  "Return the values of THEN, a function that is called with the rollout number TRIAL, with SEED, of
SCENE, where that has ended in the world that the question believes in."
  (let ((values '()) (called-p nil))
    (flet ((run ()
             (setf called-p t
                   values (multiple-value-list (funcall then (run-in-belief scene trial seed))))))
      (handler-case
          (progn
            (call-without-run (lambda ()
                                (funcall (option (scene-question scene) :world) #'run seed)))
            (unless called-p
              (reject-use "project: the function :world has not called what it was given.")))
        (error (condition)
          (setf values (list (funcall then (no-rollout scene trial seed condition))))))
      (values-list values))))
