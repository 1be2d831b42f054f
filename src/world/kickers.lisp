;;;; kickers.lisp -- code that things run at random: defining it and attaching it.

(in-package :ars-magna.world)

(export '(*kickers* kicker define-kicker attachment *kicker-generation* call-put-kicker
          find-attachment removed-kicker-placeholder warn-of-idle-kickers))

;;; A KICKER is abstract; an ATTACHMENT is a kicker on a thing. A thing has at most one kicker
;;; of each name. Redefining a kicker changes it wherever it is attached: worlds notice by
;;; *KICKER-GENERATION*. Manual 5.3.1.

(addition kicker-p)
(define-record (kicker (:constructor make-kicker (name)))
  "Code that a thing runs with the probability PROB in each tick in which TEST, if any, is true."
  (name nil symbol "the symbol that names the kicker" :writable :addition)
  (prob 1d0 (double-float 0d0 1d0) "the kicker's probability per tick" :writable :addition)
  (test nil (or null function)
        "the function of a thing that says whether the kicker may run, or NIL" :writable :export)
  (body (constantly nil) function "the function of a thing that the kicker runs" :writable :export)
  (test-attributes '() list "the attributes that the test reads" :writable)
  (test-outcome nil (member nil :no t) "NIL before the first test, :NO while all tests were false, T
after a true test" :writable)
  (checked-p nil boolean "the kicker has been attached, or a run has ended without an
attachment" :writable))

(define-kind (attachment :constructor (make-attachment (kicker thing)))
    "A kicker on a thing."
  (:fixed
   (kicker nil kicker "the attached kicker" :addition)
   (thing nil thing "the thing that the kicker is on" :addition))
  (:state
   (alive-p t boolean "the kicker has not been taken off")
   (due 0 tick-count "the WORLD-KICKER-TICK in which the attachment runs by request")
   (ran 0 tick-count "the WORLD-KICKER-TICK in which the attachment last ran by request")
   (index 0 fixnum "the index of the attachment in its group")
   (group nil t "the group that the attachment is in, or NIL")))

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

;; Kickers defined by name are shared; others may have closed over things of a run.
(defmethod copy-plan-value ((kicker kicker) fork)
  (if (or (eq kicker (find-kicker (kicker-name kicker) nil))
          (notany #'closure-p (list (kicker-test kicker) (kicker-body kicker))))
      (record-copy kicker kicker fork)
      (copy-slots kicker fork)))

(defvar *kicker-generation* 0 "How many times a kicker has been redefined.")

(public self)
(defvar self nil
  "The attached kicker whose test or body is running, for RUN-KICKER; else NIL (manual 5.3.1).")

(defmethod redo-definition ((kicker kicker))
  (incf *kicker-generation*)
  kicker)

(defun set-kicker-code (kicker definition prob test body)
  (setf (kicker-prob kicker) (checked-probability definition :prob prob)
        (kicker-test kicker) test
        (kicker-body kicker) body)
  kicker)

(defun define-kicker (name &key (prob 1) test (body (constantly nil)) test-attributes)
  "Define or redefine the kicker NAME. DEFKICKER expands to a call of this function. TEST and BODY
are functions of a thing; TEST-ATTRIBUTES lists the attributes that TEST reads. Return the kicker."
  (let ((new (set-kicker-code (make-kicker name) (definition-title "defkicker" name) prob test
                              body))
        (old (definition-to-replace name *kickers*)))
    (setf (kicker-test-attributes new) test-attributes)
    (when old
      (incf *kicker-generation*)
      (setf (kicker-checked-p new) (kicker-checked-p old)))
    (register *kickers* name (if old (overwrite-object old new) new) :variable t)))

(defun kicker-option-forms (definition variable options body)
  "Return the keyword arguments of DEFINE-KICKER, as forms, for OPTIONS and BODY (reading 169)."
  (unless (and variable (symbolp variable) (not (constantp variable)))
    (reject-clause definition variable "a variable, to be bound to the kicker's thing"))
  (unless (typep options '(or null (cons keyword)))
    (reject-clause definition options
                   "a list of options before the body, such as (:prob 1/10) or (:test form)"))
  (check-options definition options '(:prob :test))
  (let ((advice (test-advice (getf options :test))))
    (when advice (warn-of-style "~A, :test: ~A" definition advice)))
  (when (body-advice body) (warn-of-style "~A: ~A" definition (body-advice body)))
  (flet ((thing-function (forms)
           `(lambda (,variable) (declare (ignorable ,variable)) ,@forms)))
    `(:prob ,(getf options :prob 1)
      :test ,(unless (eq (getf options :test t) t)
               (thing-function (list (getf options :test))))
      :body ,(thing-function body))))

(defun attributes-read-by-test (test)
  "Return the keywords that TEST, a form, passes to GET-ATTRIBUTE."
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
  "Define the kicker NAME (manual 5.3.1), whose BODY runs with probability :prob (default 1) in each
tick in which the form :test (default true) is true. LAMBDA-LIST is a list of one variable, bound to
the thing in BODY and :test. NAME becomes a special variable bound to the kicker, unless NAME is a
symbol of Common Lisp, such as OPEN, or of the simulator, or already has a value: refer to such
kickers by name. A redefinition affects things that have the kicker. Random numbers depend on the
seed: those of CL:RANDOM, which is seeded in each tick, and those of (roll-between 0 1 (world-dice
*world* :user)). Signals MALFORMED-DEFINITION. Return the name."
  (let ((definition (definition-title "defkicker" name)))
    (expand-definition
     form environment
     (lambda ()
       (check-name definition name "kicker")
       (unless (and (proper-list-p lambda-list) (= 1 (length lambda-list)))
         (reject-clause definition lambda-list "a list of one variable"))
       (values `((define-kicker ',name
                   ,@(kicker-option-forms definition (first lambda-list) options body)
                   :test-attributes ',(attributes-read-by-test (getf options :test))))
               (defvar-forms name))))))

;;; Putting kickers on things and taking them off.

(defun find-attachment (thing name)
  "Return the attachment of the kicker named NAME on THING, or NIL."
  (find name (thing-kickers thing) :key #'attachment-name :test #'same-name-p))

(defun removed-kicker-placeholder (thing name)
  "Return a placeholder for the attachment of a kicker named NAME that was removed from THING."
  (let ((attachment (make-attachment (make-kicker name) thing)))
    (setf (attachment-alive-p attachment) nil)
    attachment))

(defun detach-kicker (thing name)
  (let ((attachment (find-attachment thing name)))
    (when attachment
      (setf (thing-kickers thing) (remove attachment (thing-kickers thing)))
      (leave-group attachment))))

(defun detach-all-kickers (thing)
  (mapc #'leave-group (thing-kickers thing))
  (setf (thing-kickers thing) '()))

(defun attach-kicker (thing kicker)
  "Attach KICKER to THING instead of any other kicker of the same name. Return the attachment."
  (detach-kicker thing (kicker-name kicker))
  (setf (kicker-checked-p kicker) t)
  (let ((attachment (make-attachment kicker thing)))
    (setf (thing-kickers thing) (append (thing-kickers thing) (list attachment)))
    (when (and (thing-world thing) (thing-alive-p thing))
      (join-group attachment (thing-world thing)))
    attachment))

(public set-kicker)
(defun set-kicker (thing kicker-name)
  "Attach the kicker KICKER-NAME, a symbol or a kicker, to THING (manual 5.3.1). Signals
WRONG-ARGUMENT and UNKNOWN-NAME. Return the attached kicker, SELF while it runs. See reading 171."
  (check-argument set-kicker thing (and (thing-p thing) (not (body-p thing)))
                  (argument-type-text 'thing thing))
  (let ((kicker (find-kicker kicker-name)))
    (changing ((world-of-living-thing thing) set-kicker thing (kicker-name kicker))
      (attach-kicker thing kicker))))

(define-operator 'set-kicker '(thing name) #'set-kicker)

(defun call-put-kicker (thing name &key (prob 1) test body)
  "Attach a kicker NAME to THING only, as PUT-KICKER does. Without a BODY, remove the kicker NAME."
  (check-argument put-kicker thing (and (thing-p thing) (not (body-p thing)))
                  (argument-type-text 'thing thing))
  (let ((kicker (and body (set-kicker-code (make-kicker name) (definition-title "put-kicker" name)
                                           prob test body))))
    (changing ((world-of-living-thing thing) call-put-kicker thing name
                        :prob prob :test test :body body)
      (if kicker
          (attach-kicker thing kicker)
          (detach-kicker thing name)))))

(define-operator 'call-put-kicker '(thing name) #'call-put-kicker :rest 'datum)

(public put-kicker)
(define-user-macro put-kicker (name target &optional options &body body)
  "Define a kicker NAME for one thing only, with options as for DEFKICKER. The new kicker replaces
the thing's kicker of the same name. With an empty BODY, remove the thing's kicker NAME, even if
DEFKICKER defined it (manual 5.3.1). TARGET is (variable thing); the variable is bound to the thing
in test and body. Return the attached kicker, if any."
  (let ((definition (definition-title "put-kicker" name)))
    (check-name definition name "kicker")
    (unless (and (proper-list-p target) (= 2 (length target)))
      (reject-clause definition target "(variable thing)"))
    (destructuring-bind (variable thing) target
      (if (every #'null body)
          `(progn (call-put-kicker ,thing ',name) nil)
          `(call-put-kicker ,thing ',name
                            ,@(kicker-option-forms definition variable options body))))))

;;; All threads that run worlds share kickers. The slots CHECKED-P and TEST-OUTCOME change in one
;;; direction only, by single writes, so a race can at most repeat a warning.

(defun code-refers-to-p (name package)
  "True if the code of another kicker, or of a user's function in PACKAGE, refers to NAME."
  (flet ((names-it-p (function) (member name (code-references function))))
    (or (loop for kicker in (all-kickers)
                thereis (and (not (eq name (kicker-name kicker)))
                             (names-it-p (kicker-body kicker))))
        (and package
             (do-symbols (symbol package)
               (when (and (users-symbol-p symbol) (fboundp symbol)
                          (not (macro-function symbol))
                          (names-it-p (fdefinition symbol)))
                 (return t)))))))

(defun kicker-maybe-used-p (entry world)
  "True if the kicker of ENTRY may be in use: a function refers to it, its name occurs more than
once in the file of WORLD's map, or the kicker is from another file."
  (let ((name (entry-name entry)) (file (source-file (entry-source entry)))
        (map-entry (lookup-entry (map-name (world-map world)) *maps*)))
    (if file
        (not (and map-entry
                  (equal file (source-file (entry-source map-entry)))
                  (eql 1 (word-count-in-file (name-string name) file))))
        (code-refers-to-p name (symbol-package name)))))

(defun warn-of-unused-kicker (entry world)
  "Warn if the kicker of ENTRY is new, and no program, thing or map seems to use the kicker."
  (let ((kicker (entry-object entry)))
    (unless (or (shiftf (kicker-checked-p kicker) t)
                (kicker-maybe-used-p entry world)
                (some (lambda (map) (kicker-on-map-p kicker map)) (all-maps)))
      (warn-once (list :kicker (kicker-name kicker)) world
                 (format nil "No thing has the kicker ~(~A~), so it never ran. Attach it: ~
                              (obj (NAME :kickers (~:*~(~A~))) ...) in the map, or ~
                              (set-kicker THING '~:*~(~A~))."
                         (kicker-name kicker))))))

(defun warn-of-untrue-test (kicker world)
  "Warn if the test of KICKER, on a thing of WORLD, was never true and reads an unknown attribute."
  (let ((key (and (eq :no (kicker-test-outcome kicker))
                  (some-kicker-p (lambda (each) (eq each kicker)) world)
                  (find-if-not (lambda (name)
                                 (or (declared-attribute name) (attribute-in-world-p name world)))
                               (kicker-test-attributes kicker)))))
    (when key
      (warn-once (list :kicker (kicker-name kicker)) world
                 (format nil "The :test of the kicker ~(~A~) was never true. It reads ~(~S~), ~
                              which no thing here has and no DEFATTRIBUTE declares."
                         (kicker-name kicker) key)))))

(defun warn-of-idle-kickers (world)
  "At the end of a run in WORLD, warn of kickers that most likely could never run."
  (dolist (entry (registry-entries *kickers*))
    (warn-of-unused-kicker entry world)
    (warn-of-untrue-test (entry-object entry) world)))

;;; Remedies for a kicker that fails again and again.

(defun kicker-correction-text (attachment)
  (let* ((kicker (attachment-kicker attachment))
         (file (function-file (kicker-body kicker))))
    (cond (file (format nil "in ~A, and load the file again" file))
          ((eq kicker (find-kicker (kicker-name kicker) nil)) "by DEFKICKER")
          (t "by PUT-KICKER"))))

(defmethod recurring-function ((attachment attachment))
  (kicker-body (attachment-kicker attachment)))

(defmethod stop-recurring-remedy ((attachment attachment))
  (let ((name (attachment-name attachment)))
    (format nil "Correct the kicker ~A ~A; or remove it: (put-kicker ~(~A~) (thing (find-thing ~
                 \"~A\")))."
            name (kicker-correction-text attachment) name (attachment-thing attachment))))

(define-facts (kicker kicker)
  "Chance in a tick" (kicker-prob kicker)
  "Only when its test holds" (and (kicker-test kicker) "yes"))
