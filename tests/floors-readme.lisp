;;;; floors-readme.lisp -- the examples of src/floors/README.md and the shipped floor are correct.

(in-package :ars-magna.tests)

(in-suite floors)

(test floors-readme.shows-what-is-so
  (let ((blocks (lisp-blocks (project-file "src/floors/README.md")))
        (*package* (find-package :ars-user))
        (base:*message-queue* (base:make-message-queue)))
    (unwind-protect
         (base:with-own-definitions ()
           (is (<= 8 (reduce #'+ (mapcar #'run-block blocks)))))
      (when (find-package :surveyor) (delete-package :surveyor)))))

(test ward.is-as-drawn
  (base:with-own-definitions ()
    (call-in-directory
     (lambda (directory)
       (ars-worlds::write-ward-files directory)
       (dolist (name '("ward.yaml" "ward.pgm" "ward.svg" "ward-coarse.svg"))
         (is (equalp (floors::read-octets (merge-pathnames name directory) 10000000)
                     (floors::read-octets (project-file (format nil "worlds/floors/~A" name))
                                          10000000))
             "run ./worlds/figures: ~A is not as it would be drawn" name))))))
