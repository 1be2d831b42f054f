;;;; children.lisp -- suites in child processes, one per processor at a time.

(in-package :ars-magna.tests)

;;; A child is a forked copy of this Lisp after the tests have been loaded. It runs one suite, with
;;; a temporary directory of its own. It writes what it prints, and at the end what it returns, to
;;; files. So suites cannot disturb each other. A suite that ends its Lisp or fills its memory has
;;; failed; the others go on.

(defun child-directory (name root)
  (uiop:subpathname root (format nil "~(~A~)/" name)))

(defun child-file (kind name root)
  "Return the path of a file of the child NAME: its output or its value, by KIND."
  (uiop:subpathname root (format nil "~(~A.~A~)" name kind)))

(defun redirect (descriptor file flags)
  "Redirect the file descriptor DESCRIPTOR, a number, to FILE in this process and those it starts."
  (let ((opened (sb-posix:open (uiop:native-namestring file) flags #o600)))
    (sb-posix:dup2 opened descriptor)
    (sb-posix:close opened)))

(defun redirect-child (name root)
  (let ((directory (ensure-directories-exist (child-directory name root)))
        (writing (logior sb-posix:o-wronly sb-posix:o-creat sb-posix:o-append)))
    (redirect 0 #p"/dev/null" sb-posix:o-rdonly)
    (redirect 1 (child-file :output name root) writing)
    (redirect 2 (child-file :output name root) writing)
    (setf uiop:*temporary-directory* directory
          (uiop:getenv "TMPDIR") (string-right-trim "/" (uiop:native-namestring directory)))))

(defun write-value (value file)
  (with-open-file (out file :direction :output)
    (with-standard-io-syntax (prin1 value out))))

;; No handler here takes a condition: what tests make of one must not depend on who runs them.
(defun live-as-child (function name root)
  "Call FUNCTION, write its value to a file, and end this process."
  (unwind-protect
       (let ((*standard-output* uiop:*stdout*) (*error-output* uiop:*stderr*))
         (redirect-child name root)
         (handler-bind ((error (lambda (condition) (format uiop:*stdout* "~&~A~%" condition))))
           (write-value (funcall function) (child-file :value name root))))
    (finish-output uiop:*stdout*)
    (finish-output uiop:*stderr*)
    (sb-ext:exit :abort t)))

(defun start-child (function name root)
  "Start a process that calls FUNCTION. Return its number."
  (finish-output)
  (finish-output *error-output*)
  (let ((process (sb-posix:fork)))
    (when (zerop process) (live-as-child function name root))
    process))

(defun child-value (name root)
  "Return the value of the function of the child NAME, or NIL if it did not return. Print its
output."
  (let ((output (child-file :output name root))
        (value (child-file :value name root)))
    (when (probe-file output) (write-string (uiop:read-file-string output)))
    (and (probe-file value)
         (with-standard-io-syntax (uiop:read-file-form value)))))

(defun call-in-children (function names processes root)
  "Call FUNCTION with each of NAMES in a child, at most PROCESSES at once, in the order of NAMES.
Call the function returned with a name to wait for its child; it returns CHILD-VALUE."
  (let ((waiting names) (under-way '()) (ended '()))
    (labels ((start-next ()
               (loop while (and waiting (< (length under-way) processes))
                     do (let ((name (pop waiting)))
                          (push (cons (start-child (lambda () (funcall function name)) name root)
                                      name)
                                under-way))))
             (await-one ()
               (let* ((process (sb-posix:waitpid -1 0))
                      (child (assoc process under-way)))
                 (when child
                   (setf under-way (remove child under-way))
                   (push (cdr child) ended)
                   (start-next)))))
      (start-next)
      (lambda (name)
        (loop until (member name ended) do (await-one))
        (child-value name root)))))

(defun call-with-children (user function names processes)
  "Call USER with what CALL-IN-CHILDREN returns for the other arguments. What children leave is gone
afterwards."
  (experiment::call-with-temporary-directory
   (lambda (root) (funcall user (call-in-children function names processes root)))))
