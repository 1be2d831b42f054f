;;;; rpl-readme.lisp -- the pages on the plan language are right, and show every construct.

(in-package :ars-magna.tests)

(def-suite* rpl-readme :in ars-magna)

(defparameter *plan-pages*
  '("rpl/README.md" "rpl/fluents/README.md" "rpl/language/README.md" "rpl/constructs/README.md"
    "rpl/projecting/README.md" "worlds/how-to/thinking/README.md")
  "The pages that define or describe constructs.")

(defun plan-page-blocks ()
  (mapcan (lambda (page) (lisp-blocks (project-file page))) *plan-pages*))

(defun copied-table (table)
  (let ((copy (make-hash-table :test (hash-table-test table))))
    (maphash (lambda (key value) (setf (gethash key copy) value)) table)
    copy))

(defun call-with-plan-examples (function)
  "Call FUNCTION. Forget the packages and constructs that it defines."
  (let ((language::*constructs* language::*constructs*)
        (language::*plan-forms* (copied-table language::*plan-forms*)))
    (call-forgetting-packages function)))

(defun run-plan-page (page)
  "Run the Lisp of PAGE. Return how many results it checked."
  (reduce #'+ (mapcar #'run-block (lisp-blocks (project-file page)))))

(test rpl-readme.shows-what-is-so
  (dolist (page *plan-pages*)
    (call-with-plan-examples
     (lambda ()
       (is (< 0 (run-plan-page page)) page)))))

(test rpl-readme.leaves-nothing-behind
  (let ((constructs (rpl:all-constructs)) (plans (rpl:all-procedures)))
    (call-with-plan-examples
     (lambda ()
       (mapc #'run-plan-page '("rpl/README.md" "rpl/language/README.md"))
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
  (let ((text (format nil "~{~A~}" (mapcar (lambda (page)
                                             (base:read-file-into-string (project-file page)))
                                           *plan-pages*)))
        (examples (format nil "~{~A~}" (plan-page-blocks))))
    (dolist (name (rpl:all-constructs))
      (is (shown-p "**`(" name text)
          "~(~A~) is not in rpl/constructs/README.md, as **`(~:*~(~A~) ...)`**" name)
      (is (shown-p "(" name examples) "~(~A~) has no example on the pages on plans" name))))

(test rpl-readme.has-lines-to-be-read
  (dolist (page *plan-pages*)
    (dolist (line (file-lines (project-file page)))
      (unless (or (begins-with-p "|" line) (begins-with-p "![" line))
        (is (<= (length line) 112) "~A: ~A" page line)))))
