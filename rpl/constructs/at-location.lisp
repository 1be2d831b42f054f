;;;; at-location.lisp -- doing something at a place, and returning there if pushed away.

(in-package :ars-magna.rpl.constructs)

;;; WHEREABOUTS keep a robot in place for the tasks that stay there. A task that comes to stay
;;; passes a valve. A task that has to drive first waits, owning the valve, until no task stays. So
;;; tasks whose place fits do not drive, and a waiting task is not overtaken by later ones.

(defstruct (stay-registry (:constructor make-stay-registry ()) (:copier nil))
  "The value of the fluent STAYS is a list of STAY-RECORDs of tasks that are busy at a place."
  (valve (make-valve 'stay-registry) :type valve :read-only t)
  (stays (create-fluent 'stays '()) :type fluent :read-only t))

(defstruct (stay-record (:constructor make-stay-record (task)) (:copier nil))
  "A record that TASK does something at the place where the robot is."
  (task nil :type task :read-only t))

(defun stay-registry ()
  (let ((agent (calling-agent)))
    (or (agent-note agent 'stay-registry)
        (setf (agent-note agent 'stay-registry) (make-stay-registry)))))

(defun begin-stay (whereabouts)
  "Record that the calling task is busy where the robot is now. Return the record."
  (let ((stay (make-stay-record (current-task))))
    (set-value (stay-registry-stays whereabouts)
               (cons stay (fluent-value (stay-registry-stays whereabouts))))
    stay))

(defun end-stay (whereabouts stay)
  (when stay
    (set-value (stay-registry-stays whereabouts)
               (remove stay (fluent-value (stay-registry-stays whereabouts))))))

(defun no-other-stays-fluent (whereabouts)
  "Return a fluent that is true while WHEREABOUTS lists only the current task and tasks around it."
  (let ((task (current-task)))
    (fl-funcall (lambda (stays)
                  (every (lambda (stay) (part-of-p task (stay-record-task stay))) stays))
                (stay-registry-stays whereabouts))))

(addition location-lost)
(define-condition location-lost (plan-failure)
  ((place :initarg :place :initform nil :reader lost-place)
   (attempts :initarg :attempts :initform 0 :reader lost-attempts))
  (:documentation "The robot did not stay at the place of an AT-LOCATION in :ATTEMPTS attempts."))

(addition lost-place lost-attempts)
(setf (documentation 'lost-place 'function)
      "Return the place where the robot did not stay."
      (documentation 'lost-attempts 'function)
      "Return how often the plan went to the place again.")

(defmethod write-failure ((failure location-lost) stream)
  (format stream "The robot did not stay at the place ~A; the plan went there ~D more time~:P"
          (lost-place failure) (lost-attempts failure)))

(defun check-attempts (attempts)
  (check-argument at-location attempts (whole-p attempts 0) "an integer from 0 to 1e9")
  attempts)

(defun option-given-p (key form)
  "True if FORM, an AT-LOCATION, has the keyword KEY, even if its value is NIL."
  (and (get-properties (rest (second form)) (list key)) t))

(defun at-location-form (place there go attempts body)
  "Return plan text that runs BODY at PLACE. GO brings the robot there; THERE is true at PLACE."
  (with-gensyms (at most left here stay done again lost)
    `(let* ((,at ,place) (,most (check-attempts ,attempts)) (,left ,most)
            (,here (stay-registry)) (,stay nil))
       (block ,done
         (tagbody
            ,again
            (evap-protect
             (seq (with-valve ((stay-registry-valve ,here))
                    (if (not ,there)
                        (seq (wait-for (no-other-stays-fluent ,here))
                             ,go))
                    (setq ,stay (begin-stay ,here)))
                  (if (not ,there) (go ,lost))
                  (return-from ,done
                    (with-policy (seq (wait-until (not ,there)) (go ,lost))
                      ,@body)))
             (end-stay ,here (shiftf ,stay nil)))
            ,lost
            (if (= 0 ,left)
                (fail 'location-lost :place ,at :attempts ,most))
            (setq ,left (- ,left 1))
            (go ,again))))))

(define-construct at-location ((place &key there go attempts) &body body)
  "Run BODY at PLACE, in a plan. Return the first value of BODY.
  THERE is a form that is true while the robot is at PLACE; it is watched as by WAIT-UNTIL.
  GO is plan text that brings the robot to PLACE. GO is skipped if the robot is at PLACE already.
  ATTEMPTS is how often the robot may go back to PLACE, by default 10.
When the robot leaves PLACE, BODY evaporates, GO runs again and BODY starts again. A GO that does
not lead to PLACE counts as an attempt. After ATTEMPTS attempts AT-LOCATION fails with
LOCATION-LOST, which names PLACE. If GO fails, AT-LOCATION fails too.
Several plans of one robot can use AT-LOCATION. Plans whose THERE is true run without driving. The
others wait, in order of arrival, until no plan is at a place. (From CRAM, which asks its process
modules instead of THERE and GO.)"
  (:code (progn
           (unless (and (option-given-p :there form) (option-given-p :go form))
             (reject-clause (text-title) form "(at-location (place :there test :go form) form...)"))
           (plan-code (note-expansion (at-location-form place there go (or attempts 10) body) form)
                      scope))))
