;;;; reading.lisp -- reading a line, and its first look: what kind of line it is.

(in-package :ars-magna.cli)

;;; Somebody may paste what a page shows, prompts and all. They are taken off. What stands after one
;;; may also be a message of the robot's, such as "robot-turn: Robot turned 1.00": its first word
;;; ends with a colon. Other answers cannot be told from lines.

(defparameter *labels* '("Robot>" "Break>") "What prompts look like.")

(defun message-p (text)
  "True if TEXT, what stands after a prompt, is a message."
  (let* ((start (position-if-not #'blank-p text))
         (end (and start (position-if #'blank-p text :start start))))
    (and end (< start (1- end)) (char= #\: (char text (1- end))))))

(defun without-label (text)
  "Return TEXT, a line as typed, without the prompts that it begins with; nothing of a message."
  (let* ((start (or (position-if-not #'blank-p text) 0))
         (label (find-if (lambda (label) (starts-with-subseq label (subseq text start))) *labels*))
         (rest (and label (subseq text (+ start (length label))))))
    (cond ((null rest) text)
          ((message-p rest) "")
          (t (without-label (string-left-trim " " rest))))))

(define-constant +going-on+ "     > " :test #'string=
  :documentation "The prompt for what goes on from the line before.")

(defun line-pasted (text before)
  "Return TEXT, a line as typed, without a prompt that was pasted with it. BEFORE is true if it goes
on from another."
  (cond ((null before) (without-label text))
        ((starts-with-subseq +going-on+ text) (subseq text (length +going-on+)))
        (t text)))

;; What knows what can be typed where sets it.
(defvar *completion* (constantly nil)
  "A function of a session, a text and a place in it: what *COMPLETER* returns of the text.")

(defun read-typed (session before)
  "Return the next line that is typed in SESSION, or NIL at the end. Whoever edits it can complete
it, and have it again; if BEFORE is a text, together with that, which it goes on from."
  (let* ((*completer* (lambda (text point) (funcall *completion* session text point)))
         (line (progn
                 ;; What goes on over lines is kept whole.
                 (unless before (keep-lines (session-input session)))
                 (read-line (session-input session) nil)))
         (line (and line (line-pasted line before))))
    (when line (remember-line (session-input session) line before))
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
                 (answered console))))
      (clrhash (session-told session))
      (note-read (session-account session))
      line)))

(defun comment-p (text)
  "True if there is nothing to do in TEXT: it is blank, or a comment after ; or #, but not after #|,
which may end in it."
  (let ((start (position-if-not #'blank-p text)))
    (or (null start)
        (and (find (char text start) ";#")
             (not (block-at-p text start))))))

;; As reading 205 says.
(defun lisp-p (text)
  "True if TEXT is Lisp: it begins with a parenthesis, or with Nisp's mark of a slot."
  (let ((start (position-if-not #'blank-p text)))
    (or (find (char text start) "()")
        (eql start (search "!>" text)))))

(defun split-line (text)
  "Return the first word of TEXT and what follows it."
  (let* ((start (position-if-not #'blank-p text))
         (end (token-end text start)))
    (values (subseq text start end) (subseq text end))))
