;;;; files.lisp -- files and streams as the system knows them; programs; environment; terminal.

(in-package :ars-magna.host)

(export '(base-directory native-name native-path native-path-of-directory path-of-name
          existing-path missing-directory wildcard-name-p replace-file regular-file-p
          check-writable dangling-link-p file-base-name file-size unusable-file-text
          file-name-text +illegible+ utf-8-encoded utf-8-decoded truncate-file call-with-file-lock
          make-directories make-missing-directory process-id copy-permissions temporary-file-prefix
          remove-abandoned-files *wildcard-text* check-name-decodable environment-value
          real-microseconds date-and-time run-command run-attached run-filter octet-input-stream
          text-output-stream descriptor-stream wait-for-input window-rows-and-columns char-width))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defconstant +illegible+ (code-char #xFFFD)
    "The Unicode character that replaces octets that are not valid text."))

;;; In a native name no character is special, unlike * in a Lisp pathname.

(defun native-name (path)
  "Return the operating system's name of PATH, a pathname or string. If PATH is NIL, return NIL."
  (uiop:native-namestring path))

(defun native-path (name)
  "Return the pathname of NAME, the operating system's name of a file."
  (uiop:parse-native-namestring name))

;; UIOP's function for directories puts a backslash before a star.
(defun native-path-of-directory (name)
  "Return the pathname of NAME, the operating system's name of a directory."
  (sb-ext:parse-native-namestring name nil *default-pathname-defaults* :as-directory t))

(defun path-of-name (name &key directory)
  "Return the pathname of NAME, a string or pathname, as a file, or as a directory if DIRECTORY is
true. ~ and ~/ are the home directory."
  (flet ((path (name) (if directory (native-path-of-directory name) (native-path name))))
    (cond ((pathnamep name) (if directory (uiop:ensure-directory-pathname name) name))
          ((string= "~" name) (user-homedir-pathname))
          ((starts-with-subseq "~/" name)
           (merge-pathnames (path (subseq name 2)) (user-homedir-pathname)))
          (t (path name)))))

;;; Relative names start at the directory of Lisp's file functions, not at that of system calls.

(defun base-directory ()
  "Return the absolute path of the directory in which relative names start: the directory of
*DEFAULT-PATHNAME-DEFAULTS*, by default the current directory."
  (uiop:pathname-directory-pathname (uiop:get-pathname-defaults)))

(defun absolute-native-name (path)
  "Return the name of PATH for system calls. A relative PATH starts in the BASE-DIRECTORY."
  (native-name (merge-pathnames path (base-directory))))

(defun wildcard-name-p (name)
  "True if NAME, a pathname or string, has wildcards, or an unclosed bracket ([)."
  (handler-case (wild-pathname-p name)
    (error () t)))

(defun file-name-text (file)
  "Return the native name of FILE, a pathname or string, for messages; two quotes if it is empty."
  (let ((name (if (and (pathnamep file) (not (wildcard-name-p file))) (native-name file) file)))
    (if (equal name "") "\"\"" name)))

