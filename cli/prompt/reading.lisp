;;;; reading.lisp -- reading lines, and forms that go on over lines; past those that cannot be read.

(in-package :ars-magna.cli)

(defun without-program (session text)
  "Return TEXT, a line as typed, but an empty one if it says, as the first line of SESSION, what
program runs a script."
  (if (and (not (shiftf (reader-typed-p (session-reader session)) t))
           (starts-with-subseq "#!" text))
      ""
      text))

(defun answer-p (session line)
  "True if LINE, of SESSION, answers a program that has broken: it makes no sense later."
  (and (breaks-awaiting (session-break-state session))
       (not (comment-p line))
       (not (lisp-p line))))

(defun read-typed (session before)
  "Return the next line that is typed in SESSION, or NIL at the end. Whoever edits it can complete
it, and have it again; if BEFORE is a text, together with that, which it goes on from."
  (let* ((line (progn
                 ;; What goes on over lines is kept whole.
                 (unless before (keep-lines (session-input session)))
                 (let ((*program-reads* nil)) (read-line (session-input session) nil))))
         (line (and line (line-pasted (without-program session line) before))))
    (unless (or (null line) (and (null before) (answer-p session line)))
      (remember-line (session-input session) line before))
    line))

(defun read-input (session prompt &optional before)
  "Return the next line of SESSION, or NIL at the end; it goes on from the text BEFORE, if there is
one. Show PROMPT unless it is a batch, and what comes of earlier lines if the session waits for
that."
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
        (count-anew (session-told session))
        (begin-flood-anew (session-flood session)))
      line)))

;;; Forms that cannot be read.

;;; Where the reader gives up amid a form, what stands below is the rest of it, and no command. Only
;;; parentheses, quotes and comments say here how far it goes on.

(defun skip-to (char stream)
  "Read STREAM up to and with the next CHAR that no backslash is before."
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
  "Read STREAM past a character, or all that is quoted or a comment there. Return the character."
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
  "Return the next line of SESSION, which goes on from TEXT, or the outline of one that is too long
and the condition that says so; NIL at the end."
  (handler-case (read-input session +going-on+ text)
    (line-too-long (condition) (values (line-outline condition) condition))))

(defun skip-forms (stream)
  "Read STREAM, a growing text, until no form is open at the end of a line."
  (loop with depth = 0
        until (and (zerop depth) (grown-out-p stream))
        do (case (skip-item stream)
             (#\( (incf depth))
             (#\) (setf depth (max 0 (1- depth)))))))

(defun skip-rest (session text start)
  "Read on in SESSION, of which TEXT has been read, with forms from START on, until these end."
  (flet ((next-outline (text)
           (or (values (read-outline session text))
               (error 'end-of-file :stream (session-input session)))))
    (handler-case (skip-forms (text-stream text start #'next-outline))
      (end-of-file ()))))

(defun skip-after (condition session text start)
  "Do as SKIP-REST does if CONDITION says that what begins in TEXT at START cannot be read."
  (typecase condition
    (line-too-long
     (skip-rest session (format nil "~A~%~A" text (line-outline condition)) start))
    ((or bad-line storage-condition end-of-file) nil)
    (error (note-trouble-line (session-account session) (lines-typed (session-input session)))
           (skip-rest session text start))))

(defmacro skipping-rest ((session text start) &body body)
  "Run BODY, which reads what begins in TEXT at START. If it cannot, its rest is passed over."
  `(handler-bind ((error (lambda (condition) (skip-after condition ,session ,text ,start))))
     ,@body))

;;; A form of Lisp that goes on over lines is read while its lines come.

;;; Each character is read once or twice, however many lines there are, and what is evaluated while
;;; it is read, after #., is so as often.

(defun read-growing (session text start)
  "Return what READ-FORM does, of a form that goes on after TEXT."
  (flet ((read-more (text)
           (or (read-input session +going-on+ text)
               (reject-line "The form is not complete: ~A" (one-line text)))))
    (let* ((stream (text-stream text start #'read-more))
           (form (skipping-rest (session (grown-text stream) start)
                   (read-preserving-whitespace stream))))
      (values form
              (min (grown-position stream) (length (grown-text stream)))
              (grown-text stream)))))

(defun left-out-p (text start)
  "True if TEXT has from START on no form but one that Lisp leaves out, as after #-sbcl."
  (let ((start (position-if-not #'blank-p text :start start)))
    (and start
         (< (1+ start) (length text))
         (char= #\# (char text start))
         (find (char text (1+ start)) "+-")
         ;; Then what is put behind it is what is read.
         (eql 0 (ignore-errors (read-from-string (format nil "~A~%0" text) t nil :start start))))))

(defun read-form (session text &optional (start 0))
  "Return the form in TEXT at START, reading on in SESSION while it is incomplete; where it ends;
and TEXT with what was read. Where Lisp leaves out what is there, the form is one without values.
One that cannot be read is read over to its end."
  (handler-case (skipping-rest (session text start)
                  (read-from-string text t nil :start start))
    (end-of-file ()
      (if (left-out-p text start)
          (values '(values) (length text) text)
          (read-growing session text start)))
    (:no-error (form end) (values form end text))))
