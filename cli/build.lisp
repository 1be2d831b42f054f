;;;; build.lisp -- compiles the project for ./cli/ars-magna and ./tests/run.

;;; Those scripts load this file into a bare SBCL. The environment says where compiled files go. For
;;; the tests, any warning ends the build with status 2, also that of an undefined function. It
;;; removes the project's compiled files, so that the next build finds it again. For users, who may
;;; have another SBCL, what ASDF accepts is accepted; the tests compile files again that had
;;; warnings then.

(require "asdf")

(defpackage :ars-magna.build
  (:documentation "Compiling, saving the prompt's core, running the tests.")
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
  "Return the path that the environment's variable NAME has as the system writes it, or NIL."
  (let ((value (uiop:getenvp name)))
    (and value (uiop:parse-native-namestring value))))

(defvar *cache* (path-in-environment "ARS_MAGNA_CACHE")
  "The directory of all compiled files; NIL means ASDF's own.")

(defun project-fasls ()
  (uiop:subpathname *cache* "project/"))

(defun library-fasls ()
  (uiop:subpathname *cache* "libraries/"))

(defun configure ()
  "Make ASDF find the project here and put compiled files into the cache."
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
  "Return the text of CONDITION, or a text itself, on one line."
  (let ((words (uiop:split-string (princ-to-string condition) :separator '(#\Space #\Newline))))
    (format nil "~{~A~^ ~}" (remove "" words :test #'string=))))

(defun call-telling (function &optional (where ""))
  "Call FUNCTION. If an error ends it, print WHERE and the error on one line, and end this Lisp."
  (handler-case (funcall function)
    (error (condition)
      (format t "~&~A~%" (one-line (format nil "~A~A" where condition)))
      (uiop:quit 2))))

(call-telling #'configure "The places where ASDF looks for libraries cannot be read
(from CL_SOURCE_REGISTRY or files in ~/.config/common-lisp): ")

(load (uiop:subpathname *root* "cli/prompt/clx.lisp"))

;;; Libraries.

(defun missing-p (library)
  "True if ASDF cannot find LIBRARY. A file that should define it, and does not, is an error."
  (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream)))
    (not (or (asdf:find-system library nil)
             (let ((file (nth-value 2 (asdf:locate-system library))))
               (when file
                 (error "~A does not define ~A, and hides others that may. Mend or remove it."
                        (uiop:native-namestring file) library)))))))

(defun print-missing-libraries ()
  "Print on a line which of the libraries named in the environment ASDF cannot find."
  (call-telling
   (lambda ()
     (format t "~&missing: ~{~A ~}~%"
             (remove-if-not #'missing-p (uiop:split-string (uiop:getenv "LIBRARIES")))))))

(defun project-system-p (name)
  (string= (asdf:primary-system-name name) "ars-magna"))

(defun libraries (system)
  "Return the names of the libraries that SYSTEM stands on, through the project's systems."
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
  "Return the systems that are loaded, but for the project's and those that SBCL comes with."
  (remove-if (lambda (system)
               (or (null (asdf:system-source-file system))
                   (project-system-p (asdf:component-name system))))
             (mapcar #'asdf:find-system (asdf:already-loaded-systems))))

(defun files-of (component)
  (if (typep component 'asdf:parent-component)
      (mapcan #'files-of (asdf:component-children component))
      (list (asdf:component-pathname component))))

(defun library-files ()
  "Return the files of SBCL and of the loaded libraries, and those that say Quicklisp's versions."
  (append (list sb-ext:*runtime-pathname* sb-ext:*core-pathname*)
          (loop for system in (loaded-libraries)
                collect (asdf:system-source-file system)
                append (files-of system))
          (directory (merge-pathnames "quicklisp/dists/*/distinfo.txt" (user-homedir-pathname)))))

(defun library-names ()
  "Return how the paths of files end that decide which libraries ASDF finds."
  (remove-duplicates
   (cons "/source-registry.conf"
         (loop for system in (loaded-libraries)
               collect (format nil "/~A" (file-namestring (asdf:system-source-file system)))))
   :test #'string=))

(defun library-places ()
  "Return lists (directory . options), as ASDF has them, that say where it looks for libraries and
for what it is told about that, and where Quicklisp does."
  (flet ((tree (directory) (list directory :recurse t)))
    (append (remove *root* (uiop:symbol-call :asdf/source-registry :flatten-source-registry)
                    :key #'first :test #'equal)
            (mapcar #'tree (uiop:xdg-config-pathnames "common-lisp/"))
            (mapcar #'tree (uiop:system-config-pathnames "common-lisp/"))
            (list (tree (merge-pathnames "quicklisp/local-projects/" (user-homedir-pathname)))))))

(defun write-libraries (out)
  "Write to OUT what this Lisp depends on besides the project, as setup.sh says."
  (flet ((note (kind path) (format out "~A ~A~%" kind (uiop:native-namestring path))))
    (dolist (path (library-files)) (note "file" path))
    (format out "~{name ~A~%~}" (library-names))
    (loop for (directory . options) in (library-places)
          do (note (if (getf options :recurse) "tree" "directory") directory))))

(defun list-libraries ()
  "Write the list of libraries into the file that the environment names, if it names one."
  (let ((file (path-in-environment "ARS_MAGNA_LIBRARIES")))
    (when file
      (ensure-directories-exist file)
      (with-open-file (out file :direction :output :if-exists :supersede)
        (write-libraries out)))))

;;; Compiling.

(defun forget (fasls)
  "Delete the directory FASLS, of compiled files, if they are ours."
  (when *cache*
    (uiop:delete-directory-tree fasls :validate t :if-does-not-exist :ignore)))

(defun note-trouble (condition)
  (format t "~&*** ~A~@[ in ~A~]: ~A~%" (type-of condition)
          (or *compile-file-truename* *load-truename*) condition))

(defvar *began* (get-universal-time) "When this Lisp has begun.")

(defvar *damaged-p* nil "True if compiled files cannot be loaded.")

(defun loading-old-p ()
  "True while a file is loaded that was compiled before this Lisp began."
  (and *load-truename*
       (equal "fasl" (pathname-type *load-truename*))
       (< (file-write-date *load-truename*) *began*)))

(defun warned-file ()
  "Return the file that is there while compiled files are there whose sources were warned of."
  (merge-pathnames "warned" (project-fasls)))

(defun note-warned ()
  (when *cache*
    (ensure-directories-exist (warned-file))
    (with-open-file (out (warned-file) :direction :output :if-exists :append
                                       :if-does-not-exist :create)
      (declare (ignorable out)))))

(defun count-troubles (function)
  "Call FUNCTION. Return how many warnings it signalled, and true if an error has ended it."
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
  "End this Lisp, with status 2 if sources are at fault; else it may be that compiling helps."
  (forget (project-fasls))
  (uiop:quit (if *damaged-p* 1 2)))

(defun load-libraries (names)
  "Compile and load the libraries called NAMES; anew, if what was compiled of them is damaged. If
that fails, too, end this Lisp with status 2: one of them does not compile, or is missing."
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
  "Compile and load SYSTEM, one of the project's. If that fails, end this Lisp."
  (load-libraries (libraries system))
  (when (nth-value 1 (count-troubles (lambda () (asdf:load-system system))))
    (give-up))
  (list-libraries))

(defun load-strictly (system)
  "Compile and load SYSTEM as LOAD-PROJECT does; a warning in any file of the project is an error."
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
  "Compile and load the tests, and those of the window where there is what it needs."
  (load-strictly "ars-magna/tests")
  (unless (some #'missing-p (libraries "ars-magna/clim-tests"))
    (load-strictly "ars-magna/clim-tests")))

;;; McCLIM, which only the window needs, is found by ASDF or by an installed Quicklisp.

(defun print-window-libraries ()
  "Print where McCLIM can be found: asdf, quicklisp or nothing; or why CLX does not work."
  (call-telling
   (lambda ()
     (write-line (cond ((uiop:symbol-call :ars-magna.clx :clx-trouble))
                       ((not (missing-p "mcclim/looks")) "asdf")
                       ((uiop:symbol-call :ars-magna.clx :quicklisp-file) "quicklisp")
                       (t "nothing"))))))

(defun get-window-libraries ()
  "Load McCLIM; Quicklisp fetches it if needed. If that fails, print why and end this Lisp."
  (handler-case (uiop:symbol-call :ars-magna.clx :get-by-quicklisp)
    (error (condition)
      (format t "~&*** ~A~%" (one-line condition))
      (uiop:quit 1))))

;;; The prompt.

(defun save-prompt (&optional (system "ars-magna/cli"))
  "Save a core that runs the prompt, with SYSTEM, in the file named in the environment."
  (load-project system)
  ;; Files in the core must not be compiled again under its user.
  (mapc #'asdf:register-immutable-system (asdf:already-loaded-systems))
  (uiop:call-image-dump-hook)
  (uiop:symbol-call :ars-magna.cli :make-process-own)
  (sb-ext:save-lisp-and-die (path-in-environment "ARS_MAGNA_CORE")
                            :toplevel (uiop:find-symbol* :main :ars-magna.cli)))

(defun save-window-prompt ()
  "Save a core of the prompt that can open windows in the file named in the environment."
  (when (missing-p "mcclim/looks")
    (get-window-libraries))
  (save-prompt "ars-magna/clim"))

;;; The manual.

(defun write-manual ()
  "Write the manual into the directory named in the environment; exit with status 1 if that fails."
  (load-project "ars-magna/manual")
  (uiop:quit (uiop:symbol-call :ars-magna.manual :main (uiop:getenv "ARS_MAGNA_MANUAL"))))

;;; The tests.

(defun run-tests (suites &optional seed)
  "Run SUITES, or all, shuffled if there is a SEED; exit with status 1 if a check fails."
  (load-tests)
  (uiop:quit (if (uiop:symbol-call :ars-magna.tests :run-from-shell suites seed) 0 1)))

(defun record-sessions (names)
  "Write the screens of the newcomer's sessions NAMES, or of all, into their files; exit with status
1 if one does not get what it waits for."
  (load-strictly "ars-magna/tests")
  (uiop:quit (if (uiop:symbol-call :ars-magna.tests :record-sessions names) 0 1)))
