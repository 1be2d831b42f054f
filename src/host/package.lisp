;;;; package.lisp -- the host layer: everything of SBCL that its manual does not document.

(defpackage :ars-magna.host
  (:documentation "The features of SBCL and of libraries that the simulator needs beyond Common
Lisp, one part per file: threads, files, the compiler. Only this folder uses undocumented functions
of SBCL.")
  (:use :cl)
  (:import-from :alexandria
                #:clamp #:ensure-list #:once-only #:parse-body #:removef
                #:with-gensyms #:symbolicate #:make-keyword #:hash-table-values
                #:ensure-gethash #:copy-array #:read-file-into-string #:starts-with-subseq
                #:ends-with #:ends-with-subseq #:define-constant #:proper-list-p
                #:parse-ordinary-lambda-list #:simple-style-warning)
  (:import-from :sb-ext
                #:compare-and-swap #:atomic-push #:atomic-incf #:atomic-decf
                #:package-locked-p #:lock-package #:unlock-package #:weak-pointer-p)
  (:import-from :sb-thread #:signal-semaphore #:thread-alive-p #:thread-name)
  (:export #:clamp #:ensure-list #:once-only #:parse-body #:removef #:with-gensyms #:symbolicate
           #:make-keyword #:hash-table-values #:ensure-gethash #:copy-array
           #:read-file-into-string #:starts-with-subseq #:ends-with #:ends-with-subseq
           #:define-constant #:proper-list-p #:parse-ordinary-lambda-list #:simple-style-warning
           #:compare-and-swap #:atomic-push #:atomic-incf #:atomic-decf
           #:package-locked-p #:lock-package #:unlock-package #:weak-pointer-p
           #:signal-semaphore #:thread-alive-p #:thread-name))

(in-package :ars-magna.host)

(export 'define-package)

(defmacro define-package (name &body options)
  "Define the package NAME as DEFPACKAGE does. The files of the package contain its exports.
Defining the package again, for example in an editor, keeps the exports."
  (let ((exported '()))
    (when (find-package name)
      (do-external-symbols (symbol name) (push (make-symbol (symbol-name symbol)) exported)))
    `(defpackage ,name ,@options (:export ,@exported))))
