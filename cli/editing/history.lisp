;;;; history.lisp -- texts that grow line by line, and the file of typed lines.

(in-package :ars-magna.cli)

;;; One text grows in place. Copying it for each line would take quadratic time for long forms.

(defclass growing-text (fundamental-character-input-stream)
  ((text :initarg :text :reader grown-text)
   (position :initarg :position :accessor grown-position)
   (more :initarg :more :reader text-grower))
  (:documentation "A stream of the characters of TEXT from POSITION on. TEXT has a fill pointer. At
the end of TEXT, the function MORE is called with TEXT. MORE returns the next line, which is
appended after a newline, or NIL at the end of the stream."))

(defun extensible-text (text)
  "Return TEXT, or a copy of TEXT, with a fill pointer, so that lines can be appended."
  (if (array-has-fill-pointer-p text)
      text
      (make-array (length text) :element-type 'character :adjustable t :fill-pointer t
                                :initial-contents text)))

(defun extend-text (text line)
  (vector-push-extend #\Newline text)
  (loop for char across line do (vector-push-extend char text)))

(defun make-growing-text-stream (text start more)
  "Return a stream of TEXT from START on. MORE returns more lines, as in GROWING-TEXT."
  (make-instance 'growing-text :text (extensible-text text) :position start :more more))

(defmethod stream-read-char ((stream growing-text))
  (let ((text (grown-text stream)) (position (grown-position stream)))
    (when (> position (length text))
      (let ((line (funcall (text-grower stream) text)))
        (unless line (return-from stream-read-char :eof))
        (extend-text text line)))
    (incf (grown-position stream))
    (if (< position (length text)) (char text position) #\Newline)))

(defmethod stream-unread-char ((stream growing-text) char)
  (declare (ignore char))
  (decf (grown-position stream))
  nil)

;;;; The history

;;; A Lisp form in several lines is one entry. So an entry is written when the next one begins, or
;;; the session ends. The file has an entry on each line, with \n for a newline and \\ for a
;;; backslash. Several sessions may write at once. A file that cannot be read or written is ignored.

(defparameter *history-limit* 1000 "The largest number of entries in the history.")

(defstruct (line-history (:conc-name history-) (:copier nil)
                         (:constructor %make-history))
  "ENTRIES are typed lines, newest first. FILE is the history file's pathname, or NIL. UNSAVED-P is
true if the newest entry is not in the file. If the last line was appended to the newest entry,
GROWING is the text before that line, and the entry has a fill pointer; else GROWING is NIL."
  (entries '() :type list)
  (growing nil :type (or null string))
  (file nil :type (or null pathname) :read-only t)
  (unsaved-p nil :type boolean))

;;; The file.

(defun encode-entry (entry)
  (flet ((escaped (line) (format nil "~{~A~^\\\\~}" (uiop:split-string line :separator "\\"))))
    (format nil "~{~A~^\\n~}" (mapcar #'escaped (lines-in entry)))))

(defun decode-entry (line)
  (with-output-to-string (out)
    (loop with position = 0
          while (< position (length line))
          do (let* ((char (char line position))
                    (escaped (and (char= char #\\) (< (1+ position) (length line))
                                  (position (char line (1+ position)) "n\\"))))
               (write-char (if escaped (char (format nil "~%\\") escaped) char) out)
               (incf position (if escaped 2 1))))))

(defun read-history-file (file)
  "Return the newest entries in FILE, newest first."
  (let ((lines (remove "" (uiop:split-string (file-text file) :separator '(#\Newline))
                       :test #'string=)))
    (mapcar #'decode-entry (reverse (last lines *history-limit*)))))

(defun shorten-history-file (file entries)
  "Rewrite FILE with only ENTRIES, newest first, if FILE has more than twice *HISTORY-LIMIT* lines."
  (when (< (* 2 *history-limit*) (count #\Newline (file-text file)))
    (call-replacing-file (lambda (out)
                           (format out "~{~A~%~}" (mapcar #'encode-entry (reverse entries))))
                         file)))

(defun make-history (&optional file)
  (let ((entries (and file (ignore-errors (read-history-file file)))))
    (when entries (ignore-errors (shorten-history-file file entries)))
    (%make-history :entries entries :file file)))

(defun save-newest-entry (history)
  (destructuring-bind (&optional newest before &rest others) (history-entries history)
    (declare (ignore others))
    (when (and newest (equal newest before))
      (pop (history-entries history))
      (setf (history-unsaved-p history) nil)))
  (when (and (shiftf (history-unsaved-p history) nil) (history-file history))
    (ignore-errors
     (check-writable (history-file history))
     (with-open-file (out (history-file history) :direction :output :if-exists :append
                                                 :if-does-not-exist :create
                                                 :external-format :utf-8)
       (format out "~A~%" (encode-entry (first (history-entries history))))))))

;;; Entries.

(defun add-entry (history text)
  "Add TEXT, a typed line, to HISTORY, unless TEXT is blank or equals the newest entry."
  (save-newest-entry history)
  (setf (history-growing history) nil)
  (unless (or (every #'blank-character-p text) (equal text (first (history-entries history))))
    (push text (history-entries history))
    (setf (history-unsaved-p history) t)))

(defun begins-with-p (text start)
  "True if TEXT begins with START. For long texts, BEGINS-WITH-P is faster than STARTS-WITH-SUBSEQ."
  (and (<= (length start) (length text))
       (string= start text :end2 (length start))))

;; The same text need not be compared for each line to see that it continues.
(defun extend-newest-entry (history line before)
  "Append LINE, which continues the text BEFORE, to the newest entry of HISTORY. Do nothing unless
BEFORE begins with that entry."
  (let ((newest (first (history-entries history)))
        (same-p (eq before (history-growing history))))
    (when (and newest (or same-p (begins-with-p before newest)))
      (unless same-p
        (setf (first (history-entries history)) (extensible-text (copy-seq before))
              (history-growing history) before))
      (extend-text (first (history-entries history)) line)
      (setf (history-unsaved-p history) t))))
