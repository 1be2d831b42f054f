;;;; tabbing.lisp -- Tab: what was begun is completed, or what it could become is listed.

(in-package :ars-magna.cli)

(defvar *completer* nil
  "NIL, or a function of a text and of the point in it where the cursor is. It returns where what is
to be completed begins, a list of all texts that it could become, and what follows one that is the
only one.")

(defun common-start (texts)
  "Return what all of TEXTS begin with, in whatever case."
  (let ((first (first texts)))
    (subseq first 0 (reduce #'min (rest texts)
                            :key (lambda (text)
                                   (or (mismatch first text :test #'char-equal) (length text)))
                            :initial-value (length first)))))

;;; Listing.

(defun last-part (text)
  "Return TEXT, or if it is a file's name, that without the directory."
  (let ((slash (position #\/ text :from-end t :end (max 0 (1- (length text))))))
    (if slash (subseq text (1+ slash)) text)))

(defun in-columns (texts width)
  "Return TEXTS as a list of lines of at most WIDTH characters, in columns to be read downwards."
  (let* ((column (+ 2 (reduce #'max texts :key #'length)))
         (count (max 1 (floor width column)))
         (height (ceiling (length texts) count)))
    (loop for row below height
          collect (string-right-trim " " (format nil "~{~VA~}"
                                                 (loop for text in (nthcdr row texts)
                                                       for i from 0
                                                       when (zerop (mod i height))
                                                         append (list column text)))))))

(defun list-choices (stream texts)
  "Show TEXTS above the line that is typed, as many as the window has room for."
  (multiple-value-bind (width height) (funcall (console-window (edited-console stream)))
    (let* ((lines (in-columns (mapcar #'last-part texts) (1- width)))
           (room (max 1 (- height 4))))
      (write-fresh (format nil "~{~A~%~}~:[~;There are more. Type more of it.~%~]"
                           (subseq lines 0 (min room (length lines))) (< room (length lines)))
                   (edited-console stream))
      (finish-output (edited-console stream)))))

;;; Completing.

(defun replace-typed (stream start string)
  (let ((line (line-of stream)))
    (multiple-value-call #'change-to stream
      (inserted string
                (uiop:strcat (subseq (drawn-line-text line) 0 start)
                             (subseq (drawn-line-text line) (drawn-line-point line)))
                start))))

(defun complete (stream start texts after)
  "Let the part of the line from START to the cursor become as much as all of TEXTS have in common,
and AFTER if it is one; list them if that is no more than there is."
  (let ((typed (subseq (typed-text-of stream) start (drawn-line-point (line-of stream))))
        (common (common-start texts)))
    (cond ((null (rest texts))
           (replace-typed stream start
                          (if (uiop:string-suffix-p common "/")
                              common
                              (uiop:strcat common after))))
          ((< (length typed) (length common)) (replace-typed stream start common))
          ;; What has been listed, with nothing typed since, is not listed again.
          ((not (equal texts (edited-listed stream)))
           (list-choices stream texts)
           (setf (edited-listed stream) texts)))))

(define-action (:tab) (stream)
  "Complete what was begun."
  (let ((line (line-of stream)))
    (when (and *completer* (not *program-reads*))
      (multiple-value-bind (start texts after)
          (funcall *completer* (drawn-line-text line) (drawn-line-point line))
        (when texts (complete stream start texts after)))))
  nil)
