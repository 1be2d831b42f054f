;;;; changes.lisp -- the keys that move the cursor in the line being typed, or change the line.

(in-package :ars-magna.cli)

;;; Each such key is a function of a text and of the position of the cursor in it, its point. It
;;; returns a new text and point, and what it has killed, which Control-Y brings back. The keys are
;;; those of Emacs and of shells. A pasted text may have several lines.

(defvar *editing-keys* (make-hash-table)
  "Table from keys to functions that change a line. Such a function takes the text and the position
of the cursor. The function returns the new text, the new position and the killed text, if any.")

(defmacro define-key (table keys lambda-list documentation &body body)
  "Make each of KEYS in TABLE run BODY, as a function with LAMBDA-LIST."
  `(dolist (key ',keys)
     (setf (gethash key ,table)
           (lambda ,lambda-list ,documentation (declare (ignorable ,@lambda-list)) ,@body))))

;;; Places in a text.

(defun line-start (text point)
  (let ((newline (position #\Newline text :end point :from-end t)))
    (if newline (1+ newline) 0)))

(defun line-end (text point)
  (or (position #\Newline text :start point) (length text)))

(defun word-start-before (text point &optional (in-word-p #'alphanumericp))
  "Return the start of the word in TEXT at or before POINT. Characters of words satisfy IN-WORD-P."
  (let* ((end (position-if in-word-p text :end point :from-end t))
         (gap (and end (position-if-not in-word-p text :end end :from-end t))))
    (if gap (1+ gap) 0)))

(defun word-end-after (text point)
  (let ((start (position-if #'alphanumericp text :start point)))
    (or (and start (position-if-not #'alphanumericp text :start start))
        (length text))))

;;; Moving.

(define-key *editing-keys* (:control-a :home) (text point)
  "Go to the beginning of the line."
  (values text (line-start text point)))

(define-key *editing-keys* (:control-e :end) (text point)
  "Go to the end of the line."
  (values text (line-end text point)))

(define-key *editing-keys* (:control-b :left) (text point)
  "Go one character back."
  (values text (max 0 (1- point))))

(define-key *editing-keys* (:control-f :right) (text point)
  "Go one character forward."
  (values text (min (length text) (1+ point))))

(define-key *editing-keys* (:meta-b) (text point)
  "Go back to the beginning of a word."
  (values text (word-start-before text point)))

(define-key *editing-keys* (:meta-f) (text point)
  "Go forward to the end of a word."
  (values text (word-end-after text point)))

;;; Changing.

(defun insert-in-text (string text point)
  (values (concatenate 'string (subseq text 0 point) string (subseq text point))
          (+ point (length string))))

(defun delete-from-text (text start end)
  "Return TEXT without its part from START to END, and the new position of the cursor, START."
  (values (concatenate 'string (subseq text 0 start) (subseq text end)) start))

(defun kill-from-text (text start end)
  "Return the values of DELETE-FROM-TEXT, and the deleted text as a third value."
  (multiple-value-call #'values (delete-from-text text start end) (subseq text start end)))

(define-key *editing-keys* (:rubout) (text point)
  "Delete the character before the cursor."
  (delete-from-text text (max 0 (1- point)) point))

(define-key *editing-keys* (:delete) (text point)
  "Delete the character under the cursor."
  (delete-from-text text point (min (length text) (1+ point))))

(define-key *editing-keys* (:control-k) (text point)
  "Kill the text from the cursor to the end of the line."
  (kill-from-text text point (line-end text point)))

(define-key *editing-keys* (:control-u) (text point)
  "Kill the text from the beginning of the line to the cursor."
  (kill-from-text text (line-start text point) point))

(define-key *editing-keys* (:control-w) (text point)
  "Kill the text before the cursor, back to a blank."
  (kill-from-text text (word-start-before text point (lambda (char) (not (blank-character-p char))))
                  point))

(define-key *editing-keys* (:meta-rubout) (text point)
  "Kill the word before the cursor."
  (kill-from-text text (word-start-before text point) point))

(define-key *editing-keys* (:meta-d) (text point)
  "Kill the word after the cursor."
  (kill-from-text text point (word-end-after text point)))
