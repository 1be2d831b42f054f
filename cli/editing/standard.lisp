;;;; standard.lisp -- what is typed into this process: edited, where somebody sits at a terminal.

(in-package :ars-magna.cli)

(export '(take-waiting))

;;; A terminal that obeys nothing, such as a buffer of Emacs, edits lines itself.

(defun obeying-terminal-p (stream)
  "True if STREAM, of this process, is a terminal that moves its cursor when it is told to."
  (and (interactive-stream-p stream)
       (not (member (environment-value "TERM") '(nil "" "dumb" "unknown") :test #'equal))))

(defun standard-output ()
  (let ((stream (text-output 1)))
    (make-console stream (and (obeying-terminal-p stream) #'window-size))))

(defun file-for-history ()
  "Return the pathname of the file that the environment names for what was typed, or NIL."
  (let ((name (environment-value "ARS_MAGNA_HISTORY")))
    (and name (string/= name "") (native-path name))))

(defun standard-input (console plain)
  "Return what is typed into this process. It is edited on CONSOLE if that is possible, unless PLAIN
is true."
  (let ((octets (octet-input 0)))
    (if (and (not plain) (console-window console) (obeying-terminal-p octets))
        (make-instance 'edited-text :octets octets :by-hand-p t :console console
                                    :history (make-history (file-for-history)))
        (make-instance 'typed-text :octets octets :by-hand-p (interactive-stream-p octets)))))

(defgeneric call-typing (function input)
  (:documentation "Call FUNCTION, which reads lines from INPUT.")
  (:method (function input)
    (declare (ignore input))
    (funcall function))
  (:method (function (input edited-text))
    (let ((console (edited-console input)))
      (unwind-protect (progn (tell-pastes-apart console t)
                             (call-handing-over-keys function))
        (save-entry (edited-history input))
        (answered console)
        (tell-pastes-apart console nil)))))

(defgeneric keep-lines (input)
  (:documentation "Let no line that was typed into INPUT be lost, whatever becomes of this
process.")
  (:method (input))
  (:method ((input edited-text)) (save-entry (edited-history input))))

(defgeneric remember-line (input line before)
  (:documentation "Let whoever types into INPUT have LINE again, together with the text BEFORE, if
that is not NIL.")
  (:method (input line before)
    (declare (ignore input line before)))
  (:method ((input edited-text) line before)
    (if before
        (amend-entry (edited-history input) line before)
        (add-entry (edited-history input) line))))

;;; A terminal may paste without saying so, as those do that edit lines themselves. What comes all
;;; at once, with more than a line, is counted as pasted, too: nobody types as fast, but while
;;; nothing was read.

(defgeneric pasted-lines-left-p (input)
  (:documentation "True if lines that were pasted into INPUT, with the one read last, wait to be
read.")
  (:method (input)
    (declare (ignore input))
    nil)
  (:method ((input typed-text))
    (and (typed-by-hand-p input)
         (typed-followed-p input)
         (more-at-once-p (typed-octets input))))
  (:method ((input edited-text))
    (and (or (edited-lines input) (whole-line-p (edited-ahead input))) t)))

(defgeneric take-waiting (input)
  (:documentation "Return the lines that wait to be read of INPUT, and leave them unread.")
  (:method (input)
    (declare (ignore input))
    '())
  (:method ((input edited-text))
    (setf (typed-position input) (length (typed-line input)))
    (append (shiftf (edited-lines input) '()) (take-lines-ahead input))))

(defun take-lines-ahead (input)
  "Return the lines that came into INPUT all at once with the one read last, and leave them unread.
What is no whole line is being typed."
  (when (whole-line-p (edited-ahead input))
    (let ((ahead (ahead-in (coerce (take-all-octets (edited-ahead input)) 'string) '())))
      (unless (string= "" (ahead-text ahead))
        (setf (edited-put-off input) (list (ahead-text ahead) (ahead-point ahead))))
      (ahead-lines ahead))))

(defgeneric swallow-key (input)
  (:documentation "Take the key that was pressed in INPUT; but leave it to be read if more was typed
or pasted with it.")
  (:method (input) (clear-input input))
  (:method ((input edited-text))
    (let* ((octets (octets-come input)) (next (text-reader (coerce octets 'string))))
      (read-key next)
      (when (funcall next) (add-octets (edited-ahead input) octets)))))

(defun drop-waiting (input)
  "Leave the lines that wait to be read of INPUT; the history has them as one entry. Return how many
there were."
  (let ((lines (take-waiting input)))
    (when lines (remember-line input (format nil "~{~A~^~%~}" lines) nil))
    (length lines)))
