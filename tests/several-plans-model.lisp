;;;; several-plans-model.lisp -- a model of when, and how, plans of several robots end.

(in-package :ars-magna.tests)
(in-suite several-plans)

;;; The model. A plan here is a list (kind part...), see RUN-MODELLED and ROBOT-PLAN-TEXT. An ACT is
;;; a part of a plan that runs. When it ends, K is called with :ok, :fail or :gone. What is ready
;;; in a tick runs in a random order. So a case may have several admissible outcomes.

(defstruct (act (:constructor make-act (k))) k (cancel nil) (over nil) (doomed nil) (part nil))

(defstruct (modelled-plan (:conc-name plan-)) id robot act (joins '()) (cleaning '()))

(defstruct (modelled-robot (:conc-name model-)) name (waiting '()) (command nil))

(defvar *model*)
(defvar *at-once-p* nil "True while cleanups are given up.")

(defstruct model
  (tick 0) (ready '()) (timers '()) (plans '()) (ends '()) (order nil) (charged-p nil)
  (fluents (make-array 4 :initial-element nil))
  (watching (make-array 4 :initial-element '()))
  (owners (make-array 2 :initial-element nil))
  (queues (make-array 2 :initial-element '()))
  (robots '()))

(defun model-robot (name) (find name (model-robots *model*) :key #'model-name))

(defun when-ready (function)
  (setf (model-ready *model*) (append (model-ready *model*) (list function))))

(defun after (ticks function)
  (push (cons (+ ticks (model-tick *model*)) function) (model-timers *model*)))

(defun settle ()
  "Run what is ready, in the order of the model: first, last, or by its dice."
  (loop while (model-ready *model*)
        do (let* ((ready (model-ready *model*)) (order (model-order *model*))
                  (next (case order
                          (:first (first ready))
                          (:last (first (last ready)))
                          (t (base:roll-element ready order)))))
             (setf (model-ready *model*) (remove next ready :count 1))
             (funcall next))))

(defun end-act (act outcome)
  (unless (act-over act)
    (setf (act-over act) t)
    (funcall (act-k act) (if (act-doomed act) :gone outcome))))

(defun doom (act)
  "Let ACT evaporate."
  (unless (or (act-over act) (act-doomed act))
    (setf (act-doomed act) t)
    (cond ((act-cancel act) (funcall (act-cancel act)))
          ((act-part act) (doom (act-part act)))
          (t (end-act act :gone)))))

;; Some constructs run their bodies as tasks of their own, others do not.
(defun separate-p ()
  (case (model-order *model*)
    (:first nil)
    (:last t)
    (t (base:chance 1/2 (model-order *model*)))))

(defun run-part (act plan place k)
  "Run PLAN as the only part of ACT. PLACE is a list: the whole plan, the robot driven."
  (let ((part (make-act k)))
    (setf (act-part act) part)
    (flet ((start () (unless (act-over part) (run-modelled plan place part))))
      (if (separate-p) (when-ready #'start) (start)))))

(defmacro wake-all (waiting)
  `(dolist (act (shiftf ,waiting '()))
     (let ((act act)) (when-ready (lambda () (end-act act :ok))))))

(defun set-modelled (index value)
  (let ((before (shiftf (aref (model-fluents *model*) index) value)))
    (when (and value (not before)) (wake-all (aref (model-watching *model*) index)))))

(defmacro removef-eq (item place) `(setf ,place (remove ,item ,place :test #'eq)))

(defun await-stop (act robot)
  (setf (act-cancel act) (lambda ()
                           (removef-eq act (model-waiting robot))
                           (end-act act :gone)))
  (push act (model-waiting robot)))

(defun start-turn (plan robot ticks)
  (let ((command (list plan)))
    (when (shiftf (model-command robot) command) (wake-all (model-waiting robot)))
    (after ticks (lambda ()
                   (when (eq command (model-command robot))
                     (setf (model-command robot) nil)
                     (wake-all (model-waiting robot)))))))

(defun run-chain (act plans place goes-on)
  (destructuring-bind (plan &rest more) plans
    (run-part act plan place
              (lambda (outcome)
                (if (and more (eq outcome goes-on) (not (act-doomed act)))
                    (run-chain act more place goes-on)
                    (end-act act outcome))))))

(defun run-side-by-side-modelled (act deciding plans place)
  "Run PLANS as parts of ACT, which the first end with an outcome among DECIDING decides."
  (let* ((left (length plans)) (decided nil) (parts '()) (last nil))
    (labels ((ended (outcome)
               (if (and (separate-p) (not *at-once-p*))
                   (when-ready (lambda () (note-end outcome)))
                   (note-end outcome)))
             (note-end (outcome)
               (decf left)
               (setf last outcome)
               (when (and (member outcome deciding) (not decided) (not (act-doomed act)))
                 (setf decided outcome)
                 (mapc #'doom parts))
               (when (zerop left) (end-act act (or decided last)))))
      (setf (act-cancel act) (lambda () (mapc #'doom parts))
            parts (loop repeat left collect (make-act #'ended)))
      (loop for part in parts
            for plan in plans
            do (let ((part part) (plan plan))
                 (when-ready (lambda ()
                               (unless (act-over part) (run-modelled plan place part)))))))))

(defun run-protected (act plan span place)
  (let ((whole (first place)))
    (run-part act plan place
              (lambda (outcome)
                (setf (act-cancel act) #'list)
                (cond (*at-once-p* (end-act act outcome))
                      (t (push act (plan-cleaning whole))
                         (after span (lambda () (end-act act outcome)))))))))

(defun release (index)
  (let ((next (pop (aref (model-queues *model*) index))))
    (setf (aref (model-owners *model*) index) next)
    (when next (when-ready next))))

(defun run-owning (act index plan place)
  (let ((started nil))
    (flet ((start ()
             (cond ((act-over act) (release index))
                   (t (setf started t)
                      (run-part act plan place (lambda (outcome)
                                                 (release index)
                                                 (end-act act outcome)))))))
      (setf (act-cancel act)
            (lambda ()
              (cond (started (doom (act-part act)))
                    (t (removef-eq #'start (aref (model-queues *model*) index))
                       (end-act act :gone)))))
      (cond ((aref (model-owners *model*) index)
             (setf (aref (model-queues *model*) index)
                   (append (aref (model-queues *model*) index) (list #'start))))
            (t (setf (aref (model-owners *model*) index) #'start)
               (start))))))

(defun run-with-deadline (act plan span place)
  (let ((missed nil))
    (after span (lambda ()
                  (unless (or (act-over act) (act-doomed act))
                    (setf missed t)
                    (doom (act-part act)))))
    (run-part act plan place (lambda (outcome) (end-act act (if missed :fail outcome))))))

(defun begin-modelled (id robot body)
  (let ((plan (make-modelled-plan :id id :robot robot)))
    (flet ((ended (outcome)
             (push (list id (model-tick *model*) outcome) (model-ends *model*))
             (unless (eq outcome :ok)
               (dolist (robot (model-robots *model*))
                 (when (eq plan (first (model-command robot)))
                   (setf (model-command robot) nil)
                   (wake-all (model-waiting robot)))))
             (dolist (join (plan-joins plan)) (funcall join outcome))))
      (let ((act (make-act #'ended)))
        (setf (plan-act plan) act)
        (push plan (model-plans *model*))
        (when-ready (lambda () (unless (act-over act) (run-modelled body (list plan robot) act))))
        plan))))

(defun run-modelled (plan place act)
  (destructuring-bind (kind &optional first second third) plan
    (flet ((robot () (model-robot (second place)))
           (done () (end-act act :ok)))
      (ecase kind
        (wait (after first #'done))
        (fail (after first (lambda () (end-act act :fail))))
        (think (if (model-charged-p *model*) (after first #'done) (done)))
        (pulse (unless (aref (model-fluents *model*) first)
                 (wake-all (aref (model-watching *model*) first)))
               (done))
        (set (set-modelled first second) (done))
        (await (cond ((aref (model-fluents *model*) first) (done))
                     (t (push act (aref (model-watching *model*) first))
                        (when second (after second #'done)))))
        (turn (start-turn (first place) (robot) (+ 2 first))
              (await-stop act (robot)))
        (listen (await-stop act (robot)))
        (hear (await-stop act (model-robot first)))
        (on (run-part act second (list (first place) first) (lambda (o) (end-act act o))))
        (seq (run-chain act (rest plan) place :ok))
        (try (run-chain act (rest plan) place :fail))
        (par (run-side-by-side-modelled act '(:fail) (rest plan) place))
        (pursue (run-side-by-side-modelled act '(:ok :fail) (rest plan) place))
        (try-all (run-side-by-side-modelled act '(:ok) (rest plan) place))
        (protect (run-protected act first second place))
        (handle (run-part act first place
                          (lambda (outcome)
                            (if (and (eq outcome :fail) (not (act-doomed act)))
                                (run-part act (list 'wait second) place
                                          (lambda (outcome) (end-act act outcome)))
                                (end-act act outcome)))))
        (deadline (run-with-deadline act first second place))
        (valve (run-owning act first second place))
        (begin (begin-modelled first second third) (done))
        (join (push (lambda (outcome)
                      (when-ready (lambda () (end-act act (if (eq outcome :fail) :fail :ok)))))
                    (plan-joins (begin-modelled first second third))))))))

;;; Deeds: what is done from outside after a tick, lists (tick kind argument...).

(defun plans-modelled (&optional (robot nil robot-p))
  (remove-if (lambda (plan)
               (or (act-over (plan-act plan))
                   (and robot-p (not (eq robot (plan-robot plan))))))
             (model-plans *model*)))

(defun end-modelled-at-once (plan)
  (let ((*at-once-p* t))
    (doom (plan-act plan))
    (dolist (act (plan-cleaning plan)) (end-act act :gone))))

(defun do-modelled (kind &rest arguments)
  (ecase kind
    (begin (apply #'begin-modelled arguments))
    (end (dolist (plan (plans-modelled))
           (when (eql (plan-id plan) (first arguments))
             (doom (plan-act plan))
             (settle))))
    (end-robot (dolist (plan (plans-modelled (first arguments))) (doom (plan-act plan)))
               (settle))
    (end-all (when (model-plans *model*)
               (dolist (plan (plans-modelled)) (doom (plan-act plan)))
               (settle)))
    (init (mapc #'end-modelled-at-once (plans-modelled (first arguments))))))

(defun next-modelled-tick (deeds)
  (let ((ticks (append (mapcar #'first deeds)
                       (mapcar #'car (model-timers *model*))
                       (when (model-ready *model*) (list (1+ (model-tick *model*)))))))
    (when ticks (reduce #'min ticks))))

(defun pass-modelled-tick (tick)
  (setf (model-tick *model*) tick)
  (dolist (timer (reverse (model-timers *model*)))
    (when (= tick (car timer))
      (removef-eq timer (model-timers *model*))
      (when-ready (cdr timer))))
  (settle))

(defun ends-by-model (robots deeds order charged-p)
  "Return a sorted list (id tick outcome) of the ends of all plans that end, and the last tick."
  (let ((*model* (make-model :order order :charged-p charged-p
                             :robots (loop for name in robots
                                           collect (make-modelled-robot :name name)))))
    (loop for tick = (next-modelled-tick deeds)
          while tick
          do (when (> tick (model-tick *model*)) (pass-modelled-tick tick))
             (loop while (and deeds (= tick (first (first deeds))))
                   do (apply #'do-modelled (rest (pop deeds)))))
    (values (sort (model-ends *model*) #'< :key #'first)
            (model-tick *model*))))
