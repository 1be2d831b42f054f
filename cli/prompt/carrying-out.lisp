;;;; carrying-out.lisp -- carrying out a line, Lisp or a line command; an error ends it.

(in-package :ars-magna.cli)

;;; A line that begins with a parenthesis, or with # as forms do, is Lisp, in the package ARS-USER
;;; and the syntax of the readtable :NISP; IN-PACKAGE applies to the lines that follow. A form may
;;; span lines. Typed numbers are double-floats. Code that runs, loaded files included, finds the
;;; standard variables of Lisp as everywhere else.

(defvar *undefined-names* '()
  "Lists (name kind new-p) of undefined names that the compiler has found in the forms being
evaluated, newest first. NEW-P is true if the name had no value when found.")

(defun handle-warning (condition)
  "Show definition warnings as messages, record undefined names, muffle other style warnings."
  (typecase condition
    (definition-warning (warning-set (one-line (princ-to-string condition)))
                        (muffle-warning condition))
    (t (multiple-value-bind (name kind) (undefined-name-of-warning condition)
         (when name
           (pushnew (list name kind (still-undefined-p name kind)) *undefined-names* :test #'equal)
           (muffle-warning condition)))
       (when (typep condition '(or style-warning compiler-note)) (muffle-warning condition)))))

(defun call-quietly (function)
  (handler-bind ((warning #'handle-warning)
                 (compiler-note #'muffle-warning))
    (funcall function)))

(defun call-reporting-undefined (function &optional file)
  "Call FUNCTION, which evaluates forms of FILE or typed forms, and return its values. At the end,
report the names in these forms that are still undefined."
  (let ((*undefined-names* '()))
    (multiple-value-prog1 (funcall function)
      (loop for (name kind new-p) in (reverse *undefined-names*)
            do (cond ((still-undefined-p name kind)
                      (warning-set (format nil "~@[~A: ~]The ~(~A~) ~(~A~) is not defined."
                                           file kind (safe-text name))))
                     ((and new-p (null file) (eq :variable kind))
                      (warn-of-new-variable name)))))))

(define-condition file-trouble (ars-magna-error)
  ((file  :initarg :file  :reader file-trouble-file)
   (line  :initarg :line  :reader file-trouble-line)
   (cause :initarg :cause :reader file-trouble-cause))
  (:report (lambda (condition stream)
             (format stream "~A, line ~D: ~A"
                     (file-trouble-file condition) (file-trouble-line condition)
                     (condition-text (file-trouble-cause condition)))))
  (:documentation "A form of a file being loaded has failed; earlier forms were evaluated."))

(defun condition-has-location-p (condition)
  (or (typep condition 'file-trouble)
      (and (typep condition 'malformed-definition)
           (malformed-definition-place condition))))

(defun report-from-compiler (tell condition)
  "Report CONDITION of COMPILE-FILE, with file and line, by calling TELL: ERROR-SET or WARNING-SET.
Do nothing outside of COMPILE-FILE."
  (let ((text (one-line (condition-text condition))))
    (multiple-value-bind (file line) (if (typep condition 'reader-error)
                                         (reading-location condition)
                                         (compiling-location))
      (cond ((null file))
            ((condition-has-location-p condition) (funcall tell text))
            (t (funcall tell (format nil "~A~@[, line ~D~]: ~A" file line text)))))))

(defun report-compiler-condition (condition)
  "Report CONDITION if it is an error or warning of COMPILE-FILE about a form."
  (cond ((null *compile-file-truename*))
        ((compiler-error-p condition)
         (report-from-compiler #'error-set (encapsulated-condition condition)))
        ((typep condition 'warning) (report-from-compiler #'warning-set condition))))

(defun call-reporting-warnings (function)
  "Call FUNCTION and return its values. Meanwhile report warnings about evaluated
forms, and errors and warnings of COMPILE-FILE, as messages."
  (let ((last nil))
    ;; Each nested EVAL signals the compiler's conditions once more.
    (handler-bind ((condition (lambda (condition)
                                (unless (eq condition (shiftf last condition))
                                  (report-compiler-condition condition)))))
      (call-quietly (lambda () (call-in-new-unit function))))))

(defun eval-quietly (form)
  "Evaluate FORM. At the end, show the text that FORM wrote to the error output."
  (let ((diagnostics (make-string-output-stream)))
    (unwind-protect (let ((*error-output* diagnostics)
                          (*read-default-float-format* 'single-float))
                      (call-quietly (lambda () (eval (replace-robot-symbol form)))))
      ;; Except those of the compiler, and Lisp's own note on a full stack, which users are told of.
      (dolist (line (lines-in (get-output-stream-string diagnostics)))
        (unless (or (string= line "") (char= #\; (char line 0))
                    (starts-with-subseq "Control stack guard page" line))
          (format *standard-output* "~&~A~%" line))))))

(defun eval-locating-read-errors (form)
  "Evaluate FORM. If LOAD in FORM cannot read a file, signal FILE-TROUBLE with file and line."
  (handler-bind ((reader-error (lambda (condition)
                                 (multiple-value-bind (file line) (reading-location condition)
                                   (when file
                                     (error 'file-trouble :file file :line line
                                                          :cause condition))))))
    (eval-quietly form)))

(defun value-line (value)
  (let ((*print-circle* (or *print-circle* (not (tree-p value)))))
    (handler-bind ((error (lambda (trouble)
                            (reject-line "The value, of type ~(~A~), cannot be printed: ~A. ~
                                          Perhaps a method for PRINT-OBJECT fails."
                                         (class-name (class-of value)) (one-line-text trouble)))))
      (format nil "~S" (if (readtablep value) (readtable-name value) value)))))

(defun evaluate (session form)
  (setf (session-lisp-p session) t)
  (let ((values (multiple-value-list
                 (call-reporting-warnings
                  (lambda ()
                    (call-refusing-exits
                     (lambda () (eval-locating-read-errors form))
                     "EXIT would end the simulator during a line. QUIT leaves."))))))
    (shiftf *** ** * (first values))
    (unless (report-values (session-account session) (mapcar #'value-line values))
      (when values (fresh-line))
      (format t "~{~A~%~}" (mapcar #'value-line values)))))

(defun reject-surplus-parenthesis (text position)
  (let ((start (skip-blanks text position)))
    (when (char= #\) (char text start))
      (reject-line "There is one parenthesis too many: ~A~:[~;  Forms before it were evaluated.~]"
                   (one-line (subseq text start)) (plusp position)))))

(defun parameter-error ()
  (handler-case (check-parameters)
    (wrong-argument (condition) condition)))

(defun call-checking-parameters (function)
  "Call FUNCTION; signal WRONG-ARGUMENT if it has given a parameter an invalid value."
  (let ((before (parameter-error)))
    (funcall function)
    (let ((after (parameter-error)))
      (unless (equal (and before (princ-to-string before)) (and after (princ-to-string after)))
        (when after (error after))))))

(defun note-clause-line (session text form clause)
  "Record the line number of CLAUSE of FORM in TEXT. TEXT ends with the last line read in SESSION."
  (let ((line (line-of-clause text form clause)))
    (when line
      (note-trouble-line (session-account session)
                         (- (+ line (count-of-lines-read (session-input session)))
                            (count #\Newline text)
                            1)))))

(defun evaluate-locating-clauses (session text form)
  "Evaluate FORM, read from TEXT in SESSION, and record the line number of an invalid clause."
  (handler-bind ((malformed-definition
                   (lambda (condition)
                     (unless (malformed-definition-place condition)
                       (ignore-errors
                        (note-clause-line session text form
                                          (malformed-definition-clause condition)))))))
    (evaluate session form)))

(defun check-utf-8 (session text start end)
  "Signal BAD-LINE if TEXT from START to END is not UTF-8. TEXT ends with the last line of SESSION."
  (let ((place (position +illegible+ text :start start :end end)))
    (when place
      (note-trouble-line (session-account session)
                         (- (count-of-lines-read (session-input session))
                            (count #\Newline text :start place)))
      (reject-line "The line has bytes that are not UTF-8, or U+FFFD, which replaces such bytes. ~
                    Write the line in UTF-8."))))

(defun evaluate-forms (session text)
  (loop with position = 0
        with start = 0
        with form
        do (setf (values text position) (skip-comments session text position))
        until (= (skip-blanks text position) (length text))
        do (reject-surplus-parenthesis text position)
           (setf start position
                 (values form position text) (read-form session text position))
           (check-utf-8 session text start position)
           (check-line-in-parentheses form)
           (check-typed-call form)
           (check-typed-load form)
           (call-checking-parameters (lambda () (evaluate-locating-clauses session text form)))))

(defun evaluate-text (session text)
  (call-reporting-undefined (lambda () (evaluate-forms session text))))

;;; Lines of both kinds.

(defun expand-alias (text &optional known)
  "Return TEXT with leading aliases expanded, one after another, but each alias only once."
  (multiple-value-bind (name rest) (split-first-word text)
    (let ((alias (assoc name *aliases* :test #'string-equal)))
      (if (and alias (not (member alias known)))
          (expand-alias (concatenate 'string (second alias) rest) (cons alias known))
          text))))

(defun line-output-unbuffered-p (line)
  "True if the output of LINE is shown while LINE runs, not only at its end."
  (or (line-full-name line)
      (member (line-name line)
              '("ALL:" "EVAL" "REPEAT" "TRIAL" "FORK" "WATCH" "WINDOW" "DISPLAY")
              :test #'string=)))

(defun text-width (session)
  "Return the largest number of characters in a line of text for SESSION, at most 79."
  (if (session-terminal-p session) (clamp (1- (size-of-window session)) 40 79) 79))

(defun run-line-command (session line text)
  "Run the line command LINE with the arguments in TEXT. Write its output in one piece."
  (let ((arguments (read-arguments line text))
        (*text-width* (text-width session))
        (*asker* (asker-for (session-account session) :typed-p t)))
    (if (line-output-unbuffered-p line)
        (apply (line-action line) session arguments)
        (write-string (fit-to-window (printing-text ()
                                       (with-output-to-string (*standard-output*)
                                         (apply (line-action line) session arguments)))
                                     (session-console session))))))

(defun evaluate-line (session text)
  "Evaluate TEXT as Lisp. Fit printed tables to the window of SESSION, if there is a window."
  (if (session-terminal-p session)
      (call-with-page-width (lambda () (evaluate-text session text)) (1- (size-of-window session)))
      (evaluate-text session text)))

(defun run-typed-line (session text)
  "Run the typed line TEXT, and mark its requests as requests of the prompt."
  (let* ((*asker* (asker-for (session-account session)))
         (*request-origin* *asker*))
    (cond ((nothing-to-run-p text))
          ((lisp-p text) (evaluate-line session text))
          (t (let ((text (expand-alias text)))
               (if (lisp-p text)
                   (evaluate-line session text)
                   (multiple-value-bind (name rest) (split-first-word text)
                     (warn-of-command-in-comment text)
                     (check-utf-8 session text 0 nil)
                     (run-line-command session (find-line-command name) rest))))))))

;;;; Errors

;;; An interrupt (Control-C) ends the line that is being read or carried out, and does not affect
;;; the simulator. Between lines it waits for the next one.

(defun debug-if-wanted (session condition)
  (when (and *break-on-user-error*
             (session-terminal-p session)
             (not (typep condition '(or ars-magna-error storage-condition))))
    (invoke-debugger condition)))

(defun report-printing-error (session trouble)
  "Report in SESSION that an error cannot be printed. TROUBLE is the error in printing; at a
terminal, signal TROUBLE, because the prompt could not be printed, either."
  (when (session-terminal-p session) (error trouble))
  (incf (session-errors session))
  (write-on-fresh-line (concatenate 'string "*ERROR* -> " +unprintable+ '(#\Newline))
                       (session-console session)))

(defun call-reporting-session-errors (session function)
  (handler-case (funcall function)
    ((or error storage-condition) (condition)
      (recover-memory condition)
      (handler-case (report-session-error session (text-with-advice condition))
        (error (trouble) (report-printing-error session trouble))))))

(defun ongoing-work-text (session)
  "Return text for the user of SESSION after an interrupted line. The text says what continues in
the simulator and how to end that; or, if nothing continues, how to leave the prompt. During a
break, the text says how to answer. In a trial, it is empty."
  (multiple-value-bind (robot command) (command-in-progress session)
    (let ((plans-p (notevery #'plan-ending-p (plans))) (others (other-robots-at-work robot)))
      (cond ((restart-choices-text session)
             (format nil " Answer the break by one of ~A." (restart-choices-text session)))
            ((session-trial session) "")
            ((or robot others plans-p)
             (format nil "~@[ ~A continues with ~]~@[~A; STOP ends that.~]~
                          ~@[ Other robots at work: ~{~A~^, ~}; ALL: STOP stops all robots.~]~
                          ~:[~; Plans continue; STOP-PLAN ends them.~]"
                     robot command others plans-p))
            (t " QUIT leaves.")))))

(defun running-code-owner-text (&optional (calls *user-calls*))
  "Return text that says whose code the thread of CALLS runs, or which form of a file the thread
loads; NIL if CALLS records neither."
  (let ((origin (and calls (user-calls-origin calls)))
        (place (and calls (user-calls-place calls))))
    (cond (origin (text-of-origin origin))
          (place (funcall place)))))

(defun report-with-line-number (session text)
  "Write TEXT to the error output. Before it, write the script and number of the running line."
  (let* ((account (session-account session)) (line (running-line-number account)))
    (say-on-error-output (format nil "~@[~A, ~]~@[line ~D: ~]~A"
                                 (and line (account-file account)) line text))))

(defun dropped-lines-text (count)
  (format nil "~[~:; ~:*~D line~:P that waited ~:*~[~;was~:;were~] dropped; the up arrow brings ~
               ~:*~[~;it~:;them~] back.~]"
          count))

(defun report-interrupt (session whose)
  "Report in SESSION that an interrupt has ended the line. WHOSE, a text or NIL, names the code that
was running. Abort users' code that blocks the simulator, too."
  (when (session-batch-p session)
    (report-with-line-number session (format nil "stopped~@[ in ~A~]." whose))
    (throw 'leave 130))
  (when *simulation* (abort-hog *simulation*))
  (let ((console (session-console session))
        (dropped (discard-waiting-lines (session-input session))))
    (note-answered console)
    (write-fitted console "Interrupted.~A~A~%" (dropped-lines-text dropped)
                  (ongoing-work-text session))))

(defun call-guarded (session function)
  "Call FUNCTION, which may be interrupted; report its errors."
  (let ((whose nil))
    (flet ((look-into (condition) (debug-if-wanted session condition))
           (look-whose (condition)
             (declare (ignore condition))
             (setf whose (running-code-owner-text))))
      (handler-case
          (with-simple-restart (end-line "End the line.")
            (call-reporting-session-errors session
                                           (lambda ()
                                             (handler-bind ((error #'look-into)
                                                            (user-interrupt #'look-whose))
                                               (call-releasing-interrupts function)))))
        (user-interrupt () (report-interrupt session whose))))))
