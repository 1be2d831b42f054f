;;;; ways-readme.lisp -- the examples of src/ways/README.md are correct.

(in-package :ars-magna.tests)

(def-suite* ways-readme :in ars-magna)

(test ways-readme.shows-what-is-so
  (let ((blocks (lisp-blocks (project-file "src/ways/README.md")))
        (*package* (find-package :ars-user))
        (base:*message-queue* (base:make-message-queue)))
    (unwind-protect
         (base:with-own-definitions ()
           (is (<= 7 (reduce #'+ (mapcar #'run-block blocks)))))
      (when (find-package :wayfarer) (delete-package :wayfarer)))))
