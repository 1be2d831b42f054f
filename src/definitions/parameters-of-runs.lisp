;;;; parameters-of-runs.lisp -- a run binds the parameters and notices changes.

(in-package :ars-magna.definitions)

(export '(call-with-parameters call-with-parameter-values parameter-values digest-parameters
          synchronize-parameters parameters-changed-since parameters-summary))

;; Much faster than PROGV for parameters defined before this is compiled, as all of ours are.
(defmacro with-parameters-bound ((values) &body body)
  "Run BODY with all parameters bound, in order, to the elements of the list VALUES."
  (let ((symbols (mapcar #'parameter-symbol (registry-objects *parameters*))))
    `(let* ,(loop for symbol in symbols collect `(,symbol (pop ,values)))
       (progv (mapcar #'parameter-symbol (nthcdr ,(length symbols) (registry-objects *parameters*)))
           ,values
         ,@body))))

(defun check-parameter-settings (settings)
  (unless (and (proper-list-p settings)
               (loop for setting in settings
                     always (and (proper-list-p setting) (= 2 (length setting)))))
    (reject-argument 'with-simulation 'parameters settings
                     "a list of lists (name value), such as '((max-speed* 1/2))")))

(defun call-with-parameters (settings function)
  "Call FUNCTION with every parameter bound: to its value in SETTINGS, a list of lists (name value),
or else to its current value. Changes of parameters by FUNCTION end with the call. Signals
WRONG-ARGUMENT for an invalid value and UNKNOWN-NAME for an unknown parameter."
  (check-parameter-settings settings)
  (let* ((settings (loop for (name value) in settings
                         collect (cons (parameter-symbol (find-parameter name)) value)))
         (values (loop for parameter in (registry-objects *parameters*)
                       for symbol = (parameter-symbol parameter)
                       for setting = (assoc symbol settings)
                       do (when setting (check-parameter-value parameter (cdr setting)))
                       collect (if setting (cdr setting) (symbol-value symbol)))))
    (let ((*noise-before-cleaning* *noise-before-cleaning*))
      (with-parameters-bound (values) (funcall function)))))

(defun call-with-parameter-values (values function)
  "Call FUNCTION with the parameters bound to VALUES, a vector as PARAMETER-VALUES returns. At the
end, store the parameters' values in VALUES. Return the values of FUNCTION."
  ;; Parameters that were defined after VALUES were made have their defaults.
  (let ((known (append (coerce values 'list)
                       (mapcar #'parameter-default (nthcdr (length values)
                                                           (registry-objects *parameters*))))))
    (with-parameters-bound (known)
      (multiple-value-prog1 (funcall function)
        (replace values (parameter-values))))))

(defun parameter-values ()
  "Return a vector of the current values of all parameters, for SYNCHRONIZE-PARAMETERS."
  (map 'vector (lambda (parameter) (symbol-value (parameter-symbol parameter)))
       (registry-objects *parameters*)))

(defun parameters-summary (values)
  "Return a short text on how VALUES, a vector as PARAMETER-VALUES returns, differ from the
defaults: \"default\", \"clean\" (no noise), \"clean, 2 others changed\" or \"3 changed\"."
  (flet ((count-different (kept-p value-of)
           (loop for parameter in (registry-objects *parameters*)
                 for value across values
                 count (and (funcall kept-p parameter)
                            (not (value-equal value (funcall value-of parameter))))))
         (noise-p (parameter) (eq :noise (parameter-kind parameter))))
    (let ((changed (count-different #'identity #'parameter-default))
          (changed-others (count-different (complement #'noise-p) #'parameter-default)))
      (cond ((zerop changed) "default")
            ((zerop (count-different #'noise-p #'parameter-clean))
             (format nil "clean~[~:;, ~:*~D other~:P changed~]" changed-others))
            (t (format nil "~D changed" changed))))))

(defun digest-parameters (known digest)
  "Add KNOWN, a vector as PARAMETER-VALUES returns, to DIGEST. Parameters without the mark :DIGESTED
are added by name, and only if they differ from their defaults. So earlier digests remain valid."
  (loop for parameter in (registry-objects *parameters*)
        for value across known
        if (parameter-digested-p parameter)
          collect value into values
        else unless (eql value (parameter-default parameter))
          append (list (parameter-name parameter) value) into others
        finally (digest-add digest (coerce values 'simple-vector))
                (when others (digest-add digest others))))

(defun parameters-changed-since (known)
  "Return an alist (symbol . value) of the parameters changed since PARAMETER-VALUES gave KNOWN."
  (declare (type simple-vector known))
  (loop for parameter in (registry-objects *parameters*)
        for old across known
        for symbol = (parameter-symbol parameter)
        unless (eql old (symbol-value symbol)) collect (cons symbol (symbol-value symbol))))

(defun usable-value-p (parameter value)
  "Return true if PARAMETER can have VALUE. Otherwise queue an error message and return NIL."
  (handler-case (progn (check-parameter-value parameter value) t)
    (wrong-argument (trouble) (error-set (princ-to-string trouble)) nil)))

(defun synchronize-parameters (known global-p note)
  "Find the parameters changed since the last update of KNOWN, a vector as PARAMETER-VALUES returns,
and update KNOWN. Call NOTE with the symbol and new value of each. If GLOBAL-P is true, the
caller is a thread with its own bindings of parameters: adopt values that other threads have set
globally, and make values set in this thread global. Reset an invalid value, with an error message."
  (declare #.*hot* (type simple-vector known) (type function note))
  (loop for parameter in (registry-objects *parameters*)
        for index of-type fixnum from 0 below (length known)
        for symbol = (parameter-symbol (the parameter parameter))
        for old = (svref known index)
        for here = (symbol-value symbol)
        for global = (if global-p (global-value symbol) here)
        unless (and (eql here old) (eql global old))
          do (let ((new (if (eql global old) here global)))
               (unless (usable-value-p parameter new) (setf new old))
               (setf (svref known index) new
                     (symbol-value symbol) new)
               (when global-p (setf (global-value symbol) new))
               (unless (eql new old) (funcall note symbol new)))))
