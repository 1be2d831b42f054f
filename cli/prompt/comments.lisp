;;;; comments.lisp -- comments between #| and |#, which may go on over lines.

(in-package :ars-magna.cli)

;;; In a form they are Lisp's to read. Around forms, and before, in and behind other lines, they are
;;; left out here, and lines are read until they end.

(defun block-at-p (text position)
  "True if a comment begins in TEXT at POSITION that goes on until |#."
  (let ((end (+ 2 position)))
    (and (<= end (length text))
         (string= "#|" text :start2 position :end2 end))))

(defun block-end (text start depth)
  "Return where the comments end in which TEXT is at START, DEPTH of them one in the other; NIL, and
in how many it is at its end, if they go on."
  (loop with i = start
        for end = (+ 2 i)
        while (<= end (length text))
        do (cond ((block-at-p text i) (incf depth) (setf i end))
                 ((string/= "|#" text :start2 i :end2 end) (incf i))
                 ((zerop (decf depth)) (return end))
                 (t (setf i end)))
        finally (return (values nil depth))))

(defun rest-after-block (session text start trouble)
  "Return what stands behind the comment that begins in TEXT at START, reading on in SESSION until
it ends; and what TROUBLE is for TEXT: NIL, or the condition that says that this is but the outline
of a line that is too long. Signals BAD-LINE if the comment does not end."
  (let ((line text) (position (+ 2 start)) (depth 1))
    (loop
      (multiple-value-bind (end deeper) (block-end line position depth)
        (when end (return (values (subseq line end) trouble)))
        (setf depth deeper
              position 0
              (values line trouble) (read-outline session text))
        (unless line
          (reject-line "The comment that begins with #| does not end; close it with |#."))))))

(defun block-start (text)
  "Return where the first such comment begins in TEXT, of no form, outside of quotes and of other
comments; NIL if there is none."
  (loop with quoted = nil
        for char across text
        for i from 0
        do (cond ((char= #\" char) (setf quoted (not quoted)))
                 (quoted)
                 ((block-at-p text i) (return i))
                 ((comment-at-p text i) (return nil)))))

(defun without-blocks (session text &optional trouble)
  "Return TEXT, a line of SESSION as typed, without such comments, unless it begins with a form; and
what TROUBLE is for TEXT, as in REST-AFTER-BLOCK. What is in comments may be too long."
  (let ((start (unless (or (comment-p text) (lisp-p text)) (block-start text))))
    (if start
        (let ((before (subseq text 0 start)))
          (multiple-value-bind (rest later) (rest-after-block session text start trouble)
            (without-blocks session (format nil "~A ~A" before rest)
                            (or (unless (comment-p rest) later)
                                (unless (comment-p before) trouble)))))
        (values text trouble))))

(defun check-outline (session text trouble)
  "Signal TROUBLE, unless it is NIL or TEXT, an outline of a line of SESSION, is a comment. A form
that begins there is passed over."
  (when (and trouble (not (comment-p text)))
    (when (lisp-p text) (skip-rest session text 0))
    (error trouble)))

(defun forms-after-block (session text start)
  "Return what stands behind the comment that begins in TEXT, of forms, at START, reading on in
SESSION until it ends. Signals LINE-TOO-LONG if there is more than comments in such a line."
  (multiple-value-bind (rest trouble) (rest-after-block session text start nil)
    (cond (trouble (multiple-value-call #'check-outline
                     session (without-blocks session rest trouble))
                   "")
          (t rest))))

(defun skip-comments (session text position)
  "Return TEXT, of forms, or as much of it as stands behind comments, and where it goes on from
POSITION behind blanks and comments; read on in SESSION until these end."
  (loop
    (let ((start (or (position-if-not #'blank-p text :start position) (length text))))
      (unless (block-at-p text start)
        (return (values text start)))
      ;; Not at 0: there is something before it.
      (setf text (format nil " ~A" (forms-after-block session text start))
            position 1))))
