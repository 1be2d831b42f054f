;;;; loading.lisp -- DSKLAP, Nisp's loader, and where the simulator is installed (manual A).

(in-package :ars-magna.nisp)

(defun last-component (path)
  "Return what follows the last slash of the string PATH."
  (subseq path (1+ (or (position #\/ path :from-end t) -1))))

(defun lisp-file (path)
  "Return the Lisp file at PATH, with or without its type, or NIL."
  (let ((file (probe-file (merge-pathnames path (make-pathname :type "lisp")))))
    (and file (pathname-name file) file)))

(public dsklap)
(defun dsklap (path)
  "Load the Lisp file at PATH, or the ASDF system named by the last component of PATH, as in
(dsklap \"ars-dir/ars-magna\"). Return true. It is an error if there is
neither (manual A; reading 41)."
  (check-argument dsklap path (typep path '(or string pathname symbol)) "a path or a system's name")
  (let* ((path (if (pathnamep path) (namestring path) (string path)))
         (file (lisp-file path))
         (system (string-downcase (last-component path))))
    (cond (file (load file))
          ((asdf:find-system system nil) (asdf:load-system system) t)
          (t (reject-name "Lisp file or system" path '())))))

(defun define-logical-host ()
  "Let ARS: name the installation directory in logical pathnames (manual A)."
  (let ((system (asdf:find-system "ars-magna" nil)))
    (when system
      (setf (logical-pathname-translations "ARS")
            `(("**;*.*.*" ,(merge-pathnames "**/*.*" (asdf:system-source-directory system))))))))

(define-logical-host)
