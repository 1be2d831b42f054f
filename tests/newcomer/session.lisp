;;;; session.lisp -- scripted sessions: what is typed, what to wait for, which screens to compare.

(in-package :ars-magna.tests)

;;; A session is a file; each line is a word and a text. README.md here lists the words. It is
;;; played with a new home directory in a terminal that begins with a shell's $.

(defun session-file (name)
  (project-file (format nil "tests/newcomer/sessions/~A.txt" name)))

(defun session-names ()
  "Return the names of the sessions, in alphabetical order."
  (texts-in "sessions"))

(defun session-steps (name)
  "Return the steps of the session NAME, each a list of a word and of the text that follows."
  (loop for line in (file-lines (session-file name))
        for end = (or (position #\Space line) (length line))
        unless (or (string= line "") (begins-with-p "#" line))
          collect (list (subseq line 0 end) (subseq line (min (length line) (1+ end))))))

;;; The words. Each is a function of a terminal and of the text after it.

(defparameter *program* "./cli/ars-magna" "What begins a session at Robot>.")

(defun last-start (blocks)
  "Return the last line that BLOCKS, of sessions, type at a shell to begin one at Robot>."
  (loop with start = *program*
        for block in blocks
        do (loop for (prompt line) in (session-turns block)
                 when (and (string= prompt "$") (begins-with-p *program* line))
                   do (setf start line))
        finally (return start)))

(defun play-page (terminal text)
  "Play the sessions below the heading; TEXT has the page and the heading. If a session begins at
Robot> and the last one has quit, start the prompt again first."
  (loop for (block . before) on (reverse (remove-if-not #'session-block-p (blocks-below text)))
        collect (list block (last-start (reverse before))) into blocks
        finally (loop for (block start) in (reverse blocks)
                      do (play-block terminal block start))))

(defun play-block (terminal block start)
  "Play BLOCK, a session, at the prompt that stands; START begins one at Robot>."
  (let ((turns (session-turns block)))
    (when (and (string= "Robot>" (first (first turns)))
               (string= "$" (await-prompt terminal "$" "Robot>" "Break>")))
      (type-line terminal start))
    (dolist (turn turns) (play-turn terminal turn))))

(defun blocks-below (text)
  "Return the blocks that TEXT asks for: the name of a page, and one of its headings or nothing."
  (let* ((end (or (position #\Space text) (length text)))
         (heading (string-trim " " (subseq text end)))
         (blocks (page-blocks (subseq text 0 end))))
    (or (if (string= heading "")
            blocks
            (remove heading blocks :key #'page-block-heading :test-not #'equal))
        (error "There is nothing to type in ~A" text))))

(defun play-lisp (terminal text)
  "Type the blocks of Lisp that stand below the heading, both in TEXT, at Robot>."
  (dolist (block (blocks-below text))
    (when (equal "lisp" (page-block-kind block))
      (dolist (form (forms-in (page-block-lines block))) (type-form terminal form)))))

(defun definitions-below (text)
  "Return the lines of the Lisp blocks that TEXT selects, as BLOCKS-BELOW does, without blocks that
show values."
  (loop for block in (blocks-below text)
        for lines = (page-block-lines block)
        when (and (equal "lisp" (page-block-kind block))
                  (notany (lambda (line) (begins-with-p "; =>" line)) lines))
          append (append lines '(""))))

(defun play-file (terminal text)
  "Write at the end of a file in the home directory what DEFINITIONS-BELOW returns. TEXT is the name
of the file, then what that takes."
  (let ((end (position #\Space text)))
    (with-open-file (out (uiop:strcat (terminal-home terminal) (subseq text 0 end))
                         :direction :output :if-exists :append :if-does-not-exist :create)
      (format out "~{~A~%~}" (definitions-below (subseq text (1+ end)))))))

(defun play-resize (terminal text)
  (apply #'resize-terminal terminal (mapcar #'parse-integer (uiop:split-string text))))

(defun play-paste (terminal text)
  "Paste TEXT, in which \\n stands for a newline."
  (tell-terminal terminal "set-buffer -- ~A"
                 (quoted-for-tmux (uiop:frob-substrings text '("\\n") (string #\Return))))
  (tell-terminal terminal "paste-buffer -p -r"))

(defparameter *session-words*
  '(("type" . type-line) ("keys" . type-text) ("press" . press-key)
    ("wait" . await-text) ("prompt" . await-prompt) ("resize" . play-resize) ("paste" . play-paste)
    ("page" . play-page) ("lisp" . play-lisp) ("file" . play-file))
  "The words of sessions except SCREEN, with the functions that carry them out.")

;;; Playing.

(defun play-step (terminal word text)
  "Carry out a step. Return an error message, a string, or NIL."
  (if (string= word "screen")
      (screen-trouble text terminal)
      (handler-case
          (progn (funcall (or (cdr (assoc word *session-words* :test #'string=))
                              (error "~A is no word of sessions" word))
                          terminal text)
                 nil)
        (newcomer-stuck (condition) (princ-to-string condition)))))

(defun play-steps (terminal steps)
  "Do STEPS. Return what came of each, a list of strings and NILs; nothing comes after what waits in
vain."
  (loop for (word text) in steps
        for trouble = (play-step terminal word text)
        collect (and trouble (format nil "~A ~A:~%~A" word text trouble))
        until (and trouble (string/= word "screen"))))

(defun call-with-home (function name)
  "Call FUNCTION with the name of a new directory, called after NAME and removed afterwards."
  (let* ((home (format nil "~Aars-~A-~A/" (uiop:native-namestring (uiop:temporary-directory))
                       name (base:process-id)))
         (path (uiop:parse-native-namestring home)))
    (ensure-directories-exist path)
    (unwind-protect (funcall function home)
      (uiop:delete-directory-tree path :validate t))))

(defun play-session (name)
  "Play the session NAME in a terminal. Return what came of its steps, as PLAY-STEPS does."
  (call-with-home
   (lambda (home)
     (call-with-terminal (lambda (terminal) (play-steps terminal (session-steps name)))
                         home))
   name))

(defun play-sessions (names)
  "Play the sessions NAMES, all at once. Return a list of lists of a name and what came of its
steps."
  (let* ((results (mapcar #'list names))
         (threads (loop for result in results
                        collect (start-session result))))
    (mapc #'base:join-thread threads)
    results))

(defun start-session (result)
  "Do as NOTE-SESSION does in a new thread; return it."
  (base:start-thread (lambda () (note-session result)) "newcomer's session"))

(defun note-session (result)
  "Play the session that RESULT, a list, begins with, and put what came of it after that."
  (setf (rest result)
        (handler-case (play-session (first result))
          (error (condition) (list (princ-to-string condition))))))

(defun make-core ()
  "Build the core of ./cli/ars-magna if it is missing, so that no session waits for it."
  (base:run-command (base:native-name (project-file "cli/ars-magna")) '("--batch")))

(defun record-sessions (names)
  "Write the screens of the sessions NAMES, or of all, into their files. True if none waits in
vain."
  (make-core)
  (let* ((*recording-p* t)
         (troubles (loop for name in (or names (session-names))
                         append (remove nil (play-session name)))))
    (format t "~{~A~%~}" troubles)
    (null troubles)))
