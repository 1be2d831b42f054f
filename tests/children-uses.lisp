;;;; children-uses.lisp -- what a child process returns, prints and leaves behind.

(in-package :ars-magna.tests)

(def-suite* children :in ars-magna)

;;; A Lisp with several threads cannot be forked, so these are skipped after tests that left some.

(defun play-child (name)
  (print name)
  (finish-output)
  (ecase name
    (:returns '(1 "two" (3)))
    (:errs (error "in vain"))
    (:ends (sb-ext:exit :code 0 :abort t))))

(defun outcome-of-children (names processes)
  "Return a list of lists (value output): what came of children that play NAMES."
  (call-with-children
   (lambda (value-of)
     (loop for name in names
           collect (let* ((value nil)
                          (output (with-output-to-string (*standard-output*)
                                    (setf value (funcall value-of name)))))
                     (list value output))))
   #'play-child names processes))

(test children.return-and-print
  "What a child returns and prints is had in whatever order it is asked for; one that ends before,
by an error or otherwise, returns NIL, and its output is not lost."
  (if (rest (bt:all-threads))
      (skip "There are several threads in this Lisp.")
      (dolist (processes '(1 2 5))
        (destructuring-bind (returned erred ended)
            (outcome-of-children '(:returns :errs :ends) processes)
          (is (equal '(1 "two" (3)) (first returned)))
          (is (search "RETURNS" (second returned)))
          (is (null (first erred)))
          (is (search "in vain" (second erred)))
          (is (null (first ended)))
          (is (search "ENDS" (second ended)))))))

(test children.that-end-fail
  "A suite whose process ends has failed."
  (let (counts)
    (is (search "FAILED geometry"
                (with-output-to-string (*standard-output*)
                  (setf counts (report-suite-of-child 'geometry nil)))))
    (is (equal '(0 1 0) counts))))
