;;;; trouble.lisp -- what is wrong with a file that should hold a floor or its image.

(in-package :ars-magna.floors)

(addition unusable-floor)
(define-condition unusable-floor (ars-magna-error)
  ((file   :initarg :file   :reader unusable-floor-file)
   (line   :initarg :line   :initform nil :reader unusable-floor-line)
   (reason :initarg :reason :reader unusable-floor-reason))
  (:report (lambda (condition stream)
             (format stream "~A~@[, line ~D~]: ~A."
                     (shown-name (unusable-floor-file condition))
                     (unusable-floor-line condition)
                     (unusable-floor-reason condition))))
  (:documentation "A file that IMPORT-MAP was to read, or EXPORT-MAP to write, cannot be used."))

(setf (documentation 'unusable-floor-file 'function)
      "Return the file that an UNUSABLE-FLOOR is about, a pathname or string."
      (documentation 'unusable-floor-line 'function)
      "Return the number of the line that an UNUSABLE-FLOOR is about, or NIL."
      (documentation 'unusable-floor-reason 'function)
      "Return in words what is wrong, and what to do about it.")

(defun reject-floor (file line control &rest arguments)
  "Signal UNUSABLE-FLOOR about LINE, perhaps NIL, of FILE. The text names the remedy."
  (error 'unusable-floor :file file :line line :reason (apply #'format nil control arguments)))

(defun file-called (name)
  "Return the pathname for NAME, a string or pathname, which may begin with ~/. Signals
UNUSABLE-FLOOR for ~user."
  (when (and (stringp name) (starts-with-subseq "~" name) (not (starts-with-subseq "~/" name)))
    (reject-floor name nil "of names that begin with ~~ only ~~/, your home directory, is known ~
                            here; write the whole name of the file"))
  (path-called name))

(defun check-readable (file)
  (let ((trouble (unusable-file-text file)))
    (when trouble
      (reject-floor file nil "~A (relative names begin in ~A)"
                    trouble (native-name (base-directory))))))
