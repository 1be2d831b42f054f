;;;; finding.lisp -- which line command a user means.

(in-package :ars-magna.cli)

(defvar *aliases* '() "Lists (name text), in upper case and as typed: what ALIAS has defined.")

(defun all-lines ()
  "Return a list of all line commands: the prompt's own, then the robot's."
  (append *lines*
          (remove-if (lambda (line)
                       (find (line-name line) *lines* :key #'line-name :test #'string=))
                     (robot-lines))))

(defun all-line-names ()
  "Return a list of the names of all line commands, and of the functions that they stand for."
  (let ((lines (all-lines)))
    (remove-duplicates (append (mapcar #'line-name lines)
                               (remove nil (mapcar #'line-full-name (robot-lines))))
                       :test #'string= :from-end t)))

(defun lines-starting (start lines key)
  (remove-if-not (lambda (line)
                   (let ((name (funcall key line)))
                     (and name (starts-with-subseq start name))))
                 lines))

(defun reject-ambiguous (name lines)
  (reject-line "~A could be ~{~A~#[~; or ~:;, ~]~}. Type more of it." name
               (mapcar #'line-name lines)))

(defun reject-unknown (name)
  (reject-line "There is no command ~A.~@[ Did you mean ~A?~] HELP lists all commands." name
               (nearest-name name (append (mapcar #'first *aliases*) (all-line-names)))))

(defun beginning-of-all (lines)
  "Return the one of LINES with whose name those of all others begin, or NIL: STOP, not STOP-PLAN."
  (find-if (lambda (line)
             (every (lambda (other) (starts-with-subseq (line-name line) (line-name other))) lines))
           lines))

(defun complete-line (name)
  "Return the line command whose name, or else full name, begins with NAME: the only one, or the one
that all others go on from."
  (let ((candidates (or (lines-starting name (all-lines) #'line-name)
                        (lines-starting name (robot-lines) #'line-full-name))))
    (cond ((null candidates) (reject-unknown name))
          ((beginning-of-all candidates))
          (t (reject-ambiguous name candidates)))))

(defun find-line (name)
  "Return the line command called NAME, a string of any case: its name, the full name of a command's
function, or the beginning of a name; if several begin so, of the one that the others go on from.
Signals BAD-LINE."
  (let ((name (string-upcase name)))
    (or (find name (all-lines) :key #'line-name :test #'string=)
        (find name (robot-lines) :key #'line-full-name :test #'equal)
        (complete-line name))))
