;;;; parameters.lisp -- a parameter of the simulation is defined once (manual, chapter 4).

(in-package :ars-magna.definitions)

(export '(parameter check-parameter-value describe-type define-parameter parameter-settings
          check-parameters *noise-before-cleaning*))

;;; Each parameter is a special variable that users may SETF. From its one definition come its
;;; documentation, the check of its value, what CLEAN-SIMULATION does to it and the prompt's
;;; list. A headless run binds all of them anew; a live run follows the global values.

(addition parameter-p)
(define-record parameter
  "What is known of one simulation parameter besides its value."
  (symbol nil symbol "the special variable that is the parameter" :export)
  (default nil t "the value that the manual gives" :addition)
  (unit "" string "the unit of the values, a string" :addition)
  (type t t "the type of the parameter's values" :export)
  (test (constantly t) function "the function that is true of the values that are of the type")
  (kind :limit (member :noise :delay :limit :setting)
        ":NOISE, :DELAY, :LIMIT or :SETTING" :addition)
  (clean nil t "the value in a noiseless world of a parameter of kind :NOISE" :export)
  (group "" string "the heading that chapter 4 lists it under" :addition)
  (sentence "" string "what the parameter means" :addition)
  (digested-p t boolean
              "digests have its value even where that is the default; see DIGEST-PARAMETERS"))

(addition parameter-name)
(defun parameter-name (parameter)
  "Return what PARAMETER is called, a lower-case string such as \"max-speed*\"."
  (string-downcase (parameter-symbol parameter)))

(defmethod print-object ((parameter parameter) stream)
  (print-unreadable-object (parameter stream :type t)
    (write-string (parameter-name parameter) stream)))

(defun parameter-aliases (parameter)
  (list (string-right-trim "*" (symbol-name (parameter-symbol parameter)))))

(define-registry parameter "simulation parameter"
  :object-p parameter-p :fixed t :aliases #'parameter-aliases)

(defun limit-text (limit)
  "Return LIMIT, a number, as people read it: 1e9 for a thousand million."
  (let ((power (and (integerp limit) (>= limit 1000000) (1- (length (princ-to-string limit))))))
    (if (and power (= limit (expt 10 power)))
        (format nil "1e~D" power)
        (princ-to-string limit))))

(defun describe-type (type)
  "Return TYPE, a parameter's, in words."
  (cond ((eq type 'boolean) "T or NIL")
        ((and (consp type) (member (first type) '(real integer)))
         (format nil "~:[a number~;an integer~]~@[ from ~A~]~@[ to ~A~]"
                 (eq (first type) 'integer)
                 (and (second type) (limit-text (second type)))
                 (and (third type) (limit-text (third type)))))
        (t (format nil "a value of type ~(~S~)" type))))

;; As numbers have two limits each, so do the types: (real 0 1).
(defmacro define-parameter (symbol default
                            (&key (unit "") (type t) (kind :limit) (group "") clean addition)
                            sentence)
  "Define SYMBOL as a special variable and simulation parameter. CLEAN is its value in a
noiseless world, for parameters of kind :noise; ADDITION is true if the manual does not have it, and
:DIGESTED if digests have it even where its value is the default."
  `(progn
     (,(if addition 'addition 'public) ,symbol)
     (defvar ,symbol ,default
       ,(format nil "~A Default ~A~@[ ~A~]; ~A.~:[ (Manual, chapter 4.)~;~]" sentence
                (let ((*read-default-float-format* 'double-float))
                  (princ-to-string (eval default)))
                (and (string/= unit "") unit)
                (describe-type type)
                addition))
     (register
      *parameters* ',symbol
      (make-parameter :symbol ',symbol :default ,default :unit ,unit :type ',type
                      :test (lambda (value) (typep value ',type))
                      :kind ,kind :clean ,clean :group ,group :sentence ,sentence
                      :digested-p ,(and (member addition '(nil :digested)) t)))
     ',symbol))

(defun check-parameter-value (parameter value)
  "Signal WRONG-ARGUMENT unless PARAMETER can have VALUE."
  ;; Of a number that is none not even the type can be asked.
  (unless (and (or (not (realp value)) (finite-p value))
               (funcall (parameter-test parameter) value))
    (reject-argument "set parameter" (parameter-name parameter) value
                     (describe-type (parameter-type parameter)))))

(addition parameter-value)
(settable parameter-value)
(defun parameter-value (parameter)
  "Return the value that PARAMETER (or the parameter so named) has now. Can be set; signals
WRONG-ARGUMENT if the new value is of the wrong type or out of range."
  (symbol-value (parameter-symbol (find-parameter parameter))))

(defun (setf parameter-value) (value parameter)
  (let ((parameter (find-parameter parameter)))
    (check-parameter-value parameter value)
    (setf (symbol-value (parameter-symbol parameter)) value)))

(defun check-parameters ()
  "Signal WRONG-ARGUMENT if any parameter has a value of the wrong type or out of range."
  (dolist (parameter (registry-objects *parameters*))
    (check-parameter-value parameter (symbol-value (parameter-symbol parameter)))))

(defun parameter-settings ()
  "Return a list (symbol value) for each parameter whose value is not its default."
  (loop for parameter in (registry-objects *parameters*)
        for value = (parameter-value parameter)
        unless (eql value (parameter-default parameter))
          collect (list (parameter-symbol parameter) value)))

;;; Noise on and off.

(defvar *noise-before-cleaning* nil
  "What CLEAN-SIMULATION changed: a list (symbol value), or NIL in a dirty simulation.")

(public clean-simulation)
(defun clean-simulation ()
  "Remove all noise and error: set every noise parameter to its noiseless value and
NO-SENSOR-ERROR* to T. DISCRETE-NOISE-FACTOR*, CONTINUOUS-NOISE-FACTOR* and
STANDARD-MATCH-THRESHOLD* stay as they are: while NO-SENSOR-ERROR* is true they make no error.
Delays and limits stay. A second call changes nothing. Returns nothing (manual, chapter 4). See
reading 117."
  (unless *noise-before-cleaning*
    (setf *noise-before-cleaning*
          (loop for parameter in (registry-objects *parameters*)
                when (eq (parameter-kind parameter) :noise)
                  collect (list (parameter-symbol parameter) (parameter-value parameter))
                  and do (setf (parameter-value parameter) (parameter-clean parameter)))))
  (values))

(public dirty-simulation)
(defun dirty-simulation ()
  "Restore the noise parameters as they were before CLEAN-SIMULATION; without it, do nothing.
Returns nothing (manual, chapter 4)."
  (loop for (symbol value) in (shiftf *noise-before-cleaning* nil)
        do (setf (symbol-value symbol) value))
  (values))
