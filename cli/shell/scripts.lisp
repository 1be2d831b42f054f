;;;; scripts.lisp -- ./cli/ars-magna SCRIPT: a file of lines as they are typed at the prompt.

(in-package :ars-magna.cli)

;;; A script is a batch: each line has completed before the next is read, and the same lines and
;;; seed give the same run.

(defun script-path (name)
  (let ((path (native-path name)))
    (and (pathname-name path) (existing-path path))))

(defun open-script (name)
  "Return a stream of the lines of the script NAME; - is what is typed."
  (if (string= name "-")
      (standard-input *standard-output* t)
      (make-instance 'typed-text
                     :octets (open (or (script-path name)
                                       (reject-usage "There is no script ~A." name))
                                   :external-format :latin-1))))

(defun object-console ()
  "Return a console that turns what is written to it into objects on the standard output."
  (make-console (make-instance 'object-stream :stream (console-stream *standard-output*))))

(defun report-end (session status)
  "Report that SESSION is over, and the process will exit with STATUS. Return the status."
  (let ((status (if (console-trouble (session-console session)) (max 1 status) status)))
    (report-object (session-account session) "end" :status status
                                                   :errors (session-errors session))
    status))
