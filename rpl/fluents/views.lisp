;;;; views.lisp -- what has happened to a fluent since one looked last.

(in-package :ars-magna.rpl.fluents)

;;; A view is a network that remembers. To read it, be it by FLUENT-VALUE or by being woken by it,
;;; uses up what it says; so each reader needs a view of its own. While somebody waits for it, it is
;;; true for the instant of what happens; its value then is a number that it never had before, so
;;; that each event is heard. Nothing is missed while nobody waits: fluents count how often they
;;; were set and pulsed, so that a view costs nothing until it is read.

(defun count-sets (fluents)
  (loop for fluent in fluents sum (fluent-sets fluent)))

(defun count-events (fluents)
  (loop for fluent in fluents sum (+ (fluent-sets fluent) (fluent-pulses fluent))))

(defun make-view (name sources function)
  "Return a view of SOURCES called NAME, whose value is what FUNCTION returns for theirs; it is read
when FUNCTION is called."
  (let ((view nil))
    (flet ((look (&rest values)
             (let ((value (apply function values)))
               (when value (note-instant view))
               value)))
      (setf view (make-derived name #'look sources)))))

(addition fl-pulsed)
(defun fl-pulsed (fluent &key (handle-missed-pulses :once))
  "Return a fluent that is true if FLUENT was set to another value or pulsed since one has read what
is returned last; to read it, or to be woken by it, uses that up. HANDLE-MISSED-PULSES is for what
happened while nobody waited: :ONCE, true at one reading, whatever happened, also before the call;
:ALWAYS, true at as many readings as things happened; :NEVER, as :ONCE, but for what happened before
the call. A network is pulsed when what it is computed from is, whatever its value. Signals
WRONG-ARGUMENT. (CRAM's; what a network's pulse is, is ours.)"
  (check-argument fl-pulsed fluent (fluent-p fluent) "a fluent")
  (check-argument fl-pulsed handle-missed-pulses
                  (member handle-missed-pulses '(:once :never :always)) ":once, :never or :always")
  (let* ((bases (base-fluents fluent))
         (seen (if (eq handle-missed-pulses :never) (count-events bases) 0)))
    (make-view 'fl-pulsed bases
               (lambda (&rest values)
                 (declare (ignore values))
                 (let ((events (count-events bases)))
                   (when (< seen events)
                     (setf seen (if (eq handle-missed-pulses :always) (1+ seen) events))))))))

(defun function-given-p (object)
  "True if OBJECT is a function or the name of one that there is."
  (or (functionp object)
      (and (symbolp object) (fboundp object) (functionp (symbol-function object))
           (not (macro-function object)) (not (special-operator-p object)))))

(addition fl-value-changed)
(defun fl-value-changed (fluent &key (test #'eql) (key #'identity))
  "Return a fluent that is true if KEY of the value of FLUENT is another, by TEST, than when one has
read what is returned last, or than at the call; to read it, or to be woken by it, uses that up.
Pulses alone are no change. Signals WRONG-ARGUMENT. (CRAM's.)"
  (check-argument fl-value-changed fluent (fluent-p fluent) "a fluent")
  (check-argument fl-value-changed test (function-given-p test) "a function of two values")
  (check-argument fl-value-changed key (function-given-p key) "a function of a value")
  (let* ((bases (base-fluents fluent))
         (sets (count-sets bases))
         (last (funcall key (fluent-value fluent))))
    (make-view 'fl-value-changed (list fluent)
               (lambda (value)
                 (let ((now (count-sets bases)))
                   (unless (or (= sets now) (funcall test last (funcall key value)))
                     (setf last (funcall key value)
                           sets now)))))))
