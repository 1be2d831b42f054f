;;;; clauses.lisp -- the clauses of DEFEXPERIMENT: reading and checking them.

(in-package :ars-magna.experiment)

;;;; Designs: samples from ranges, instead of all combinations

;;; :VARY takes (KIND N range...) or (KIND N :SEED seed range...). A RANGE is (what low high), or
;;; (what low high :INTEGER) or (what low high :LOG).

(defun design-part-p (part)
  (member (first part) '(:latin-hypercube :sobol :random)))

(defun design-ranges (part)
  (if (eq :seed (third part)) (cddddr part) (cddr part)))

(defun design-seed (part)
  (if (eq :seed (third part)) (fourth part) 0))

(defun vary-part-names (part)
  (if (design-part-p part)
      (mapcar #'first (design-ranges part))
      (list (first part))))

;;; Values. They are rounded, so that conditions have short names.

(defconstant +design-digits+ 6 "The number of significant digits of numbers of designs.")

(defun check-bounds (definition range low high)
  (let* ((scale (fourth range))
         (expected (cond ((not (and (bounded-number-p low) (bounded-number-p high) (< low high)))
                          "two numbers, from -1e15 to 1e15, the lower number first")
                         ((and (eq :integer scale) (notevery #'integerp (list low high)))
                          "two integers")
                         ((and (eq :log scale) (not (plusp low))) "two numbers above 0"))))
    (when expected
      (reject-clause definition range
                     (format nil "~A; not ~A and ~A" expected (safe-text low) (safe-text high))))))

(defun round-to-power-of-ten (value power)
  (let ((step (expt 10 power)))
    (float (* step (round (rational value) step)) 1d0)))

(defun value-on-scale (low high scale share)
  "SHARE is from 0 to below 1. Return the number at this share of the range LOW to HIGH on SCALE."
  (ecase scale
    (:integer (+ low (floor (* (rational share) (- (1+ high) low)))))
    (:log (let* ((start (logarithm (float low 1d0)))
                 (value (exponential (+ start (* share (- (logarithm (float high 1d0)) start))))))
            (round-to-power-of-ten value (- (decimal-exponent (rational value))
                                            (1- +design-digits+)))))
    ((nil) (let ((width (- (rational high) (rational low))))
             (round-to-power-of-ten (+ (rational low) (* (rational share) width))
                                    (- (decimal-exponent width) (1- +design-digits+)))))))

(defun settings-of-design (definition part bounds)
  "Return a list of settings for each point of the design PART. BOUNDS are lists (low high), one for
each of its ranges. Equal points count once; ranges of few integers give equal points."
  (let ((ranges (design-ranges part)))
    (loop for range in ranges
          for (low high) in bounds
          do (check-bounds definition range low high))
    (remove-duplicates
     (loop for point in (design-points (first part) (second part) (length ranges)
                                       (design-seed part))
           collect (loop for share in point
                         for (name nil nil scale) in ranges
                         for (low high) in bounds
                         collect (list name (value-on-scale low high scale share))))
     :test #'equal :from-end t)))

;;;; All clauses

(defparameter *clause-syntax*
  '((:robots "(:robots name...), robots of one map; in place of a name also ~
              (name :as other-name :at (x y) :angle a)")
    (:parameters "(:parameters (parameter form)...)")
    (:clean "(:clean) or (:clean t)")
    (:ghosts "(:ghosts) or (:ghosts t)")
    (:thinking "(:thinking mode), as WITH-SIMULATION takes it")
    (:vary "(:vary part...). A part is (what form...), (what :in form) with values in a list, or a ~
            design such as (:sobol n (what low high)...)")
    (:conditions "(:conditions (name (what form)...)...)")
    (:trials "(:trials n), an integer from 1 to 1e9")
    (:seed "(:seed n), an integer")
    (:limit "(:limit n), a number of ticks from 1 to 1e9")
    (:time-limit "(:time-limit n), a number of seconds from .001 to 1e9")
    (:run "(:run form...)")
    (:until "(:until form)")
    (:success "(:success form)")
    (:measure "(:measure part...). A part is (name form); the name of a measure that DEFMEASURE ~
               has defined; or (name :over summary) for such a measure, sampled at each tick, with ~
               the summary :mean, :sum, :max or :min")
    (:each-tick "(:each-tick part...). A part is (name form), or the name of a measure that ~
                 DEFMEASURE has defined"))
  "The clauses and their syntax.")

(defun clause-usage (key)
  (format nil (second (assoc key *clause-syntax*))))

(defun reject-by-usage (definition clause)
  (reject-clause definition clause (clause-usage (first clause))))

(defun clause-key (definition clause)
  (unless (and (proper-list-p clause) (assoc (first clause) *clause-syntax*))
    (let* ((keys (mapcar #'first *clause-syntax*))
           (word (and (consp clause) (symbolp (first clause)) (first clause)))
           (nearest (and word (nearest-name word keys))))
      (reject-clause definition clause
                     (format nil "~@[the clause ~(~S~); or one of the others, ~]a list that ~
                                  begins with ~{~(~S~)~^, ~} or ~(~S~)"
                             (and nearest (find nearest keys :test #'same-name-p))
                             (butlast keys) (first (last keys))))))
  (first clause))

(defun check-clauses (definition clauses)
  (loop for (clause . others) on clauses
        for key = (clause-key definition clause)
        when (find key others :key (lambda (other) (and (consp other) (first other))))
          do (reject-clause definition clause (format nil "one clause ~(~S~) only" key))))

(defun clause-arguments (key clauses)
  "Return two values: the arguments of the clause KEY, and whether CLAUSES has such a clause."
  (let ((clause (find key clauses :key #'first)))
    (values (rest clause) (and clause t))))

(defun check-elements (definition clause test &optional (expected (clause-usage (first clause))))
  "Signal MALFORMED-DEFINITION if CLAUSE has only a key, or for the first of its other elements that
fails TEST."
  (unless (rest clause) (reject-by-usage definition clause))
  (dolist (element (rest clause))
    (unless (funcall test element) (reject-clause definition element expected))))

(defun check-names-differ (definition clause names)
  (loop for (name . others) on names
        when (member name others)
          do (reject-clause definition clause
                            (format nil "each name once, not ~(~A~) twice" name))))

;;; Names. What varies is a parameter, :ROBOTS, :THINKING, or a variable.

(defun check-visible-name (definition clause name)
  "Signal MALFORMED-DEFINITION about CLAUSE unless the symbol NAME can name a column."
  (unless (and (string/= "" name) (every #'writable-char-p (symbol-name name)))
    (reject-clause definition clause
                   (format nil "another name: names of columns must not be empty or contain ~
                                characters that cannot be seen, such as line feeds"))))

(defun keyword-factor-p (name)
  (member name '(:robots :thinking)))

(defun special-p (name)
  (special-variable-p name nil))

(defun can-vary-p (name)
  (and name (symbolp name) (not (keywordp name))
       (or (parameter-of-variable name)
           (null (variable-kind name))
           (and (special-p name) (not (package-locked-p (symbol-package name)))))))

(defun reason-not-to-vary (name)
  "Return a text about NAME, which cannot be varied."
  (cond ((not (and name (symbolp name))) "no name")
        ((eq :symbol-macro (variable-kind name))
         "a run variable or other symbol macro: vary another name, and set it to that in :run")
        (t "Lisp's or the simulator's")))

(defun check-factor-name (definition part)
  (unless (or (keyword-factor-p (first part)) (can-vary-p (first part)))
    (reject-clause definition part
                   (format nil "something to vary: a parameter, :robots, :thinking, or your own ~
                                variable; ~(~A~) is ~A"
                           (safe-text (first part)) (reason-not-to-vary (first part))))))

(defun check-factor (definition part)
  (unless (and (proper-list-p part) (rest part))
    (reject-clause definition part (clause-usage :vary)))
  (when (and (eq :in (second part)) (/= 3 (length part)))
    (reject-clause definition part "(what :in form)"))
  (let ((list (find-if (lambda (form) (typep form '(cons number))) (rest part))))
    (when list
      (reject-clause definition part
                     (format nil "values one by one, as in (~(~A~)~{ ~S~}): ~S is not a ~
                                  form" (first part) list list))))
  (check-factor-name definition part))

(defun check-range (definition range)
  "Signal MALFORMED-DEFINITION unless RANGE is a range of a factor whose values are numbers."
  (unless (and (proper-list-p range)
               (or (= 3 (length range))
                   (and (= 4 (length range)) (member (fourth range) '(:integer :log)))))
    (reject-clause definition range "a range (what low high), perhaps with :integer or :log"))
  (when (keyword-factor-p (first range))
    (reject-clause definition range "a parameter, or a variable, whose values are numbers"))
  (check-factor-name definition range))

(defun check-design (definition part)
  (let ((ranges (and (proper-list-p part) (> (length part) 2) (design-ranges part))))
    (unless (and ranges (typep (second part) '(integer 1 100000))
                 (integerp (design-seed part)))
      (reject-clause definition part
                     (format nil "(:sobol n (what low high)...), or :latin-hypercube or :random, ~
                                  with N from 1 to 100000, perhaps (:sobol n :seed integer ...), ~
                                  and :integer or :log after a range")))
    (dolist (range ranges) (check-range definition range))
    (when (and (eq :sobol (first part)) (> (length ranges) +most-dimensions+))
      (reject-clause definition part
                     (format nil "~D ranges at most; :latin-hypercube and :random take more"
                             +most-dimensions+)))))

(deftype named-form ()
  "A list (name form)."
  '(cons (and symbol (not null)) (cons t null)))

;;; Measures, in the clauses :measure and :each-tick.

(defun valid-measure-part-p (key part)
  "True if PART can be a part of the clause KEY, :measure or :each-tick."
  ;; A keyword as the form is a slip, such as (score :mean).
  (or (and (typep part 'named-form) (not (keywordp (second part))))
      (multiple-value-bind (name summary) (parse-measure part)
        (and name (not (keywordp name)) (or (null summary) (eq :measure key))))))

(defun named-measure-part (part)
  "Return three values for PART of :measure or :each-tick: the name of its column; a form for the
value; and, for a measure that is sampled at each tick, the summary. The fourth value is the name
of the measure, if PART names one that DEFMEASURE has defined."
  (multiple-value-bind (name summary) (parse-measure part)
    (if name
        (values (if summary (symbolicate name '- summary) name)
                (if summary `(measured-number ',name) `(measure-value ',name))
                summary
                name)
        (values (first part) (second part) nil nil))))

(defun column-of-part (part)
  (values (named-measure-part part)))

(defun check-case (definition case)
  (unless (and (proper-list-p case) (symbolp (first case)) (first case) (rest case)
               (every (lambda (part) (typep part '(cons t (cons t null)))) (rest case)))
    (reject-clause definition case "a condition (name (what form)...)"))
  (check-visible-name definition case (first case))
  (check-names-differ definition case (mapcar #'first (rest case)))
  (mapc (lambda (part) (check-factor-name definition part)) (rest case)))

(defun check-same-factors (definition cases)
  (let ((names (mapcar #'first (rest (first cases)))))
    (dolist (case (rest cases))
      (when (set-exclusive-or names (mapcar #'first (rest case)))
        (reject-clause definition case
                       (format nil "values for ~{~(~A~)~^, ~}, as in ~(~A~)" names
                               (first (first cases))))))))

(defun varied-names (clauses)
  (remove-duplicates
   (append (loop for case in (clause-arguments :conditions clauses)
                 append (mapcar #'first (rest case)))
           (loop for part in (clause-arguments :vary clauses) append (vary-part-names part)))
   :from-end t))

(defun varied-variables (clauses)
  (remove-if (lambda (name) (or (keyword-factor-p name) (parameter-of-variable name)))
             (varied-names clauses)))

;;; Checking all clauses.

(defun check-columns (definition taken clauses key)
  "Signal MALFORMED-DEFINITION if two columns of a table would have the same name. The columns are
those TAKEN, the factors in CLAUSES, and the names in the clause KEY."
  (flet ((check (name clause)
           (check-visible-name definition clause name)
           (when (member name taken :test #'string-equal)
             (reject-clause definition clause
                            (format nil "another name; the table has a column ~(~A~) already"
                                    name)))
           (push name taken)))
    (dolist (name (varied-names clauses)) (check name name))
    (dolist (part (clause-arguments key clauses)) (check (column-of-part part) part))))

(defun check-column-names (definition clauses)
  (let ((before (append *columns-before-factors*
                        (and (clause-arguments :conditions clauses) '("case")))))
    (check-columns definition (append before *columns-before-measures* *columns-after-measures*)
                   clauses :measure)
    (check-columns definition (append before *columns-before-values*) clauses :each-tick)))

(defun check-number-clause (definition clause test)
  (unless (and (= 2 (length clause)) (funcall test (second clause)))
    (reject-by-usage definition clause)))

(defun seconds-p (value)
  (and (bounded-number-p value) (<= 1/1000 value +largest+)))

(defun check-clause (definition clause)
  (ecase (first clause)
    (:robots (check-elements definition clause
                             (lambda (element)
                               (typep element '(or (and symbol (not null))
                                                (cons symbol (cons keyword)))))))
    (:parameters
     (check-elements definition clause
                     (lambda (part)
                       (and (typep part 'named-form) (parameter-of-variable (first part))))
                     "(parameter form), with a parameter of the simulation such as max-speed*")
     (check-names-differ definition clause (mapcar #'first (rest clause))))
    ((:clean :ghosts)
     (unless (member (rest clause) '(() (t) (nil)) :test #'equal)
              (reject-by-usage definition clause)))
    (:vary (check-elements definition clause #'consp)
     (dolist (part (rest clause))
       (if (design-part-p part) (check-design definition part) (check-factor definition part)))
     (check-names-differ definition clause
                         (loop for part in (rest clause) append (vary-part-names part))))
    (:conditions (check-elements definition clause #'consp)
     (dolist (case (rest clause)) (check-case definition case))
     (check-names-differ definition clause (mapcar #'first (rest clause)))
     (check-same-factors definition (rest clause)))
    ((:trials :limit)
     (check-number-clause definition clause
                          (lambda (n) (and (integerp n) (<= 1 n +largest+)))))
    (:time-limit (check-number-clause definition clause #'seconds-p))
    (:seed (check-number-clause definition clause #'integerp))
    (:run (unless (rest clause) (reject-by-usage definition clause))
     (check-run-clause definition clause))
    (:thinking (unless (= 2 (length clause)) (reject-by-usage definition clause)))
    ((:until :success) (check-test-clause definition clause))
    ((:measure :each-tick)
     (check-elements definition clause (lambda (part) (valid-measure-part-p (first clause) part)))
     (dolist (part (rest clause))
       (when (typep part 'named-form) (warn-of-quoted-measure definition part))))))

(defun check-all-clauses (definition name clauses)
  (check-clauses definition clauses)
  (dolist (clause clauses) (check-clause definition clause))
  (flet ((given-p (key) (nth-value 1 (clause-arguments key clauses))))
    (unless (or (given-p :robots) (member :robots (varied-names clauses)))
      (reject-clause definition (list name +more+) "a clause (:robots name...)"))
    (unless (given-p :run) (reject-clause definition (list name +more+) "a clause (:run form...)")))
  (when (and (clause-arguments :thinking clauses) (member :thinking (varied-names clauses)))
    (reject-clause definition (find :thinking clauses :key #'first)
                   "no clause (:thinking mode) if :thinking varies"))
  (dolist (part (clause-arguments :vary clauses))
    (when (find-if (lambda (case)
                     (intersection (vary-part-names part) (mapcar #'first (rest case))))
                   (clause-arguments :conditions clauses))
      (reject-clause definition part "something that the :conditions do not vary already")))
  (check-column-names definition clauses)
  (warn-of-unnamed-measures :measure clauses)
  (warn-of-unnamed-measures :each-tick clauses)
  (warn-of-nested-run (clause-arguments :run clauses))
  (warn-of-plan-as-test (first (last (clause-arguments :run clauses))))
  (warn-of-unused-variables clauses))
