;;;; screens.lisp -- compares screens with screens/*.txt; masks what depends on the machine.

(in-package :ars-magna.tests)

;;; A screen is compared after the texts that its session waits for have come. If it differs, it is
;;; compared again a little later, as the last letters of a line may still be missing. A message of
;;; a live robot may come before or after the prompt of the next line: both are as they should be.

(defparameter *grace* 2 "For how many seconds nothing comes on a screen that is as it will be.")

(defvar *recording-p* nil
  "True if screens are written into their files instead of being held against them.")

(defun masks (home)
  "Return the replacements for screens of a terminal with the home directory HOME: a list of lists
(text replacement)."
  (list (list home "<home>/")
        (list (string-right-trim "/" (base:native-name (project-file ""))) "<checkout>")
        (list (format nil "SBCL ~A" (lisp-implementation-version)) "SBCL <version>")))

(defun without-addresses (line)
  "Return LINE with * for where in memory something is that is printed, as in #<THING
{1001BCB383}>."
  (let* ((start (search " {" line)) (end (and start (search "}>" line :start2 start))))
    (if end
        (uiop:strcat (subseq line 0 (+ start 2)) "*" (without-addresses (subseq line end)))
        line)))

(defun masked (line home)
  "Return LINE with what depends on the machine replaced."
  (loop for (text mask) in (masks home)
        do (setf line (uiop:frob-substrings line (list text) mask)))
  (without-addresses line))

(defun masked-screen (terminal)
  (loop for line in (screen-lines terminal)
        collect (masked line (terminal-home terminal))))

(defun texts-in (directory)
  "Return the names of the texts in DIRECTORY, of tests/newcomer, in alphabetical order."
  (sort (mapcar #'pathname-name
                (uiop:directory-files (project-file (format nil "tests/newcomer/~A/" directory))))
        #'string<))

(defun screen-file (name)
  (project-file (format nil "tests/newcomer/screens/~A.txt" name)))

(defun held-screen (name)
  "Return the lines of the screen NAME as its file has them."
  (let ((file (screen-file name)))
    (and (probe-file file) (file-lines file))))

(defun record-screen (name terminal)
  (await-quiet terminal)
  (with-open-file (out (screen-file name) :direction :output :if-exists :supersede
                                          :external-format :utf-8)
    (format out "~{~A~%~}" (masked-screen terminal))))

(defun await-quiet (terminal)
  "Wait until nothing has been written on the screen for *GRACE* seconds."
  (handler-case
      (loop (host:waiting-at-most (*grace*) (await-news terminal)))
    (host:deadline-passed () nil)))

(defun without-prompt (line)
  "Return LINE without its prompt if a message of a robot follows that."
  (multiple-value-bind (prompt text) (prompt-of line)
    (if (and prompt (message-p text)) text line)))

(defun await-screen (name terminal)
  "True if the screen is as the file of NAME has it, at last when nothing has come for *GRACE*
seconds."
  (flet ((as-held-p ()
           (equal (mapcar #'without-prompt (held-screen name))
                  (mapcar #'without-prompt (masked-screen terminal)))))
    (or (as-held-p)
        (progn (await-quiet terminal) (as-held-p)))))

(defun screen-trouble (name terminal)
  "Return how the screen differs from the file of NAME, a string, or NIL if it does not. While
recording, it does not."
  (cond (*recording-p* (record-screen name terminal) nil)
        ((await-screen name terminal) nil)
        (t (format nil "~A.txt is~%~{|~A~%~}but the screen~%~{|~A~%~}If that is as it should be: ~
                        ./tests/newcomer/record"
                   name (held-screen name) (masked-screen terminal)))))
