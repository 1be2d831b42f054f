;;;; pasting.lisp -- what is pasted: lines, perhaps with the prompts and answers around them.

(in-package :ars-magna.cli)

;;; Somebody may paste what a page or the window shows, prompts and all. They are taken off. What
;;; stands after one may also be a message of the robot's, such as "robot-turn: Robot turned 1.00":
;;; its first word ends with a colon. Other answers are known by having no prompt where lines have.

(defparameter *labels* '("Robot>" "Break>") "What prompts look like.")

(defun message-p (text)
  "True if TEXT, what stands after a prompt, is a message."
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

(defun goes-on-p (text)
  "True if TEXT, as typed, is Lisp that is not complete."
  (and (not (comment-p text))
       (lisp-p text)
       (handler-case (let ((*read-suppress* t)) (read-from-string text) nil)
         (end-of-file () t)
         (error () nil))))

(defun typed-by-label (lines)
  "Return what was typed of LINES, as pasted, the first of which has a prompt. What stands below a
form that is not complete is the rest of it."
  (loop with form = ""
        for line in lines
        for label-p = (after-label line)
        for typed = (or (typed-line-of line)
                        (and (not label-p) (goes-on-p form) line))
        when typed
          collect typed
          and do (setf form (if label-p typed (format nil "~A~%~A" form typed)))))

(defun typed-lines (lines)
  "Return what was typed of LINES, as pasted: all up to the first with a prompt, which may be the
rest of one, those with prompts, but for messages, and the rests of their forms; or LINES if none
has any."
  (let ((start (position-if #'after-label lines)))
    (if start
        (append (subseq lines 0 start) (typed-by-label (nthcdr start lines)))
        lines)))

(defun lines-in (text)
  "Return the lines of TEXT, at least one."
  (or (uiop:split-string text :separator '(#\Newline)) (list "")))

(defun answers-at-end (text)
  "Return how many lines of TEXT, as pasted, below the last with a prompt are left out as answers."
  (let* ((lines (lines-in text))
         (start (position-if #'after-label lines :from-end t))
         (last (and start (nthcdr start lines))))
    (count-if-not (lambda (line) (or (after-label line) (going-on-p line) (comment-p line)))
                  (set-difference last (and last (typed-by-label last)) :test #'eq))))

(defun without-answers (text)
  "Return TEXT, as pasted, without the answers to what was typed in it."
  (format nil "~{~A~^~%~}" (typed-lines (lines-in text))))
