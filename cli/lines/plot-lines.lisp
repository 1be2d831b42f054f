;;;; plot-lines.lisp -- quantities over time: PLOT, PLOT-TICKS, PLOT-PICTURE.

(in-package :ars-magna.cli)

(export '(plottable-names))

;;; The quantities that have names.

(defun zero-if-rounded (metres)
  "Return METRES, a double-float, or 0 if METRES may be a rounding error."
  (declare (type double-float metres))
  (if (< metres 1d-9) 0d0 metres))

(defun speed-now (robot tick)
  "Return how many metres ROBOT has driven in the tick TICK."
  (if (= (the fixnum tick) (the fixnum (robot-drove-tick robot)))
      (zero-if-rounded (abs (robot-moved robot)))
      0d0))

(defun distance-function (metres tick)
  "Return a function that adds up the distance that a robot drives, from METRES at TICK or from 0."
  (let ((metres (or metres 0d0)) (last tick))
    (lambda (robot now)
      (when (and last (> now last)) (incf metres (speed-now robot now)))
      (setf last now)
      metres)))

(defun reckoning-error (robot tick)
  "Return the distance between the position of ROBOT and the estimate of its main odometer."
  (declare (ignore tick))
  (multiple-value-bind (x y) (odometer-estimate (robot-main-odometer robot))
    (zero-if-rounded (distance-to robot x y))))

(defun stateless-maker (function)
  "Return the maker of a quantity that FUNCTION, of a robot and a tick, returns."
  (lambda (value tick)
    (declare (ignore value tick))
    function))

(defparameter *named-quantities*
  (list (make-quantity "speed" "m/tick" (stateless-maker #'speed-now))
        (make-quantity "distance" "m" #'distance-function)
        (make-quantity "odometer-error" "m" (stateless-maker #'reckoning-error)))
  "The quantities that users plot by name.")

;;; Fluents. A run has its own fluents, so the variable is read for each sample.

(defun value-of-variable (variable robot)
  "Return the value of VARIABLE, or what it stands for in plans of ROBOT if it is one of the robot's
fluents; NIL if no plan has driven ROBOT."
  (if (assoc variable (all-fluent-variables))
      (fluent-of-robot variable robot)
      (symbol-value variable)))

(defun fluent-in-variable (variable index robot)
  "Return the fluent in VARIABLE or, if its value is a vector, in the element INDEX; or NIL. ROBOT
is as for VALUE-OF-VARIABLE."
  (let* ((value (value-of-variable variable robot))
         (fluent (if (and index (simple-vector-p value) (< index (length value)))
                     (svref value index)
                     value)))
    (and (fluent-p fluent) fluent)))

(defun fluent-quantity (variable index)
  "Return the quantity that plots the fluent in VARIABLE, or in element INDEX of the vector there.
If the fluent is only pulsed, the quantity is the number of pulses."
  (let ((pulsed-p (known-pulse-p variable)))
    (make-quantity (format nil "~(~A~)~@[ ~D~]" variable index) ""
                   (stateless-maker
                    (lambda (robot tick)
                      (declare (ignore tick))
                      (let ((fluent (fluent-in-variable variable index robot)))
                        (and fluent (if pulsed-p (peek-pulses fluent) (peek-fluent fluent))))))
                   t)))

(defun fluents-count (variable kind)
  "Return the number of fluents in VARIABLE, one for each part of KIND. Return NIL if KIND is NIL."
  (and kind
       (let ((value (value-of-variable variable (session-robot))))
         (if (simple-vector-p value)
             (length value)
             (length (parts-of-kind (session-robot) (make-keyword (string-upcase kind))))))))

(defun find-fluent-quantity (variable index)
  (let* ((kind (vector-variable-kind variable)) (count (fluents-count variable kind)))
    (cond ((null kind)
           (when index (reject-line "~(~A~) is one fluent. Leave out the number." variable))
           (fluent-quantity variable nil))
          ((and index (< index count)) (fluent-quantity variable index))
          (t (reject-line "~(~A~) has a fluent for each ~A. Give its number, from 0 to ~D: PLOT ~
                           ~(~:*~:*~:*~A~) 0."
                          variable kind (1- count))))))

(defun fluent-variable-p (symbol)
  (or (known-fluent-variable-p symbol)
      (vector-variable-kind symbol)
      (and (boundp symbol) (fluent-p (symbol-value symbol)))))

;;; Functions of the user's.

(defun function-quantity (name function)
  (make-quantity name "" (stateless-maker (lambda (robot tick)
                                            (declare (ignore tick))
                                            (funcall function robot)))
                 t))

(defun run-quantity (name documentation function)
  "Return the quantity NAME, a symbol, that FUNCTION computes from the state of the current run."
  (make-quantity (string-downcase name) ""
                 (stateless-maker (lambda (robot tick)
                                    (declare (ignore robot tick))
                                    (funcall function)))
                 t documentation))

(defun measure-quantity (measure)
  (let ((name (measure-name measure)))
    (run-quantity name (documentation name 'measure) (lambda () (measure-value measure)))))

(defun run-variable-typed (symbol)
  "Return the name of the run variable that SYMBOL means, which may be of another package: one that
the current run has, if there are several."
  (let ((name (variable-definition-name (find-run-variable symbol))))
    (or (and (not (eq name symbol))
             *simulation*
             (find symbol (mapcar #'first (run-variables *simulation*)) :test #'string=))
        name)))

(defun run-variable-quantity (name)
  (run-quantity name (documentation name 'variable) (lambda () (run-variable name))))

(defun measure-names ()
  "Return the names of all measures, as typed."
  (mapcar (lambda (measure) (string-downcase (measure-name measure))) (all-measures)))

(defun run-variable-names ()
  "Return the names of all run variables, as typed."
  (mapcar #'string-downcase (mapcar #'variable-definition-name (all-run-variables))))

(defun plottable-names (robot)
  "Return the names of the quantities and fluents of ROBOT that can be plotted."
  (append (mapcar #'quantity-name *named-quantities*)
          (measure-names)
          (run-variable-names)
          (loop for (variable kind) in (all-fluent-variables)
                for name = (string-downcase variable)
                if kind
                  append (loop for index below (length (parts-of-kind robot (make-keyword kind)))
                               collect (format nil "~A ~D" name index))
                else collect name)))

(defun plottable-text ()
  "Return a text about what can be plotted."
  (format nil "~{~A~^, ~}~@[; a measure (~{~A~^, ~})~]~@[; a run variable (~{~A~^, ~})~]; a ~
               fluent, such as robot-stopped* or hand-moved* 0; or a function of a robot, such as ~
               robot-x or (lambda (robot) ...)"
          (mapcar #'quantity-name *named-quantities*)
          (names-to-show (measure-names))
          (names-to-show (run-variable-names))))

(defun reject-plot (text)
  (let ((similar (nearest-name text (plottable-names (session-robot)))))
    (reject-line "~A cannot be plotted~@[; did you mean ~A?~]~:*~:[.~;~] PLOT takes ~A."
                 text similar (plottable-text))))

(defun lambda-quantity (form text)
  "Return the quantity that the lambda expression FORM, typed as TEXT, computes."
  (handler-case (function-quantity text (eval-quietly form))
    (error (condition)
      (reject-line "~A is not a function: ~A." text (one-line-text condition)))))

(defun quantity-for-datum (datum index text)
  (cond ((typep datum '(cons (eql function) (cons t null)))
         (quantity-for-datum (second datum) index text))
        ((typep datum '(cons (eql lambda))) (lambda-quantity datum text))
        ((or (null datum) (not (symbolp datum))) (reject-plot text))
        ((fluent-variable-p datum) (find-fluent-quantity datum index))
        ((find-measure datum nil) (measure-quantity (find-measure datum)))
        ((find-run-variable datum nil) (run-variable-quantity (run-variable-typed datum)))
        ((and (fboundp datum) (not (macro-function datum)) (not (special-operator-p datum)))
         (function-quantity (string-downcase datum) datum))
        (t (reject-plot text))))

(defun find-quantity (text)
  "Return the quantity for TEXT, typed after PLOT. Signals BAD-LINE if there is none."
  (or (find text *named-quantities* :key #'quantity-name :test #'string-equal)
      (multiple-value-bind (datum end) (read-datum text 0 (find-line-command "PLOT"))
        (let ((index (and (< end (length text)) (parse-typed-number (subseq text end)))))
          (unless (or (= end (length text)) (whole-p index))
            (reject-line "~A is too much after PLOT ~(~A~)." (string-trim " " (subseq text end))
                         (subseq text 0 end)))
          (quantity-for-datum datum index text)))))

;;; PLOT.

(defun write-plots (session)
  (let ((all (current-plotted session *simulation* (name-of-robot-commanded))))
    (if all
        (loop for plotted in all
              for number from 1
              for curve = (plotted-series plotted)
              do (multiple-value-bind (tick value) (last-sample curve)
                   (format t "~2D ~30A ~A~%" number (quantity-name (plotted-quantity plotted))
                           (or (end-of-curve-text plotted)
                               (and tick (format nil "~A at tick ~D"
                                                 (value-and-unit-text curve value) tick))
                               "no value yet"))))
        (format t "Nothing is plotted. PLOT takes ~A.~%" (plottable-text)))))

(defun curve-ended-p (session quantity)
  "True if the curve of QUANTITY in the present run of SESSION has ended after an error."
  (let ((plotted (find quantity
                       (current-plotted session *simulation* (name-of-robot-commanded))
                       :key #'plotted-quantity)))
    (and plotted (end-of-curve-text plotted) t)))

(defun add-plot (session text)
  (let ((plotter (ensure-plotter session)) (quantity (find-quantity text)))
    (when (find (quantity-name quantity) (plotted-names session) :test #'string-equal)
      (reject-line "~A is plotted already. PLOT ~:*~A off removes the plot."
                   (quantity-name quantity)))
    (setf (plotter-quantities plotter)
          (append (plotter-quantities plotter) (list quantity)))
    (update-plots session)
    (unless (curve-ended-p session quantity)
      (format t "Plotting ~A~@[, in ~A~].~%" (quantity-name quantity)
              (and (string/= "" (quantity-unit quantity)) (quantity-unit quantity))))))

(defun remove-plot (session text)
  "Remove the plot with the name or number TEXT from SESSION, or all plots if TEXT is empty."
  (let* ((plotter (ensure-plotter session)) (all (plotter-quantities plotter))
         (number (parse-typed-number text))
         (quantity (or (find text all :key #'quantity-name :test #'string-equal)
                       (and (whole-p number 1 (length all)) (nth (1- number) all)))))
    (unless (or quantity (string= "" text))
      (reject-line "~A is not plotted~:[; nothing is~;; ~:*~{~A~^, ~} ~:[are~;is~]~]." text
                   (plotted-names session) (null (rest all))))
    (setf (plotter-quantities plotter) (and quantity (remove quantity all)))
    (update-plots session)
    (format t "~:[No more plots~;~:*~A is no longer plotted~].~%"
            (and quantity (quantity-name quantity)))))

(defun without-off (text)
  "Return TEXT without the word OFF at its end, and true if there was one."
  (let* ((text (string-trim " " text)) (start (- (length text) 3)))
    (if (and (<= 0 start)
             (string-equal "off" text :start2 start)
             (or (zerop start) (char= #\Space (char text (1- start)))))
        (values (string-trim " " (subseq text 0 start)) t)
        (values text nil))))

(define-line "PLOT" (session (what :plot "a quantity, and OFF to remove it" :optional))
    (:seeing
     "PLOT speed, PLOT distance and PLOT odometer-error plot what the robot drives in a tick, what
it has driven since then, and the distance between its position and the estimate of its odometer."
     "PLOT tidiness plots the measure that (defmeasure tidiness ...) has defined; see MEASURE. PLOT
*score* plots the run variable of (define-run-variable *score* ...). Their titles are from their
docstrings."
     "PLOT robot-place* and PLOT hand-moved* 0 plot fluents. For a fluent that is only pulsed, the
number of pulses is plotted. In place of a truth value, 1 is true and 0 is NIL."
     "PLOT my-function and PLOT (lambda (robot) (robot-x robot)) call a function of the robot after
each tick. After an error in the function its curve ends; time goes on."
     "PLOT speed off removes a plot, PLOT 2 off the second plot, PLOT off all plots. PLOT lists
the plots."
     "A window shows the plots of its own prompt. PLOT-PICTURE saves them in a file; PLOT-TICKS
chooses the ticks that they show. Curves begin anew in forks and trials, and a rewind cuts them."
     "Older samples are kept as the least and the greatest value of intervals, which are at most
a 256th part of the curve. So no peak is lost.")
    "Plot a quantity over time."
  (session-robot)
  (if (null what)
      (write-plots session)
      (multiple-value-bind (text off-p) (without-off what)
        (if off-p (remove-plot session text) (add-plot session text)))))

;; Completed word by word.
(define-argument-choices :plot
  (append (mapcar #'quantity-name *named-quantities*)
          (measure-names)
          (run-variable-names)
          (loop for (variable) in (all-fluent-variables) collect (string-downcase variable))
          '("off")))

(defun parse-plot-ticks (word)
  "Return the number of ticks for WORD, typed after PLOT-TICKS; NIL for the word ALL."
  (let ((number (parse-typed-number word)))
    (cond ((string-equal word "all") nil)
          ((whole-p number 1) number)
          (t (reject-line "PLOT-TICKS takes a number of ticks, from 1 to 1e9, or ALL; not ~A."
                          word)))))

(define-line "PLOT-TICKS" (session (ticks :plot-ticks "a number of ticks, or ALL" :optional))
    (:seeing)
    "Let plots show the last TICKS ticks. Without TICKS, tell which ticks they show."
  (let ((plotter (ensure-plotter session)))
    (when ticks (setf (plotter-ticks plotter) (parse-plot-ticks ticks)))
    (format t "Plots show ~:[all ticks~;~:*the last ~D tick~:P~].~%" (plotter-ticks plotter))))

(define-argument-choices :plot-ticks '(all 100 1000))

;;; PLOT-PICTURE.

(define-line "PLOT-PICTURE" (session (file :file "a name that ends in .svg or .png"))
    (:seeing)
    "Save the plots in FILE, replacing it."
  (let ((charts (plotted-charts session *simulation* (name-of-robot-commanded) 720))
        (title (format nil "~(~A~) in ~(~A~), tick ~D" (robot-label (session-robot))
                       (simulation-name *simulation*) (simulation-tick *simulation*))))
    (unless charts (reject-line "Nothing is plotted. PLOT speed plots the robot's speed."))
    (format t "~A~%" (native-name (save-chart (path-of-name file)
                                              (time-charts-svg charts title))))))
