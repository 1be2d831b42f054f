;;;; files.lisp -- reading text files, recognizing their kind, and replacing them safely.

(in-package :ars-magna.basics)

(export '(file-text illegible-file-line illegible-file note-kind-of-file advice-on-file
          other-kind-of-file-p check-kind-of-file call-replacing-file overwrite-file
          write-failure-text))

(define-condition illegible-file (ars-magna-error)
  ((file :initarg :file :reader illegible-file-name)
   (line :initarg :line :reader illegible-file-line))
  (:report (lambda (condition stream)
             (format stream "~A, line ~D: it has bytes that are not UTF-8. Save the file in UTF-8."
                     (native-name (illegible-file-name condition))
                     (illegible-file-line condition))))
  (:documentation "A text file has a line that is not valid UTF-8."))

(setf (documentation 'illegible-file-line 'function)
      "Return the number of the first line that is not valid UTF-8.")

(defun file-text (path)
  "Return the text of the file PATH, without a byte order mark. Signals an error if PATH is not a
regular file, and ILLEGIBLE-FILE if the text is not valid UTF-8."
  (unless (regular-file-p path) (error "~A is a directory or a device" (native-name path)))
  (let* ((text (utf-8-decoded (read-file-into-string path :external-format :latin-1)))
         (illegible (position +illegible+ text)))
    (when illegible
      (error 'illegible-file :file path :line (1+ (count #\Newline text :end illegible))))
    (string-left-trim '(#.(code-char #xFEFF)) text)))

;;; The kind of a file, for users who pass it to the wrong function.

;;; The layer that writes or reads a kind of file registers how such files begin.

(defvar *kinds-of-files* '() "Lists (kind beginning advice).")

(defun note-kind-of-file (kind beginning advice)
  "Register that files of KIND, a keyword, begin with the text BEGINNING. The text ADVICE says what
a file of KIND is and which function reads it."
  (pushnew (list kind beginning advice) *kinds-of-files* :test #'equal))

(dolist (beginning '("(in-package" "(def"))
  (note-kind-of-file :lisp beginning "it is Lisp; (load FILE) reads it"))

(defun beginning-of-file (path)
  "Return the first characters of the file PATH, or an empty string if it cannot be read."
  (or (ignore-errors
       (and (regular-file-p path)
            (with-open-file (in path :external-format :latin-1)
              (let ((text (make-string 60)))
                (subseq text 0 (read-sequence text in))))))
      ""))

(defun find-kind-of-file (path)
  "Return the list (kind beginning advice) that fits the file PATH, or NIL if none fits."
  (let ((text (beginning-of-file path)))
    (find-if (lambda (beginning) (starts-with-subseq beginning text))
             *kinds-of-files* :key #'second)))

(defun advice-on-file (path kind)
  "Return a text that says what the file PATH is and which function reads it. Return NIL if the file
is of KIND, a keyword, or of no known kind."
  (let ((entry (find-kind-of-file path)))
    (and entry
         (not (eq kind (first entry)))
         (third entry))))

(defun other-kind-of-file-p (file kind)
  "True if FILE exists, is not empty, and does not begin like a file of KIND; or is unreadable."
  (let ((path (ignore-errors (probe-file file))))
    (and path
         (not (ignore-errors
               (and (regular-file-p path)
                    (or (string= "" (beginning-of-file path))
                        (eq kind (first (find-kind-of-file path))))))))))

(defun check-kind-of-file (file kind what)
  "Signal MISUSE if FILE exists, is not empty and is not of KIND, called WHAT in the message."
  (when (other-kind-of-file-p file kind)
    (reject-use "~A is not a ~A. The file is unchanged; give another name."
                (file-name-text file) what)))

;;;; Replacing a file, or explaining why that is impossible

(defun path-to-write (file)
  "Return the absolute path of FILE, for writing; if FILE is a link, the path of its target. Signals
an error if the path cannot name a regular file, or if the file is write-protected."
  (when (wildcard-name-p file) (error *wildcard-text*))
  (check-name-decodable file)
  (when (dangling-link-p file)
    (error "it is a link to a file that does not exist"))
  (let ((path (or (probe-file file)
                  (uiop:ensure-absolute-pathname (merge-pathnames file) #'uiop:getcwd))))
    (when (and (probe-file path) (not (regular-file-p path)))
      (error "it is a directory or a device"))
    (check-writable path)
    (unless (uiop:directory-exists-p (uiop:pathname-directory-pathname path))
      (error "there is no such directory"))
    path))

(defun call-replacing-file (function file &key (external-format :utf-8) (check #'identity))
  "Call FUNCTION with a stream to a new UTF-8 file, which replaces FILE atomically when FUNCTION has
returned. If anything fails, FILE is unchanged. Return the truename of FILE. FILE keeps its
permissions. Printer variables have standard values. With EXTERNAL-FORMAT :LATIN-1, each character
is an octet. CHECK is called with the path of the complete new file and may signal errors."
  (let* ((path (path-to-write file)) (directory (uiop:pathname-directory-pathname path)))
    (remove-abandoned-files directory)
    ;; The new file's name is random. The caller's random state must not change.
    (call-with-own-random-state
     (lambda ()
       (uiop:with-temporary-file (:stream out :pathname new :external-format external-format
                                  :directory directory :prefix (temporary-file-prefix)
                                  :type :unspecific)
         (printing-plainly () (funcall function out))
         :close-stream
         (funcall check new)
         (copy-permissions new path)
         (replace-file path new))))
    (truename path)))

(defun write-failure-text (trouble)
  "Return a text that says why a file could not be written, from the error TROUBLE. The text is the
system's message, without the names of Lisp streams and temporary files."
  (let* ((text (one-line-text trouble))
         (end (search ": " text :from-end t))
         (words (and end (subseq text (+ 2 end)))))
    (cond ((not (typep trouble '(or file-error stream-error))) text)
          ((and words (notany (lambda (char) (find char "\"/")) words)) (string-downcase words))
          (t "no file can be made in that directory"))))

(defun overwrite-file (function file what
                       &key (check #'identity) kind
                         (remedy "give the name of a file that you may write"))
  "Call CALL-REPLACING-FILE with FUNCTION, FILE and CHECK. Signals MISUSE if FILE cannot be written
(the message gives REMEDY), or is of another known kind than KIND (see NOTE-KIND-OF-FILE). Messages
call the contents WHAT, such as \"the run\". FILE is then unchanged."
  (let ((advice (advice-on-file file kind)))
    (when advice
      (reject-use "~@(~A~) is not written to ~A: ~A. The file is unchanged; give another name."
                  what (file-name-text file) advice)))
  (handler-case (call-replacing-file function file :check check)
    (ars-magna-error (trouble) (error trouble))
    (error (trouble)
      (reject-use "~@(~A~) cannot be written to ~A: ~A. An existing file is unchanged; ~A."
                  what (cut (princ-to-string (file-name-text file)) 200)
                  (cut (write-failure-text trouble) 200)
                  remedy))))
