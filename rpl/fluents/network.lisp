;;;; network.lisp -- fluents computed from fluents.

(in-package :ars-magna.rpl.fluents)

(export '(base-fluents depends-p was-read-p forget-reading fluent-watchers fluent-text
          operand-value checked-condition truth-value unwatch watch repair-fluents
          peek-fluent peek-pulses))

;;; Computing.

(declaim (inline stored-value))
(defun stored-value (source)
  (if (fluent-p source) (fluent-now source) source))

(defun compute (derived)
  "Return the value of DERIVED, computed from the stored values of its sources, which are in use."
  (declare #.*hot*)                     ; 12 ns for two sources
  (let* ((operator (derived-operator derived))
         (sources (derived-sources derived))
         (others (rest sources)))
    (cond ((null others) (values (funcall operator (stored-value (first sources)))))
          ((null (rest others))
           (values (funcall operator (stored-value (first sources)) (stored-value (first others)))))
          (t (values (apply operator (mapcar #'stored-value sources)))))))

(defun recompute (derived)
  "Recompute DERIVED, which is in use. Return true if its value changed or there was an error."
  (declare #.*hot*)
  (let ((trouble (loop for source in (derived-sources derived)
                       thereis (and (derived-p source) (derived-trouble source))))
        (value nil))
    (unless trouble
      (handler-case (setf value (compute derived))
        (error (condition) (setf trouble condition))))
    (cond ((and (null trouble) (null (derived-trouble derived)) (eql value (fluent-now derived)))
           nil)
          (t (setf (fluent-now derived) value
                   (derived-trouble derived) trouble)
             t))))

;;; Being used.

(defun add-user (fluent)
  "Count one more user of FLUENT. With the first user, FLUENT starts to follow its sources."
  (when (and (derived-p fluent) (= 1 (incf (derived-users fluent))))
    (dolist (source (derived-sources fluent))
      (when (fluent-p source)
        (add-user source)
        (let ((link (make-link source fluent)))
          (join-links link)
          (push link (derived-links fluent)))))
    (recompute fluent)))

(defun remove-user (fluent)
  "Count one user fewer of FLUENT. With the last user, FLUENT stops following its sources."
  (when (and (derived-p fluent) (= 0 (decf (derived-users fluent))))
    (dolist (link (shiftf (derived-links fluent) '()))
      (leave-links link)
      (remove-user (link-source link)))
    (setf (fluent-now fluent) nil
          (derived-trouble fluent) nil)))

(defun assign-home (fluent)
  "Make the current plan runner the home of FLUENT, and of the sources of FLUENT."
  (unless (eq *runner* (fluent-home fluent))
    (setf (fluent-home fluent) *runner*)
    (when (derived-p fluent)
      (dolist (source (derived-sources fluent))
        (when (fluent-p source) (assign-home source))))))

(defun watch (watcher)
  "Register WATCHER with its fluent, after the watchers already registered. Another thread may have
just set the fluent, so a caller that waits for it to become true must check it again afterwards."
  (let ((fluent (watcher-fluent watcher)))
    (unless (eq *runner* (fluent-home fluent))
      (assign-home fluent)
      (memory-barrier))
    (add-user fluent)
    (join-watchers watcher)))

(defun unwatch (watcher)
  "Remove WATCHER from its fluent."
  (leave-watchers watcher)
  (remove-user (watcher-fluent watcher)))

;;; Reading.

(defun used-fluent-value (fluent)
  "Return the value of FLUENT, which is in use. Signal the error of its last computation, if any."
  (when (and (derived-p fluent) (derived-trouble fluent))
    (error (derived-trouble fluent)))
  (unless (fluent-reading fluent) (setf (fluent-reading fluent) :once))
  (fluent-now fluent))

(defun current-value (fluent)
  "Return the value of FLUENT. If FLUENT is derived and not in use, compute the value."
  (cond ((or (not (derived-p fluent)) (plusp (derived-users fluent))) (used-fluent-value fluent))
        ((= 1 (fluent-height fluent)) (compute fluent))
        (t (add-user fluent)
           (unwind-protect (used-fluent-value fluent)
             (remove-user fluent)))))

(declaim (inline checked-condition truth-value))
(defun checked-condition (object)
  "Return the condition OBJECT. If OBJECT is a fluent, return its twin in the current run. Signals
MISUSE for a vector of fluents."
  (cond ((fluent-p object) (entity-here object))
        ((and (simple-vector-p object) (fluents-vector-p object)) (reject-fluent-vector object))
        (t object)))

(defun truth-value (object)
  "Return the truth value of the condition OBJECT: the value of a fluent, or any other OBJECT
itself. Signals MISUSE for a vector of fluents."
  (if (fluent-p object) (current-value (entity-here object)) (checked-condition object)))

;; An error fluent is of use only if it is read.
(defun was-read-p (fluent)
  "True if FLUENT was read since FORGET-READING, or was ever in a network, or a task waits for it."
  (let ((fluent (entity-here fluent)))
    (and (or (fluent-reading fluent) (fluent-first-watcher fluent)) t)))

(defun forget-reading (fluent)
  "Forget that FLUENT was read: see WAS-READ-P."
  (let ((fluent (entity-here fluent)))
    (when (eq :once (fluent-reading fluent)) (setf (fluent-reading fluent) nil))))

(declaim (inline operand-value))
(defun operand-value (object)
  "Return the current value of OBJECT if OBJECT is a fluent; otherwise return OBJECT."
  (if (fluent-p object) (current-value (entity-here object)) object))

(defun names-fluent-p (object)
  "True if OBJECT is a symbol whose value is, or will be, a fluent or a vector of fluents."
  (and object
       (symbolp object)
       (or (and (gethash object *known-fluent-variables*) t)
           (and (boundp object)
                (let ((value (symbol-value object)))
                  (or (fluent-p value) (fluents-vector-p value)))))))

(defun reject-name-of-fluent (name)
  "Return NAME, but signal MISUSE if the symbol's value is a fluent: then the quote is a mistake."
  (if (names-fluent-p name)
      (reject-use "~S is a symbol, not a fluent. Leave out the quote: ~(~:*~A~)." name)
      name))

(declaim (inline fluent-value))
(public fluent-value)
(settable fluent-value)
(defun fluent-value (object)
  "Return the current value of OBJECT if OBJECT is a fluent; otherwise return OBJECT. Can be set:
see SET-VALUE (manual D.2). Signals MISUSE if OBJECT is a vector of fluents, or the name of a
variable that holds a fluent."
  (cond ((fluent-p object) (current-value (entity-here object)))
        ((and object (symbolp object)) (reject-name-of-fluent object))
        ((and (simple-vector-p object) (fluents-vector-p object))
         (reject-fluent-vector object "fluent-value"))
        (t object)))

;;; For displays. Other threads may link fluents meanwhile, so this uses no links.

(defun peek-fluent (object)
  "Return the value of OBJECT, a fluent, or any other OBJECT itself. The fluent does not count as
read. Any thread may call this. Signals the errors of the operators of networks."
  (if (fluent-p object)
      (let ((fluent (entity-here object)))
        (if (and (derived-p fluent) (zerop (derived-users fluent)) (not (view-p fluent)))
            (apply (derived-operator fluent) (mapcar #'peek-fluent (derived-sources fluent)))
            (fluent-now fluent)))
      object))

(defun peek-pulses (fluent)
  "Return how often FLUENT was pulsed. FLUENT does not count as read. Any thread may call this."
  (fluent-pulses (entity-here fluent)))

;;; Building.

(defun height-over (sources)
  (1+ (loop for source in sources
            when (fluent-p source) maximize (fluent-height source))))

(defun apply-lifted (name function &rest arguments)
  "Return the value of FUNCTION for ARGUMENTS. If some of ARGUMENTS are fluents, return a new
fluent, named NAME, instead. Its value is always FUNCTION of the current values of ARGUMENTS."
  (if (some #'fluent-p arguments)
      (let ((sources (loop for argument in arguments
                           collect (if (fluent-p argument) (entity-here argument) argument))))
        (dolist (source sources)
          (when (fluent-p source) (setf (fluent-reading source) :always)))
        (%make-derived name function sources (height-over sources)))
      (apply function arguments)))

(defun function-label (function)
  (if (symbolp function)
      function
      (let ((name (nth-value 2 (function-lambda-expression function))))
        (if (symbolp name) name 'function))))

(addition fl-funcall)
(defun fl-funcall (function &rest arguments)
  "Return a fluent whose value is always FUNCTION of the current values of ARGUMENTS, some of which
are fluents. FUNCTION must depend on nothing else and must not set fluents. If no argument is a
fluent, call FUNCTION at once."
  (apply #'apply-lifted (function-label function) (coerce function 'function) arguments))

(addition fl-apply)
(defun fl-apply (function &rest arguments)
  "Do as FL-FUNCALL, but the last of ARGUMENTS is a list of arguments, as for APPLY."
  (apply #'fl-funcall function (apply #'list* arguments)))

(defun depends-p (fluent source)
  "True if FLUENT is the base fluent SOURCE, or a network that is computed from SOURCE."
  (and (member source (base-fluents fluent)) t))

(defun base-fluents (fluent)
  "Return a list of the base fluents that FLUENT is computed from, without repetition. If FLUENT is
a base fluent, return a list of FLUENT."
  (if (derived-p fluent)
      (remove-duplicates (loop for source in (derived-sources fluent)
                               when (fluent-p source) append (base-fluents source))
                         :from-end t)
      (list fluent)))

(defun fluent-watchers (fluent)
  "Return the clients of the watchers of FLUENT itself, not of its networks, in order of arrival."
  (loop for watcher = (fluent-first-watcher fluent) then (watcher-next watcher)
        while watcher collect (watcher-client watcher)))

;;; Printing.

(defconstant +printed-fluents-limit+ 100 "How many fluents the text of a network shows at most.")

(defun write-network (fluent stream)
  "Write to STREAM the expression that made FLUENT, or the beginning of a large expression."
  (let ((left +printed-fluents-limit+))
    (labels ((name (fluent)
               (write-string (if (or (fluent-name fluent) (derived-p fluent))
                                 (safe-text (fluent-name fluent) :escape nil)
                                 "a fluent without a name")
                             stream))
             (visit (object)
               (cond ((not (fluent-p object)) (write-string (safe-text object) stream))
                     ((minusp (decf left)) (write-string "..." stream))
                     ((derived-p object)
                      (write-char #\( stream)
                      (name object)
                      (dolist (source (derived-sources object))
                        (write-char #\Space stream)
                        (visit source))
                      (write-char #\) stream))
                     (t (name object)))))
      (visit fluent))))

(defun fluent-text (fluent)
  "Return the name of FLUENT, or the expression of a network, in lower case."
  (let ((*print-case* :downcase) (*print-length* 5) (*print-level* 4))
    (with-output-to-string (stream) (write-network fluent stream))))

(defvar *printing-fluent-value* nil
  "True while the value of a fluent is printed. Fluents inside that value are printed by name only,
because the values of fluents may refer to each other.")

(defun value-text (fluent)
  "Return the value of FLUENT as text, or the type of the error in computing it."
  (handler-case (let ((*printing-fluent-value* t)) (safe-text (current-value (entity-here fluent))))
    (error (condition) (format nil "error: ~A" (type-of condition)))))

(defmethod print-object ((fluent fluent) stream)
  (print-unreadable-object (fluent stream)
    (format stream "fluent ~A~@[ = ~A~]" (fluent-text fluent)
            (unless *printing-fluent-value* (value-text fluent)))))

;;; The lists of fluents may be in any state. So the watched fluents are found from the watchers,
;;; which are known; the links between fluents are dropped and made again.

(defun reachable-fluents (watchers)
  "Return the fluents that WATCHERS watch, and all fluents that networks connect with these."
  (let ((seen (make-hash-table :test 'eq)) (fluents '()))
    (labels ((visit (fluent)
               (unless (gethash fluent seen)
                 (setf (gethash fluent seen) t)
                 (push fluent fluents)
                 (when (derived-p fluent)
                   (dolist (source (derived-sources fluent))
                     (when (fluent-p source) (visit source))))
                 (loop for link = (fluent-first-link fluent) then (link-next link)
                       repeat 1000000
                       while link do (visit (link-dependent link))))))
      (mapc (lambda (watcher) (visit (watcher-fluent watcher))) watchers))
    (nreverse fluents)))

(defun distinct-watchers (fluent)
  "Return a list of the watchers that are registered with FLUENT, without repetition."
  (let ((seen '()))
    (loop for watcher = (fluent-first-watcher fluent) then (watcher-next watcher)
          until (or (null watcher) (member watcher seen :test #'eq))
          do (push watcher seen))
    (nreverse seen)))

(defun reset-fluent-links (fluent)
  (setf (fluent-first-watcher fluent) nil
        (fluent-last-watcher fluent) nil
        (fluent-first-link fluent) nil
        (fluent-last-link fluent) nil)
  (when (derived-p fluent)
    (setf (derived-users fluent) 0
          (derived-links fluent) '()
          (derived-queued fluent) nil
          (derived-successor fluent) nil)))

(defun add-user-despite-abort (fluent)
  "Count one more user of FLUENT. If the function of FLUENT aborts, record an error in FLUENT."
  (restart-case (add-user fluent)
    (abort ()
      :report "Let the fluent be in error."
      (when (derived-p fluent)
        (setf (derived-trouble fluent)
              (make-condition 'simple-error
                              :format-control "The function of ~A was aborted."
                              :format-arguments (list (fluent-text fluent))))))))

(defun repair-fluents (home watchers unwanted-p)
  "Register WATCHERS again in HOME, and other watchers of their fluents except UNWANTED-P ones."
  (let* ((fluents (reachable-fluents watchers))
         (listed (remove-if unwanted-p (mapcan #'distinct-watchers fluents)))
         (all (append listed (set-difference watchers listed))))
    (setf (home-backlog home) (make-backlog))
    (mapc #'reset-fluent-links fluents)
    (dolist (watcher all)
      (setf (watcher-previous watcher) nil
            (watcher-next watcher) nil)
      (add-user-despite-abort (watcher-fluent watcher))
      (join-watchers watcher))))
