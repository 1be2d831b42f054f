;;;; views.lisp -- what has happened to a fluent since one looked last.

(in-package :ars-magna.rpl.fluents)

(export '(function-given-p misses-nothing-p))

;;; A view is a network that remembers. To read it, be it by FLUENT-VALUE or by being woken by it,
;;; uses up what it says; so each reader needs a view of its own. While somebody waits for it, it is
;;; true for the instant of what happens; its value then is a number that it never had before, so
;;; that each event is heard. Nothing is missed while nobody waits: fluents count how often they
;;; were set and pulsed, so that a view costs nothing until it is read.

(defun count-sets (fluents)
  (loop for fluent in fluents sum (fluent-sets fluent)))

(defun count-events (fluents)
  (loop for fluent in fluents sum (+ (fluent-sets fluent) (fluent-pulses fluent))))

(defun look-for-event (view)
  "Return a number if something has happened to the fluents of VIEW since it was read last, or NIL."
  (let ((seen (view-memory view)) (events (count-events (view-bases view))))
    (when (< seen events)
      (before-change view)
      (setf (view-memory view) (if (view-always-p view) (1+ seen) events)))))

(defun look-for-change (view value)
  "Return a number if VALUE, what the fluent of VIEW is now, is another than when it was read last."
  (destructuring-bind (sets . last) (view-memory view)
    (let ((now (count-sets (view-bases view))))
      (unless (= sets now)
        (let ((value (funcall (view-key view) value)))
          (unless (funcall (view-test view) last value)
            (before-change view)
            (setf (view-memory view) (cons now value))
            now))))))

(defun look (view value)
  "Return what VIEW says, which this uses up. VALUE is the value of its first fluent."
  (let ((answer (if (view-test view) (look-for-change view value) (look-for-event view))))
    ;; It is no longer true when the change under way, if any, is spread.
    (when (and answer *spreading*) (push view (first *spreading*)))
    answer))

(defun make-view (name sources bases memory &key always-p test key)
  "Return a view of SOURCES called NAME; see VIEW."
  (let ((view nil))
    (dolist (base bases) (setf (fluent-looked base) :always))
    (setf view (%make-view name (lambda (&rest values) (look view (first values)))
                           sources (height-over sources) bases memory always-p test key))))

;; What it remembers is a state, and it is of the fork's fluents.
(defmethod fresh-twin ((view view) realm)
  (flet ((twins (fluents) (mapcar (lambda (fluent) (entity-in fluent realm)) fluents)))
    (make-view (fluent-name view) (twins (derived-sources view)) (twins (view-bases view))
               (view-memory view)
               :always-p (view-always-p view) :test (view-test view) :key (view-key view))))

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
  (let* ((bases (base-fluents (here fluent)))
         (seen (if (eq handle-missed-pulses :never) (count-events bases) 0)))
    (make-view 'fl-pulsed bases bases seen :always-p (eq handle-missed-pulses :always))))

(defun misses-nothing-p (fluent)
  "True if FLUENT is a view that is true as often as things happen, whenever it is read."
  (and (view-p fluent) (view-always-p fluent)))

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
  (let* ((fluent (here fluent))
         (bases (base-fluents fluent))
         (key (coerce key 'function)))
    (make-view 'fl-value-changed (list fluent) bases
               (cons (count-sets bases) (funcall key (fluent-value fluent)))
               :test (coerce test 'function) :key key)))
