;;;; faces.lisp -- the packages that users see: ARS, NISP and ARS-USER.

(defpackage :ars-magna.faces
  (:documentation "ARS and NISP, which export symbols of all layers; ARS-USER, which uses both.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:export #:cli #:define-user-package #:join-editors #:inspect-in-editor #:editor-server))

(in-package :ars-magna.faces)

(defun document-as-addition (symbol)
  "Say in all documentation of SYMBOL that SYMBOL is an addition to the manual."
  (dolist (kind '(function variable type))
    (let ((text (documentation symbol kind)))
      (when text
        (setf (documentation symbol kind) (addition-docstring text))))))

;;; Layers SETF what they read of a run; users must not, as no journal would know. So where a
;;; function can be set and is not marked as SETTABLE, a face has its own symbol for it.

(defun read-only-for-users-p (symbol)
  "True if users may call the function named SYMBOL but not SETF it. (The simulator's layers may.)"
  (and (fboundp `(setf ,symbol)) (not (settable-p symbol))))

(defun rejecting-setter (symbol)
  (lambda (value object)
    (declare (ignore value object))
    (reject-use "~(~A~) cannot be set. To change a run, use commands, or functions such as ~
                 PLACE-ROBOT, MOVE-THING and SET-ATTRIBUTE, which the journal records."
                symbol)))

(defun ensure-own-symbol (face name)
  (let ((present (find-symbol name face)))
    (unless (or (null present) (eq (find-package face) (symbol-package present)))
      (unintern present face))
    (intern name face)))

(defun ensure-read-only-reader (symbol face)
  "Return a symbol of FACE, a package, that names SYMBOL's function. Its SETF signals MISUSE."
  (let ((reader (ensure-own-symbol face (symbol-name symbol))))
    (setf (fdefinition reader) (fdefinition symbol)
          (documentation reader 'function) (documentation symbol 'function)
          (fdefinition `(setf ,reader)) (rejecting-setter symbol))
    reader))

(defun export-symbol (symbol face)
  "Make the package FACE export SYMBOL. If users must not SETF the function SYMBOL, export a symbol
of FACE that names the same function."
  (when (addition-p symbol) (document-as-addition symbol))
  (let ((shown (if (read-only-for-users-p symbol) (ensure-read-only-reader symbol face) symbol)))
    (shadowing-import (list shown) face)
    (export (list shown) face)))

(defun ensure-public-package (face documentation)
  "Return the package FACE, with DOCUMENTATION. It uses no other package."
  (let ((package (or (find-package face) (make-package face :use '()))))
    (setf (documentation package t) documentation)
    package))

(defparameter *public-packages*
  '((:ars . "The simulator as the manual describes it. It replaces CL:EQUAL and CL:MAP by extended
versions.")
    (:nisp . "The Nisp dialect and the plan language. It replaces CL:LET, CL:LOOP and CL:IF by
extended versions."))
  "The packages for users, with their documentation. Each exports the symbols marked for it.")

(defun export-all-marked-names ()
  (loop for (face . documentation) in *public-packages*
        do (unlock-package (ensure-public-package face documentation))
           (dolist (symbol (public-symbols face))
             (export-symbol symbol face))))

(defmacro export-marked-names ()
  "Define the packages ARS and NISP. They export the symbols that are marked when this form is
evaluated (see PUBLIC). See reading 29."
  '(eval-when (:compile-toplevel :load-toplevel :execute)
     (export-all-marked-names)))

;;; Locks. A user who by accident defines a function, type or variable called as one of ours is told
;;; so, instead of changing the simulator.

(defparameter *unlocked-packages*
  '("ARS-MAGNA.SLOTS" "ARS-MAGNA.BUILD" "ARS-MAGNA.TESTS" "ARS-MAGNA.CLI" "ARS-MAGNA.CLIM"
    "ARS-MAGNA.FIVEAM" "ARS-MAGNA.MANUAL")
  "Packages of the project that are not locked, because users' packages do not use them.")

(defun packages-to-lock ()
  "Return a list of the packages to lock: ARS, NISP and the packages of the layers. The packages of
slot accessors and of tools are not locked."
  (remove-if-not (lambda (package)
                   (let ((name (package-name package)))
                     (or (member name '("ARS" "NISP") :test #'string=)
                         (and (starts-with-subseq "ARS-MAGNA." name)
                              (not (member name *unlocked-packages* :test #'string=))))))
                 (list-all-packages)))

(defun lock-packages ()
  "Lock the simulator's packages, so that users cannot redefine its functions. Later definitions are
not marked as the simulator's."
  (setf *loading-simulator-p* nil)
  (mapc #'lock-package (packages-to-lock)))

(defun unlock-packages ()
  "Unlock the simulator's packages, so that the system can be loaded again."
  (setf *loading-simulator-p* t)
  (mapc #'unlock-package (packages-to-lock)))

;;; The prompt is a separate system, which nothing here depends on.

(public cli)
(defun cli (&rest options)
  "Run the command-line interface Robot> on the current simulation until QUIT or the end of input;
the simulator keeps running. OPTIONS are those of ARS-MAGNA.CLI:PROMPT. Loads the system
ars-magna/cli the first time. Returns nothing (manual A, E)."
  (unless (find-package :ars-magna.cli)
    (asdf:load-system "ars-magna/cli"))
  (apply (uiop:find-symbol* :prompt :ars-magna.cli) options))
