;;;; homes.lisp -- three users' worlds in packages of their own, side by side in one Lisp.

(in-package :ars-magna.tests)

(def-suite* homes :in ars-magna)

;;; The worlds in tests/homes share names on purpose: RED, ROOM, MAX, STEP and more. Each file
;;; defines a package with the functions CHECK, headless, and LIVE-CHECK. Both return a list of the
;;; claims that do not hold, or NIL.

(defparameter *homes* '("bakery" "ward" "workshop"))

(defun load-home (name)
  "Load the world called NAME as a user does, with that user's readtable left behind in the file."
  (let ((*package* (find-package :ars-user)) (*readtable* (copy-readtable *readtable*)))
    (load (project-file (format nil "tests/homes/~A.lisp" name)))))

(defun claims-of (name function)
  "Return what FUNCTION, named by a string, of the world NAME does not find as it should be."
  (let ((*package* (find-package (string-upcase name))))
    (funcall (find-symbol function *package*))))

(defmacro with-homes ((&rest names) &body body)
  "Run BODY with the worlds called NAMES loaded in turn; forget them and their packages."
  `(unwind-protect
        (with-own-definitions
          (let ((warnings (warnings-of (lambda () (mapc #'load-home ',names)))))
            (is (null warnings) "~{~A~%~}" warnings))
          ,@body)
     (dolist (package (remove-duplicates ',names :test #'string=))
       (when (find-package (string-upcase package))
         (delete-package (string-upcase package))))))

(defun check-homes (names)
  (dolist (name names)
    (dolist (function '("CHECK" "LIVE-CHECK" "CHECK"))
      (is (null (claims-of name function)) "~A in ~A" function name))))

(test homes.each-works-alone
  (with-homes ("bakery") (check-homes '("bakery")))
  (with-homes ("ward") (check-homes '("ward")))
  (with-homes ("workshop") (check-homes '("workshop"))))

(test homes.all-work-side-by-side
  "In any order, and when they are loaded once more."
  (with-homes ("bakery" "ward" "workshop" "bakery" "ward" "workshop")
    (check-homes *homes*)
    (check-homes (reverse *homes*)))
  (with-homes ("workshop" "ward" "bakery")
    (check-homes *homes*)))
