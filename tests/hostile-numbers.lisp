;;;; hostile-numbers.lisp -- any number in any place is used or refused with a message.

(in-package :ars-magna.tests)

(def-suite* numbers :in ars-magna)

(world:defmap abacus (12 12)
  (rect (0 0) (11 11) bricks 1 4 8 12)
  (obj ball (6 6) ((:size 1) (:color world:red) (:weight 2)))
  (obj box (3 3) ((:size 8) (:capacity 6)) (bead ((:size .1)))))

(robot:defrobot counter (abacus (4.5 8.5) 0) :cameras ((3 5)) :hands (10) :bins (20))

;;; The numbers. SBCL has no notation for some.

(defparameter *no-number* (base:bits-to-double #x7FF8000000000000))

(defparameter *infinities*
  (list sb-ext:double-float-positive-infinity sb-ext:double-float-negative-infinity
        sb-ext:single-float-positive-infinity sb-ext:single-float-negative-infinity))

(defparameter *never*
  (list* *no-number* (coerce *no-number* 'single-float) (expt 10 400) (- (expt 10 400))
         (+ 1/3 (expt 10 400)) *infinities*)
  "What is nowhere a number.")

(defparameter *hostile*
  (append *never*
          (list 0 -0d0 0d0 1 -1 100 1/3 (/ (expt 10 400)) (/ -1 (expt 10 320)) 1f0 1d0 .5d0
                least-positive-double-float least-negative-double-float
                least-positive-normalized-double-float least-positive-single-float
                (1+ (expt 2 30)) (expt 10 9) (1+ (expt 10 9)) (expt 10 15) (1+ (expt 10 15))
                most-positive-fixnum most-negative-fixnum (expt 2 64) 4d18 1d38 1d300 1d-300
                1d308 -1d308 most-positive-double-float most-negative-double-float
                most-positive-single-float
                #c(1 2) #c(1d0 1d0) nil "5" :five '(1 2) #(1))))

;;; Trying them.

(defun clear-trouble-p (condition)
  "True if CONDITION is an error of ours that says what would do."
  (typecase condition
    (base:wrong-argument (plusp (length (princ-to-string condition))))
    ((or base:malformed-definition base:misuse base:unknown-name) t)))

(defun answer-to (function number)
  "Call FUNCTION with NUMBER. Return :USED, :REFUSED, or the condition that is neither."
  (handler-case (handler-bind ((warning #'muffle-warning))
                  (funcall function number)
                  :used)
    (error (condition) (if (clear-trouble-p condition) :refused condition))))

(defun raw-messages ()
  "Return the messages queued that tell of an arithmetic error or one of type."
  (remove-if-not (lambda (text)
                   (some (lambda (words) (search words text))
                         '("arithmetic" "FLOATING-POINT" "DIVISION" "is not of type"
                           "divided by 0" "floating-point"
                           "The value" "is not a ")))
                 (mapcar #'base:message-text (base:take-messages))))

(defun try-in-run (function number)
  "Call FUNCTION with NUMBER in a run, which then goes on for some ticks. Return the outcome, and
what went wrong after it."
  (run:with-simulation (counter :seed 3)
    (let ((outcome (answer-to function number)))
      (handler-case (progn (run:run-ticks 12) (values outcome (raw-messages)))
        (error (condition) (values outcome (list (princ-to-string condition))))))))

(defun check-number (name function number)
  (multiple-value-bind (outcome after) (try-in-run function number)
    (is (member outcome '(:used :refused)) "~A of ~A: ~A" name (type-of number) outcome)
    (is (null after) "~A of ~S, later: ~A" name number after)
    (when (member number *never*)
      (is (eq :refused outcome) "~A took ~S" name number))
    outcome))

(defun check-numbers (name function)
  "Check that FUNCTION, of a number, uses some of them and refuses the others with a word."
  (is (member :used (loop for number in *hostile* collect (check-number name function number)))
      "~A uses none" name))

;;; Commands and parameters: all there are.

(defun sample-argument (type)
  "Return a good argument of TYPE, for a command of COUNTER."
  (ecase (base:make-keyword (symbol-name type))
    (:robot counter)
    (:camera (robot:robot-camera counter 0))
    (:hand (robot:robot-hand counter 0))
    (:storage-bin (robot:robot-storage-bin counter 0))
    ((:number :angle :speed :distance :ticks :tick-span :duration) 1)
    (:direction :east)
    (:designator-type :non-local)
    (:receiving-part :hand)
    (:part-number 0)
    (:recipient :all)
    (:message 1)
    (:specification '((:color world:red)))
    (:place-type 'world::corner)
    ((:designator :destination) (robot:robot-storage-bin counter 0))))

(defun numeric-p (spec)
  (member (command:spec-type spec) '(number angle speed ticks)
          :test #'base:same-name-p))

(defun manuals-commands ()
  (remove-if-not #'ours-p (command:all-commands) :key #'command:command-name))

(test numbers.commands-use-or-refuse
  (let ((tried 0))
    (dolist (command (manuals-commands))
      (loop for spec in (command:command-parameters command)
            for place from 0
            when (numeric-p spec)
              do (incf tried)
                 (let ((place place))
                   (check-numbers
                    (list (command:command-name command) (command:spec-name spec))
                    (lambda (number)
                      (let ((arguments (loop for spec in (command:command-parameters command)
                                             collect (sample-argument (command:spec-type spec)))))
                        (setf (nth place arguments) number)
                        (apply (command:command-name command)
                               (sample-argument (command:spec-type
                                                 (command:command-resource command)))
                               arguments)))))))
    (is (<= 5 tried))))

(defun busy-run (name number)
  "Let COUNTER do this and that where the parameter NAME is NUMBER."
  (run:with-simulation (counter :parameters `((,name ,number)))
    (let ((camera (robot:robot-camera counter 0)))
      (command:robot-turn counter 1)
      (command:camera-get-object-designator camera :non-local '((:color world:red))
                                            (lambda (err camera designator)
                                              (unless err
                                                (command:camera-track camera designator))))
      (run:run-ticks 12)
      (command:robot-go-forward counter 3)
      (command:camera-view camera)
      (run:run-ticks 12)
      (raw-messages))))

(test numbers.parameters-use-or-refuse
  "Set before a run begins; each has two limits, which it names."
  (dolist (parameter (base:all-parameters))
    (let ((name (base:parameter-name parameter)))
      (dolist (number *hostile*)
        (let ((outcome (answer-to (lambda (number)
                                     (let ((messages (busy-run name number)))
                                       (when messages (error "~A" messages))))
                                   number)))
          (is (member outcome '(:used :refused)) "~A ~S: ~A" name number outcome)
          (when (and (realp number) (member number (append *never* '(1d308))))
            (is (eq :refused outcome) "~A took ~S" name number)))))))

(test numbers.parameters-set-by-setf-are-checked-by-with-simulation
  (dolist (parameter (base:all-parameters))
    (let ((symbol (definitions::parameter-symbol parameter)))
      (progv (list symbol) (list *no-number*)
        (signals base:wrong-argument (run:with-simulation (counter)))))))

;;; Functions.

(defmacro calls (&rest forms)
  "Return a list of lists (form function): each of FORMS as a function of N."
  `(list ,@(loop for form in forms
                 collect `(list ',form (lambda (n) ,form)))))

(defun abacus () (robot:robot-world counter))
(defun dice () (world:world-dice (abacus) :user))
(defun bead () (world:find-thing 'ball))

(defun check-calls (calls)
  (loop for (form function) in calls do (check-numbers form function)))

(test numbers.geometry-uses-or-refuses
  (let ((pt (geo:make-pt 1 2)) (interval (geo:make-interval 1 2)))
    (let ((box (geo:make-pt-interval interval interval)))
      (check-calls
       (calls (geo:make-pt n 1) (geo:make-pt 1 n) (setf (geo:pt-x (geo:make-pt 1 2)) n)
              (setf (geo:pt-y (geo:make-pt 1 2)) n)
              (geo:make-interval n 1d308) (geo:make-interval -1d308 n)
              (setf (geo:interval-min (geo:copy-obj interval)) n)
              (setf (geo:interval-max (geo:copy-obj interval)) n)
              (geo:make-pt-interval n interval) (geo:make-pt-interval interval n)
              (geo:add interval n) (geo:add n 1d308) (geo:subtract n interval) (geo:neg n)
              (geo:mul pt n) (geo:mul box n) (geo:mul interval n) (geo:mul n 1d300)
              (geo:mul! (geo:copy-obj box) n) (geo:norm n) (geo:dist n interval)
              (geo:grow-interval interval n) (geo:grow-interval box n)
              (geo:interval-lift n) (geo:lift-lbi 1 n) (geo:lift-lbi n)
              (geo:add-to-lbi interval n) (geo:in-interval n interval) (geo:less n interval)
              (geo:greater interval n) (geo:interval-dist n interval)
              (geo:interval-intersect? n interval) (geo:atan2 n 1) (geo:atan2 1 n)
              (geo:angle-difference n 1) (geo:angle-difference 1 n) (geo:nearest-angle n 1)
              (geo:nearest-angle 1 n 2))))))

(test numbers.geometry-refuses-what-gets-too-large
  (let ((far (geo:make-pt 1d308 -1d308)) (wide (geo:make-interval -1d308 1.5d308)))
    (dolist (function (list (lambda () (geo:add far far)) (lambda () (geo:mul far 10))
                            (lambda () (geo:norm far)) (lambda () (geo:interval-width wide))
                            (lambda () (geo:mul wide wide)) (lambda () (geo:nominal far))
                            (lambda () (geo:pt-interval-dx (geo:make-pt-interval wide 1)))))
      (signals base:wrong-argument (funcall function)))))

(test numbers.worlds-use-or-refuse
  (check-calls
   (calls (robot:place-robot counter n 2 0) (robot:place-robot counter 2 n 0)
          (robot:place-robot counter 2 2 n)
          (world:kick-thing (bead) n 0 t) (world:kick-thing (bead) 0 n t)
          (world:move-thing (bead) n 3) (world:move-thing (bead) (list 3 n))
          (world:wall-at-p (world:world-map (abacus)) n 1)
          (world:wall-at-p (world:world-map (abacus)) 1 n)
          (world:map-cell (world:world-map (abacus)) n 1) (world:things-at (abacus) n 1)
          (world:things-at (abacus) 1 n)
          (world:make-new-thing 'cube (list 'abacus n 2) '((:size 1)))
          (world:make-new-thing 'cube (list 'abacus 2 2) `((:size ,n)))
          (world:make-new-thing 'cube (list 'abacus 2 2) `((:substance ,n)))
          (world:set-attribute (bead) :weight n) (world:set-attribute (bead) :capacity n)
          (world:set-attribute (bead) :substance (list 'wood n))
          (world:change-attribute (bead) `((:size ,n)))
          (robot:robot-camera counter n) (robot:robot-hand counter n)
          (base:chance n (dice)) (base:roll-between n 1 (dice)) (base:roll-between 0 n (dice))
          (base:roll-within n (dice)) (base:roll-index n (dice))
          (base:roll-gaussian n 1 (dice)) (base:roll-gaussian 0 n (dice)))))

(test numbers.of-attributes-nobody-defined-are-finite
  (run:with-simulation (counter)
    (dolist (number (list* *no-number* *infinities*))
      (signals base:wrong-argument (world:set-attribute (bead) :luck number)))
    (dolist (number (list (expt 10 400) (+ 1/3 (expt 10 400)) #c(1 2)))
      (is (= number (world:set-attribute (bead) :luck number)))
      (is (integerp (run:state-digest))))))

(test numbers.runs-use-or-refuse
  (check-calls
   (calls (when (or (not (realp n)) (member n *never*) (< n 1000) (> n 1000000000))
            (run:run-ticks n) (error 'base:misuse :text "so few are used"))
          (run:step-ticks (if (typep n '(integer 1000 1000000000)) 10 n))
          (time:set-rate n) (run:await-idle time:*simulation* n)
          (time:schedule ('x :timer n) 1) (time:schedule ('x :priority n) 1)
          (time:schedule ('x :when nil :timeout n) 1)
          (display:text-map counter :columns n) (display:text-map counter :radius n)
          (display::svg-picture counter :scale n)
          (display::check-animation nil nil n :world '() 8 nil)
          (display::check-animation nil n 10 :world '() 8 nil)
          (ars-magna.canvas::check-pen nil n nil))))

(test numbers.of-plans-are-used-or-refused
  (dolist (number *hostile*)
    (let ((never (rpl:create-fluent 'never)))
      (dolist (plan (list (rpl:interp-lambda () (rpl:wait-time number) :done)
                          (rpl:interp-lambda () (rpl:wait-for never :timeout number) :done)
                          (rpl:interp-lambda () (rpl:n-times number (return)) :done)))
        (let ((result (with-messages (rpl:run-plan-alone plan))))
          (cond ((and (realp number) (not (member number *never*)) (<= (abs number) (expt 10 15)))
                 (is (eq :done result) "~S: ~A" number result))
                ((null number))
                (t (is (typep (rpl:lisp-failure-condition result) 'base:wrong-argument)
                       "~S: ~A" number result))))))))

(test numbers.of-lines-are-refused-with-their-range
  (dolist (line '("rate 1d-300" "rate 1d300" "rate 1/100000" "rate 0" "rate -5"))
    (is (search "from 0.001 to 1000000" (complaint line))))
  (dolist (line '("turn 1d300" "go-forward 1000000001" "pos 1d10 3" "angle -1d10"))
    (is (search "from -1e9 to 1e9" (complaint line)))))

(test numbers.definitions-use-or-refuse
  (with-own-definitions
    (check-calls
     (calls (eval `(world:defmap hall-of-n (,n 5)))
            (eval `(world:defmap hall-of-n (9 9) (rect (0 ,n) (8 8) bricks 1)))
            (eval `(world:defmap hall-of-n (9 9) (wall (0 1) (8 8) bricks ,n)))
            (eval `(world:defmap hall-of-n (9 9) (circle (,n 1) 3 bricks 1)))
            (eval `(world:defmap hall-of-n (9 9) (obj ball (,n 1) ((:size 1)))))
            (eval `(world:defmap hall-of-n (9 9) (obj ball (1 1) ((:size ,n)))))
            (eval `(robot:defrobot robot-of-n (abacus (',n 3) 0)))
            (eval `(robot:defrobot robot-of-n (abacus (3 3) ',n)))
            (eval `(robot:defrobot robot-of-n (abacus (3 3) 0) :cameras ((',n 3))))
            (eval `(robot:defrobot robot-of-n (abacus (3 3) 0) :cameras ((1 ',n))))
            (eval `(robot:defrobot robot-of-n (abacus (3 3) 0) :hands (',n)))
            (eval `(robot:defrobot robot-of-n (abacus (3 3) 0) :bins (',n)))
            (eval `(world:defsubstance stuff-of-n ',n))
            (eval `(world:defattribute :luck-of-n numeric :base ',n))
            (eval `(world:defattribute :luck-of-n numeric :max-mult ',n))
            (eval `(world:defattribute :luck-of-n (a b) :success ',n))
            (eval `(world:defkicker kick-of-n (thing) (:prob ',n)))
            (eval `(world:def-place-type spot-of-n (cell)
                      :check-matchers ((((-)) 1)) :confusion ',n))
            (eval `(world:def-place-type spot-of-n (cell) :check-matchers ((((-)) ',n))))))))
