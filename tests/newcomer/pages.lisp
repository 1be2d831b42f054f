;;;; pages.lisp -- types what a page of Markdown shows, and checks the answers shown.

(in-package :ars-magna.tests)

;;; A block is the text between ``` and ```, or lines indented by four. A block that begins with a
;;; prompt shows a session: the text after a prompt is typed, the lines below are the answer. An
;;; answer may be left out. In an answer ... stands for any lines, or any part of a line. If the
;;; first word after a prompt ends with a colon it is a message of the robot, and is not typed.

(defparameter *prompts* '("$" "Robot>" "Break>" "Step>" "*") "The prompts that pages show.")

(defstruct (page-block (:copier nil))
  "A block of a page: its LINES, the HEADING above it, and its KIND, as after ```, or NIL."
  heading kind lines)

(defun heading-in (line)
  "Return the heading that LINE is, or NIL."
  (let ((start (position #\# line :test #'char/=)))
    (and start (plusp start) (char= #\Space (char line start))
         (string-trim " " (subseq line start)))))

(defun indented-lines (lines)
  "Return the text that LINES begin with, indented by four, a list, and the lines after it."
  (let ((end (or (position-if-not (lambda (line) (or (string= line "") (begins-with-p "    " line)))
                                  lines)
                 (length lines))))
    (loop while (and (plusp end) (string= "" (nth (1- end) lines)))
          do (decf end))
    (values (mapcar (lambda (line) (subseq line (min 4 (length line)))) (subseq lines 0 end))
            (nthcdr end lines))))

(defun fenced-lines (lines)
  "Return those of LINES before the one that is ```, and those after."
  (let ((end (or (position "```" lines :test #'string=) (length lines))))
    (values (subseq lines 0 end) (nthcdr (1+ end) lines))))

(defun page-blocks (page)
  "Return the blocks of the file PAGE, in order."
  (let ((lines (file-lines (project-file page))) (heading nil) (before "") (blocks '()))
    (flet ((take (kind function start)
             (multiple-value-bind (inside rest) (funcall function start)
               (push (make-page-block :heading heading :kind kind :lines inside) blocks)
               (setf lines rest))))
      (loop while lines
            do (let ((line (first lines)))
                 (cond ((begins-with-p "```" line)
                        (take (subseq line 3) #'fenced-lines (rest lines)))
                       ((and (string= before "") (begins-with-p "    " line))
                        (take nil #'indented-lines lines))
                       (t (setf heading (or (heading-in line) heading)
                                lines (rest lines))))
                 (setf before line))))
    (nreverse blocks)))

;;; Sessions.

(defun prompt-of (line)
  "Return the prompt that LINE begins with, or NIL, and what follows it."
  (let* ((end (or (position #\Space line) (length line)))
         (prompt (find (subseq line 0 end) *prompts* :test #'string=)))
    (values prompt (if prompt (string-trim " " (subseq line end)) line))))

(defun message-p (text)
  "True if the first word of TEXT ends with a colon, as in robot-turn: Robot turned 1.00."
  (let ((end (or (position #\Space text) (length text))))
    (and (plusp end) (char= #\: (char text (1- end))))))

(defun what-is-typed (line)
  "Return the text typed in LINE of a session, or NIL if LINE is an answer."
  (multiple-value-bind (prompt text) (prompt-of line)
    (and prompt (string/= text "") (not (message-p text)) text)))

(defun answer-in (line)
  "Return LINE of an answer without the prompt before it."
  (nth-value 1 (prompt-of line)))

(defun session-block-p (block)
  (and (page-block-lines block) (prompt-of (first (page-block-lines block))) t))

(defun session-turns (block)
  "Return what happens in BLOCK: a list of lists of a prompt, a line that is typed at it, and the
lines that answer it."
  (loop with turns = '()
        for line in (page-block-lines block)
        do (cond ((what-is-typed line)
                  (push (list (prompt-of line) (what-is-typed line)) turns))
                 ((string= "" (answer-in line)))
                 (turns (setf (first turns) (append (first turns) (list (answer-in line))))))
        finally (return (nreverse turns))))

;;; Comparing.

(defun like-p (pattern text)
  "True if TEXT is PATTERN, where ... stands for anything."
  (let ((dots (search "..." pattern)))
    (if (null dots)
        (string= pattern text)
        (and (begins-with-p (subseq pattern 0 dots) text)
             (loop with rest = (subseq pattern (+ dots 3))
                   for start from dots to (length text)
                   thereis (like-p rest (subseq text start)))))))

(defun lines-like-p (patterns lines)
  "True if LINES begin with matches of PATTERNS; the pattern ... matches any lines."
  (cond ((null patterns) t)
        ((string= "..." (first patterns))
         (loop for rest on lines
                 thereis (lines-like-p (rest patterns) rest)
               finally (return (null (rest patterns)))))
        (t (and lines
                (like-p (first patterns) (first lines))
                (lines-like-p (rest patterns) (rest lines))))))

(defun answered-p (patterns lines)
  "True if LINES, of a screen, have somewhere what PATTERNS, of a page, show."
  (let ((lines (remove "" (mapcar (lambda (line) (string-left-trim " " (answer-in line))) lines)
                       :test #'string=))
        (patterns (mapcar (lambda (pattern) (string-left-trim " " pattern)) patterns)))
    (loop for rest on lines thereis (lines-like-p patterns rest))))

(defun await-answer (terminal patterns)
  "Wait until what came after the last line that was typed is as PATTERNS show."
  (await-fact terminal (format nil "~{~A~%~}does not come" patterns)
              (lambda (terminal) (answered-p patterns (answered-lines terminal)))))

(defun play-turn (terminal turn)
  "Type a line of a page, where it shows it, and wait for the answer that it shows."
  (destructuring-bind (prompt line &rest answer) turn
    (await-prompt terminal prompt)
    (type-line terminal line)
    (when answer (await-answer terminal answer))))

;;; Lisp.

(defun forms-in (lines)
  "Return the forms in LINES of Lisp, each as the list of the lines that it takes; comments are left
out."
  (let ((text (format nil "~{~A~%~}" lines)) (*package* (find-package :ars-user)))
    (loop with start = 0 and end = 0
          do (setf start (or (form-start text end) (return forms))
                   end (form-end text start))
          collect (uiop:split-string (subseq text start end) :separator '(#\Newline)) into forms)))

(defun form-start (text position)
  "Return where in TEXT the next form begins, from POSITION on, or NIL."
  (loop for start = (position-if-not (lambda (char) (find char '(#\Space #\Newline))) text
                                     :start position)
        while (and start (char= #\; (char text start)))
        do (setf position (position #\Newline text :start start))
        finally (return start)))

(defun form-end (text start)
  (let ((*read-suppress* t)
        (*readtable* (named-readtables:find-readtable :nisp)))
    (nth-value 1 (read-from-string text t nil :start start :preserve-whitespace t))))

(defun type-form (terminal lines)
  "Type a form's LINES at Robot>, and wait until it has been evaluated. An error of its is one
here."
  (await-prompt terminal "Robot>")
  (loop for (line . more) on lines
        do (type-line terminal line)
           (when more (await-prompt terminal ">")))
  (await-prompt terminal "Robot>")
  (let ((trouble (find "*ERROR*" (answered-lines terminal) :test #'search)))
    (when trouble
      (error 'newcomer-stuck :fact trouble :screen (format nil "~{|~A~%~}" lines)))))
