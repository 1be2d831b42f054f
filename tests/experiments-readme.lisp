;;;; experiments-readme.lisp -- the examples of the pages on experiments are correct.

(in-package :ars-magna.tests)

(def-suite* experiments-readme :in ars-magna)

(defparameter *pages-on-experiments*
  '("src/experiment/README.md" "src/experiment/table/README.md")
  "The pages whose Lisp is run as one program.")

(test experiments-readme.shows-what-is-so
  (let ((blocks (mapcan (lambda (page) (lisp-blocks (project-file page))) *pages-on-experiments*))
        (*package* (find-package :ars-user))
        (base:*message-queue* (base:make-message-queue)))
    (is (<= 3 (length blocks)))
    (unwind-protect
         (base:with-own-definitions ()
           (is (<= 5 (reduce #'+ (mapcar #'run-block blocks)))))
      (when (find-package :question) (delete-package :question)))))
