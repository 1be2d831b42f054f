;;;; reading.lisp -- reading a line, and its first look: what kind of line it is.

(in-package :ars-magna.cli)

;; What knows what can be typed where sets it.
(defvar *completion* (constantly nil)
  "A function of a session, a text and a place in it: what *COMPLETER* returns of the text.")

(defun without-program (session text)
  "Return TEXT, a line as typed, but an empty one if it says, as the first line of SESSION, what
program runs a script."
  (if (and (not (shiftf (session-typed-p session) t))
           (starts-with-subseq "#!" text))
      ""
      text))

(defun answer-p (session line)
  "True if LINE, of SESSION, answers a program that has broken: it makes no sense later."
  (and (or (session-breaks session) (session-debugging session))
       (not (comment-p line))
       (not (lisp-p line))))

(defun read-typed (session before)
  "Return the next line that is typed in SESSION, or NIL at the end. Whoever edits it can complete
it, and have it again; if BEFORE is a text, together with that, which it goes on from."
  (let* ((*completer* (lambda (text point) (funcall *completion* session text point)))
         (line (progn
                 ;; What goes on over lines is kept whole.
                 (unless before (keep-lines (session-input session)))
                 (let ((*program-reads-p* nil)) (read-line (session-input session) nil))))
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
    (let* ((given (pop (session-lines session)))
           (line (or given
                     (and (not (console-trouble console))
                          (read-typed session before)))))
      (with-lock ((session-lock session))
        (cond ((and line (not (session-batch-p session)) (or given (session-echo-p session)))
               (show-answer console (visible line)))
              (t (unless (or line (session-batch-p session)) (fresh-line console))
                 (answered console)))
        (count-anew (session-told session))
        (count-others-anew session))
      (note-read (session-account session))
      line)))

(defun comment-p (text)
  "True if there is nothing to do in TEXT: it is blank, or a comment after ; or a # that stands
alone."
  (let ((start (position-if-not #'blank-p text)))
    (or (null start) (comment-at-p text start))))

;; #|, which may end in the line, is for others, and #FOO is a word like others.
(defun sharp-form-p (text start)
  "True if a form of Lisp begins in TEXT at START with #, such as #'car, #(1 2), #xFF or #p\"f\"."
  (flet ((char-at (position) (and (< position (length text)) (char text position))))
    (let ((first (char-at (1+ start))) (second (char-at (+ 2 start))))
      (and (eql #\# (char-at start))
           first
           (not (find first "|!"))
           (not (blank-p first))
           (or (not (alpha-char-p first))
               (find second "(\"")
               (and (char-equal #\b first) (find second "01+-"))
               (and (char-equal #\o first) (find second "01234567+-"))
               (and (char-equal #\x first) (find second "0123456789+-abcdefABCDEF")))
           t))))

;; As reading 205 says.
(defun lisp-p (text)
  "True if TEXT is Lisp: it begins with a parenthesis, with # and what follows that in a form, or
with Nisp's mark of a slot."
  (let ((start (position-if-not #'blank-p text)))
    (or (find (char text start) "()")
        (sharp-form-p text start)
        (eql start (search "!>" text)))))

(defun split-line (text)
  "Return the first word of TEXT and what follows it."
  (let* ((start (position-if-not #'blank-p text))
         (end (token-end text start)))
    (values (subseq text start end) (subseq text end))))
