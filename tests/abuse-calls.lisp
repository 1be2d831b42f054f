;;;; abuse-calls.lisp -- commands and functions called with wrong arguments.

(in-package :ars-magna.tests)

;;; In an example :SENSIBLE stands for a valid argument, which is chosen when the example is tried.

(defun run-about ()
  "Let a dozen ticks pass; the world must not contradict itself."
  (run:run-ticks 12)
  (find-contradictions (run:simulation-world (time:current-simulation)))
  (run:state-digest))

(defmacro in-zoo ((seed) &body body)
  "Run BODY in a fresh zoo, where *RIDE* has dice of SEED."
  `(run:with-simulation ((keeper helper) :seed 5)
     (let ((*ride* (make-ride (base:make-dice ,seed))))
       ,@body)))

(defun mixed-arguments (count dice)
  "Return COUNT arguments, one of them hostile, the others sensible or, rarely, hostile as well."
  (let ((which (base:roll-index (max 1 count) dice)))
    (loop for i below count
          collect (if (or (= i which) (base:chance .2 dice)) (hostile dice) :sensible))))

(define-abuse commands (example)
    (let ((command (base:roll-element (own-commands) dice)))
      (list* (base:roll-index 1000000000 dice) (command:command-name command)
             (mixed-arguments (+ 1 (length (command:command-parameters command))
                                 (one-of dice 0 0 0 1))
                              dice)))
  (destructuring-bind (seed name &rest arguments) example
    (in-zoo (seed)
      (let ((command (command:find-command name)))
        (unwind-protect
             (apply name (loop for argument in arguments
                               for specs = (cons (command:command-resource command)
                                                 (command:command-parameters command))
                                 then (rest specs)
                               collect (if (and specs (eq argument :sensible))
                                           (sensible-argument (command:spec-type (first specs)))
                                           argument)))
          (run-about)
          ;; A function may be called if it came last, as the continuation.
          (when (functionp (first (last arguments))) (setf *sprung* 0)))))))

(define-abuse specifications (example)
    (list (base:roll-index 1000000000 dice)
          (one-of dice :local :non-local)
          (form-mutant (base:roll-element '(((:size (1 3)) (:color (red blue)) (:weight 2 1))
                                            ((:closed nil) (:mood good) (:size 4))
                                            ((:substance (10 90)) (:capacity (1 9) .5)))
                                          dice)
                       dice :keep 0))
  (destructuring-bind (seed type specification) example
    (in-zoo (seed)
      (command:camera-get-object-designator (part-of-any #'robot:robot-cameras)
                                            type specification)
      (run-about))))

;;; Functions: those that users call, but for those that pass time or ask people.

(defparameter *not-called*
  '("CLI" "SIMULATOR" "OPEN-DISPLAY" "STOP-SIMULATOR" "PAUSE" "RESUME" "AWAIT-IDLE" "SAVE-JOURNAL"
    "SAVE-PICTURE" "SAVE-ANIMATION" "RUN-TICKS" "RUN-UNTIL" "STEP-TICKS" "MAP" "ASK" "EQUAL"
    "SET-RATE"))

(defun user-functions ()
  "Return the functions that ARS exports, symbols, in alphabetical order."
  (sort (loop for symbol being the external-symbols of :ars
              when (and (fboundp symbol)
                        (not (macro-function symbol))
                        (not (slot-reader-p symbol))
                        (not (member (symbol-name symbol) *not-called* :test #'string=)))
                collect symbol)
        #'string<))

(defun slot-reader-p (symbol)
  "True if SYMBOL names a reader of a structure's or condition's slot, which Lisp itself checks the
argument of."
  (let ((function (fdefinition symbol)))
    (if (typep function 'generic-function)
        (equal '(condition) (shown-lambda-list symbol))
        (let ((parameters (host:declared-lambda-list function)))
          ;; The name that DEFSTRUCT gives its readers' parameter.
          (and (typep parameters '(cons symbol null))
               (string= "INSTANCE" (first parameters))
               (host:lisp-symbol-p (first parameters)))))))

(defun shown-lambda-list (symbol)
  "Return the lambda list of the function SYMBOL. Of a generic one, its code has none of its own."
  (if (typep (fdefinition symbol) 'generic-function)
      (uiop:symbol-call :sb-introspect '#:function-lambda-list symbol)
      (host:declared-lambda-list (fdefinition symbol))))

(defun parameters-of (symbol)
  "Return lists (name kind) of the parameters of the function SYMBOL; the kinds are NIL, &OPTIONAL,
&KEY and &REST."
  (loop with kind = nil
        for parameter in (shown-lambda-list symbol)
        for name = (if (consp parameter) (first parameter) parameter)
        if (member name lambda-list-keywords)
          do (setf kind name)
        else
          collect (list (string name) kind)))

(defun sensible-by-name (name)
  "Return something that a function's parameter called NAME, a string, may well take."
  (flet ((named (&rest names) (member name names :test #'string=)))
    (cond ((named "ROBOT") (any-robot))
          ((named "CAMERA") (part-of-any #'robot:robot-cameras))
          ((named "HAND") (part-of-any #'robot:robot-hands))
          ((named "STORAGE-BIN") (part-of-any #'robot:robot-bins))
          ((named "THING" "OBJECT" "LOCATION") (pick (world:world-thing-list world:*world*)))
          ((named "WORLD") world:*world*)
          ((named "MAP") (world:find-map 'zoo))
          ((named "SIMULATION") (time:current-simulation))
          ((named "INTERVAL") (geo:make-interval 1 2))
          ((named "A" "B") (pick (list 2 (geo:make-pt 1 2) (geo:make-interval 1 2))))
          ((named "DICE") (base:make-dice 1))
          ((named "ODOMETER") (robot:robot-main-odometer (any-robot)))
          ((named "DESCRIPTOR" "SPECIFICATION") '((:size 1) (:color red)))
          ((named "NEW-VALUE") 'red)
          ((named "ATTRIBUTE") (pick '(:color :size)))
          ((named "CELL") (world:map-cell (world:find-map 'zoo) 3 3))
          ((named "NAME" "KICKER-NAME") (pick '(box open ride-hop size)))
          ((named "FUNCTION" "PREDICATE" "CONTINUATION") (constantly nil))
          ((named "RESOURCE") (part-of-any #'robot:robot-hands))
          (t (pick '(1 2 .5 :local))))))

(define-abuse functions (example)
    (let* ((name (base:roll-element (user-functions) dice))
           (parameters (parameters-of name)))
      (list* (base:roll-index 1000000000 dice) name
             (mixed-arguments (base:roll-element (list (count nil parameters :key #'second)
                                                       (length parameters))
                                                 dice)
                              dice)))
  (destructuring-bind (seed name &rest arguments) example
    (in-zoo (seed)
      (unwind-protect
           (apply name (loop for argument in arguments
                             for (parameter kind) in (parameters-of name)
                             when (eq kind '&key) collect (intern parameter :keyword)
                             collect (if (eq argument :sensible)
                                         (sensible-by-name parameter)
                                         argument)))
        (setf *sprung* 0)
        (run-about)))))
