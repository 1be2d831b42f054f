;;;; reading.lisp -- reading lines, and forms and comments that span lines.

(in-package :ars-magna.cli)

(export '(tell-asking))

;;; While a program reads, the next typed line is for it, and not for the prompt.

(defgeneric tell-asking (console)
  (:documentation "Tell the user of CONSOLE that a program reads the next line.")
  (:method ((console console))
    (unless (shiftf (console-asking-told-p console) t)
      (write-fitted console "A program waits for your answer; control-C ends the program.~%"))
    (finish-output console)))

(defun call-asking (console function)
  "Call FUNCTION, which lets a program read a line that is typed on CONSOLE."
  ;; A question that the program has written stands before the line.
  (when (zerop (console-column console)) (write-string "Answer> " console))
  (setf (console-asked-p console) t)
  (unwind-protect (funcall function)
    (setf (console-asked-p console) nil)))

;;;; Lines and forms

(defun answer-p (session line)
  "True if LINE, of SESSION, answers a break: it makes no sense later."
  (and (breaks-awaiting session) (not (answers-break-p line))))

(defun read-typed (session before)
  "Return the next line typed in SESSION, or NIL at the end. The editor completes it and puts it
into the history, joined to BEFORE, a text that it continues, or NIL."
  (let* ((line (progn
                 ;; Forms that span lines are kept whole.
                 (unless before (keep-lines (session-input session)))
                 (let ((*program-reads* nil)) (read-line (session-input session) nil))))
         (first-p (and line (not (shiftf (reader-typed-p (session-reader session)) t))))
         ;; The first line may say what program runs a script.
         (line (cond ((and first-p (starts-with-subseq "#!" line)) "")
                     (line (line-pasted line before)))))
    (unless (or (null line) (and (null before) (answer-p session line)))
      (remember-line (session-input session) line before))
    line))

(defun read-input (session prompt &optional before)
  "Return the next line of SESSION, or NIL at the end; it continues the text BEFORE, if there is
one. Show PROMPT unless it is a batch, and messages of earlier lines if the session waits for
those."
  (let ((console (session-console session)))
    (unless (or (session-batch-p session)
                (and (unanswered-p console) (string= prompt (console-prompt console))))
      (with-lock ((session-lock session)) (show-prompt console prompt)))
    (catch-up session)
    (let* ((given (pop (reader-lines (session-reader session))))
           (line (or given
                     (and (not (console-trouble console))
                          (read-typed session before)))))
      (with-lock ((session-lock session))
        (cond ((and line
                    (not (session-batch-p session))
                    (or given (reader-echo-p (session-reader session))))
               (show-answer console (visible line)))
              (t (unless (or line (session-batch-p session)) (fresh-line console))
                 (answered console)))
        (reset-line-error-counts (session-error-counts session))
        (reset-flood session))
      line)))

;;; Forms that cannot be read.

;;; If the reader fails inside a form, the lines below are the rest of it, not commands. Only
;;; parentheses, quotes and comments show how far it extends.

(defun skip-to (char stream)
  "Read STREAM up to and with the next CHAR that does not follow a backslash."
  (loop for next = (read-char stream)
        until (char= char next)
        do (when (char= #\\ next) (read-char stream))))

(defun skip-block (stream)
  "Read STREAM, in a comment between #| and |#, up to its end."
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
      ((#\" #\|) (skip-to char stream))
      (#\; (loop until (char= #\Newline (read-char stream))))
      (#\# (when (char= #\| (peek-char nil stream))
             (read-char stream)
             (skip-block stream))))
    char))

(defun read-outline (session text)
  "Return the next line of SESSION, which continues TEXT, or the outline of one that is too long and
the condition that says so; NIL at the end."
  (handler-case (read-input session +continuation-prompt+ text)
    (line-too-long (condition) (values (line-outline condition) condition))))

(defun skip-forms (stream)
  "Read STREAM, a growing text, until no form is open at the end of a line."
  (loop with depth = 0
        until (and (zerop depth) (<= (length (grown-text stream)) (grown-position stream)))
        do (case (skip-item stream)
             (#\( (incf depth))
             (#\) (setf depth (max 0 (1- depth)))))))

(defun skip-rest (session text start)
  "Read on in SESSION until the forms end that begin in TEXT, read so far, at START."
  (flet ((next-outline (text)
           (or (values (read-outline session text))
               (error 'end-of-file :stream (session-input session)))))
    (handler-case (skip-forms (text-stream text start #'next-outline))
      (end-of-file ()))))

(defun skip-after (condition session text start)
  "Call SKIP-REST if CONDITION says that what begins in TEXT at START cannot be read."
  (typecase condition
    (line-too-long
     (skip-rest session (format nil "~A~%~A" text (line-outline condition)) start))
    ((or bad-line storage-condition end-of-file) nil)
    (error (note-trouble-line (session-account session) (lines-typed (session-input session)))
           (skip-rest session text start))))

(defmacro skipping-rest ((session text start) &body body)
  "Run BODY, which reads what begins in TEXT at START. If it cannot, skip the rest."
  `(handler-bind ((error (lambda (condition) (skip-after condition ,session ,text ,start))))
     ,@body))

;;; A form of Lisp that spans lines is read while its lines come.

;;; Each character is read once or twice, however many lines there are. What is evaluated during
;;; reading, after #., is evaluated as often.

(defun read-growing (session text start)
  "Return the values of READ-FORM for a form that continues after TEXT."
  (flet ((read-more (text)
           (or (read-input session +continuation-prompt+ text)
               (reject-line "The form is not complete: ~A" (one-line text)))))
    (let* ((stream (text-stream text start #'read-more))
           (form (skipping-rest (session (grown-text stream) start)
                   (read-preserving-whitespace stream))))
      (values form
              (min (grown-position stream) (length (grown-text stream)))
              (grown-text stream)))))

(defun left-out-p (text start)
  "True if from START on TEXT has only a form that Lisp skips, as after #-sbcl."
  (let ((start (position-if-not #'blank-p text :start start)))
    (and start
         (< (1+ start) (length text))
         (char= #\# (char text start))
         (find (char text (1+ start)) "+-")
         ;; Then the reader returns what is appended to it.
         (eql 0 (ignore-errors (read-from-string (format nil "~A~%0" text) t nil :start start))))))

(defun read-form (session text &optional (start 0))
  "Return the form in TEXT at START, reading on in SESSION while it is incomplete; where it ends;
and TEXT with what was read. If Lisp skips what is there, the form is one without values. An
unreadable form is skipped to its end."
  (handler-case (skipping-rest (session text start)
                  (read-from-string text t nil :start start))
    (end-of-file ()
      (if (left-out-p text start)
          (values '(values) (length text) text)
          (read-growing session text start)))
    (:no-error (form end) (values form end text))))

;;;; Comments between #| and |#

;;; Comments in a form are read by Lisp. Around forms, and before, in and after other lines, they
;;; are removed here, and lines are read until they end.

(defun block-at-p (text position)
  "True if a comment that continues until |# begins in TEXT at POSITION."
  (let ((end (+ 2 position)))
    (and (<= end (length text))
         (string= "#|" text :start2 position :end2 end))))

(defun block-end (text start depth)
  "Return where the DEPTH nested comments end in which TEXT is at START; if they continue, NIL and
their depth at the end of TEXT."
  (loop with i = start
        for end = (+ 2 i)
        while (<= end (length text))
        do (cond ((block-at-p text i) (incf depth) (setf i end))
                 ((string/= "|#" text :start2 i :end2 end) (incf i))
                 ((zerop (decf depth)) (return end))
                 (t (setf i end)))
        finally (return (values nil depth))))

(defun rest-after-block (session text start trouble)
  "Return the text after the comment that begins in TEXT at START, reading on in SESSION until it
ends; and TROUBLE for that text: NIL, or the condition that says that it is only the outline of a
line that is too long. Signals BAD-LINE if the comment does not end."
  (let ((line text) (position (+ 2 start)) (depth 1))
    (loop
      (multiple-value-bind (end deeper) (block-end line position depth)
        (when end (return (values (subseq line end) trouble)))
        (setf depth deeper
              position 0
              (values line trouble) (read-outline session text))
        (unless line
          (reject-line "The comment that begins with #| does not end; close it with |#."))))))

(defun block-start (text)
  "Return where the first such comment begins in TEXT, which is not Lisp, outside of quotes and
other comments; NIL if there is none."
  (loop with quoted = nil
        for char across text
        for i from 0
        do (cond ((char= #\" char) (setf quoted (not quoted)))
                 (quoted)
                 ((block-at-p text i) (return i))
                 ((comment-at-p text i) (return nil)))))

(defun without-blocks (session text &optional trouble)
  "Return TEXT, a line of SESSION as typed, without such comments, unless it begins with a form; and
what TROUBLE is for TEXT, as in REST-AFTER-BLOCK. What is in comments may be too long."
  (let ((start (unless (or (comment-p text) (lisp-p text)) (block-start text))))
    (if start
        (let ((before (subseq text 0 start)))
          (multiple-value-bind (rest later) (rest-after-block session text start trouble)
            (without-blocks session (format nil "~A ~A" before rest)
                            (or (unless (comment-p rest) later)
                                (unless (comment-p before) trouble)))))
        (values text trouble))))

(defun check-outline (session text trouble)
  "Signal TROUBLE, unless it is NIL, or TEXT, an outline of a line of SESSION, is a comment. Skip a
form that begins there."
  (when (and trouble (not (comment-p text)))
    (when (lisp-p text) (skip-rest session text 0))
    (error trouble)))

(defun forms-after-block (session text start)
  "Return the text after the comment that begins in TEXT, of forms, at START, reading on in SESSION
until it ends. Signals LINE-TOO-LONG if such a line has more than comments."
  (multiple-value-bind (rest trouble) (rest-after-block session text start nil)
    (cond (trouble (multiple-value-call #'check-outline
                     session (without-blocks session rest trouble))
                   "")
          (t rest))))

(defun skip-comments (session text position)
  "Return TEXT, of forms, or the part of it after comments, and where it continues from POSITION
after blanks and comments; read on in SESSION until these end."
  (loop
    (let ((start (or (position-if-not #'blank-p text :start position) (length text))))
      (unless (block-at-p text start)
        (return (values text start)))
      ;; Not at 0: there is something before it.
      (setf text (format nil " ~A" (forms-after-block session text start))
            position 1))))
