;;;; reading.lisp -- reading lines, and forms and comments that span lines.

(in-package :ars-magna.cli)

(export '(announce-program-input))

;;; While a program reads, the next typed line is for it, and not for the prompt.

(defgeneric announce-program-input (console)
  (:documentation "Tell the user of CONSOLE that a program reads the next line.")
  (:method ((console console))
    (unless (shiftf (console-asking-told-p console) t)
      (write-fitted console "A program waits for your answer; control-C ends the program.~%"))
    (finish-output console)))

(defun call-reading-program-input (console function)
  "Call FUNCTION, which lets a program read a line that is typed on CONSOLE."
  ;; A question that the program has written stands before the line.
  (when (zerop (console-column console)) (write-string "Answer> " console))
  (setf (console-asked-p console) t)
  (unwind-protect (funcall function)
    (setf (console-asked-p console) nil)))

;;;; Lines and forms

(defun answers-break-p (session line)
  "True if LINE, typed in SESSION, answers a break, and so is not kept in the history."
  (and (breaks-for-session session) (not (valid-at-any-break-p line))))

(defun read-typed-line (session before)
  "Return the next line typed in SESSION, or NIL at the end. Put the line into the history; unless
BEFORE is NIL, append it to the text BEFORE there."
  (let* ((line (progn
                 ;; Forms that span lines are kept whole.
                 (unless before (save-history (session-input session)))
                 (let ((*before-program-reads* nil)) (read-line (session-input session) nil))))
         (first-p (and line (not (shiftf (reader-typed-p (session-reader session)) t))))
         ;; The first line may say what program runs a script.
         (line (cond ((and first-p (starts-with-subseq "#!" line)) "")
                     (line (without-pasted-prompt line before)))))
    (unless (or (null line) (and (null before) (answers-break-p session line)))
      (add-to-history (session-input session) line before))
    line))

(defun read-input (session prompt &optional before)
  "Return the next line of SESSION, or NIL at the end. The line continues the text BEFORE, if any.
Show PROMPT, except in a batch. First await earlier commands if SESSION waits for commands."
  (let ((console (session-console session)))
    (unless (or (session-batch-p session)
                (and (prompt-unanswered-p console) (string= prompt (console-prompt console))))
      (with-lock ((session-lock session)) (show-prompt console prompt)))
    (await-session-commands session)
    (let* ((given (pop (reader-lines (session-reader session))))
           (line (or given
                     (and (not (console-trouble console))
                          (read-typed-line session before)))))
      (with-lock ((session-lock session))
        (cond ((and line
                    (not (session-batch-p session))
                    (or given (reader-echo-p (session-reader session))))
               (show-answer console (escape-controls line)))
              (t (unless (or line (session-batch-p session)) (fresh-line console))
                 (note-answered console)))
        (reset-line-error-counts (session-error-counts session))
        (reset-message-count session))
      line)))

;;; Forms that cannot be read.

;;; If the reader fails inside a form, the lines below are the rest of it, not commands. Only
;;; parentheses, quotes and comments show how far it extends.

(defun skip-past-character (char stream)
  "Read STREAM past the next CHAR that does not follow a backslash."
  (loop for next = (read-char stream)
        until (char= char next)
        do (when (char= #\\ next) (read-char stream))))

(defun skip-to-comment-end (stream)
  "STREAM is inside a comment between #| and |#. Read past the end of that comment."
  (loop with depth = 1
        for last = #\Space then char
        for char = (read-char stream)
        do (cond ((and (char= #\# last) (char= #\| char)) (incf depth) (setf char #\Space))
                 ((and (char= #\| last) (char= #\# char)) (decf depth) (setf char #\Space)))
        until (zerop depth)))

(defun skip-item (stream)
  "Read STREAM past a character, a quoted text or a comment. Return its first character."
  (let ((char (read-char stream)))
    (case char
      (#\\ (read-char stream))
      ((#\" #\|) (skip-past-character char stream))
      (#\; (loop until (char= #\Newline (read-char stream))))
      (#\# (when (char= #\| (peek-char nil stream))
             (read-char stream)
             (skip-to-comment-end stream))))
    char))

(defun read-continuation-line (session text)
  "Return the next line of SESSION, which continues TEXT; NIL at the end. For a line that is too
long, return an outline and the condition LINE-TOO-LONG."
  (handler-case (read-input session +continuation-prompt+ text)
    (line-too-long (condition) (values (line-outline condition) condition))))

(defun skip-forms (stream)
  "Read STREAM, which gets more lines as needed, until no form is open at the end of a line."
  (loop with depth = 0
        until (and (zerop depth) (<= (length (grown-text stream)) (grown-position stream)))
        do (case (skip-item stream)
             (#\( (incf depth))
             (#\) (setf depth (max 0 (1- depth)))))))

(defun skip-rest-of-forms (session text start)
  "TEXT was read so far. Read lines in SESSION until all forms in TEXT from START on are complete."
  (flet ((next-outline (text)
           (or (values (read-continuation-line session text))
               (error 'end-of-file :stream (session-input session)))))
    (handler-case (skip-forms (make-growing-text-stream text start #'next-outline))
      (end-of-file ()))))

(defun skip-unreadable-rest (condition session text start)
  "Call SKIP-REST-OF-FORMS if CONDITION says that the form in TEXT at START cannot be read."
  (typecase condition
    (line-too-long
     (skip-rest-of-forms session (format nil "~A~%~A" text (line-outline condition)) start))
    ((or bad-line storage-condition end-of-file) nil)
    (error (note-trouble-line (session-account session)
                              (count-of-lines-read (session-input session)))
           (skip-rest-of-forms session text start))))

(defmacro skipping-unreadable-rest ((session text start) &body body)
  "Run BODY, which reads the form in TEXT at START. Skip the rest of a form that cannot be read."
  `(handler-bind ((error (lambda (condition)
                           (skip-unreadable-rest condition ,session ,text ,start))))
     ,@body))

;;; A form of Lisp that spans lines is read while its lines come.

;;; Each character is read once or twice, however many lines there are. What is evaluated during
;;; reading, after #., is evaluated as often.

(defun read-continued-form (session text start)
  "Return the values of READ-FORM for a form that continues after TEXT."
  (flet ((read-more (text)
           (or (read-input session +continuation-prompt+ text)
               (reject-line "The form is not complete: ~A" (one-line text)))))
    (let* ((stream (make-growing-text-stream text start #'read-more))
           (form (skipping-unreadable-rest (session (grown-text stream) start)
                   (read-preserving-whitespace stream))))
      (values form
              (min (grown-position stream) (length (grown-text stream)))
              (grown-text stream)))))

(defun only-skipped-form-p (text start)
  "True if TEXT contains, from START on, only a form that Lisp skips, as after #-sbcl."
  (let ((start (position-if-not #'blank-character-p text :start start)))
    (and start
         (< (1+ start) (length text))
         (char= #\# (char text start))
         (find (char text (1+ start)) "+-")
         ;; Then the reader returns what is appended to it.
         (eql 0 (ignore-errors (read-from-string (format nil "~A~%0" text) t nil :start start))))))

(defun read-form (session text &optional (start 0))
  "Return the form in TEXT at START, the position of its end, and TEXT with the lines read
meanwhile. Read lines in SESSION while the form is incomplete. If the Lisp reader skips the text,
return the form (VALUES). Skip an unreadable form to its end."
  (handler-case (skipping-unreadable-rest (session text start)
                  (read-from-string text t nil :start start))
    (end-of-file ()
      (if (only-skipped-form-p text start)
          (values '(values) (length text) text)
          (read-continued-form session text start)))
    (:no-error (form end) (values form end text))))

;;;; Comments between #| and |#

;;; Comments in a form are read by Lisp. Around forms, and before, in and after other lines, they
;;; are removed here, and lines are read until they end.

(defun block-comment-at-p (text position)
  (let ((end (+ 2 position)))
    (and (<= end (length text))
         (string= "#|" text :start2 position :end2 end))))

(defun block-comment-end (text start depth)
  "DEPTH nested comments are open in TEXT at START. Return the position of their common end. If
comments are still open at the end of TEXT, return NIL and their depth."
  (loop with i = start
        for end = (+ 2 i)
        while (<= end (length text))
        do (cond ((block-comment-at-p text i) (incf depth) (setf i end))
                 ((string/= "|#" text :start2 i :end2 end) (incf i))
                 ((zerop (decf depth)) (return end))
                 (t (setf i end)))
        finally (return (values nil depth))))

(defun text-after-block-comment (session text start trouble)
  "Return the text after the comment that begins in TEXT at START. Read lines in SESSION until the
comment ends. If the returned text is only the outline of a line that is too long, the second value
is the condition LINE-TOO-LONG; otherwise NIL. Signals BAD-LINE if the comment does not end."
  (let ((line text) (position (+ 2 start)) (depth 1))
    (loop
      (multiple-value-bind (end deeper) (block-comment-end line position depth)
        (when end (return (values (subseq line end) trouble)))
        (setf depth deeper
              position 0
              (values line trouble) (read-continuation-line session text))
        (unless line
          (reject-line "The comment that begins with #| does not end; close it with |#."))))))

(defun block-comment-start (text)
  "TEXT is a line that is not Lisp. Return the position of its first comment between #| and |#
outside of quotes and other comments; NIL if there is no such comment."
  (loop with quoted = nil
        for char across text
        for i from 0
        do (cond ((char= #\" char) (setf quoted (not quoted)))
                 (quoted)
                 ((block-comment-at-p text i) (return i))
                 ((comment-at-p text i) (return nil)))))

(defun without-block-comments (session text &optional trouble)
  "Return TEXT, a typed line of SESSION, without comments between #| and |#, unless TEXT begins with
a form. If the returned text is an outline of a line that is too long, the second value is the
condition LINE-TOO-LONG. TROUBLE is that condition for TEXT itself, or NIL."
  (let ((start (unless (or (nothing-to-run-p text) (lisp-p text)) (block-comment-start text))))
    (if start
        (let ((before (subseq text 0 start)))
          (multiple-value-bind (rest later) (text-after-block-comment session text start trouble)
            (without-block-comments session (format nil "~A ~A" before rest)
                                    (or (unless (nothing-to-run-p rest) later)
                                        (unless (nothing-to-run-p before) trouble)))))
        (values text trouble))))

(defun reject-overlong-line (session text trouble)
  "Signal TROUBLE, unless TROUBLE is NIL or TEXT is a comment. TEXT is the outline of a line of
SESSION; first skip a form that begins in TEXT."
  (when (and trouble (not (nothing-to-run-p text)))
    (when (lisp-p text) (skip-rest-of-forms session text 0))
    (error trouble)))

(defun form-text-after-block-comment (session text start)
  "Return the text after the comment that begins at START in TEXT, a text of forms. Read lines in
SESSION until the comment ends. Signals LINE-TOO-LONG if a line is too long even without comments."
  (multiple-value-bind (rest trouble) (text-after-block-comment session text start nil)
    (cond (trouble (multiple-value-call #'reject-overlong-line
                     session (without-block-comments session rest trouble))
                   "")
          (t rest))))

(defun skip-comments (session text position)
  "Skip blanks and comments from POSITION in TEXT, a text of forms. Read lines in SESSION until the
comments end. Return TEXT, or its part after the comments, and the position of its next form."
  (loop
    (let ((start (or (position-if-not #'blank-character-p text :start position) (length text))))
      (unless (block-comment-at-p text start)
        (return (values text start)))
      ;; Not at 0: there is something before it.
      (setf text (format nil " ~A" (form-text-after-block-comment session text start))
            position 1))))
