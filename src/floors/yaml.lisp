;;;; yaml.lisp -- the little of YAML that descriptions of floors are written in.

(in-package :ars-magna.floors)

;;; This is no reader of YAML, but a strict one of the flat form that map savers write: lines
;;; `key: value', each key once, where a value is a word, a text in quotes, or a list [a, b, c],
;;; which may also stand below its key, an item a line behind a dash. What else YAML has is refused
;;; with the number of its line. Values are strings; nothing is evaluated.

(defstruct (entry (:constructor make-entry (key line value)) (:copier nil))
  "That a file has KEY on LINE with VALUE: a string, or a list of strings."
  (key "" :type string :read-only t)
  (line 1 :type (integer 1) :read-only t)
  (value "" :type (or string list)))

(defun find-entry (key entries)
  (find key entries :key #'entry-key :test #'string=))

(defun trim (text)
  (string-trim '(#\Space #\Tab #\Return) text))

(defun without-comment (text)
  "Return TEXT without a comment, which begins at its start or behind a blank."
  (loop for start = (position #\# text) then (position #\# text :start (1+ start))
        while start
        when (or (zerop start) (blank-p (char text (1- start))))
          return (trim (subseq text 0 start))
        finally (return (trim text))))

(defun end-of-quoted (file line text)
  "Return where the quotes that TEXT begins with are closed. A quote that is doubled in single
quotes, or behind a backslash in double ones, does not close them."
  (loop with quote = (char text 0)
        for i from 1 below (length text)
        for char = (char text i)
        do (cond ((and (char= #\\ char) (char= #\" quote)) (incf i))
                 ((char/= char quote))
                 ((and (char= #\' quote) (< (1+ i) (length text)) (char= #\' (char text (1+ i))))
                  (incf i))
                 (t (return i)))
        finally (reject-floor file line "the quotes are not closed; add a ~C at the end" quote)))

(defun unquoted (file line text end)
  "Return what stands between the quotes of TEXT, which are closed at END."
  (with-output-to-string (out)
    (loop with quote = (char text 0) and i = 1
          while (< i end)
          do (let ((char (char text i)))
               (when (or (and (char= #\' quote) (char= #\' char))
                         (and (char= #\" quote) (char= #\\ char)))
                 (setf char (char text (incf i)))
                 (unless (find char "'\"\\")
                   (reject-floor file line "\\~C in quotes is not known here; write the text in ~
                                            'single quotes', where a backslash is one" char)))
               (write-char char out)
               (incf i)))))

(defun read-quoted (file line text)
  (let ((end (end-of-quoted file line text)))
    (unless (string= "" (without-comment (concatenate 'string " " (subseq text (1+ end)))))
      (reject-floor file line "there is more behind the closing quote; leave that out"))
    (unquoted file line text end)))

(defun read-list (file line text)
  (let ((text (without-comment text)))
    (unless (eql (position #\] text) (1- (length text)))
      (reject-floor file line "a list is written on one line and ends it, as in [0.0, 0.0, 0.0]"))
    (mapcar #'trim (uiop:split-string (subseq text 1 (1- (length text))) :separator ","))))

(defun value-at (file line text)
  "Return the value that TEXT, the rest of LINE of FILE, stands for: a string or list of strings."
  (case (if (string= "" text) #\Space (char text 0))
    ((#\" #\') (read-quoted file line text))
    (#\[ (read-list file line text))
    ((#\& #\* #\! #\| #\> #\{ #\% #\@ #\`)
     (reject-floor file line "a value that begins with ~C is not read here; write a number, a name ~
                              of a file, or a list [a, b, c]"
                   (char text 0)))
    (t (without-comment text))))

(defun key-end (text)
  "Return where the colon behind the key in TEXT is, or NIL if that begins with no key."
  (let ((end (position-if-not (lambda (char) (or (alphanumericp char) (find char "_-"))) text)))
    (and end
         (plusp end)
         (char= #\: (char text end))
         (or (= (1+ end) (length text)) (blank-p (char text (1+ end))))
         end)))

(defun read-entry (file line text)
  (let ((end (key-end text)))
    (unless end
      (reject-floor file line "~S is no line such as resolution: 0.05, a key at the left edge, a ~
                               colon, a blank and a value"
                    (cut text 60)))
    (make-entry (subseq text 0 end) line (value-at file line (trim (subseq text (1+ end)))))))

(defun item-p (text)
  "True if TEXT is an item of a list below its key."
  (let ((text (trim text)))
    (and (starts-with-subseq "-" text)
         (or (= 1 (length text)) (blank-p (char text 1))))))

(defun add-item (file line text entry)
  "Let the list of ENTRY, which stands above TEXT, end with the item in that."
  (unless (and entry (or (consp (entry-value entry)) (string= "" (entry-value entry))))
    (reject-floor file line "an item of a list stands below no key; write the list behind its key, ~
                             as in origin: [0.0, 0.0, 0.0]"))
  (setf (entry-value entry)
        (append (and (consp (entry-value entry)) (entry-value entry))
                (list (without-comment (trim (subseq (trim text) 1)))))))

(defun check-new-key (file entry entries)
  (let ((other (find-entry (entry-key entry) entries)))
    (when other
      (reject-floor file (entry-line entry) "~A is on line ~D already; leave one of the two out"
                    (entry-key entry) (entry-line other)))))

(defun read-entries (file text)
  "Return the entries, in order, that TEXT, which FILE has, consists of. Signals UNUSABLE-FLOOR."
  (let ((entries '()))
    (loop for line from 1
          for whole in (uiop:split-string text :separator '(#\Newline))
          for text = (string-right-trim '(#\Return) whole)
          until (string= "..." (trim text))
          do (cond ((string= "" (without-comment text)))
                   ((and (null entries) (string= "---" (without-comment text))))
                   ((item-p text) (add-item file line text (first entries)))
                   (t (let ((entry (read-entry file line text)))
                        (check-new-key file entry entries)
                        (push entry entries)))))
    (nreverse entries)))
