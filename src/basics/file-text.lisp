;;;; file-text.lisp -- what is in a file: its text, of whatever octets, and of which kind it is.

(in-package :ars-magna.basics)

(export '(file-text illegible-file-line illegible-file note-kind-of-file file-advice foreign-file-p
          check-not-foreign))

(define-condition illegible-file (ars-magna-error)
  ((file :initarg :file :reader illegible-file-name)
   (line :initarg :line :reader illegible-file-line))
  (:report (lambda (condition stream)
             (format stream "~A, line ~D: it has bytes that are not UTF-8. Save the file in UTF-8."
                     (native-name (illegible-file-name condition))
                     (illegible-file-line condition))))
  (:documentation "A file that is to be read as text has a line that is no text in UTF-8."))

(setf (documentation 'illegible-file-line 'function)
      "Return the number of the first line that is no text in UTF-8.")

(defun file-text (path)
  "Return the text in the file PATH, without a byte order mark. Signals an error if it has none, and
ILLEGIBLE-FILE if it has octets that are no text in UTF-8."
  (unless (plain-file-p path) (error "~A is a directory or a device" (native-name path)))
  (let* ((text (decoded (read-file-into-string path :external-format :latin-1)))
         (illegible (position +illegible+ text)))
    (when illegible
      (error 'illegible-file :file path :line (1+ (count #\Newline text :end illegible))))
    (string-left-trim '(#.(code-char #xFEFF)) text)))

;;; What a file holds, for somebody who has given it to the wrong function.

;;; The layer that writes or reads a kind of file notes how such files begin.

(defvar *kinds-of-files* '() "Lists (kind beginning advice).")

(defun note-kind-of-file (kind beginning advice)
  "Note that files of KIND, a keyword, begin with the text BEGINNING; ADVICE says in words what such
a file is, and what reads it."
  (pushnew (list kind beginning advice) *kinds-of-files* :test #'equal))

(dolist (beginning '("(in-package" "(def"))
  (note-kind-of-file :lisp beginning "it is Lisp; (load FILE) reads it"))

(defun beginning-of-file (path)
  "Return the first characters of the file PATH, or an empty text if it cannot be read."
  (or (ignore-errors
       (and (plain-file-p path)
            (with-open-file (in path :external-format :latin-1)
              (let ((text (make-string 60)))
                (subseq text 0 (read-sequence text in))))))
      ""))

(defun known-beginning (path)
  "Return the list (kind beginning advice) of the file PATH, or NIL."
  (let ((text (beginning-of-file path)))
    (find-if (lambda (beginning) (starts-with-subseq beginning text))
             *kinds-of-files* :key #'second)))

(defun file-advice (path kind)
  "Return in words what is in the file PATH, and what reads it, if that is another kind of file than
KIND, a keyword; else NIL."
  (let ((entry (known-beginning path)))
    (and entry
         (not (eq kind (first entry)))
         (third entry))))

(defun foreign-file-p (file kind)
  "True if there is something called FILE that is neither empty nor of KIND, whole or damaged, or
that cannot be told."
  (let ((path (ignore-errors (probe-file file))))
    (and path
         (not (ignore-errors
               (and (plain-file-p path)
                    (or (string= "" (beginning-of-file path))
                        (eq kind (first (known-beginning path))))))))))

(defun check-not-foreign (file kind what)
  "Signal MISUSE if there is something called FILE that is neither empty nor of KIND, a WHAT."
  (when (foreign-file-p file kind)
    (reject-use "~A is no ~A, and is left as it is. Give another name." (shown-name file) what)))
