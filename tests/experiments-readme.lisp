;;;; experiments-readme.lisp -- the examples of src/experiment/README.md are correct.

(in-package :ars-magna.tests)

(def-suite* experiments-readme :in ars-magna)

(test experiments-readme.shows-what-is-so
  (let ((blocks (lisp-blocks (project-file "src/experiment/README.md")))
        (*package* (find-package :ars-user))
        (base:*message-queue* (base:make-message-queue)))
    (is (<= 4 (length blocks)))
    (unwind-protect
         (base:with-own-definitions ()
           (is (<= 4 (reduce #'+ (mapcar #'run-block blocks)))))
      (when (find-package :question) (delete-package :question)))))
