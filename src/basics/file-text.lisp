;;;; file-text.lisp -- the text in a file, of whatever octets.

(in-package :ars-magna.basics)

(export '(file-text illegible-file-line illegible-file))

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
