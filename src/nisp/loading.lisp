;;;; loading.lisp -- DSKLAP, Nisp's loader, and where the simulator is installed (manual A).

(in-package :ars-magna.nisp)

(public dsklap)
(defun dsklap (path)
  "Load the Lisp file at PATH, or the ASDF system named by the last component of PATH, as in
(dsklap \"ars-dir/ars-magna\"). Return true. It is an error if there is
neither (manual A; reading 41)."
  (check-argument dsklap path (typep path '(or string pathname symbol)) "a path or a system's name")
  (let* ((path (if (pathnamep path) (namestring path) (string path)))
         (file (probe-file (merge-pathnames path (make-pathname :type "lisp"))))
         (slash (position #\/ path :from-end t))
         (system (string-downcase (subseq path (if slash (1+ slash) 0)))))
    (cond ((and file (pathname-name file)) (load file))
          ((asdf:find-system system nil) (asdf:load-system system) t)
          (t (reject-name "Lisp file or system" path '())))))

;; ARS: is the installation directory in logical pathnames (manual A).
(let ((system (asdf:find-system "ars-magna" nil)))
  (when system
    (setf (logical-pathname-translations "ARS")
          `(("**;*.*.*" ,(merge-pathnames "**/*.*" (asdf:system-source-directory system)))))))

;;; What ASDF compiles while Nisp's syntax is current is read as anywhere else.

;;; ASDF keeps what it compiles, for all Lisps of the user. Files are read in the syntax and package
;;; that are current until they say otherwise; so whoever asks for a library after
;;; (in-readtable :nisp) would have it compiled in Nisp's syntax, and have it so ever after.

(defvar *library-readtable* (copy-readtable nil)
  "The syntax of files of systems that say nothing of theirs, if Nisp's is current. It is one, since
there are libraries of which one file adds to the syntax of the next.")

(defun nisp-syntax-p (readtable)
  (eq (get-macro-character #\! (find-readtable :nisp)) (get-macro-character #\! readtable)))

(defmethod asdf:perform :around ((operation asdf:operation) (component asdf:cl-source-file))
  (if (nisp-syntax-p *readtable*)
      (let ((*readtable* *library-readtable*)
            (*package* (find-package :cl-user)))
        (call-next-method))
      (call-next-method)))
