;;;; abuse.lisp -- the abuse of the tests, in any number, under a watchdog.

;;; Prints for each kind the number of examples by outcome, and the shortest that ended badly. None
;;; should end badly. Environment variables:
;;;   ABUSE_COUNT  how many examples of each kind; 10,000 by default
;;;   ABUSE_FROM   the number of the first; 0 by default
;;;   ABUSE_KINDS  the names of the kinds; all by default

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defparameter *patience* 20 "Seconds after which something counts as hung.")

(defun setting (name default)
  "Return the integer that the environment variable NAME holds, or DEFAULT."
  (let ((text (uiop:getenv name)))
    (if (and text (string/= text "")) (parse-integer text) default)))

(defun tests-value (name)
  (symbol-value (uiop:find-symbol* name :ars-magna.tests)))

(defun asked-for-p (name)
  (let ((names (uiop:getenv "ABUSE_KINDS")))
    (or (null names)
        (member name (uiop:split-string names) :test #'string-equal))))

(defun call-watched (function)
  (sb-ext:with-timeout *patience* (funcall function)))

(defun show-case (outcome case)
  "Print the CASE, (number text example), that ended in OUTCOME."
  (let ((*print-circle* t) (*print-length* 40) (*print-level* 10))
    (destructuring-bind (number text example) case
      (flet ((beginning (object)
               (let ((text (princ-to-string object)))
                 (subseq text 0 (min 400 (length text))))))
        (format t "  ~(~A~), number ~D: ~A~%    ~A~%"
                outcome number (beginning text) (beginning example))))))

(defun show-abuse (name)
  "Try the abuse NAME and print how that went. Return how many ended badly."
  (let* ((table (uiop:symbol-call :ars-magna.tests :abuse-table
                                  (uiop:symbol-call :ars-magna.tests :find-abuse name)
                                  (setting "ABUSE_COUNT" 10000) :from (setting "ABUSE_FROM" 0)))
         (bad (uiop:symbol-call :ars-magna.tests :bad-rows table)))
    (format t "~&~(~20A~)~:{ ~(~A~) ~D~:^,~}~%" name table)
    (loop for (outcome nil case) in bad do (show-case outcome case))
    (finish-output)
    (loop for (nil count) in bad sum count)))

(setf (symbol-value (uiop:find-symbol* '#:*watchdog* :ars-magna.tests)) #'call-watched)

(say "abuse that ended badly"
     (loop for abuse in (reverse (tests-value '#:*abuses*))
           for name = (uiop:symbol-call :ars-magna.tests :abuse-name abuse)
           when (asked-for-p name) sum (show-abuse name))
     "")
