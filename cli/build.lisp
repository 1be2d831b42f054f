;;;; build.lisp -- compiles the project for ./cli/ars-magna and ./tests/run.

;;; Those scripts load this file into a bare SBCL. The environment says where compiled files go. For
;;; the tests, any warning ends the build with status 2, also that of an undefined function. It
;;; removes the project's compiled files, so that the next build finds it again. For users, who may
;;; have another SBCL, what ASDF accepts is accepted; the tests compile files with warnings again.

(require "asdf")

(defpackage :ars-magna.build
  (:documentation "Compiles the project, saves the prompt's core and runs the tests.")
  (:use :cl)
  (:export #:configure #:show-progress #:print-missing-libraries #:print-window-libraries
           #:get-window-libraries #:load-project #:load-strictly
           #:print-library-versions #:load-tests #:save-prompt #:save-window-prompt #:save-tests
           #:record-sessions #:write-manual))

(in-package :ars-magna.build)

(defvar *project-directory* (uiop:pathname-parent-directory-pathname
                             (uiop:pathname-directory-pathname *load-truename*))
  "The project's directory.")

(defun path-in-environment (name)
  "Return the native path in the environment variable NAME; NIL if it is unset or empty."
  (let ((value (uiop:getenvp name)))
    (and value (uiop:parse-native-namestring value))))

(defvar *cache-directory* (path-in-environment "ARS_MAGNA_CACHE")
  "The directory for all compiled files; NIL means ASDF's default cache.")

(defun project-fasl-directory ()
  (uiop:subpathname *cache-directory* "project/"))

(defun library-fasl-directory ()
  (uiop:subpathname *cache-directory* "libraries/"))

(defun configure ()
  "Make ASDF find this project and write compiled files into *CACHE-DIRECTORY*."
  (mapc #'asdf:register-immutable-system '("asdf" "uiop"))
  (asdf:initialize-source-registry
   `(:source-registry (:directory ,*project-directory*) :inherit-configuration))
  (when *cache-directory*
    (asdf:initialize-output-translations
     `(:output-translations
       (,(merge-pathnames "**/*.*" *project-directory*)
        ,(merge-pathnames "**/*.*" (project-fasl-directory)))
       (t (,(library-fasl-directory) :implementation))
       :ignore-inherited-configuration))))

(defun text-on-one-line (condition)
  (let ((words (uiop:split-string (princ-to-string condition) :separator '(#\Space #\Newline))))
    (format nil "~{~A~^ ~}" (remove "" words :test #'string=))))

(defun call-or-quit (function &optional (where ""))
  "Call FUNCTION. After an error, print WHERE and the error on one line, and exit with status 2."
  (handler-case (funcall function)
    (error (condition)
      (format t "~&~A~%" (text-on-one-line (format nil "~A~A" where condition)))
      (uiop:quit 2))))

(call-or-quit #'configure "ASDF's list of library directories cannot be read
(from CL_SOURCE_REGISTRY or files in ~/.config/common-lisp): ")

(load (uiop:subpathname *project-directory* "cli/prompt/clx.lisp"))
(load (uiop:subpathname *project-directory* "cli/prompt/compiling.lisp"))

;;; Libraries.

(defun library-missing-p (library)
  "True if ASDF cannot find LIBRARY. Signals an error if its system file does not define LIBRARY."
  (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream)))
    (not (or (asdf:find-system library nil)
             (let ((file (nth-value 2 (asdf:locate-system library))))
               (when file
                 (error "~A does not define ~A, and hides files that may. Correct or remove it."
                        (uiop:native-namestring file) library)))))))

(defun print-missing-libraries ()
  "Print, on one line, the libraries in the variable LIBRARIES of the environment that ASDF lacks."
  (call-or-quit
   (lambda ()
     (format t "~&missing: ~{~A ~}~%"
             (remove-if-not #'library-missing-p (uiop:split-string (uiop:getenv "LIBRARIES")))))))

(defun project-system-p (name)
  (string= (asdf:primary-system-name name) "ars-magna"))

(defun libraries (system)
  "Return the names of the libraries that SYSTEM needs itself or through the project's systems."
  (remove-duplicates
   (loop for name in (asdf:system-depends-on (asdf:find-system system))
         if (project-system-p name) append (libraries name) else collect name)
   :test #'string=))

(defun print-library-versions ()
  "Print the versions of the libraries that the simulator and its prompt use, on one line."
  (flet ((text (name)
           (format nil "~A ~A" name
                   (if (library-missing-p name)
                       "(not installed)"
                       (or (asdf:component-version (asdf:find-system name)) "(no version)")))))
    (call-or-quit
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

(defun component-files (component)
  (if (typep component 'asdf:parent-component)
      (mapcan #'component-files (asdf:component-children component))
      (list (asdf:component-pathname component))))

(defun library-files ()
  "Return the files of SBCL and of the loaded libraries, and Quicklisp's version files."
  (append (list sb-ext:*runtime-pathname* sb-ext:*core-pathname*)
          (loop for system in (loaded-libraries)
                collect (asdf:system-source-file system)
                append (component-files system))
          (directory (merge-pathnames "quicklisp/dists/*/distinfo.txt" (user-homedir-pathname)))))

(defun system-file-endings ()
  "Return the path endings of the files through which ASDF finds libraries."
  (remove-duplicates
   (cons "/source-registry.conf"
         (loop for system in (loaded-libraries)
               collect (format nil "/~A" (file-namestring (asdf:system-source-file system)))))
   :test #'string=))

(defun library-directories ()
  "Return lists (directory . options) of directories where ASDF and Quicklisp look for libraries,
and of ASDF's configuration directories. The options have ASDF's format."
  (flet ((tree (directory) (list directory :recurse t)))
    (append (remove *project-directory*
                    (uiop:symbol-call :asdf/source-registry :flatten-source-registry)
                    :key #'first :test #'equal)
            (mapcar #'tree (uiop:xdg-config-pathnames "common-lisp/"))
            (mapcar #'tree (uiop:system-config-pathnames "common-lisp/"))
            (list (tree (merge-pathnames "quicklisp/local-projects/" (user-homedir-pathname)))))))

(defun write-library-list (out)
  "Write a list for setup.sh to OUT: the library files and directories that this Lisp depends on."
  (flet ((note (kind path) (format out "~A ~A~%" kind (uiop:native-namestring path))))
    (dolist (path (library-files)) (note "file" path))
    (format out "~{name ~A~%~}" (system-file-endings))
    (loop for (directory . options) in (library-directories)
          do (note (if (getf options :recurse) "tree" "directory") directory))))

(defun save-library-list ()
  "Write the list of libraries to the file named in ARS_MAGNA_LIBRARIES, if that variable is set."
  (let ((file (path-in-environment "ARS_MAGNA_LIBRARIES")))
    (when file
      (ensure-directories-exist file)
      (with-open-file (out file :direction :output :if-exists :supersede)
        (write-library-list out)))))

;;; Compiling.

(defvar *progress-stream* nil "The stream on which to show which file is compiled, or NIL.")

(defun show-progress ()
  "From now on, show on the error output which file is compiled. Write errors to standard output."
  (setf *progress-stream* (shiftf *error-output* *standard-output*)))

(defun call-showing-progress (function system)
  "Call FUNCTION, which loads SYSTEM. Show which file is compiled, if SHOW-PROGRESS was called."
  (if *progress-stream*
      (uiop:symbol-call :ars-magna.compiling :call-showing-files function system *progress-stream*)
      (funcall function)))

(defun delete-fasls (fasls)
  (when *cache-directory*
    (uiop:delete-directory-tree fasls :validate t :if-does-not-exist :ignore)))

(defun print-condition-and-file (condition)
  (format t "~&*** ~A~@[ in ~A~]: ~A~%" (type-of condition)
          (or *compile-file-truename* *load-truename*) condition))

(defvar *start-time* (get-universal-time) "The universal time when this Lisp started.")

(defvar *damaged-fasls-p* nil "True if compiled files cannot be loaded.")

(defun loading-old-fasl-p ()
  "True while Lisp loads a compiled file that is older than this process."
  (and *load-truename*
       (equal "fasl" (pathname-type *load-truename*))
       (< (file-write-date *load-truename*) *start-time*)))

(defun warnings-marker-path ()
  "Return the path of a file that exists while the cache has fasls whose sources caused warnings."
  (merge-pathnames "warned" (project-fasl-directory)))

(defun make-warnings-marker ()
  (when *cache-directory*
    (ensure-directories-exist (warnings-marker-path))
    (with-open-file (out (warnings-marker-path) :direction :output :if-exists :append
                                                :if-does-not-exist :create)
      (declare (ignorable out)))))

(defun call-counting-warnings (function)
  "Call FUNCTION. Return the number of warnings, and true if FUNCTION signalled an error."
  (let ((count 0))
    (handler-bind ((sb-ext:compiler-note #'muffle-warning)
                   (warning (lambda (warning)
                              ;; SBCL itself muffles that compiling and loading define macros twice.
                              (unless (typep warning sb-ext:*muffled-warnings*)
                                (incf count)
                                (make-warnings-marker)
                                (print-condition-and-file warning))))
                   (error (lambda (condition)
                            (print-condition-and-file condition)
                            (setf *damaged-fasls-p* (or (typep condition 'sb-ext:invalid-fasl)
                                                        (loading-old-fasl-p)))
                            (return-from call-counting-warnings (values count t)))))
      (funcall function))
    (values count nil)))

(defun quit-after-failure ()
  "Delete the project's compiled files and exit. The status is 1 if these files were damaged and
compiling again may help, otherwise 2."
  (delete-fasls (project-fasl-directory))
  (uiop:quit (if *damaged-fasls-p* 1 2)))

(defun load-libraries (names)
  "Compile and load the libraries NAMES. After an error, delete the compiled files of all libraries
and try again. If the second try fails, too, exit with status 2."
  (flet ((load-them () (mapc #'asdf:load-system names)))
    (handler-case (load-them)
      (error (condition)
        (print-condition-and-file condition)
        (delete-fasls (library-fasl-directory))
        (handler-case (load-them)
          (error (condition)
            (print-condition-and-file condition)
            (uiop:quit 2)))))))

(defun load-project (system)
  "Compile and load SYSTEM, a system of the project. Exit if loading fails."
  (call-showing-progress
   (lambda ()
     (load-libraries (libraries system))
     (when (nth-value 1 (call-counting-warnings (lambda () (asdf:load-system system))))
       (quit-after-failure)))
   system)
  (save-library-list))

(defun load-strictly (system)
  "Compile and load SYSTEM like LOAD-PROJECT, but exit also after a warning in the project's files."
  (when (and *cache-directory* (probe-file (warnings-marker-path)))
    (delete-fasls (project-fasl-directory)))
  (call-showing-progress
   (lambda ()
     (load-libraries (libraries system))
     (let ((uiop:*compile-file-warnings-behaviour* :error)
           (uiop:*compile-file-failure-behaviour* :error))
       (multiple-value-bind (warnings failed-p)
           (call-counting-warnings (lambda () (asdf:load-system system)))
         (when (or failed-p (plusp warnings))
           (quit-after-failure)))))
   system)
  (save-library-list))

(defun load-tests ()
  "Compile and load the tests. If the window's libraries are installed, load its tests, too."
  (load-strictly "ars-magna/tests")
  (unless (some #'library-missing-p (libraries "ars-magna/clim-tests"))
    (load-strictly "ars-magna/clim-tests")))

;;; McCLIM, which only the window needs, is found by ASDF or by an installed Quicklisp.

(defun print-window-libraries ()
  "Print where McCLIM was found: asdf, quicklisp or nothing. If CLX does not work, print why."
  (call-or-quit
   (lambda ()
     (write-line (cond ((uiop:symbol-call :ars-magna.clx :clx-trouble))
                       ((not (library-missing-p "mcclim/looks")) "asdf")
                       ((uiop:symbol-call :ars-magna.clx :quicklisp-file) "quicklisp")
                       (t "nothing"))))))

(defun get-window-libraries ()
  "Load McCLIM through Quicklisp. If loading fails, print the reason and exit with status 1."
  (handler-case (call-showing-progress
                 (lambda () (uiop:symbol-call :ars-magna.clx :load-by-quicklisp))
                 "mcclim/looks")
    (error (condition)
      (format t "~&*** ~A~%" (text-on-one-line condition))
      (uiop:quit 1))))

;;; The prompt.

(defun save-core (main)
  "Save this Lisp in the file named in ARS_MAGNA_CORE, as a core that calls MAIN when it starts."
  ;; Files in the core must not be compiled again under its user.
  (mapc #'asdf:register-immutable-system (asdf:already-loaded-systems))
  (uiop:call-image-dump-hook)
  ;; The core keeps the streams of this process.
  (when *progress-stream* (setf *error-output* (shiftf *progress-stream* nil)))
  (sb-ext:save-lisp-and-die (path-in-environment "ARS_MAGNA_CORE") :toplevel main))

(defun save-prompt (&optional (system "ars-magna/cli"))
  "Save a core that runs the prompt, with SYSTEM loaded, in the file named in ARS_MAGNA_CORE."
  (load-project system)
  (uiop:symbol-call :ars-magna.cli :mark-process-as-own)
  (save-core (uiop:find-symbol* :main :ars-magna.cli)))

(defun save-window-prompt ()
  "Save a core of the prompt with McCLIM loaded, in the file named in ARS_MAGNA_CORE."
  (when (library-missing-p "mcclim/looks")
    (get-window-libraries))
  (save-prompt "ars-magna/clim"))

;;; The manual.

(defun write-manual ()
  "Write the manual into the directory named in ARS_MAGNA_MANUAL. Exit with status 1 on an error."
  (load-project "ars-magna/manual")
  (uiop:quit (uiop:symbol-call :ars-magna.manual :manual-main (uiop:getenv "ARS_MAGNA_MANUAL"))))

;;; The tests.

(defun run-tests ()
  "Run the tests: the first of this process's arguments is the seed, or nil; the others are names of
suites. Exit with status 1 if a check fails. The argument --probe only tests whether Lisp starts."
  (uiop:call-image-restore-hook)
  (configure)
  (destructuring-bind (seed &rest suites) (rest (uiop:raw-command-line-arguments))
    (when (string= "--probe" seed) (uiop:quit 0))
    (uiop:quit (if (uiop:symbol-call :ars-magna.tests :run-from-shell
                                     suites (parse-integer seed :junk-allowed t))
                   0
                   1))))

(defun save-tests ()
  "Save a core that runs the tests in the file named in ARS_MAGNA_CORE."
  (load-tests)
  (save-core #'run-tests))

(defun record-sessions (names)
  "Play the sessions NAMES of tests/newcomer, or all, and save their screens. Exit with status 1 if
a session does not get the text that it waits for."
  (load-strictly "ars-magna/tests")
  (uiop:quit (if (uiop:symbol-call :ars-magna.tests :record-sessions names) 0 1)))
