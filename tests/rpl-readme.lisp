;;;; rpl-readme.lisp -- the examples of rpl/README.md are correct and show every construct.

(in-package :ars-magna.tests)

(def-suite* rpl-readme :in ars-magna)

(defun rpl-readme () (project-file "rpl/README.md"))

(defun copied-table (table)
  (let ((copy (make-hash-table :test (hash-table-test table))))
    (maphash (lambda (key value) (setf (gethash key copy) value)) table)
    copy))

(defun call-with-plan-examples (function)
  "Call FUNCTION; forget the package of the README on plans, and what is defined there."
  (let ((*package* (find-package :ars-user))
        (base:*message-queue* (base:make-message-queue))
        (language::*constructs* language::*constructs*)
        (language::*plan-forms* (copied-table language::*plan-forms*)))
    (unwind-protect (base:with-own-definitions () (funcall function))
      (when (find-package :workshop) (delete-package :workshop)))))

(test rpl-readme.shows-what-is-so
  (let ((blocks (lisp-blocks (rpl-readme))))
    (is (< 20 (length blocks)))
    (call-with-plan-examples
     (lambda ()
       (is (< 20 (reduce #'+ (mapcar #'run-block blocks))))))))

(test rpl-readme.leaves-nothing-behind
  (let ((constructs (rpl:all-constructs)) (plans (rpl:all-procedures)))
    (call-with-plan-examples
     (lambda ()
       (mapc #'run-block (lisp-blocks (rpl-readme)))
       (is (< (length constructs) (length (rpl:all-constructs))))
       (is (< (length plans) (length (rpl:all-procedures))))))
    (is (equal constructs (rpl:all-constructs)))
    (is (equal plans (rpl:all-procedures)))))

(defun shown-p (start name text)
  "True if TEXT has START and NAME, and there NAME ends."
  (loop with words = (format nil "~A~(~A~)" start name)
        for position = (search words text) then (search words text :start2 (1+ position))
        while position
        thereis (find (char text (+ position (length words))) '(#\Space #\) #\Newline))))

(test rpl-readme.has-every-construct-with-an-example
  (let ((text (base:read-file-into-string (rpl-readme)))
        (examples (format nil "~{~A~}" (lisp-blocks (rpl-readme)))))
    (dolist (name (rpl:all-constructs))
      (is (shown-p "**`(" name text)
          "~(~A~) is not in rpl/README.md, as **`(~:*~(~A~) ...)`**" name)
      (is (shown-p "(" name examples) "~(~A~) has no example in rpl/README.md" name))))

(test rpl-readme.has-lines-to-be-read
  (dolist (line (file-lines (rpl-readme)))
    (unless (begins-with-p "|" line)
      (is (<= (length line) 112) "~A" line))))
