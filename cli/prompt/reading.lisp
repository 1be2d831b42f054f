;;;; reading.lisp -- reading a line, and its first look: what kind of line it is.

(in-package :ars-magna.cli)

(defun read-input (session prompt)
  "Return the next line of SESSION, or NIL at the end. Show PROMPT unless it is a batch, and what
comes of earlier lines if the session waits for that."
  (let ((console (session-console session)))
    (unless (or (session-batch-p session)
                (and (unanswered-p console) (string= prompt (console-prompt console))))
      (with-lock ((session-lock session)) (show-prompt console prompt)))
    (catch-up session)
    (let* ((given (pop (session-lines session)))
           (line (or given
                     (and (not (console-trouble console))
                          (read-line (session-input session) nil)))))
      (with-lock ((session-lock session))
        (cond ((session-batch-p session))
              ((null line) (terpri console))
              ((or given (session-echo-p session)) (format console "~A~%" (visible line))))
        (answered console))
      (note-read (session-account session))
      line)))

(defun comment-p (text)
  "True if there is nothing to do in TEXT: it is blank, or a comment after ; or #."
  (let ((start (position-if-not #'blank-p text)))
    (or (null start) (find (char text start) ";#"))))

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
