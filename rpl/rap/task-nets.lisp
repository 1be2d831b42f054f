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
                                result of a step must give it one; (not ...), or only some ~
                                branches of (or ...), give none"
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

(defun own-event-code (annotation tag known)
  "Return plan text that waits for the query of ANNOTATION, which ends the step TAG."
  (destructuring-bind (query how) (rest annotation)
    (let ((wait `(shown-as ,annotation
                   (await-memory (holds-p ,(query-code query known))
                                 ,(pattern-code query known)))))
      (if (eq :fail how)
          `(seq ,wait (fail-by-event ,(pattern-code query known) ',tag))
          wait))))

(defun end-code (annotation step known)
  "Return a list with plan text that waits for what ends STEP by ANNOTATION; NIL if nothing does."
  (let ((tag (first (last annotation))))
    (ecase (annotation-kind annotation)
      ((:for :fact) '())
      (:wait-for (when (keywordp tag)
                   (list (own-event-code annotation (net-step-tag step) known))))
      (:until-start (list `(wait-for ,(begin-variable tag))))
      (:until-end (list `(wait-for ,(over-code tag)))))))

(defun watched-code (step known)
  "Return the call of STEP, which also ends when its annotations say so."
  (let ((ends (loop for annotation in (net-step-annotations step)
                    append (loop for end in (end-code annotation step known)
                                 collect `(shown-as ,annotation ,end)))))
    (if ends `(pursue ,(call-code step known) ,@ends) (call-code step known))))

(defun fact-code (annotation other known)
  "Return plan text that repeats OTHER, a step, until the fact of its ANNOTATION holds."
  (let* ((fact (first annotation)) (query (query-code fact known)))
    `(seq (n-times *net-tries* until (holds-p ,query) ,(call-code other known))
          (check-happened (holds-p ,query) ,(pattern-code fact known)
                          ',(first (last annotation))))))

(defun event-code (annotation other known)
  "Return plan text that waits until OTHER, a step, has begun and the query of ANNOTATION holds."
  (destructuring-bind (event later) (rest annotation)
    (let ((query (query-code event known)) (tag (net-step-tag other)))
      `(seq (shown-as ,annotation (wait-for (or ,(begin-variable tag) ,(over-code tag))))
            (shown-as ,annotation
              (await-memory (or (holds-p ,query) (over-p ,tag)) ,(pattern-code event known)))
            (check-happened (holds-p ,query) ,(pattern-code event known) ',later)))))

(defun conditions-code (step steps known)
  "Return plan text that waits for what other STEPS make true for STEP."
  (loop for other in steps
        append (loop for annotation in (annotations-of other :fact :wait-for)
                     when (eq (net-step-tag step) (first (last annotation)))
                       collect `(shown-as ,annotation
                                  ,(if (eq :fact (annotation-kind annotation))
                                       (fact-code annotation other known)
                                       (event-code annotation other known))))))

;;; Orders.

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

(defun queries-for (step steps)
  "Return the queries that STEP evaluates: its own, and those of other STEPS that are for it."
  (append (mapcar #'second (annotations-to step '(:succeed :fail)))
          (loop for other in steps
                append (loop for annotation in (annotations-to other (list (net-step-tag step)))
                             collect (case (annotation-kind annotation)
                                       (:fact (first annotation))
                                       (:wait-for (second annotation)))))))

(defun annotations-to (step tags)
  (remove-if-not (lambda (annotation) (member (first (last annotation)) tags))
                 (net-step-annotations step)))

(defun precedes-p (a b orders)
  "True if the step A comes before the step B by ORDERS, a list of (:order a b)."
  (loop for open = (list a) then (set-difference (union open more) '())
        for more = (loop for (nil earlier later) in orders
                         when (and (member earlier open) (not (member later open)))
                           collect later)
        thereis (member b more)
        while more))

(defun giver-tags (variable user steps orders known)
  "Return the tags of the STEPS that must give VARIABLE a result before USER uses it: not of those
after USER by ORDERS, unless VARIABLE has no other value. KNOWN variables have one."
  (let* ((tag (net-step-tag user))
         (givers (loop for step in steps
                       when (and (not (eq step user)) (member variable (net-step-results step)))
                         collect (net-step-tag step)))
         (others (remove-if (lambda (giver) (precedes-p tag giver orders)) givers)))
    (if (or others (member variable known)) others givers)))

(defun value-orders (steps orders known)
  "Return a list of (:order a b) by which a step that uses a result comes after the step that gives
it."
  (loop for user in steps
        append (loop for variable in (code-variables (cons (rest (net-step-call user))
                                                           (queries-for user steps)))
                     append (loop for giver in (giver-tags variable user steps orders known)
                                  collect `(:order ,giver ,(net-step-tag user))))))

(defun net-precedences (steps orders)
  "Return a list of pairs of events, each (:start tag) or (:end tag): the first precedes the other."
  (append (loop for step in steps
                for tag = (net-step-tag step)
                collect `((:start ,tag) (:end ,tag))
                append (loop for annotation in (annotations-of step :wait-for)
                             for other = (first (last annotation))
                             unless (keywordp other)
                               collect `((:start ,tag) (:start ,other))))
          (loop for (nil a b) in orders collect `((:end ,a) (:start ,b)))))

(defun circle-in (precedences)
  "Return those of PRECEDENCES that are in circles, or between circles."
  (loop for left = (remove-if-not (lambda (pair)
                                    (and (find (first pair) precedences :key #'second
                                                                        :test #'equal)
                                         (find (second pair) precedences :key #'first
                                                                         :test #'equal)))
                                  precedences)
        until (= (length left) (length precedences))
        do (setf precedences left)
        finally (return left)))

(defun check-circles (clause steps orders)
  "Signal an error about CLAUSE, a task net, if some of its STEPS could never begin."
  (let* ((circle (circle-in (net-precedences steps orders)))
         (tags (loop for step in steps
                     when (find (net-step-tag step) circle :key #'cadar)
                       collect (net-step-tag step))))
    (when tags
      (reject-part clause
                   (format nil "orders without a circle: the steps ~{~(~A~)~#[~; and ~:;, ~]~} ~
                                could never begin, because each waits for another, as a step ~
                                that uses a result waits for the step that gives it" tags)))))

(defun step-results (steps)
  (remove-duplicates (loop for step in steps append (net-step-results step))))

(defun tags-awaited (steps)
  "Return the tags of STEPS whose start begins or ends another step."
  (remove-duplicates
   (loop for step in steps
         append (mapcar #'second (annotations-of step :until-start))
         when (remove-if #'keywordp (annotations-of step :wait-for)
                         :key (lambda (annotation) (first (last annotation))))
           collect (net-step-tag step))))

(defun step-code (step steps known begun)
  "Return a branch of a PARTIAL-ORDER that runs STEP, one of STEPS. BEGUN are the tags whose start
others wait for."
  (let ((tag (net-step-tag step)))
    `(:tag ,tag
       ,@(conditions-code step steps known)
       ,@(when (member tag begun) `((set-value ,(begin-variable tag) t)))
       ,(watched-code step known))))

(defun checked-orders (clause steps orders known)
  "Return the constraints (:order a b) of STEPS, those of the task net CLAUSE, with ORDERS."
  (let* ((explicit (net-orders steps orders))
         (all (remove-duplicates (append explicit (value-orders steps explicit known))
                                 :test #'equal)))
    (check-circles clause steps all)
    all))

(defun check-queries (steps known)
  (dolist (step steps)
    (dolist (query (queries-for step steps))
      (when query (variables-after query known)))))

(defun task-net-code (clause known results)
  "Return the plan text of CLAUSE, a task net. KNOWN are the Lisp variables that have values,
RESULTS those of the results of the RAP."
  (multiple-value-bind (steps orders) (parse-net (rest clause))
    (checked-steps steps)
    (let* ((given (step-results steps))
           (all (union given known))
           (begun (tags-awaited steps)))
      (check-queries steps all)
      `(let (,@(set-difference given (append results known))
             ,@(loop for tag in begun
                     collect `(,(begin-variable tag) (state ',(begin-variable tag)))))
         (shown-as ,clause
           (partial-order (,@(loop for step in steps
                                   collect (step-code step steps all begun)))
                          ,@(checked-orders clause steps orders known)))))))
