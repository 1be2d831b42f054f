;;;; kinds-of-lines.lisp -- whether a line is a comment or Lisp, and what its words are.

(in-package :ars-magna.cli)

(defun comment-at-p (text position)
  "True if a comment begins in TEXT at POSITION: with ;, or with # between blanks or ends of the
line."
  (flet ((blank-at-p (position)
           (or (not (array-in-bounds-p text position))
               (blank-p (char text position)))))
    (case (char text position)
      (#\; t)
      (#\# (and (blank-at-p (1- position)) (blank-at-p (1+ position)))))))

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

;;; The words of a line.

(defun skip-blanks (text start)
  "Return where, from START, TEXT goes on after blanks; its length if no more than a comment does."
  (let ((position (position-if-not #'blank-p text :start start)))
    (if (and position (not (comment-at-p text position)))
        position
        (length text))))

(defun word-end (text start)
  "Return where the word ends that begins in TEXT at START: at a blank, or a comment after ;."
  (or (position-if (lambda (char) (or (blank-p char) (char= #\; char))) text :start start)
      (length text)))

(defun token-end (text start)
  "Return where the token that begins in TEXT at START ends; one in double quotes may hold blanks,
and goes on to the end of TEXT if there is no second one."
  (if (char= (char text start) #\")
      (let ((quote (position #\" text :start (1+ start))))
        (if quote (1+ quote) (length text)))
      (word-end text start)))

(defun split-line (text)
  "Return the first word of TEXT and what follows it."
  (let* ((start (position-if-not #'blank-p text))
         (end (token-end text start)))
    (values (subseq text start end) (subseq text end))))
