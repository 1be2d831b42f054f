;;;; files.lisp -- files as the operating system knows them: their names, kinds and renaming.

(in-package :ars-magna.base)

;;; In a native name no character has a meaning of its own, as * has in one of Lisp's.

(defun native-name (path)
  "Return the name by which the operating system knows PATH, a pathname or string; NIL of NIL."
  (uiop:native-namestring path))

(defun native-path (name)
  "Return the pathname of what the operating system calls NAME, a string."
  (uiop:parse-native-namestring name))

(defun existing-path (path)
  "Return the truename of the file PATH, or NIL if there is none, or it is a directory."
  (uiop:file-exists-p path))

(defun replace-file (file by)
  "Let the file BY have the name FILE, in place of what is there, at one stroke. Both are pathnames
as they are, with nothing to be filled in. Signals an error if the system refuses."
  (sb-posix:rename (native-name by) (native-name file))
  (values))

(defun plain-file-p (path)
  "True if PATH is a file of bytes: no directory, device or pipe. Signals an error if there is
nothing."
  (= sb-posix:s-ifreg
     (logand sb-posix:s-ifmt (sb-posix:stat-mode (sb-posix:stat (native-name path))))))
