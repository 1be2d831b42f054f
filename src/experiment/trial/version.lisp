;;;; version.lisp -- which simulator a trial ran in.

(in-package :ars-magna.experiment)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *deciding-folders*
    '("src/host/" "src/basics/" "src/definitions/" "src/copying/" "src/geometry/"
      "src/nisp/" "src/world/" "src/time/" "src/robot/" "src/command/" "src/run/"
      "rpl/fluents/" "rpl/tasks/" "rpl/language/" "rpl/constructs/" "rpl/robot/")
    "The folders of the simulator whose code decides what becomes of a run.")

  (defun digest-of-folders (root)
    "Return one number for all code in *DECIDING-FOLDERS* under ROOT."
    (ldb (byte 64 0)
         (loop for folder in *deciding-folders*
               sum (loop for file in (directory (merge-pathnames "*.lisp"
                                                                 (merge-pathnames folder root)))
                         sum (file-digest file))))))

;; All these files are compiled before this one, and it is compiled again when one of them is.
(defparameter *simulator-digest*
  (macrolet ((digest ()
               (digest-of-folders
                (merge-pathnames "../../../" (or *compile-file-truename* *load-truename*)))))
    (digest))
  "A number for the simulator's own code.")

(defparameter *simulator-version*
  (macrolet ((version () (asdf:component-version (asdf:find-system "ars-magna"))))
    (version))
  "The version that the system's definition gives.")
