;;;; search.lisp -- control R: looking for a line in the history.

(in-package :ars-magna.cli)

;;; The prompt says meanwhile what is looked for. Control R again goes on to an older line; control
;;; G gives up; any other key takes the line that was found and does what it does to it.

(defun found-entry (stream sought skipped)
  "Return the entry of the history with SOUGHT in it that comes before SKIPPED others, and where in
it SOUGHT begins; NIL if there is none."
  (let* ((entries (remove-if-not (lambda (entry) (search sought entry :test #'char-equal))
                                 (remove-duplicates (history-entries (edited-history stream))
                                                    :test #'string= :from-end t)))
         (entry (and (string/= "" sought) (nth skipped entries))))
    (values entry (and entry (search sought entry :test #'char-equal)))))

(defun show-search (stream sought skipped)
  "Show what is found for SOUGHT. NIL if nothing is."
  (multiple-value-bind (entry place) (found-entry stream sought skipped)
    (change-line (edited-console stream)
                 (lambda (line)
                   (setf (drawn-line-label line)
                         (format nil "(search~:[, not found~;~]) ~A: "
                                 (or entry (string= "" sought)) sought))
                   (when entry
                     (setf (drawn-line-text line) entry
                           (drawn-line-point line) place))))
    entry))

(defun search-keys (stream)
  "Let keys say what is looked for. Return the first key that says something else."
  (loop with sought = "" and skipped = 0
        for key = (read-key (octet-reader stream))
        do (cond ((stringp key) (setf sought (uiop:strcat sought key)
                                      skipped 0))
                 ((eq key :rubout) (setf sought (subseq sought 0 (max 0 (1- (length sought))))
                                         skipped 0))
                 ((eq key :control-r) (when (found-entry stream sought (1+ skipped))
                                        (incf skipped)))
                 (t (return key)))
           (show-search stream sought skipped)))

(define-action (:control-r) (stream)
  "Look for a line in the history."
  (let* ((line (line-of stream))
         (prompt (drawn-line-label line))
         (text (drawn-line-text line))
         (point (drawn-line-point line)))
    (show-search stream "" 0)
    (let ((key (search-keys stream)))
      (change-line (edited-console stream)
                   (lambda (line) (setf (drawn-line-label line) prompt)))
      (if (member key '(:control-g :control-c))
          (progn (change-to stream text point) nil)
          (press stream key)))))
