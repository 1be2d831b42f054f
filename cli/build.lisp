;;;; build.lisp -- compiles the project for ./cli/ars-magna and ./tests/run.

;;; Those scripts load this file into a bare SBCL. The environment says where compiled files go. For
;;; the tests, any warning ends the build with status 2, also that of an undefined function. It
;;; removes the project's compiled files, so that the next build finds it again. For users, who may
;;; have another SBCL, what ASDF accepts is accepted; the tests compile files again that had
;;; warnings then.

(require "asdf")

(defpackage :ars-magna.build
  (:documentation "Compiles the project, saves the prompt's core and runs the tests.")
  (:use :cl)
  (:export #:configure #:print-missing-libraries #:print-window-libraries #:get-window-libraries
           #:load-project #:load-strictly
           #:print-library-versions #:load-tests #:save-prompt #:save-window-prompt #:run-tests
           #:record-sessions #:write-manual))

(in-package :ars-magna.build)

(defvar *root* (uiop:pathname-parent-directory-pathname
                (uiop:pathname-directory-pathname *load-truename*))
  "The project's directory.")

(defun path-in-environment (name)
  "Return the native path in the environment variable NAME; NIL if it is unset or empty."
  (let ((value (uiop:getenvp name)))
    (and value (uiop:parse-native-namestring value))))

(defvar *cache* (path-in-environment "ARS_MAGNA_CACHE")
  "The directory for all compiled files; NIL means ASDF's default cache.")

(defun project-fasls ()
  (uiop:subpathname *cache* "project/"))

(defun library-fasls ()
  (uiop:subpathname *cache* "libraries/"))

(defun configure ()
  "Make ASDF find this project and write compiled files into *CACHE*."
  (mapc #'asdf:register-immutable-system '("asdf" "uiop"))
  (asdf:initialize-source-registry
   `(:source-registry (:directory ,*root*) :inherit-configuration))
  (when *cache*
    (asdf:initialize-output-translations
     `(:output-translations
       (,(merge-pathnames "**/*.*" *root*)
        ,(merge-pathnames "**/*.*" (project-fasls)))
       (t (,(library-fasls) :implementation))
       :ignore-inherited-configuration))))

(defun one-line (condition)
  "Return CONDITION, a condition or a string, as text on one line."
  (let ((words (uiop:split-string (princ-to-string condition) :separator '(#\Space #\Newline))))
    (format nil "~{~A~^ ~}" (remove "" words :test #'string=))))

(defun call-telling (function &optional (where ""))
  "Call FUNCTION. If FUNCTION signals an error, print WHERE and the error on one line, and exit with
status 2."
  (handler-case (funcall function)
    (error (condition)
      (format t "~&~A~%" (one-line (format nil "~A~A" where condition)))
      (uiop:quit 2))))

(call-telling #'configure "The places where ASDF looks for libraries cannot be read
(from CL_SOURCE_REGISTRY or files in ~/.config/common-lisp): ")

(load (uiop:subpathname *root* "cli/prompt/clx.lisp"))

;;; Libraries.

(defun missing-p (library)
  "True if ASDF cannot find LIBRARY. Signals an error if its system file does not define LIBRARY."
  (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream)))
    (not (or (asdf:find-system library nil)
             (let ((file (nth-value 2 (asdf:locate-system library))))
               (when file
                 (error "~A does not define ~A, and hides others that may. Mend or remove it."
                        (uiop:native-namestring file) library)))))))

(defun print-missing-libraries ()
  "Print, on one line, the libraries from the environment variable LIBRARIES that ASDF cannot find."
  (call-telling
   (lambda ()
     (format t "~&missing: ~{~A ~}~%"
             (remove-if-not #'missing-p (uiop:split-string (uiop:getenv "LIBRARIES")))))))

(defun project-system-p (name)
  (string= (asdf:primary-system-name name) "ars-magna"))

(defun libraries (system)
  "Return the names of the libraries that SYSTEM or the project's systems below it depend on."
  (remove-duplicates
   (loop for name in (asdf:system-depends-on (asdf:find-system system))
         if (project-system-p name) append (libraries name) else collect name)
   :test #'string=))

(defun print-library-versions ()
  "Print the versions of the libraries that the simulator and its prompt use, on one line."
  (flet ((text (name)
           (format nil "~A ~A" name
                   (if (missing-p name)
                       "(not installed)"
                       (or (asdf:component-version (asdf:find-system name)) "(no version)")))))
    (call-telling
     (lambda ()
       (format t "~{~A~^, ~}~%"
               (mapcar #'text
                       (remove-if (lambda (name) (eql 0 (search "sb-" name)))
                                  (sort (libraries "ars-magna/cli") #'string<))))))))

;;; The libraries that were loaded: library_state in setup.sh checks them at each start.

(defun loaded-libraries ()
  "Return the loaded systems, except the project's and those that come with SBCL."
  (remove-if (lambda (system)
               (or (null (asdf:system-source-file system))
                   (project-system-p (asdf:component-name system))))
             (mapcar #'asdf:find-system (asdf:already-loaded-systems))))

(defun files-of (component)
  (if (typep component 'asdf:parent-component)
      (mapcan #'files-of (asdf:component-children component))
      (list (asdf:component-pathname component))))

(defun library-files ()
  "Return the files of SBCL, of the loaded libraries, and of Quicklisp's installed versions."
  (append (list sb-ext:*runtime-pathname* sb-ext:*core-pathname*)
          (loop for system in (loaded-libraries)
                collect (asdf:system-source-file system)
                append (files-of system))
          (directory (merge-pathnames "quicklisp/dists/*/distinfo.txt" (user-homedir-pathname)))))

(defun library-names ()
  "Return the endings of the paths of files that determine which libraries ASDF finds."
  (remove-duplicates
   (cons "/source-registry.conf"
         (loop for system in (loaded-libraries)
               collect (format nil "/~A" (file-namestring (asdf:system-source-file system)))))
   :test #'string=))

(defun library-places ()
  "Return lists (directory . options) of directories where ASDF and Quicklisp look for libraries,
and of ASDF's configuration directories. The options are ASDF's."
  (flet ((tree (directory) (list directory :recurse t)))
    (append (remove *root* (uiop:symbol-call :asdf/source-registry :flatten-source-registry)
                    :key #'first :test #'equal)
            (mapcar #'tree (uiop:xdg-config-pathnames "common-lisp/"))
            (mapcar #'tree (uiop:system-config-pathnames "common-lisp/"))
            (list (tree (merge-pathnames "quicklisp/local-projects/" (user-homedir-pathname)))))))

(defun write-libraries (out)
  "Write to OUT the files and directories of libraries that this Lisp depends on, for setup.sh."
  (flet ((note (kind path) (format out "~A ~A~%" kind (uiop:native-namestring path))))
    (dolist (path (library-files)) (note "file" path))
    (format out "~{name ~A~%~}" (library-names))
    (loop for (directory . options) in (library-places)
          do (note (if (getf options :recurse) "tree" "directory") directory))))

(defun list-libraries ()
  "Write the list of libraries to the file named in ARS_MAGNA_LIBRARIES, if that variable is set."
  (let ((file (path-in-environment "ARS_MAGNA_LIBRARIES")))
    (when file
      (ensure-directories-exist file)
      (with-open-file (out file :direction :output :if-exists :supersede)
        (write-libraries out)))))

;;; Compiling.

(defun forget (fasls)
  "Delete FASLS, a directory of compiled files, if *CACHE* is set."
  (when *cache*
    (uiop:delete-directory-tree fasls :validate t :if-does-not-exist :ignore)))

(defun note-trouble (condition)
  (format t "~&*** ~A~@[ in ~A~]: ~A~%" (type-of condition)
          (or *compile-file-truename* *load-truename*) condition))

(defvar *began* (get-universal-time) "The universal time when this Lisp started.")

(defvar *damaged-p* nil "True if compiled files cannot be loaded.")

(defun loading-old-p ()
  "True while a compiled file is loaded that is older than this Lisp process."
  (and *load-truename*
       (equal "fasl" (pathname-type *load-truename*))
       (< (file-write-date *load-truename*) *began*)))

(defun warned-file ()
  "Return the path of a marker file. The file exists while the cache has compiled files of sources
that caused warnings."
  (merge-pathnames "warned" (project-fasls)))

(defun note-warned ()
  (when *cache*
    (ensure-directories-exist (warned-file))
    (with-open-file (out (warned-file) :direction :output :if-exists :append
                                       :if-does-not-exist :create)
      (declare (ignorable out)))))

(defun count-troubles (function)
  "Call FUNCTION. Return the number of warnings that FUNCTION signalled, and true if it signalled an
error."
  (let ((count 0))
    (handler-bind ((sb-ext:compiler-note #'muffle-warning)
                   (warning (lambda (warning)
                              ;; SBCL itself muffles that compiling and loading define macros twice.
                              (unless (typep warning sb-ext:*muffled-warnings*)
                                (incf count)
                                (note-warned)
                                (note-trouble warning))))
                   (error (lambda (condition)
                            (note-trouble condition)
                            (setf *damaged-p* (or (typep condition 'sb-ext:invalid-fasl)
                                                  (loading-old-p)))
                            (return-from count-troubles (values count t)))))
      (funcall function))
    (values count nil)))

(defun give-up ()
  "Delete the project's compiled files and exit. The status is 1 if these files were damaged, so
that compiling again may help, else 2."
  (forget (project-fasls))
  (uiop:quit (if *damaged-p* 1 2)))

(defun load-libraries (names)
  "Compile and load the libraries NAMES. After an error, delete the compiled files of all libraries
and try again. If the second try fails, too, exit with status 2."
  (flet ((load-them () (mapc #'asdf:load-system names)))
    (handler-case (load-them)
      (error (condition)
        (note-trouble condition)
        (forget (library-fasls))
        (handler-case (load-them)
          (error (condition)
            (note-trouble condition)
            (uiop:quit 2)))))))

(defun load-project (system)
  "Compile and load SYSTEM, a system of the project. Exit if that fails."
  (load-libraries (libraries system))
  (when (nth-value 1 (count-troubles (lambda () (asdf:load-system system))))
    (give-up))
  (list-libraries))

(defun load-strictly (system)
  "Compile and load SYSTEM like LOAD-PROJECT, but exit also after a warning in the project's files."
  (when (and *cache* (probe-file (warned-file)))
    (forget (project-fasls)))
  (load-libraries (libraries system))
  (let ((uiop:*compile-file-warnings-behaviour* :error)
        (uiop:*compile-file-failure-behaviour* :error))
    (multiple-value-bind (warnings failed-p)
        (count-troubles (lambda () (asdf:load-system system)))
      (when (or failed-p (plusp warnings))
        (give-up))))
  (list-libraries))

(defun load-tests ()
  "Compile and load the tests. If the window's libraries are installed, load its tests, too."
  (load-strictly "ars-magna/tests")
  (unless (some #'missing-p (libraries "ars-magna/clim-tests"))
    (load-strictly "ars-magna/clim-tests")))

;;; McCLIM, which only the window needs, is found by ASDF or by an installed Quicklisp.

(defun print-window-libraries ()
  "Print where McCLIM was found: asdf, quicklisp or nothing. If CLX does not work, print why."
  (call-telling
   (lambda ()
     (write-line (cond ((uiop:symbol-call :ars-magna.clx :clx-trouble))
                       ((not (missing-p "mcclim/looks")) "asdf")
                       ((uiop:symbol-call :ars-magna.clx :quicklisp-file) "quicklisp")
                       (t "nothing"))))))

(defun get-window-libraries ()
  "Load McCLIM through Quicklisp. If that fails, print the reason and exit with status 1."
  (handler-case (uiop:symbol-call :ars-magna.clx :load-by-quicklisp)
    (error (condition)
      (format t "~&*** ~A~%" (one-line condition))
      (uiop:quit 1))))

;;; The prompt.

(defun save-prompt (&optional (system "ars-magna/cli"))
  "Save a core with SYSTEM loaded that runs the prompt, in the file named in ARS_MAGNA_CORE."
  (load-project system)
  ;; Files in the core must not be compiled again under its user.
  (mapc #'asdf:register-immutable-system (asdf:already-loaded-systems))
  (uiop:call-image-dump-hook)
  (uiop:symbol-call :ars-magna.cli :make-process-own)
  (sb-ext:save-lisp-and-die (path-in-environment "ARS_MAGNA_CORE")
                            :toplevel (uiop:find-symbol* :main :ars-magna.cli)))

(defun save-window-prompt ()
  "Save a core of the prompt with McCLIM loaded, in the file named in ARS_MAGNA_CORE."
  (when (missing-p "mcclim/looks")
    (get-window-libraries))
  (save-prompt "ars-magna/clim"))

;;; The manual.

(defun write-manual ()
  "Write the manual into the directory named in ARS_MAGNA_MANUAL. Exit with status 1 after an
error."
  (load-project "ars-magna/manual")
  (uiop:quit (uiop:symbol-call :ars-magna.manual :main (uiop:getenv "ARS_MAGNA_MANUAL"))))

;;; The tests.

(defun run-tests (suites &optional seed)
  "Run SUITES, or all suites, shuffled if there is a SEED. Exit with status 1 if a check fails."
  (load-tests)
  (uiop:quit (if (uiop:symbol-call :ars-magna.tests :run-from-shell suites seed) 0 1)))

(defun record-sessions (names)
  "Record the screens of the newcomer's sessions NAMES, or of all sessions, in their files. Exit
with status 1 if a session does not get the text that it waits for."
  (load-strictly "ars-magna/tests")
  (uiop:quit (if (uiop:symbol-call :ars-magna.tests :record-sessions names) 0 1)))
