;;;; kinds-of-lines.lisp -- whether a line is a comment or Lisp, its words, and what was pasted.

(in-package :ars-magna.cli)

(defun comment-at-p (text position)
  "True if a comment begins in TEXT at POSITION: with ;, or with # between blanks or line ends."
  (flet ((blank-at-p (position)
           (or (not (array-in-bounds-p text position))
               (blank-character-p (char text position)))))
    (case (char text position)
      (#\; t)
      (#\# (and (blank-at-p (1- position)) (blank-at-p (1+ position)))))))

(defun nothing-to-run-p (text)
  "True if TEXT has nothing to run: it is blank, or a comment that begins with ; or a separate #."
  (let ((start (position-if-not #'blank-character-p text)))
    (or (null start) (comment-at-p text start))))

;; Comments #| ... |#, which may end in the line, are handled elsewhere; #FOO is a word like others.
(defun sharp-form-p (text start)
  "True if TEXT has, at START, a Lisp form that begins with #: #'car, #(1 2), #xFF, #p\"f\" ..."
  (flet ((char-at (position) (and (< position (length text)) (char text position))))
    (let ((first (char-at (1+ start))) (second (char-at (+ 2 start))))
      (and (eql #\# (char-at start))
           first
           (not (find first "|!"))
           (not (blank-character-p first))
           (or (not (alpha-char-p first))
               (find second "(\"")
               (and (char-equal #\b first) (find second "01+-"))
               (and (char-equal #\o first) (find second "01234567+-"))
               (and (char-equal #\x first) (find second "0123456789+-abcdefABCDEF")))
           t))))

;; As reading 205 says.
(defun lisp-p (text)
  "True if TEXT is Lisp: it begins with a parenthesis, a form such as #'car, or Nisp's !>."
  (let ((start (position-if-not #'blank-character-p text)))
    (or (find (char text start) "()")
        (sharp-form-p text start)
        (eql start (search "!>" text)))))

;;; The words of a line.

(defun skip-blanks (text start)
  "Return the start of the first word in TEXT from START on; TEXT's length if there is no word."
  (let ((position (position-if-not #'blank-character-p text :start start)))
    (if (and position (not (comment-at-p text position)))
        position
        (length text))))

(defun word-end (text start)
  "Return the end of the word in TEXT that begins at START: the next blank or semicolon."
  (or (position-if (lambda (char) (or (blank-character-p char) (char= #\; char))) text :start start)
      (length text)))

(defun token-end (text start)
  "Return the end of the token in TEXT that begins at START. A token in double quotes may contain
blanks; without a second quote it extends to the end of TEXT."
  (if (char= (char text start) #\")
      (let ((quote (position #\" text :start (1+ start))))
        (if quote (1+ quote) (length text)))
      (word-end text start)))

(define-constant +all-robots+ "all:" :test #'string=
  :documentation "The first word of a line for all robots. No blank is needed after it.")

(defun for-all-robots-p (text)
  "True if TEXT, which begins without blanks, is a line for all robots."
  (and (<= (length +all-robots+) (length text))
       (string-equal +all-robots+ text :end2 (length +all-robots+))))

(defun first-word-end (text start)
  "Return the end of the word in TEXT that begins at START, the first word of a line."
  (if (for-all-robots-p (subseq text start))
      (+ start (length +all-robots+))
      (token-end text start)))

(defun split-first-word (text)
  "Return the first word of TEXT, and the rest of TEXT."
  (let* ((start (position-if-not #'blank-character-p text))
         (end (first-word-end text start)))
    (values (subseq text start end) (subseq text end))))

;;;; What is pasted

;;; A user may paste text from a page or window, prompts included. The prompts are removed. What
;;; follows one may also be a message of the robot's, such as "robot-turn: Robot turned 1.00": its
;;; first word ends with a colon. A warning or an error is known by its beginning. Other answers are
;;; lines without a prompt among lines with prompts.

(defparameter *prompt-labels* '("Robot>" "Break>") "The prompts that pasted lines may begin with.")

(defun message-p (text)
  (let* ((start (position-if-not #'blank-character-p text))
         (end (and start (position-if #'blank-character-p text :start start))))
    (and end (< start (1- end)) (char= #\: (char text (1- end)))
         (not (for-all-robots-p (subseq text start))))))

(defun warning-p (text)
  "True if TEXT, a line, is a warning or an error that the prompt has shown."
  (some (lambda (beginning) (starts-with-subseq beginning text))
        '("*WARNING* -> " "*ERROR* -> " "*BREAK* -> ")))

(defun text-after-prompt (text)
  "Return the rest of TEXT, a line, after its prompt; NIL if TEXT does not begin with a prompt."
  (let* ((text (subseq text (or (position-if-not #'blank-character-p text) 0)))
         (label (find-if (lambda (label) (starts-with-subseq label text)) *prompt-labels*)))
    (and label (subseq text (length label)))))

(defun text-without-prompts (text)
  "Return TEXT, a line, without the prompts at its beginning. If TEXT is a message, a warning or an
error, return an empty string."
  (let ((rest (text-after-prompt text)))
    (cond ((warning-p text) "")
          ((null rest) text)
          ((message-p rest) "")
          (t (text-without-prompts (string-left-trim " " rest))))))

(define-constant +continuation-prompt+ "     > " :test #'string=
  :documentation "The prompt for lines that continue the line before.")

(defun continuation-prompt-p (text)
  (starts-with-subseq +continuation-prompt+ text))

(defun without-pasted-prompt (text before)
  "Return the typed line TEXT without a pasted prompt. BEFORE is true if TEXT continues a line."
  (cond ((null before) (text-without-prompts text))
        ((continuation-prompt-p text) (subseq text (length +continuation-prompt+)))
        (t text)))

;;; If several lines were pasted, prompts tell which of them were typed.

(defun typed-part-of-line (line)
  "Return the part of LINE, a pasted line, that was typed after a prompt; NIL if there is none."
  (cond ((continuation-prompt-p line) (without-pasted-prompt line t))
        ((text-after-prompt line) (let ((text (text-without-prompts line)))
                                   (and (string/= "" text) text)))))

(defun read-past-form (text more)
  "If TEXT begins with a Lisp form, read that form and discard it. MORE, a function of the text read
so far, returns the next line of the form, or signals an error at the end."
  (when (and (not (nothing-to-run-p text)) (lisp-p text))
    (handler-case (let ((*read-suppress* t))
                    (read-preserving-whitespace (make-growing-text-stream text 0 more)))
      (error () nil))))

(defun split-after-form (text lines)
  "Divide LINES, pasted below TEXT. Return the lines that complete the form begun in TEXT, without
prompts, and the lines after the form. A line typed at a prompt does not belong to the form."
  (let ((taken '()))
    (flet ((next-of-form (text)
             (declare (ignore text))
             (loop for line = (first lines)
                   when (or (null lines) (and (text-after-prompt line) (typed-part-of-line line)))
                     do (error "No pasted line is left to complete the form.")
                   do (pop lines)
                   unless (text-after-prompt line)
                     return (first (push (or (typed-part-of-line line) line) taken)))))
      (read-past-form text #'next-of-form)
      (values (nreverse taken) lines))))

(defun lines-typed-at-prompts (lines)
  "Return the typed lines among the pasted LINES, the first of which has a prompt. Lines below an
incomplete form count as the rest of the form."
  (loop while lines
        for line = (pop lines)
        for typed = (typed-part-of-line line)
        when typed
          collect typed
          and when (text-after-prompt line)
                append (multiple-value-bind (rest below) (split-after-form typed lines)
                         (setf lines below)
                         rest)))

(defun typed-lines-of-paste (lines)
  "Return those of the pasted LINES that were typed: lines before the first prompt, lines with
prompts except messages, and lines that complete a form. If no line has a prompt, return LINES."
  (let ((start (position-if #'text-after-prompt lines)))
    (if start
        (append (subseq lines 0 start) (lines-typed-at-prompts (nthcdr start lines)))
        lines)))

(defun count-output-lines (text)
  "Return how many lines after the last prompt in the pasted TEXT are taken for output."
  (let* ((lines (lines-in text))
         (start (position-if #'text-after-prompt lines :from-end t))
         (last (and start (nthcdr start lines)))
         (typed (make-hash-table :test 'eq)))
    (dolist (line (lines-typed-at-prompts last)) (setf (gethash line typed) t))
    (count-if-not (lambda (line)
                    (or (gethash line typed)
                        (text-after-prompt line) (continuation-prompt-p line)
                        (nothing-to-run-p line)))
                  last)))

(defun without-pasted-output (text)
  (format nil "~{~A~^~%~}" (typed-lines-of-paste (lines-in text))))
