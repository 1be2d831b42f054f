;;;; raps.lisp -- an agent of Truckworld made of reactive action packages (RAPs).

;;; The memory has what the truck has seen: (at truck place), (parcel id place destination value
;;; deadline weight), (aboard id destination value deadline weight). The agenda has a goal for each
;;; parcel aboard, with its deadline, and one for each depot. They are ranked again at each place.

(in-package :ars-testbeds.trucks)
(in-readtable :nisp)

(defun forget-parcel (id) (memory-delete (list 'parcel id '? '? '? '? '?)))
(defun forget-aboard (id) (memory-delete (list 'aboard id '? '? '? '?)))

(defun note-reports (place reports)
  "Remember what a scan of PLACE has found; forget other parcels there."
  (memory-delete (list 'parcel '? place '? '? '? '?))
  (dolist (report reports)
    (when (eq :parcel (first report))
      (memory-add (list* 'parcel (second report) place (cddr report)))))
  (note-scan place reports (simulation-tick)))

(defun recall-parcels ()
  "Let the functions that choose targets know what is in memory."
  (setf *beliefs* (memory-query '(?id ?place ?to ?value ?deadline ?weight)
                                '(parcel ?id ?place ?to ?value ?deadline ?weight))
        *manifest* (memory-query '(?id nil ?to ?value ?deadline ?weight)
                                 '(aboard ?id ?to ?value ?deadline ?weight))))

;;; Arms.

(define-rap
  "Take the parcel ID out of a bay by ARM."
  (index (take-out ?id ?arm))
  (succeed (not (aboard ?id ? ? ? ?)))
  (method unload
    (primitive (rpl-unload-parcel arm id)
               (wait-for (vref arm-moved* arm))
               (forget-aboard id))))

(define-rap
  "Lift the parcel ID into a bay by ARM. A parcel that falls is lifted again."
  (index (take-in ?id ?arm))
  (succeed (aboard ?id ? ? ? ?))
  (attempts 3)
  (method lift
    (context (and (parcel ?id ?place ?to ?value ?deadline ?weight)
                  (at truck ?place)
                  (test (plusp (free-room)))))
    (primitive (rpl-load-parcel arm id (free-bay arm))
               (wait-for (vref arm-moved* arm))
               (unless (fluent-value (vref arm-error* arm))
                 (forget-parcel id)
                 (memory-add (list 'aboard id to value deadline weight))))))

(defun next-parcel-task ()
  (let ((task (first *tasks*)))
    (setf *tasks* (rest *tasks*))
    task))

(def-interp-proc use-both-arms (tasks)
  "Let both arms work on TASKS, lists (:unload id) or (:load id tries), until none is left."
  (setf *tasks* tasks)
  (par-loop (arm '(0 1))
    (loop
      (let ((task (next-parcel-task)))
        (cond ((null task) (return))
              ((eq :unload (first task)) (take-out (second task) arm))
              (t (handle-failure ((rap-failed () (forget-parcel (second task)) (return)))
                   (take-in (second task) arm))))))))

;;; At a place.

(define-rap
  "Scan PLACE. In rain, scan twice."
  (index (look-over ?place))
  (method look
    (primitive (rpl-scan-place 0)
               (wait-for (vref scan-ended* 0))
               (let ((reports (fluent-value (vref scan-reports* 0))))
                 (when (raining-p)
                   (rpl-scan-place 0)
                   (wait-for (vref scan-ended* 0))
                   (setf reports (remove-duplicates
                                  (append reports (fluent-value (vref scan-reports* 0)))
                                  :key #'second :from-end t)))
                 (note-reports place reports)))))

(define-rap
  "Fill the tank at PLACE if it is worth while."
  (index (fill-tank ?place))
  (method not-needed
    (context (test (not (worth-refuelling-p place))))
    (primitive t))
  (method fill
    (context (test (worth-refuelling-p place)))
    (primitive (rpl-refuel-truck)
               (wait-for truck-moved*)
               (setf *drums* (remove place *drums* :key #'first)))))

(define-rap
  "Unload what is for PLACE, where the truck is, scan it, load what can be delivered, and refuel."
  (index (serve-here ?place))
  (method in-order
    (primitive (recall-parcels)
               (use-both-arms (unloading-tasks))
               (when (worth-scanning-p place) (look-over place))
               (recall-parcels)
               (use-both-arms (loading-tasks #'worth-loading-p))
               (fill-tank place)
               (recall-parcels)
               (rank-goals))))

;;; On the road.

(define-memory-rule outbid (outbid ?place) (and (best ?target) (/= ?target ?place))
  "A place is outbid if another one is the best target.")

(def-interp-proc move-and-note (place)
  "Drive to PLACE. If the road is blocked, remember this and drive back."
  (rpl-move-truck place)
  (wait-for truck-moved*)
  (case (fluent-value truck-error*)
    ((nil) (memory-set (list 'at 'truck place)))
    (:road-closed
     (let ((back (first (remove place *leg*))))
       (push (append *leg* (list (simulation-tick))) *blocked*)
       (n-times 100 until (here)
         (rpl-move-truck back)
         (wait-for truck-moved*))
       (rank-goals)))
    (:no-fuel (wait-time 50))))

(defun closed-p (place)
  "True if the road from here to PLACE, a neighbour or NIL, was found blocked."
  (let ((road (and place (here) (find-road (here) place))))
    (and road (found-blocked-p road))))

(define-rap
  "Drive along a road to PLACE, a neighbour. A truck that was stuck drives on."
  (index (drive-road ?place))
  (succeed (at truck ?place))
  (attempts 9)
  (method drive
    (context (test (not (closed-p place))))
    (primitive (move-and-note place))))

(defun next-step (place)
  "Return the neighbour that is next on the way to PLACE, or to fuel; NIL if this is the place, or
on a road."
  (and (here) (third (assoc (checked-target place) (ways-from (here) #'time-cost)))))

(defun nearer-end ()
  "Return the end of the road, where the truck is, that is nearer."
  (first (sort (copy-list *leg*) #'< :key (lambda (place) (abs (left-to truck place))))))

(define-rap
  "Travel to PLACE, by way of fuel if there may be too little, unless it has been outbid. Serve the
places on the way."
  (index (reach-place ?place))
  (succeed (or (at truck ?place) (outbid ?place)))
  (attempts 30)
  (method leave-road
    (context (test (null (here))))
    (primitive (move-and-note (nearer-end))))
  (method wait-for-road
    (context (test (closed-p (next-step place))))
    (primitive (rpl-spend-time 10)
               (wait-for truck-moved*)
               (rank-goals)))
  (method go-on
    (context (test (and (here) (not (closed-p (next-step place))))))
    (primitive (memory-set (list 'at 'truck (here)))
               (let ((step (next-step place)))
                 (if step
                     (drive-road step)
                     (seq (rpl-spend-time 5) (wait-for truck-moved*)))
                 (when (here) (serve-here (here)))))))

;;; Goals.

(define-rap
  "Bring the parcel ID to PLACE, its destination."
  (index (deliver-parcel ?id ?place))
  (succeed (not (aboard ?id ? ? ? ?)))
  (attempts 1)
  (method by-truck (task-net (trip (reach-place ?place)))))

(define-rap
  "Look for parcels at DEPOT."
  (index (visit-depot ?depot))
  (succeed (at truck ?depot))
  (attempts 1)
  (method by-truck (task-net (trip (reach-place ?depot)))))

(defun rank-goals ()
  "Put goals for the parcels aboard and the depots on the agenda, those with the best targets
first."
  (let ((targets (ranked-targets)))
    (memory-set (list 'best (first targets)))
    (dolist (goal (agenda-goals '(:waiting))) (remove-goal (getf goal :number)))
    (flet ((install (goal target deadline)
             (install-goal goal (- (or (position target targets) 20)) deadline)))
      (dolist (belief (live-manifest))
        (destructuring-bind (id from place value deadline weight) belief
          (declare (ignore from value weight))
          (install (list 'deliver-parcel id place) place deadline)))
      (dolist (depot (remove *place* *depots*))
        (install (list 'visit-depot depot) depot nil)))))

(def-interp-proc rap-driver ()
  "Play to the end of the game."
  (memory-set '(at truck 0))
  (serve-here 0)
  (loop (work-on-agenda :at-once 1)
        (unless (here) (move-and-note (nearer-end)))
        (when (here) (rank-goals))))
