;;;; kickers.lisp -- code that things run at random: defining it and attaching it.

(in-package :ars-magna.world)

(export '(*kickers* kicker define-kicker attachment *kicker-generation*))

;;; A KICKER is abstract; an ATTACHMENT is a kicker on a thing. A thing has at most one kicker
;;; of each name. Redefining a kicker changes it wherever it is attached: worlds notice by
;;; *KICKER-GENERATION*. Manual 5.3.1.

(addition kicker-p)
(define-record (kicker (:constructor make-kicker (name)))
  "Code that is run with probability PROB on any tick on which TEST, if any, holds."
  (name nil symbol "the symbol that the kicker is called" :writable :addition)
  (prob 1d0 (double-float 0d0 1d0) "the kicker's probability per tick" :writable :addition)
  (test nil (or null function)
        "the function of a thing that says whether the kicker may run, or NIL" :writable :export)
  (body (constantly nil) function "the function of a thing that the kicker runs" :writable :export)
  (test-attributes '() list "the attributes that the test reads" :writable)
  (test-outcome nil (member nil :no t) "NIL before the first test, :NO while all tests were false, T
after a true one" :writable)
  (checked-p nil boolean "it has been attached, or a run has ended without that" :writable))

(define-kind (attachment :constructor (make-attachment (kicker thing)))
    "A kicker on a thing."
  (:fixed
   (kicker nil kicker "the attached kicker" :addition)
   (thing nil thing "the thing that the kicker is on" :addition))
  (:state
   (alive-p t boolean "the kicker has not been taken off")
   (due 0 tick-count "the tick of kickers in which it is to run because somebody asked for it")
   (ran 0 tick-count "the tick of kickers in which it last ran for that reason")
   (index 0 fixnum "its number in its group")
   (group nil t "the group of equal kickers that it is in, or NIL")))

(defmethod reference ((attachment attachment))
  (list :attachment (thing-serial (attachment-thing attachment)) (attachment-name attachment)))

(defmethod print-object ((kicker kicker) stream)
  (print-named kicker stream (kicker-name kicker) (format nil "KICKER ~A" (kicker-name kicker))))

(defmethod reference ((kicker kicker))
  (list :kicker (name-string (kicker-name kicker))))

(defun attachment-name (attachment)
  (kicker-name (attachment-kicker attachment)))

(defmethod print-object ((attachment attachment) stream)
  (print-named attachment stream
               (format nil "kicker ~A of ~A" (attachment-name attachment)
                       (attachment-thing attachment))))

(define-registry kicker "kicker" :object-p kicker-p :by-symbol t)

;; Those defined by name are everybody's; others may have closed over things of a run.
(defmethod copy-plan-value ((kicker kicker) fork)
  (if (or (eq kicker (find-kicker (kicker-name kicker) nil))
          (notany #'closure-p (list (kicker-test kicker) (kicker-body kicker))))
      (note-copy kicker kicker fork)
      (copy-slots kicker fork)))

(defvar *kicker-generation* 0 "How many times a kicker has been redefined.")

(public self)
(defvar self nil
  "While a kicker's test or body runs: the kicker being run, for RUN-KICKER (manual 5.3.1).")

(defmethod reinstate ((kicker kicker))
  (incf *kicker-generation*)
  kicker)

(defun fill-kicker (kicker definition prob test body)
  (setf (kicker-prob kicker) (check-probability definition :prob prob)
        (kicker-test kicker) test
        (kicker-body kicker) body)
  kicker)

(defun define-kicker (name &key (prob 1) test (body (constantly nil)) test-attributes)
  "Define or redefine the kicker NAME; what DEFKICKER expands to. TEST and BODY are functions of
a thing; TEST-ATTRIBUTES lists the attributes that TEST reads. Return the kicker."
  (let ((new (fill-kicker (make-kicker name) (title "defkicker" name) prob test body))
        (old (definition-to-replace name *kickers*)))
    (setf (kicker-test-attributes new) test-attributes)
    (when old
      (incf *kicker-generation*)
      (setf (kicker-checked-p new) (kicker-checked-p old)))
    (register *kickers* name (if old (become old new) new) :variable t)))

(defun kicker-functions (definition variable options body)
  "Return the keyword arguments, as forms, for a kicker with OPTIONS and BODY (reading 169)."
  (unless (and variable (symbolp variable) (not (constantp variable)))
    (reject-clause definition variable "a variable, to be bound to the kicker's thing"))
  (unless (typep options '(or null (cons keyword)))
    (reject-clause definition options
                   "a list of options before the body, such as (:prob 1/10) or (:test form)"))
  (check-options definition options '(:prob :test))
  (let ((advice (test-advice (getf options :test))))
    (when advice (doubt-definition "~A, :test: ~A" definition advice)))
  (when (body-advice body) (doubt-definition "~A: ~A" definition (body-advice body)))
  (flet ((thing-function (forms)
           `(lambda (,variable) (declare (ignorable ,variable)) ,@forms)))
    `(:prob ,(getf options :prob 1)
      :test ,(unless (eq (getf options :test t) t)
               (thing-function (list (getf options :test))))
      :body ,(thing-function body))))

(defun attributes-read-in (test)
  "Return the keywords that TEST, a form, gives GET-ATTRIBUTE."
  (let ((keys '()))
    (map-calls (lambda (call)
                 (when (and (typep call '(cons symbol (cons t (cons keyword null))))
                            (same-name-p 'get-attribute (first call)))
                   (pushnew (third call) keys)))
               test)
    keys))

(public defkicker)
(define-user-macro defkicker (&whole form name lambda-list &optional options
                     &body body &environment environment)
  "Define the kicker NAME (manual 5.3.1), whose BODY runs with probability :prob (default 1) on
any tick on which the form :test (default true) holds. LAMBDA-LIST is one variable, bound to the
thing in both. NAME becomes a special variable bound to the kicker, unless it is one of Common
Lisp's symbols, such as OPEN, or ours, or already has a value: such kickers are called by name.
Redefinition affects things that have it. Chance goes by the seed, whether by CL:RANDOM, which
begins anew in each tick, or by the world's dice: (roll-between 0 1 (world-dice *world* :user)).
Signals MALFORMED-DEFINITION. Return the name."
  (let ((definition (title "defkicker" name)))
    (expand-definition
     form environment
     (lambda ()
       (check-name definition name "kicker")
       (unless (and (proper-list-p lambda-list) (= 1 (length lambda-list)))
         (reject-clause definition lambda-list "a list of one variable"))
       (values `((define-kicker ',name
                   ,@(kicker-functions definition (first lambda-list) options body)
                   :test-attributes ',(attributes-read-in (getf options :test))))
               (variable-forms name))))))
