;;;; faces.lisp -- the packages that users see: ARS, NISP and ARS-USER.

(defpackage :ars-magna.faces
  (:documentation "Gathers the layers' symbols into the three packages that the manual knows.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:export #:cli #:define-user-package #:join-editors #:inspect-in-editor #:editor-server))

(in-package :ars-magna.faces)

(defun tell-addition (symbol)
  "Let each documentation of SYMBOL say that it is an addition to the manual."
  (dolist (kind '(function variable type))
    (let ((text (documentation symbol kind)))
      (when text
        (setf (documentation symbol kind) (addition-text text))))))

;;; Layers SETF what they read of a run; users must not, as no journal would know. So where a
;;; function can be set and is not marked as SETTABLE, a face has its own symbol for it.

(defun only-read-p (symbol)
  "True if users may call the function called SYMBOL, but not SETF it, as layers do."
  (and (fboundp `(setf ,symbol)) (not (settable-p symbol))))

(defun reject-setting (symbol)
  "Return a function that signals MISUSE, for a SETF of SYMBOL."
  (lambda (value object)
    (declare (ignore value object))
    (reject-use "~(~A~) cannot be set. What belongs to a run is changed by commands, and by ~
                 functions such as PLACE-ROBOT, MOVE-THING and SET-ATTRIBUTE, which its journal ~
                 notes."
                symbol)))

(defun own-symbol-in (face name)
  "Return the symbol called NAME whose home is the package FACE."
  (let ((present (find-symbol name face)))
    (unless (or (null present) (eq (find-package face) (symbol-package present)))
      (unintern present face))
    (intern name face)))

(defun reader-in (symbol face)
  "Return a symbol of FACE that names the function of SYMBOL, and cannot be set."
  (let ((reader (own-symbol-in face (symbol-name symbol))))
    (setf (fdefinition reader) (fdefinition symbol)
          (documentation reader 'function) (documentation symbol 'function)
          (fdefinition `(setf ,reader)) (reject-setting symbol))
    reader))

(defun show (symbol face)
  "Let the package FACE export SYMBOL, or one that names the same function and cannot be set."
  (when (addition-p symbol) (tell-addition symbol))
  (let ((shown (if (only-read-p symbol) (reader-in symbol face) symbol)))
    (shadowing-import (list shown) face)
    (export (list shown) face)))

(defun ensure-face (face documentation)
  "Return the package FACE, with DOCUMENTATION; it uses no other."
  (let ((package (or (find-package face) (make-package face :use '()))))
    (setf (documentation package t) documentation)
    package))

(defparameter *faces*
  '((:ars . "The simulator as the manual describes it. It shadows CL:EQUAL and CL:MAP by
extensions.")
    (:nisp . "The Nisp dialect, which shadows CL:LET, CL:LOOP and CL:IF by extensions, and the plan
language."))
  "The packages that export what is marked for them, and their documentation.")

(defun fill-all-faces ()
  "Let each face export what is marked for it."
  (loop for (face . documentation) in *faces*
        do (unlock-package (ensure-face face documentation))
           (dolist (symbol (public-symbols face))
             (show symbol face))))

(defmacro fill-faces ()
  "Define the faces ARS and NISP: they export what is marked by now (see PUBLIC). See reading 29."
  '(eval-when (:compile-toplevel :load-toplevel :execute)
     (fill-all-faces)))

;;; Locks. A user who by accident defines a function, type or variable called as one of ours is told
;;; so, instead of changing the simulator.

(defparameter *open-packages*
  '("ARS-MAGNA.SLOTS" "ARS-MAGNA.BUILD" "ARS-MAGNA.TESTS" "ARS-MAGNA.CLI" "ARS-MAGNA.CLIM"
    "ARS-MAGNA.FIVEAM" "ARS-MAGNA.MANUAL")
  "Packages of the project that are not locked: nobody's names lead there.")

(defun our-packages ()
  "Return the faces and the layers' packages, but not that which slot accessors are interned in,
nor those of tools."
  (remove-if-not (lambda (package)
                   (let ((name (package-name package)))
                     (or (member name '("ARS" "NISP") :test #'string=)
                         (and (starts-with-subseq "ARS-MAGNA." name)
                              (not (member name *open-packages* :test #'string=))))))
                 (list-all-packages)))

(defun lock-packages ()
  "Keep users from redefining what is ours, and what they define from looking so."
  (setf *marking-p* nil)
  (mapc #'lock-package (our-packages)))

(defun unlock-packages ()
  "Let what is ours be redefined, as when the system is loaded again."
  (setf *marking-p* t)
  (mapc #'unlock-package (our-packages)))

;;; The prompt is a separate system, which nothing here depends on.

(public cli)
(defun cli (&rest options)
  "Run the command-line interface Robot> on the current simulation until QUIT or the end of input;
the simulator keeps running. OPTIONS are those of ARS-MAGNA.CLI:PROMPT. Loads the system
ars-magna/cli the first time. Returns nothing (manual A, E)."
  (unless (find-package :ars-magna.cli)
    (asdf:load-system "ars-magna/cli"))
  (apply (uiop:find-symbol* :prompt :ars-magna.cli) options))
