;;;; pasting.lisp -- what is pasted: lines, perhaps with the prompts and answers around them.

(in-package :ars-magna.cli)

;;; Somebody may paste what a page or the window shows, prompts and all. They are taken off. What
;;; stands after one may also be a message of the robot's, such as "robot-turn: Robot turned 1.00":
;;; its first word ends with a colon. Other answers are known by having no prompt where lines have.

(defparameter *labels* '("Robot>" "Break>") "What prompts look like.")

(defun message-p (text)
  (let* ((start (position-if-not #'blank-p text))
         (end (and start (position-if #'blank-p text :start start))))
    (and end (< start (1- end)) (char= #\: (char text (1- end))))))

(defun after-label (text)
  "Return what stands after the prompt that TEXT, a line, begins with, or NIL if it has none."
  (let* ((text (subseq text (or (position-if-not #'blank-p text) 0)))
         (label (find-if (lambda (label) (starts-with-subseq label text)) *labels*)))
    (and label (subseq text (length label)))))

(defun without-label (text)
  "Return TEXT, a line as typed, without the prompts that it begins with; nothing of a message."
  (let ((rest (after-label text)))
    (cond ((null rest) text)
          ((message-p rest) "")
          (t (without-label (string-left-trim " " rest))))))

(define-constant +going-on+ "     > " :test #'string=
  :documentation "The prompt for what goes on from the line before.")

(defun going-on-p (text)
  (starts-with-subseq +going-on+ text))

(defun line-pasted (text before)
  "Return TEXT, a line as typed, without a prompt that was pasted with it. BEFORE is true if it goes
on from another."
  (cond ((null before) (without-label text))
        ((going-on-p text) (subseq text (length +going-on+)))
        (t text)))

;;; Where several lines were pasted, prompts tell which of them were typed.

(defun typed-line-of (line)
  "Return LINE, as pasted among others with prompts, without its own; NIL if it was not typed."
  (cond ((going-on-p line) (line-pasted line t))
        ((after-label line) (let ((text (without-label line)))
                             (and (string/= "" text) text)))))

(defun read-over (text more)
  "Read past the form that TEXT, as typed, begins, if that is Lisp: MORE, a function of the text so
far, returns the next line of it, or signals an error at the end."
  (when (and (not (comment-p text)) (lisp-p text))
    (handler-case (let ((*read-suppress* t))
                    (read-preserving-whitespace (text-stream text 0 more)))
      (error () nil))))

(defun rest-of-form (text lines)
  "Return which of LINES, as pasted below TEXT, are the rest of the form that it begins, without
their prompts, and the LINES below them. What was typed at another prompt is not."
  (let ((taken '()))
    (flet ((next-of-form (text)
             (declare (ignore text))
             (loop for line = (first lines)
                   when (or (null lines) (and (after-label line) (typed-line-of line)))
                     do (error "No line is left for the form.")
                   do (pop lines)
                   unless (after-label line)
                     return (first (push (or (typed-line-of line) line) taken)))))
      (read-over text #'next-of-form)
      (values (nreverse taken) lines))))

(defun typed-by-label (lines)
  "Return what was typed of LINES, as pasted, the first of which has a prompt. What stands below a
form that is not complete is the rest of it."
  (loop while lines
        for line = (pop lines)
        for typed = (typed-line-of line)
        when typed
          collect typed
          and when (after-label line)
                append (multiple-value-bind (rest below) (rest-of-form typed lines)
                         (setf lines below)
                         rest)))

(defun typed-lines (lines)
  "Return what was typed of LINES, as pasted: all up to the first with a prompt, which may be the
rest of one, those with prompts, but for messages, and the rests of their forms; or LINES if none
has any."
  (let ((start (position-if #'after-label lines)))
    (if start
        (append (subseq lines 0 start) (typed-by-label (nthcdr start lines)))
        lines)))

(defun answers-at-end (text)
  "Return how many lines of TEXT, as pasted, below the last with a prompt are left out as answers."
  (let* ((lines (lines-in text))
         (start (position-if #'after-label lines :from-end t))
         (last (and start (nthcdr start lines)))
         (typed (make-hash-table :test 'eq)))
    (dolist (line (typed-by-label last)) (setf (gethash line typed) t))
    (count-if-not (lambda (line)
                    (or (gethash line typed)
                        (after-label line) (going-on-p line) (comment-p line)))
                  last)))

(defun without-answers (text)
  (format nil "~{~A~^~%~}" (typed-lines (lines-in text))))
