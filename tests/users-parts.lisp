;;;; users-parts.lisp -- parts, commands and kinds that users add, and mistakes in them.

(in-package :ars-magna.tests)

(in-suite runs)

(base:define-kind (probe :include robot:part)
    "A part that keeps all sorts of things."
  (:fixed
   (reach 1d0 double-float "how far the probe reaches, in metres"))
  (:state
   (history '() list "what the probe has met")
   (spot nil (or null geo:pt) "a spot that it remembers")
   (chart (make-array '(2 2) :initial-element 0) array "a chart of what is around")
   (table (make-hash-table) hash-table "what it knows of what")))

(base:define-argument-type 'probe #'probe-p "a probe")

(command:define-command probe-fail (operation (probe probe)) ((depth "how deep"))
    ((:family :handling) (:report (depth) (format nil "~D deep" depth)))
    "Fail in the body."
  (error "The probe broke."))

(command:define-command probe-forget (operation (probe probe)) ()
    ((:family :handling))
    "Neither end nor go on."
  operation)

(command:define-command probe-misreport (operation (probe probe)) ((depth "how deep"))
    ((:family :handling) (:report () "deep"))
    "Report with too few variables."
  (command:succeed operation 3))

(command:define-command probe-empty (operation (probe probe)) ()
    ((:family :handling) (:errors (:empty "Nothing in it")) (:expected :empty) (:traits :asks))
    "Find that nothing is in it."
  (command:fail-with operation :empty))

(robot:defrobot diver (meadow (4 11) 0) :cameras ((1 5)) :parts ((probe :reach 2)))

(defmacro with-diver ((&rest options) &body body)
  `(run:with-simulation (diver ,@options) ,@body))

(defun the-probe (&optional (robot diver)) (robot:robot-part robot 'probe 0))

(test command.of-a-users-that-fails-is-a-message
  (loop for (command says . expected) in '((probe-fail "The probe broke." :failed)
                                           (probe-forget "neither ended nor continued" :failed)
                                           (probe-misreport "invalid number of arguments" nil))
        do (with-diver (:journal t)
             (let ((answers '()) (viewed nil))
               (funcall command (the-probe) (lambda (err &rest ignore)
                                              (declare (ignore ignore))
                                              (push err answers)))
               (command:camera-view (robot:robot-camera diver 0)
                                    (lambda (&rest ignore)
                                      (declare (ignore ignore))
                                      (setf viewed t)))
               (run:run-ticks 5)
               (is (equal expected answers) "~A" command)
               (is-true viewed)
               (is (search says (displayed)) "~A" command)
               (is-true (replays-p time:*simulation*))))))

(command:define-command probe-linger (operation (probe probe) (ticks integer "for how many ticks"))
    ()
    ((:family :handling))
    "Go on for TICKS, with no delay before."
  (push ticks (probe-history probe))
  (command:go-on operation 'end-lingering ticks))

(defun end-lingering (operation) (command:succeed operation))

(test commands.without-delay-that-go-on-are-interrupted-by-newer-ones
  (loop for (wait . expected) in '((0 (:interrupt 1) (nil 4)) (2 (:interrupt 3) (nil 6))
                                   (5 (nil 4) (nil 9)))
        do (with-diver (:journal t)
             (let ((probe (the-probe)) (answers '()))
               (flet ((note (err &rest results)
                        (declare (ignore results))
                        (push (list err (run:simulation-tick)) answers)))
                 (probe-linger probe 3 #'note)
                 (run:run-ticks wait)
                 (probe-linger probe 3 #'note)
                 (run:run-ticks 10))
               (is (equal expected (reverse answers)))
               (is (= 2 (length (probe-history probe))) "each body has run once")
               (is-false (search "Error in command" (displayed)))
               (is-true (replays-p time:*simulation*))))))

(test state.of-all-sorts-is-digested-and-copied
  (with-diver ()
    (let ((digest (run:state-digest)) (digests '()))
      (flet ((change (function)
               (funcall function (the-probe))
               (push (run:state-digest) digests)))
        (change (lambda (probe) (setf (probe-history probe) (list 1 2 3))))
        (change (lambda (probe) (setf (probe-spot probe) (geo:make-pt 1 2))))
        (change (lambda (probe) (setf (probe-spot probe) (geo:make-pt 7 8))))
        (change (lambda (probe) (setf (aref (probe-chart probe) 1 1) 5)))
        (change (lambda (probe) (setf (gethash :a (probe-table probe)) 5)))
        (change (lambda (probe) (setf (gethash :a (probe-table probe)) 6))))
      (is (= 7 (length (remove-duplicates (cons digest digests)))))
      (let* ((copy (run:fork-simulation time:*simulation*))
             (other (the-probe (first (run:simulation-robots copy)))))
        (is (= (first digests) (run:state-digest copy)))
        (setf (second (probe-history other)) :changed
              (aref (probe-chart other) 0 0) :changed
              (gethash :a (probe-table other)) :changed)
        (geo:set-pt! (probe-spot other) 0 0)
        (is (= (first digests) (run:state-digest)) "the original is not disturbed")))))

(test parts.are-made-with-what-is-fixed-only
  (with-diver () (is (= 2d0 (probe-reach (the-probe)))))
  (loop for (parts word) in '((((probe :rang 2)) "reach") (((probe :reach "far")) "reach")
                              (((probe 2)) "kind of part") (((probe :history (1))) "reach")
                              (((probe :location 3)) "reach") (((camera :resolution 3)) "cameras")
                              (((robot:part)) "cameras") (((nothing-known)) "kind of part"))
        do (handler-case
               (progn (robot:define-robot 'newt 'meadow '(4 4) 0 :parts parts)
                      (fail "~S was taken" parts))
             (base:malformed-definition (trouble)
               (is (search word (princ-to-string trouble)) "~A" trouble)
               (is (search (prin1-to-string (first (first parts))) (princ-to-string trouble)
                           :test #'char-equal)
                   "~A" trouble)))))

(test parts.of-unknown-kinds-are-told-so
  (with-diver ()
    (signals base:unknown-name (robot:robot-part diver 'nosuch 0))
    (signals base:wrong-argument (robot:robot-part diver 'probe 1))
    (signals base:wrong-argument (time:ask 3 (lambda () nil)))
    (signals base:wrong-argument (run:run-until 3))))

(test kinds.are-checked-where-they-are-defined
  (dolist (form '((base:define-kind (k :include robot:part) (:state (a 0 fixnum "x")))
                  (base:define-kind ("k") "K.")
                  (base:define-kind (:k) "K.")
                  (base:define-kind (k) "K." (:state (a 0 fixnum "x") (a 1 fixnum "y")))
                  (base:define-kind (k :include robot:part) "K." (:state (index 0 fixnum "x")))))
    (signals base:malformed-definition (macroexpand-1 form)))
  (dolist (form '((driver:define-outcome (probe-fail) (n) (:set nofluent* n))
                  (driver:define-outcome (probe-fail) (n) (:sett driver:robot-place* n))))
    (signals base:malformed-definition (macroexpand-1 form))))

(test command.says-what-warnings-are-to-know
  (let ((command (command::find-command 'probe-empty)))
    (is-false (driver::command-failed-p command :empty))
    (is-true (driver::command-failed-p command :failed))
    (is-true (command::trait-p :asks command))
    (is-false (command::trait-p :drives command))))

(test command.is-checked-where-it-is-defined
  (loop for (clause word) in '((((:famly :moving)) ":famly") (((:family :flying)) ":flying")
                               (((:family :moving) (:delya 5)) ":delya")
                               (((:family :moving) (:traits :flies)) ":flies")
                               (((:family :moving) (:expected :lost)) ":lost"))
        do (handler-case
               (progn (macroexpand-1 `(command:define-command nap (operation (robot robot:robot)) ()
                                          ,clause "Nap." (command:succeed operation)))
                      (fail "~S was taken" clause))
             (base:malformed-definition (trouble)
               (is (search word (princ-to-string trouble)) "~A" trouble))))
  (signals base:malformed-definition
    (macroexpand-1 '(command:define-command nap (operation (robot robot:robot) x) ()
                     ((:family :moving)) "Nap." (command:succeed operation))))
  (handler-case (progn (eval '(command:define-command nap
                               (operation (robot robot:robot) (x nosuch-type "an x")) ()
                               ((:family :moving)) "Nap." (command:succeed operation)))
                       (fail "was taken"))
    (base:malformed-definition (trouble)
      (is (search "define-command nap" (princ-to-string trouble)))
      (is (search "nosuch-type" (princ-to-string trouble))))))

(test plans.that-call-a-command-of-users-are-told-what-it-lacks
  (let* ((name (intern "RPL-PROBE-FAIL" :ars-magna.tests))
         (advice (language:advice-on-call name)))
    (is-true (has-words-p advice "the end of the command probe-fail" "(define-fluents probe"
                          "(define-outcome (probe-fail)" "(:pulse my-fluent*))")
             "~A" advice)
    (handler-case (progn (language::warn-of-unknown-call (list name 0)) (fail "no warning"))
      (warning (warning) (is (search advice (princ-to-string warning)) "~A" warning)))
    (is-true (tells-p "the end of the command probe-fail"
                      (handler-bind ((warning #'muffle-warning))
                        (eval `(rpl:interp-lambda () (,name 0)))))))
  (dolist (name '(rpl-nosuch robot-turn driver:rpl-robot-turn))
    (is (null (language:advice-on-call name)))))
