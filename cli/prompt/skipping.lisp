;;;; skipping.lisp -- the lines of a form that cannot be read are passed over up to its end.

(in-package :ars-magna.cli)

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

(defun next-outline (session text)
  "Return the next line of SESSION, which goes on from TEXT, or its outline. At the end of what is
typed, signal END-OF-FILE."
  (or (values (read-outline session text))
      (error 'end-of-file :stream (session-input session))))

(defun skip-forms (stream)
  "Read STREAM, a growing text, until no form is open at the end of a line."
  (loop with depth = 0
        until (and (zerop depth) (grown-out-p stream))
        do (case (skip-item stream)
             (#\( (incf depth))
             (#\) (setf depth (max 0 (1- depth)))))))

(defun skip-rest (session text start)
  "Read on in SESSION, of which TEXT has been read, with forms from START on, until these end."
  (handler-case (skip-forms (text-stream text start (lambda (text) (next-outline session text))))
    (end-of-file ())))

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