(defun file-base-name (path)
  "Return the native name of the file PATH without its directories."
  (let ((name (native-name path)))
    (subseq name (1+ (or (position #\/ name :from-end t) -1)))))

(defun file-size (path)
  "Return the size of the file PATH in bytes."
  (with-open-file (in path :element-type '(unsigned-byte 8)) (file-length in)))

(defun existing-path (path)
  "Return the truename of the file PATH; NIL if it does not exist or is a directory."
  (uiop:file-exists-p path))

(defun missing-directory (path)
  "If the directory of PATH, a pathname or string, does not exist, return its name; else NIL."
  (let ((directory (uiop:pathname-directory-pathname (merge-pathnames path))))
    (unless (or (wildcard-name-p directory) (uiop:directory-exists-p directory))
      (native-name directory))))

(defun replace-file (file by)
  "Atomically rename the file BY to FILE, replacing an existing FILE. FILE and BY are pathnames;
relative ones start in the BASE-DIRECTORY. Signals an error if the system refuses."
  (sb-posix:rename (absolute-native-name by) (absolute-native-name file))
  (values))

(defun copy-permissions (file from)
  "Give FILE the permissions of the file FROM, if FROM exists."
  (let ((status (ignore-errors (sb-posix:stat (absolute-native-name from)))))
    (when status
      (sb-posix:chmod (absolute-native-name file) (logand #o777 (sb-posix:stat-mode status))))))

(defun regular-file-p (path)
  "True if PATH is a regular file: no directory, device or pipe. Signals an error if it is missing."
  (= sb-posix:s-ifreg
     (logand sb-posix:s-ifmt (sb-posix:stat-mode (sb-posix:stat (absolute-native-name path))))))

;; Renaming needs only the directory's permissions, and the superuser may write anything.
(defun check-writable (path)
  "Signal an error if the file PATH exists and is write-protected or not writable by this process."
  (let ((name (absolute-native-name path)))
    (when (and (existing-path path)
               (or (zerop (logand #o222 (sb-posix:stat-mode (sb-posix:stat name))))
                   (handler-case (progn (sb-posix:access name sb-posix:w-ok) nil)
                     (sb-posix:syscall-error () t))))
      (error "it is write-protected"))))

(defun dangling-link-p (path)
  "True if PATH, a pathname or string, is a link to a missing file."
  (let ((name (absolute-native-name path)))
    (and (ignore-errors (sb-posix:lstat name))
         (not (ignore-errors (sb-posix:stat name))))))

(defparameter *wildcard-text*
  "its name has wildcards; in a Lisp string, write \\\\ before each * ? and ["
  "The reason why a name with wildcards cannot be used.")

(defun unusable-file-text (path)
  "Return a text that says why PATH, a pathname or string, is no usable regular file, or NIL."
  (cond ((wildcard-name-p path) *wildcard-text*)
        ((string= "" (native-name path)) "that is no name; give the name of a file")
        ((not (ignore-errors (sb-posix:stat (absolute-native-name path))))
         "there is no such file, or it cannot be accessed")
        ((not (regular-file-p path)) "it is a directory or a device")))

(defun check-name-decodable (path)
  "Signal an error if PATH has bytes that are not valid text. (Invalid names can look the same.)"
  (when (find +illegible+ (native-name path))
    (error "its name has bytes that are not UTF-8; give it a name in UTF-8")))

;;; Text of arbitrary octets. (SBCL's UTF-8 streams loop at some invalid ones.)

(defun utf-8-encoded (text)
  "Return TEXT in UTF-8, each octet as a Latin 1 character."
  (map 'string #'code-char (sb-ext:string-to-octets text :external-format :utf-8)))

(defun utf-8-decoded (octets)
  "Return the UTF-8 text of OCTETS, a Latin 1 string, with +ILLEGIBLE+ for each invalid octet."
  (sb-ext:octets-to-string (map '(vector (unsigned-byte 8)) #'char-code octets)
                           :external-format '(:utf-8 :replacement #.+illegible+)))

;;; Files shared by several processes.

(defun truncate-file (path length)
  "Truncate the file PATH to LENGTH octets."
  (sb-posix:truncate (absolute-native-name path) length)
  (values))

(defun make-directories (path)
  "Create the directory PATH and its missing parents."
  ;; Lisp's own function creates other directories if a name has a star or the like.
  (unless (uiop:directory-exists-p path)
    (let ((parent (uiop:pathname-parent-directory-pathname path)))
      (unless (equal parent path) (make-directories parent)))
    (handler-case (sb-posix:mkdir (string-right-trim "/" (absolute-native-name path)) #o777)
      (sb-posix:syscall-error ()
        (unless (uiop:directory-exists-p path)
          (error "~A cannot be created; give the name of another directory"
                 (native-name path)))))))

(defun make-missing-directory (path)
  "Create the directory PATH; its parent must exist. Return true if PATH did not exist before."
  (handler-case (progn (sb-posix:mkdir (string-right-trim "/" (absolute-native-name path)) #o700) t)
    (sb-posix:syscall-error (condition)
      ;; The owner may have removed it by now.
      (unless (= sb-posix:eexist (sb-posix:syscall-errno condition)) (error condition)))))

(defun call-with-file-lock (function path refused)
  "Call FUNCTION while this process has a lock on the file PATH, which is created if it does not
exist. Return true and the value of FUNCTION; NIL if another process has the lock. If PATH cannot be
written, call REFUSED instead of FUNCTION. The system releases the lock when this process ends."
  (let ((descriptor (handler-case (sb-posix:open (absolute-native-name path)
                                                 (logior sb-posix:o-creat sb-posix:o-rdwr) #o644)
                      (sb-posix:syscall-error () (funcall refused)))))
    (unwind-protect
         (when (handler-case (sb-posix:lockf descriptor sb-posix:f-tlock 0)
                 (sb-posix:syscall-error () nil))
           (values t (funcall function)))
      (sb-posix:close descriptor))))

(defun process-id ()
  "Return the ID of this process."
  (sb-posix:getpid))

(defun process-running-p (number)
  (handler-case (progn (sb-posix:kill number 0) t)
    (sb-posix:syscall-error (condition)
      (/= sb-posix:esrch (sb-posix:syscall-errno condition)))))

;;; A file is written under a temporary name and renamed when it is complete. The name contains host
;;; and process, so files of killed processes can be recognized.

(defun host-file-prefix ()
  "Return the prefix that this computer's processes use for names of temporary files."
  (format nil "ars-magna-~A-" (machine-instance)))

(defun temporary-file-prefix ()
  "Return the prefix that this process uses for names of temporary files."
  (format nil "~A~D-" (host-file-prefix) (process-id)))

(defun abandoned-file-p (file)
  (let ((name (file-namestring file)) (prefix (host-file-prefix)))
    (when (starts-with-subseq prefix name)
      (let ((number (parse-integer name :start (length prefix) :junk-allowed t)))
        (and number (not (process-running-p number)))))))

(defun remove-abandoned-files (directory)
  "Remove from DIRECTORY the temporary files of processes that have ended."
  (dolist (file (uiop:directory-files directory))
    (when (abandoned-file-p file) (ignore-errors (delete-file file)))))

;;;; Other programs, the environment and the clock

(defun environment-value (name)
  "Return the value of the environment variable NAME, a string, or NIL if it is not set."
  (uiop:getenv name))

(defun real-microseconds ()
  "Return a real time in microseconds, for differences. Results of runs must not depend on it."
  ;; Lisp's own clock has steps of 4000.
  (multiple-value-bind (seconds microseconds) (sb-ext:get-time-of-day)
    (+ (* 1000000 seconds) microseconds)))

(defun date-and-time ()
  "Return the date and the time in UTC, as text. Results of runs must not depend on them."
  (multiple-value-bind (second minute hour day month year)
      (decode-universal-time (get-universal-time) 0)
    (format nil "~D-~2,'0D-~2,'0D ~2,'0D:~2,'0D:~2,'0D UTC" year month day hour minute second)))

(defun run-command (program arguments &key input output)
  "Run PROGRAM, searched in PATH, with the strings ARGUMENTS, and wait for its end. INPUT is a
stream, :INTERACTIVE for this Lisp's own input, or NIL. Return the exit status of PROGRAM, or NIL if
it cannot be run. If OUTPUT is :STRING, return the output as a string, as a second value."
  (handler-case
      (multiple-value-bind (text errors status)
          (uiop:run-program (cons program arguments)
                            :input input :output output :ignore-error-status t
                            :external-format :utf-8)
        (declare (ignore errors))
        (values status text))
    (error () nil)))

(defparameter *child-start-code*
  "setpriv --pdeathsig TERM true 2>/dev/null && exec setpriv --pdeathsig TERM \"$@\"; exec \"$@\""
  "Shell code that runs a program. On systems with the command setpriv, the program is terminated
when this process ends for any reason.")

(defun run-child-program (program arguments &rest streams)
  "Run PROGRAM, searched in PATH, with the strings ARGUMENTS, and wait for its end. STREAMS are
keyword arguments for UIOP:LAUNCH-PROGRAM. PROGRAM is terminated on a non-local exit, or when this
process ends. Return the exit status of the shell, or NIL if it cannot be run; with :ERROR-OUTPUT
:STREAM also the error output, a string."
  (let ((process (handler-case (apply #'uiop:launch-program
                                      (list* "sh" "-c" *child-start-code* "sh" program arguments)
                                      streams)
                   (error () (return-from run-child-program nil))))
        (errors (eq :stream (getf streams :error-output)))
        (status nil))
    (unwind-protect
         (let ((text (and errors
                          (uiop:slurp-stream-string (uiop:process-info-error-output process)))))
           (setf status (uiop:wait-process process))
           (values status text))
      (unless status
        (uiop:terminate-process process)
        (uiop:wait-process process))
      (when errors (uiop:close-streams process)))))

(defun run-attached (program arguments)
  "Run PROGRAM as RUN-CHILD-PROGRAM does, on our standard streams. Return the exit status or NIL."
  (run-child-program program arguments
                     :input :interactive :output :interactive :error-output :interactive))

(defun run-filter (program arguments input output)
  "Run PROGRAM with ARGUMENTS as RUN-CHILD-PROGRAM does. Its input is the string INPUT; its output
goes to OUTPUT, a stream to a file. Return the exit status, or NIL if PROGRAM does not exist, and
the error output as a string."
  (with-input-from-string (in input)
    (multiple-value-bind (status errors)
        (run-child-program program arguments :input in :output output :error-output :stream
                                             :external-format :utf-8)
      ;; A shell returns this status if it finds no such program.
      (values (if (eql status 127) nil status) errors))))

;;;; Streams on file descriptors

(deftype descriptor-stream ()
  "A stream on a file, pipe or terminal of this process."
  (internal-name :sb-sys '#:fd-stream))

(defun octet-input-stream (descriptor)
  "Return an input stream on the file DESCRIPTOR, with one character for each octet."
  (internal (:sb-sys #:make-fd-stream) descriptor :input t :buffering :full
                                                  :external-format :latin-1))

(defun text-output-stream (descriptor)
  "Return a UTF-8 output stream on the file DESCRIPTOR."
  (internal (:sb-sys #:make-fd-stream) descriptor :output t :buffering :full
                                                  :external-format '(:utf-8 :replacement #\?)))

(defun wait-for-input (stream seconds)
  "Wait at most SECONDS for input to STREAM, on a descriptor. Return true if it has input or ended."
  (or (listen stream)
      (internal (:sb-sys #:wait-until-fd-usable)
                (internal (:sb-sys #:fd-stream-fd) stream) :input seconds)))

;;;; The terminal

(defconstant +window-size-request+ (if (uiop:featurep :linux) #x5413 #x40087468)
  "The system's request number for the size of a terminal window.")

(defun window-rows-and-columns ()
  "Return the numbers of rows and columns of the terminal window; zeros if unknown."
  (sb-alien:with-alien ((size (array sb-alien:unsigned-short 4)))
    (setf (sb-alien:deref size 0) 0
          (sb-alien:deref size 1) 0)
    (sb-alien:alien-funcall
     (sb-alien:extern-alien "ioctl" (function sb-alien:int sb-alien:int sb-alien:unsigned-long
                                              (* (array sb-alien:unsigned-short 4))))
     1 +window-size-request+ (sb-alien:addr size))
    (values (sb-alien:deref size 0) (sb-alien:deref size 1))))

(defun char-width (char)
  "Return how many terminal columns CHAR takes: 0 if combining, 2 if East Asian, 1 otherwise."
  (cond ((member (internal (:sb-unicode #:general-category) char) '(:mn :me :cf)) 0)
        ((member (internal (:sb-unicode #:east-asian-width) char) '(:w :f)) 2)
        (t 1)))
