;;;; packages.lisp -- locks on packages, and their local nicknames.

(in-package :ars-magna.host)

(export '(lock-violation locked-symbol copy-nicknames))

;;; What a locked package has cannot be redefined by accident.

(deftype lock-violation ()
  "The condition that a name of a locked package was to be redefined."
  'sb-ext:package-lock-violation)

(defun locked-symbol (condition)
  "Return the symbol that CONDITION, a LOCK-VIOLATION, is about, or NIL if it is about no symbol."
  (ignore-errors (sb-ext:package-locked-error-symbol condition)))

(defun copy-nicknames (from to)
  "Let the package TO call others by the nicknames that are local to the package FROM."
  (loop for (nickname . other) in (sb-ext:package-local-nicknames from)
        do (sb-ext:add-package-local-nickname nickname other to)))
