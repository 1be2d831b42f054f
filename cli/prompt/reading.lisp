;;;; reading.lisp -- reading a line.

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
