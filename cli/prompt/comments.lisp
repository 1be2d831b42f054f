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

(defun rest-after-block (session text start)
  "Return what stands behind the comment that begins in TEXT at START, reading on in SESSION until
it ends. Signals BAD-LINE if it does not."
  (let ((line text) (position (+ 2 start)) (depth 1))
    (loop
      (multiple-value-bind (end deeper) (block-end line position depth)
        (when end (return (subseq line end)))
        (setf depth deeper
              position 0
              line (or (read-outline session text)
                       (reject-line "The comment that begins with #| does not end; close it with ~
                                     |#.")))))))

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

(defun without-blocks (session text)
  "Return TEXT, a line of SESSION as typed, without such comments, unless it begins with a form."
  (let ((start (unless (or (comment-p text) (lisp-p text)) (block-start text))))
    (if start
        (without-blocks session (format nil "~A ~A" (subseq text 0 start)
                                        (rest-after-block session text start)))
        text)))

(defun skip-comments (session text position)
  "Return TEXT, of forms, or as much of it as stands behind comments, and where it goes on from
POSITION behind blanks and comments; read on in SESSION until these end."
  (loop
    (let ((start (or (position-if-not #'blank-p text :start position) (length text))))
      (unless (block-at-p text start)
        (return (values text start)))
      ;; Not at 0: there is something before it.
      (setf text (format nil " ~A" (rest-after-block session text start))
            position 1))))
