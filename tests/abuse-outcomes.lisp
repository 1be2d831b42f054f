;;;; abuse-outcomes.lisp -- who tries an example of abuse, and how it can end.

(in-package :ars-magna.tests)

;;; Each kind of abuse makes random wrong input and tries it. A try has one of these outcomes, the
;;; bad ones last:
;;;   :fine      accepted, without a message
;;;   :warned    accepted, with a warning
;;;   :refused   one of our conditions, with a short message
;;;   :typed     a type error of Lisp's about a type of ours (a reader got another object), or
;;;              keyword arguments that are not in pairs
;;;   :foreign   a condition that is not ours
;;;   :disguised one of our conditions that only repeats an internal message of Lisp's
;;;   :wordy     one of our conditions, with thousands of characters
;;;   :wrong     accepted, and the world contradicts itself
;;;   :crashed   the stack or heap was exhausted
;;;   :hung      it took longer than the watchdog's limit, if there is one
;;;   :executed  data were executed as code

(defparameter *bad-outcomes*
  '(:foreign :disguised :wordy :wrong :crashed :hung :executed))

(defstruct (abuse (:constructor make-abuse (name make try &key author samples)) (:copier nil))
  "A kind of abuse: MAKE returns an example of it, by dice; TRY tries that. If an AUTHOR's code may
be in it, that may be executed, and Lisp's complaints of it are in order. SAMPLES are examples that
nobody has damaged."
  name make try author samples)

(defvar *abuses* '() "All kinds of abuse, the newest first.")

(defun find-abuse (name)
  (find name *abuses* :key #'abuse-name))

(defun add-abuse (abuse)
  (setf *abuses* (cons abuse (remove (abuse-name abuse) *abuses* :key #'abuse-name))))

(defmacro define-abuse (name (example &key author samples) make &body try)
  "Define the kind of abuse NAME: MAKE, a form in which DICE is bound, is an EXAMPLE; TRY tries it."
  `(add-abuse (make-abuse ',name
                          (lambda (dice) (declare (ignorable dice)) ,make)
                          (lambda (,example) ,@try)
                          :author ,author :samples ,samples)))

(defun example-of (abuse number)
  "Return the example of ABUSE with the NUMBER, from 0: always the same."
  (funcall (abuse-make abuse) (base:make-dice number (symbol-name (abuse-name abuse)))))

;;; How a try ends.

(defparameter *watchdog* #'funcall
  "A function that calls a function, and signals SB-EXT:TIMEOUT if that takes too long.")

(define-condition contradiction (error)
  ((text :initarg :text))
  (:report (lambda (condition stream) (write-string (slot-value condition 'text) stream)))
  (:documentation "The world contradicts itself."))

(defparameter *words-of-lisp*
  '("is not of type" "unbound" "invalid number of arguments" "arguments to" "destructuring"
    "while parsing" "undefined" "The value" "not a string designator" "Malformed"
    "odd number of &KEY" "arithmetic error" "divided by 0" "loating-point"
    "bogus" "illegal" "Can't decode")
  "Words that show that Lisp speaks, of something that it was given by us.")

(defun text-of (condition)
  "Return what CONDITION says."
  (let ((*print-pretty* nil)) (princ-to-string condition)))

(defun refusal (condition)
  "Return how a try ends that CONDITION, one of ours, ends; and what it says."
  (let ((text (text-of condition)))
    (values (cond ((< 3000 (length text)) :wordy)
                  ((some (lambda (words) (search words text)) *words-of-lisp*) :disguised)
                  (t :refused))
            text)))

(defun of-our-type-p (condition)
  "True if CONDITION says that something is not of a type that has a name among ours."
  (and (typep condition 'type-error)
       (let ((type (type-error-expected-type condition)))
         (and type (symbolp type)
              (eql 0 (search "ARS-MAGNA." (package-name (symbol-package type))))))))

(defun odd-keywords-p (condition)
  "True if CONDITION says that arguments by keyword, of whose function Lisp itself sees to them, are
no pairs."
  (and (typep condition 'program-error)
       (search "odd number of &KEY" (text-of condition))))

(defun call-noting-warnings (function)
  "Call FUNCTION. Return true if it warned of anything, or if a message says so."
  (let ((base:*message-queue* (base:make-message-queue)) (warned nil))
    (handler-bind ((warning (lambda (warning)
                              (setf warned t)
                              (muffle-warning warning))))
      (funcall function))
    (or warned (base:take-messages))))

(defun way-of-ending (function)
  "Return how calling FUNCTION ends, and in words what was said."
  (let ((*sprung* 0))
    (multiple-value-bind (outcome text)
        (handler-case (if (funcall *watchdog* (lambda () (call-noting-warnings function)))
                          :warned
                          :fine)
          (contradiction (condition) (values :wrong (text-of condition)))
          (sb-ext:timeout () :hung)
          (storage-condition (condition) (values :crashed (type-of condition)))
          (base:ars-magna-error (condition)
            (handler-case (funcall *watchdog* (lambda () (refusal condition)))
              (sb-ext:timeout () (values :hung "while its message is printed"))
              (serious-condition (trouble) (values :foreign (list 'in-its-message trouble)))))
          (serious-condition (condition)
            (values (if (or (of-our-type-p condition) (odd-keywords-p condition))
                        :typed
                        :foreign)
                    (let ((*print-circle* t) (*print-length* 40))
                      (list (type-of condition) (text-of condition))))))
      (if (plusp *sprung*) (values :executed text) (values outcome text)))))

(defun call-unheard (function)
  "Call FUNCTION; what it prints is not shown."
  (let* ((nowhere (make-broadcast-stream))
         (*standard-output* nowhere) (*error-output* nowhere) (*query-io* nowhere))
    (funcall function)))

(defun authors-own-p (outcome text)
  "True if OUTCOME, with TEXT, is what code of an author's may well come to."
  (case outcome
    ((:disguised :executed) t)
    (:foreign (and (subtypep (first text) '(or cell-error program-error))
                   (not (search "macroexpansion" (second text)))))))

(defun try-example (abuse example)
  "Try EXAMPLE, of ABUSE. Return how that ended, and what was said."
  (multiple-value-bind (outcome text)
      (call-unheard (lambda () (way-of-ending (lambda () (funcall (abuse-try abuse) example)))))
    (values (if (and (abuse-author abuse) (authors-own-p outcome text)) :refused outcome)
            text)))

(defun try-abuse (abuse number)
  "Try the example of ABUSE with the NUMBER. Return how that ended, what was said, and the example."
  (call-isolated
   (lambda ()
     (let ((example (example-of abuse number)))
       (multiple-value-bind (outcome text) (try-example abuse example)
         (values outcome text example))))))

;;; Tables.

(defun example-size (example)
  (let ((*print-circle* t)) (length (prin1-to-string example))))

(defun shorter-case (case other)
  "Return the shorter of two cases (number text example), of which OTHER may be NIL."
  (if (and other (<= (example-size (third other)) (example-size (third case)))) other case))

(defun abuse-table (abuse count &key (from 0) (report #'identity))
  "Try COUNT examples of ABUSE, the first of which has the number FROM. Return a list of lists
\(outcome count case), case being (number text example) of the shortest that ended so. REPORT is
called with the number of each before it is tried."
  (let ((table '()))
    (loop for number from from repeat count
          do (funcall report number)
             (multiple-value-bind (outcome text example) (try-abuse abuse number)
               (let ((row (or (assoc outcome table)
                              (first (push (list outcome 0 nil) table)))))
                 (incf (second row))
                 (when (member outcome *bad-outcomes*)
                   (setf (third row)
                         (shorter-case (list number text example) (third row)))))))
    table))

(defun bad-rows (table)
  (remove-if-not (lambda (row) (member (first row) *bad-outcomes*)) table))

(defun rows-text (rows)
  "Return ROWS of a table in words."
  (let ((*print-circle* t) (*print-length* 40))
    (format nil "~:{~(~A~) ~D times, such as ~{number ~D: ~A~%~S~%~}~}" rows)))
