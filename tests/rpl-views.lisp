;;;; rpl-views.lisp -- fl-pulsed and fl-value-changed: what has happened since the last look.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun reading (view)
  "Read VIEW; return T or NIL."
  (and (rpl:fluent-value view) t))

(defun looks (view count)
  (loop repeat count collect (reading view)))

(test fl-pulsed.is-used-up-by-reading
  (let* ((f (fluent)) (view (rpl:fl-pulsed f)))
    (is (equal '(nil nil) (looks view 2)))
    (rpl:pulse f)
    (rpl:pulse f)
    (is (equal '(t nil nil) (looks view 3)))
    (rpl:set-value f 1)
    (rpl:set-value f 1)
    (is (equal '(t nil) (looks view 2)))))

(test fl-pulsed.what-was-missed
  "Set and pulsed four times before and after the view is made."
  (flet ((missed (how)
           (let ((f (fluent)))
             (rpl:set-value f :x)
             (rpl:pulse f)
             (let ((view (rpl:fl-pulsed f :handle-missed-pulses how)))
               (list (looks view 3)
                     (loop repeat 2 do (rpl:pulse f))
                     (looks view 3))))))
    (is (equal '((t nil nil) nil (t nil nil)) (missed :once)))
    (is (equal '((t t nil) nil (t t nil)) (missed :always)))
    (is (equal '((nil nil nil) nil (t nil nil)) (missed :never)))
    (signals base:wrong-argument (missed :sometimes))
    (signals base:wrong-argument (rpl:fl-pulsed 3))))

(test fl-pulsed.wakes-who-waits
  "Pulses while the body runs are heard afterwards, once or all."
  (flet ((turns (how)
           (let ((f (fluent)))
             (with-log (note)
               (plan-value
                 (rpl:pursue
                  (let ((view (rpl:fl-pulsed f :handle-missed-pulses how)))
                    (loop (rpl:wait-for view) (note :turn) (rpl:wait-time 10)))
                  (rpl:seq (rpl:wait-time 1)
                           (rpl:set-value f t)
                           (rpl:n-times 4 (rpl:wait-time 1) (rpl:pulse f))
                           (rpl:wait-time 100))))))))
    (is (equal '((:turn 1) (:turn 11)) (turns :once)))
    (is (equal '((:turn 1) (:turn 11)) (turns :never)))
    (is (equal '((:turn 1) (:turn 11) (:turn 21) (:turn 31) (:turn 41)) (turns :always)))))

(test fl-pulsed.is-heard-by-whenever-each-time
  (let ((f (fluent :something)))
    (is (equal '((:turn 0) (:turn 1) (:turn 2) (:turn 3))
               (with-log (note)
                 (rpl:pulse f)
                 (plan-value
                   (rpl:pursue (rpl:whenever (rpl:fl-pulsed f) (note :turn))
                               (rpl:seq (rpl:wait-time 1) (rpl:set-value f 1)
                                        (rpl:wait-time 1) (rpl:set-value f 2)
                                        (rpl:wait-time 1) (rpl:pulse f)
                                        (rpl:wait-time 1)))))))))

(defun turns-of-view (how missed span)
  "Return how often a WHENEVER, whose body takes SPAN ticks, runs on a view that misses pulses as
HOW says: of a fluent that is pulsed twice before, then set and pulsed four times all at once."
  (let ((f (fluent)))
    (rpl:pulse f)
    (rpl:pulse f)
    (length (with-log (note)
              (plan-value
                (rpl:pursue (rpl:whenever ((rpl:fl-pulsed f :handle-missed-pulses how)
                                           :missed missed)
                              (note :turn)
                              (rpl:wait-time span))
                            (rpl:seq (rpl:wait-time 20)
                                     (funcall (lambda ()
                                                (rpl:set-value f t)
                                                (loop repeat 4 do (rpl:pulse f))))
                                     (rpl:wait-time 100))))))))

(test fl-pulsed.is-counted-by-whenever-if-it-misses-nothing
  "As in CRAM's tests of WHENEVER."
  (dolist (span '(0 1 9))
    (dolist (missed '(:once :all))
      (is (= 7 (turns-of-view :always missed span)))))
  (is (= 2 (turns-of-view :once :once 0)))
  (is (= 1 (turns-of-view :never :once 0))))

(test fl-pulsed.is-left-by-whenever-as-it-was
  (let ((f (fluent)))
    (plan-value (rpl:pursue (rpl:whenever (rpl:fl-pulsed f :handle-missed-pulses :always) 1)
                            (rpl:wait-time 2)))
    (is (null (fluents::fluent-first-link f)))))

(test fl-pulsed.in-a-network-holds-for-an-instant
  "A pulse, or a setting, at a time when the rest was false is no reason to wake later."
  (let ((f (fluent)) (rest (fluent)))
    (is (equal '((:woken 4))
               (with-log (note)
                 (plan-value
                   (rpl:par (rpl:seq (rpl:wait-for (and (rpl:fl-pulsed f) rest)) (note :woken))
                            (rpl:seq (rpl:wait-time 1) (rpl:set-value f 1)
                                     (rpl:wait-time 1) (rpl:pulse f)
                                     (rpl:wait-time 1) (rpl:set-value rest t)
                                     (rpl:wait-time 1) (rpl:set-value f 2)))))))
    (is (null (fluents::fluent-first-link f)))
    (is (null (fluents::fluent-first-link rest)))))

(test fl-pulsed.of-a-network-is-that-of-its-sources
  (let* ((f (fluent 1)) (g (fluent 2)) (view (rpl:fl-pulsed (ars-magna.rpl.lifted:< f g f))))
    (is (not (reading view)))
    (rpl:set-value g 3)
    (is (equal '(t nil) (looks view 2)))
    (rpl:set-value f 0)
    (rpl:pulse g)
    (is (equal '(t nil) (looks view 2)))))

(test fl-pulsed.settings-at-one-instant
  (let ((f (fluent)) (heard '()))
    (with-runner (runner)
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (let ((view (rpl:fl-pulsed f)))
                                 (loop (rpl:wait-for view)
                                       (push (rpl:plan-time) heard)))))
      (rpl:react-to-all runner)
      (rpl:post-entry runner `((:set ,f 1) (:pulse ,f)))
      (rpl:post-entry runner `((:pulse ,f)))
      (loop while (rpl:apply-next-batch runner) do (rpl:react-to-all runner))
      (is (= 2 (length heard)) "What happens at one instant is one thing."))))

(test fl-value-changed.counts-changes-not-pulses
  (let* ((f (fluent 1)) (view (rpl:fl-value-changed f)))
    (is (not (reading view)))
    (rpl:set-value f 2)
    (rpl:set-value f 3)
    (is (equal '(t nil) (looks view 2)))
    (rpl:pulse f)
    (is (not (reading view)))
    (rpl:set-value f 4)
    (rpl:set-value f 3)
    (is (not (reading view)) "It is what it was.")))

(test fl-value-changed.by-test-and-key
  (let* ((f (fluent "one"))
         (text (rpl:fl-value-changed f :test #'string-equal))
         (size (rpl:fl-value-changed f :key #'length)))
    (rpl:set-value f "ONE")
    (is (equal '(nil nil) (list (reading text) (reading size))))
    (rpl:set-value f "two")
    (is (equal '(t nil) (list (reading text) (reading size))))
    (rpl:set-value f "three")
    (is (equal '(t t) (list (reading text) (reading size))))))

(test fl-value-changed.wakes-who-waits
  (let ((f (fluent 1)))
    (is (equal '((2 2) (5 4))
               (with-log (note)
                 (plan-value
                   (rpl:pursue
                    (let ((view (rpl:fl-value-changed (rpl:fl-funcall #'list f)
                                                       :test #'equal)))
                      (loop (rpl:wait-for view) (note (rpl:fluent-value f))))
                    (rpl:seq (rpl:wait-time 1) (rpl:pulse f 8)
                             (rpl:wait-time 1) (rpl:set-value f 2)
                             (rpl:wait-time 1) (rpl:set-value f 2)
                             (rpl:wait-time 1) (rpl:set-value f 5)
                             (rpl:wait-time 1)))))))
    (is (null (fluents::fluent-first-link f)))))

(test fl-value-changed.an-error-of-its-key-fails-who-waits
  (let ((f (fluent 1)))
    (is (typep (plan-failure-of
                 (rpl:par (rpl:wait-for (rpl:fl-value-changed f :key #'1+))
                          (rpl:seq (rpl:wait-time 1) (rpl:set-value f :one))))
               'rpl:lisp-failure))))
