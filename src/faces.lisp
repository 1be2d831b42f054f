;;;; faces.lisp -- the packages that users see: ARS, NISP and ARS-USER.

(defpackage :ars-magna.faces
  (:documentation "Gathers the layers' symbols into the three packages that the manual knows.")
  (:use :cl :ars-magna.base)
  (:export #:cli #:define-user-package))

(in-package :ars-magna.faces)

(defun export-from (face layer names)
  "Import the external symbols of LAYER called NAMES into the package FACE, and export them."
  (dolist (name names)
    (multiple-value-bind (symbol status) (find-symbol (string name) layer)
      (unless (eq status :external)
        (reject-use "~A does not export ~A, which ~A should show." layer name face))
      (shadowing-import (list symbol) face)
      (export (list symbol) face))))

(defun ensure-face (face documentation)
  "Return the package FACE, with DOCUMENTATION; it uses no other."
  (let ((package (or (find-package face) (make-package face :use '()))))
    (setf (documentation package t) documentation)
    package))

(defmacro define-face (face documentation &body layers)
  "Define the package FACE, which exports what each of LAYERS, a list (layer name...), lists."
  `(eval-when (:compile-toplevel :load-toplevel :execute)
     (ensure-face ,face ,documentation)
     ,@(loop for (layer . names) in layers
             collect `(export-from ,face ,layer ',names))))

;;; The prompt is a system of its own, which nothing here depends on.

(defun cli (&rest options)
  "Run the command-line interface Robot> on the current simulation until QUIT or the end of input;
the simulator keeps running. OPTIONS are those of ARS-MAGNA.CLI:PROMPT. Loads the system
ars-magna/cli the first time. Returns nothing (manual A, E)."
  (unless (find-package :ars-magna.cli)
    (asdf:load-system "ars-magna/cli"))
  (apply (uiop:find-symbol* :prompt :ars-magna.cli) options))
