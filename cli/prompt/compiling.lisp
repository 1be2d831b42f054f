;;;; compiling.lisp -- shows which file is compiled, while McCLIM and the project are compiled.

;;; cli/build.lisp, too, loads this file, into a bare SBCL.

(defpackage :ars-magna.compiling
  (:documentation "Counts the files that ASDF compiles, and shows the count.")
  (:use :cl)
  (:export #:call-counting-files #:call-showing-files))

(in-package :ars-magna.compiling)

(defvar *file-listener* nil
  "NIL, or a function to call with each file, an ASDF component, that is about to be compiled.")

(defmethod asdf:perform :before ((operation asdf:compile-op) (file asdf:cl-source-file))
  (when *file-listener* (funcall *file-listener* file)))

(defun count-files-to-compile (system)
  "Return how many files are compiled when SYSTEM is loaded, or NIL if a library is missing."
  (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream)))
    (ignore-errors
     (count-if (lambda (action)
                 (and (typep (car action) 'asdf:compile-op)
                      (typep (cdr action) 'asdf:cl-source-file)))
               (uiop:symbol-call :asdf/plan :plan-actions
                                (asdf:make-plan nil 'asdf:load-op system))))))

(defun call-counting-files (function system show)
  "Call FUNCTION, which loads SYSTEM. Before each file that is compiled, call the function SHOW with
a text that says which file it is."
  (let* ((count 0) (total (count-files-to-compile system))
         (*file-listener*
           (lambda (file)
             (incf count)
             ;; A library that is damaged is compiled twice.
             (funcall show (format nil "compiling file ~D~@[ of ~D~], in ~A"
                                   count (and total (max count total))
                                   (asdf:component-name (asdf:component-system file)))))))
    (funcall function)))

(defconstant +seconds-between-lines+ 30
  "The time between two lines that show progress where no user sits at a terminal.")

(defun rewrite-line (stream text width)
  "Write TEXT over the WIDTH characters of the last line of STREAM, a terminal."
  (format stream "~C~VA~C" #\Return width text #\Return)
  (finish-output stream))

(defun call-showing-files (function system stream)
  "Call FUNCTION, which loads SYSTEM. Show on STREAM what is compiled: on a terminal, in a line that
changes once a second, and otherwise in a line each half minute."
  (let* ((width 0) (terminal-p (interactive-stream-p stream))
         (pause (if terminal-p 1 +seconds-between-lines+))
         (due (+ pause (get-universal-time))))
    (flet ((show (text &aux (line (format nil "ars-magna: ~A" text)))
             (when (<= due (get-universal-time))
               (setf due (+ pause (get-universal-time)))
               (cond (terminal-p (rewrite-line stream line width)
                                 (setf width (length line)))
                     (t (write-line line stream)
                        (finish-output stream))))))
      (unwind-protect (call-counting-files function system #'show)
        (when (plusp width) (rewrite-line stream "" width))))))
