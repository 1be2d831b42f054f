;;;; inquiries.lisp -- who asks how code goes on that has entered a debugger, and may go away.

(in-package :ars-magna.definitions)

(export '(answering-debugger debugger-asking end-inquiries *inquiry-hooks* *debugger-refused-p*))

;;; Code that we call may enter a debugger of somebody else: Lisp's own, or that of an editor. What
;;; is typed there may go wrong too. That is a matter of the debugger: it must not come to those
;;; handlers of ours inside of which the code has been called. And the editor may go before it is
;;; answered. Then whoever else can asks; else ABORT is chosen, or CONTINUE after what is no error.

(defstruct (inquiry (:constructor make-inquiry (thread hook)) (:copier nil))
  "That the debugger of HOOK, or Lisp's own if that is NIL, asks how THREAD goes on."
  (thread nil :read-only t)
  (hook nil :read-only t))

(defvar *inquiries* '() "All inquiries under way, the newest first.")
(defvar *inquiries-lock* (make-lock "inquiries"))

(define-event *inquiry-hooks*
  "Functions, or their names, of a condition and of who asks, in words. They are called in the
thread that has broken, before it is asked there how that goes on.")

(defvar *debugger-refused-p* nil
  "True where the debugger's hook asks nobody, but signals an error.")

(defun inquiries ()
  (with-lock (*inquiries-lock*) (copy-list *inquiries*)))

(defun words-for-asker (hook)
  (if (or hook *debugger-hook*) "the editor's debugger" "Lisp's own debugger"))

(defun debugger-asking (thread)
  "Return, in words, whose debugger asks how THREAD is to go on; NIL if none of others' does."
  (let ((inquiry (find thread (inquiries) :key #'inquiry-thread)))
    (and inquiry (words-for-asker (inquiry-hook inquiry)))))

(defun end-inquiries (gone-p)
  "Let those threads in which GONE-P, called there, is true know that who was asked has gone."
  (dolist (inquiry (inquiries))
    (interrupt-thread (inquiry-thread inquiry)
                      (lambda ()
                        (when (and (member inquiry (inquiries)) (funcall gone-p))
                          (throw inquiry nil))))))

(defun call-noting-inquiry (inquiry function)
  (with-lock (*inquiries-lock*) (push inquiry *inquiries*))
  (unwind-protect (funcall function)
    (with-lock (*inquiries-lock*) (setf *inquiries* (remove inquiry *inquiries*)))))

(defun call-as-debugger (function)
  "Call FUNCTION, a debugger, in which what goes wrong in what is typed there comes up."
  (handler-bind (((or error storage-condition) #'debug-inside))
    (funcall function)))

(defun call-debugger-hook (condition)
  "Call *DEBUGGER-HOOK* with CONDITION as INVOKE-DEBUGGER does."
  (let ((hook *debugger-hook*) (*debugger-hook* nil))
    (funcall hook condition hook)))

(defun debug-inside (condition)
  "Let the debugger that is under way here look into CONDITION, in what was typed there."
  (unless (typep condition 'time-limit)
    (call-as-debugger (lambda () (invoke-debugger condition)))))

;; SWANK sets both of SBCL's hooks, and the function in the first leaves it to the other.
(defun enter-outer (condition hook)
  "Let the debugger of HOOK, or if that asks nobody the one of *DEBUGGER-HOOK*, or Lisp's own where
there is no hook, ask how to go on after CONDITION. Return if nobody is asked."
  (call-as-debugger (lambda ()
                      (when hook (funcall hook condition hook))
                      (cond (*debugger-hook* (call-debugger-hook condition))
                            ((null hook) (invoke-debugger condition))))))

(defun go-on-unasked (condition)
  "Go on after CONDITION as most likely it should, as nobody is left who could say how, and warn."
  (let ((name (if (typep condition 'serious-condition) 'abort 'continue)))
    (warning-set "The debugger that asked how something that had broken goes on has gone; "
                 (string-downcase name)
                 " was chosen: " (one-line-text condition))
    (when (eq name 'continue) (continue condition))
    (abort condition)))

(defun inquire (condition hook)
  "Let the debugger of HOOK, which is somebody else's, ask how to go on after CONDITION; and when it
has gone without an answer, somebody else. Return if they do."
  (let ((inquiry (make-inquiry (current-thread) hook)))
    (catch inquiry
      (call-noting-inquiry inquiry
                           (lambda ()
                             (tell-listeners *inquiry-hooks* condition (words-for-asker hook))
                             (enter-outer condition hook)))
      (return-from inquire))
    (ask-how-to-go-on *front-end* condition)
    (go-on-unasked condition)))

(defun call-answering-debugger (function answer)
  "Call FUNCTION and return its values. If it enters a debugger, call ANSWER with the condition, and
whether somebody is there to talk to the debugger. If nobody is, it is not to return."
  (declare (type function function answer))
  (let ((hook (debugger-hook))
        (foreign (foreign-hook)))
    (flet ((decide (condition this-hook)
             (declare (ignore this-hook))
             (funcall answer condition (debugger-p foreign))
             (cond ((disabled-hook-p hook))
                   ((and (eq hook foreign) (not *debugger-refused-p*)) (inquire condition hook))
                   (t (funcall hook condition hook)))))
      (declare (dynamic-extent #'decide))
      (let* ((answerer (cons #'decide foreign))
             (*answerer* answerer))
        (declare (dynamic-extent answerer))
        (with-debugger-hook (#'decide)
          (funcall function))))))

(defmacro answering-debugger ((answer) &body body)
  "Run BODY as CALL-ANSWERING-DEBUGGER would a function."
  (form-calling 'call-answering-debugger body answer))
