;;;; task-nets.lisp -- the plan text of a task net.

(in-package :ars-rap)

;;; A task net becomes a PARTIAL-ORDER of tagged steps. So the steps are tasks that the plan tree
;;; shows under their tags.

(defstruct (net-step (:copier nil))
  "A step of a task net. CALL is a plan call, ANNOTATIONS its annotations."
  (tag nil :read-only t)
  (call nil :read-only t)
  (results '() :read-only t)
  (annotations '() :read-only t))

(defun annotation-kind (annotation)
  "Return the kind of ANNOTATION: :FOR, :FACT, :WAIT-FOR, :UNTIL-START or :UNTIL-END."
  (flet ((is (word object) (and (symbolp object) (string= word object))))
    (cond ((not (and (proper-list-p annotation) annotation)) nil)
          ((and (is 'for (first annotation)) (= 2 (length annotation))) :for)
          ((and (= 3 (length annotation)) (is 'for (second annotation))
                (consp (first annotation)))
           :fact)
          ((and (is 'wait-for (first annotation)) (= 3 (length annotation))) :wait-for)
          ((and (is 'until-start (first annotation)) (= 2 (length annotation))) :until-start)
          ((and (is 'until-end (first annotation)) (= 2 (length annotation))) :until-end))))

(defun parse-step (form)
  (unless (and (typep form '(cons (and symbol (not null)) (cons cons))) (proper-list-p form)
               (proper-list-p (second form)))
    (reject-part form (format nil "a step (tag (name argument...) annotation...), (sequence ~
                                   step...) or (parallel step...)")))
  (destructuring-bind (tag call . annotations) form
    (dolist (annotation annotations)
      (unless (annotation-kind annotation)
        (reject-part annotation
                     (format nil "an annotation (fact for tag), (for tag), (wait-for query tag), ~
                                  (wait-for query :succeed), (wait-for query :fail), (until-start ~
                                  tag) or (until-end tag)"))))
    (multiple-value-bind (call results) (split-result call)
      (make-net-step :tag tag :call call :results results :annotations annotations))))

(defun group-p (form)
  "Return the first word of FORM if it is (sequence step...) or (parallel step...), else NIL."
  (and (proper-list-p form)
       (symbolp (first form))
       (every #'consp (rest form))
       (find (first form) '(sequence parallel) :test #'string=)))

(defun parse-net (forms)
  "Return the steps of FORMS, in the order of the text, and a list of orders (tag tag)."
  (let ((steps '()) (orders '()))
    (labels ((walk (form)
               ;; Returns the tags of the steps in FORM.
               (let ((group (group-p form)))
                 (cond (group
                        (let ((parts (mapcar #'walk (rest form))))
                          (when (eq 'sequence group)
                            (loop for (before after) on parts while after
                                  do (dolist (a before)
                                       (dolist (b after) (pushnew (list a b) orders
                                                                  :test #'equal)))))
                          (apply #'append parts)))
                       (t (let ((step (parse-step form)))
                            (push step steps)
                            (list (net-step-tag step))))))))
      (mapc #'walk forms))
    (values (reverse steps) (reverse orders))))

(defun checked-steps (steps)
  "Return STEPS. Signal an error unless their tags differ and their annotations name tags."
  (let ((tags (mapcar #'net-step-tag steps)))
    (unless (= (length tags) (length (remove-duplicates tags)))
      (reject-part tags "steps with different tags"))
    (dolist (step steps steps)
      (dolist (annotation (net-step-annotations step))
        (let ((tag (first (last annotation))))
          (unless (or (member tag tags)
                      (and (eq :wait-for (annotation-kind annotation))
                           (member tag '(:succeed :fail))))
            (reject-part annotation (format nil "the tag of a step: ~{~(~A~)~^, ~}" tags)))
          (when (eq tag (net-step-tag step))
            (reject-part annotation "the tag of another step")))
        (case (annotation-kind annotation)
          (:fact (check-rap-query (first annotation)))
          (:wait-for (check-rap-query (second annotation))))))))

(defun annotations-of (step &rest kinds)
  (remove-if-not (lambda (annotation) (member (annotation-kind annotation) kinds))
                 (net-step-annotations step)))

(defun over-code (tag)
  "Return a form for a fluent that is true when the step TAG is over."
  `(fl-funcall 'over-word-p (task-status ,tag)))

(defun begin-variable (tag) (intern (format nil "~A-BEGINS" tag)))

(defun call-code (step known)
  "Return the plan call of STEP. Its arguments are data, in which the Lisp variables KNOWN have
values."
  (destructuring-bind (name . arguments) (net-step-call step)
    (dolist (argument (set-difference (code-variables arguments) known))
      (reject-part (net-step-call step)
                   (format nil "no ?~(~A~), which has no value: the index, the context or the ~
                                result of a step must give it one"
                           argument)))
    (let ((call `(shown-as ,(net-step-call step)
                           (,name ,@(loop for argument in arguments
                                          collect (pattern-code argument known)))))
          (results (net-step-results step)))
      (if results
          (let ((values (loop for variable in results collect (gensym (symbol-name variable)))))
            `(multiple-value-bind ,values ,call
               (setf ,@(mapcan #'list (copy-list results) values))))
          call))))

(defun watched-code (step known)
  "Return the call of STEP, which also ends when its annotations say so."
  (let ((ends (loop for annotation in (net-step-annotations step)
                    for tag = (first (last annotation))
                    append (ecase (annotation-kind annotation)
                             ((:for :fact) '())
                             (:wait-for
                              (let ((wait `(wait-until
                                            (holds-p ,(query-code (second annotation) known)))))
                                (case tag
                                  (:succeed (list wait))
                                  (:fail (list `(seq ,wait (fail-by-event
                                                            ',(second annotation))))))))
                             (:until-start (list `(wait-for ,(begin-variable tag))))
                             (:until-end (list `(wait-for ,(over-code tag))))))))
    (if ends `(pursue ,(call-code step known) ,@ends) (call-code step known))))

(defun conditions-code (step steps known)
  "Return plan text that waits for what other STEPS make true for STEP."
  (loop for other in steps
        append (loop for annotation in (annotations-of other :fact :wait-for)
                     when (eq (net-step-tag step) (first (last annotation)))
                       collect (ecase (annotation-kind annotation)
                                 (:fact
                                  (let ((query (query-code (first annotation) known)))
                                    `(seq (n-times *net-tries* until (holds-p ,query)
                                            ,(call-code other known))
                                          (check-happened (holds-p ,query)
                                                          ',(first annotation)))))
                                 (:wait-for
                                  (let ((query (query-code (second annotation) known)))
                                    `(seq (wait-until (or (holds-p ,query)
                                                          (over-p ,(net-step-tag other))))
                                          (check-happened (holds-p ,query)
                                                          ',(second annotation)))))))))

(defun net-orders (steps orders)
  "Return the constraints (:order a b) of STEPS, and those of ORDERS that no other kind replaces."
  (append (loop for step in steps
                append (loop for annotation in (annotations-of step :for :fact)
                             collect `(:order ,(net-step-tag step) ,(first (last annotation)))))
          (loop for (a b) in orders
                for step = (find a steps :key #'net-step-tag)
                unless (find b (annotations-of step :wait-for :until-start :until-end)
                             :key (lambda (annotation) (first (last annotation))))
                  collect `(:order ,a ,b))))

(defun step-results (steps)
  (remove-duplicates (loop for step in steps append (net-step-results step))))

(defun tags-awaited (steps)
  "Return the tags of STEPS whose start ends another step."
  (remove-duplicates (loop for step in steps
                           append (mapcar #'second (annotations-of step :until-start)))))

(defun step-code (step steps known begun)
  "Return a branch of a PARTIAL-ORDER that runs STEP, one of STEPS. BEGUN are the tags whose start
others wait for."
  (let ((tag (net-step-tag step)))
    `(:tag ,tag
       ,@(conditions-code step steps known)
       ,@(when (member tag begun) `((set-value ,(begin-variable tag) t)))
       ,(watched-code step known))))

(defun task-net-code (forms known results)
  "Return the plan text of the task net FORMS. KNOWN are the Lisp variables that have values,
RESULTS those of the results of the RAP."
  (multiple-value-bind (steps orders) (parse-net forms)
    (checked-steps steps)
    (let* ((given (step-results steps))
           (begun (tags-awaited steps)))
      `(let (,@(set-difference given (append results known))
             ,@(loop for tag in begun
                     collect `(,(begin-variable tag) (state ',tag))))
         (shown-as (task-net ,@forms)
           (partial-order (,@(loop for step in steps
                                   collect (step-code step steps (union given known) begun)))
                          ,@(remove-duplicates (net-orders steps orders) :test #'equal)))))))
