;;;; known-types.lisp -- the types that programs use, by name.

(in-package :ars-magna.nisp)

;;; Types are known by name, whatever package it was read in. A layer registers a type when it
;;; is loaded; after that the registry is only read.

(defstruct (nisp-type (:constructor make-nisp-type (name)) (:copier nil))
  "What is known of the type called NAME. CLASS is its Lisp name, if it has registered slots;
SLOTS an alist from slot names to reader functions' names; MAKER a function or NIL."
  (name "" :type string :read-only t)
  (class nil :type symbol)
  (slots '() :type list)
  (maker nil :type (or null function))
  (parameters '() :type list))

(defvar *nisp-types* (make-hash-table :test 'equal)
  "All registered types by name.")

(defun find-nisp-type (name)
  (values (gethash (string name) *nisp-types*)))

(defun ensure-nisp-type (name)
  (or (find-nisp-type name)
      (setf (gethash (string name) *nisp-types*) (make-nisp-type (string name)))))

(defun names-of-classes (package)
  "Return the names of the classes that PACKAGE, the name of a package or nothing's, offers."
  (and (find-package package)
       (loop for symbol being the external-symbols of package
             when (find-class symbol nil) collect (symbol-name symbol))))

(defun known-types ()
  "Return the names of the types that programs use, in order: those registered, and classes that
the packages of users have."
  (sort (remove-duplicates (append (loop for name being the hash-keys of *nisp-types* collect name)
                                   (names-of-classes "NISP")
                                   (names-of-classes "ARS"))
                           :test #'string=)
        #'string<))
