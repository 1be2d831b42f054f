;;;; files.lisp -- files as the operating system knows them, other programs and the environment.

(in-package :ars-magna.host)

(export '(base-directory native-name native-path native-path-of-directory path-called
          existing-path missing-directory many-files-p replace-file plain-file-p
          check-unprotected dangling-link-p name-in-directory file-size unusable-file-text
          shown-name +illegible+ encoded decoded cut-file call-with-file-lock make-directories
          make-new-directory process-number copy-permissions temporary-file-prefix
          remove-abandoned-files *many-files-text* check-name-legible environment-value
          real-microseconds date-and-time run-command run-attached run-filter))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defconstant +illegible+ (code-char #xFFFD)
    "Unicode's character for octets that cannot be read as text."))

;;; In a native name no character has a meaning of its own, as * has in one of Lisp's.

(defun native-name (path)
  "Return the name by which the operating system knows PATH, a pathname or string; NIL of NIL."
  (uiop:native-namestring path))

(defun native-path (name)
  "Return the pathname of what the operating system calls NAME, a string."
  (uiop:parse-native-namestring name))

;; UIOP's own way to a directory puts a backslash before a star.
(defun native-path-of-directory (name)
  "Return the pathname of what the operating system calls NAME, a string, as of a directory."
  (sb-ext:parse-native-namestring name nil *default-pathname-defaults* :as-directory t))

(defun path-called (name &key directory)
  "Return the pathname that NAME, a string or pathname, stands for, of a file, or if DIRECTORY of a
directory; ~ and ~/ are the home directory."
  (flet ((path (name) (if directory (native-path-of-directory name) (native-path name))))
    (cond ((pathnamep name) (if directory (uiop:ensure-directory-pathname name) name))
          ((string= "~" name) (user-homedir-pathname))
          ((starts-with-subseq "~/" name)
           (merge-pathnames (path (subseq name 2)) (user-homedir-pathname)))
          (t (path name)))))

;;; Relative names begin where Lisp's functions for files begin, not where the system's calls do.

(defun base-directory ()
  "Return the absolute path of the directory in which relative names of files begin: that of
*DEFAULT-PATHNAME-DEFAULTS*, which by default is the current directory."
  (uiop:pathname-directory-pathname (uiop:get-pathname-defaults)))

(defun system-name (path)
  "Return the name of PATH, a pathname or string, for calls of the system: one that is relative
begins in the BASE-DIRECTORY."
  (native-name (merge-pathnames path (base-directory))))

(defun many-files-p (name)
  "True if NAME, a pathname or string, stands for many files, or has a [ that nothing closes."
  (handler-case (wild-pathname-p name)
    (error () t)))

(defun shown-name (file)
  "Return FILE, a pathname or string, as the operating system writes it; an empty name in quotes."
  (let ((name (if (and (pathnamep file) (not (many-files-p file))) (native-name file) file)))
    (if (equal name "") "\"\"" name)))

(defun name-in-directory (path)
  "Return the name of the file PATH, as the system knows it, without its directories."
  (let ((name (native-name path)))
    (subseq name (1+ (or (position #\/ name :from-end t) -1)))))

(defun file-size (path)
  "Return how many bytes the file PATH has."
  (with-open-file (in path :element-type '(unsigned-byte 8)) (file-length in)))

(defun existing-path (path)
  "Return the truename of the file PATH, or NIL if there is none, or it is a directory."
  (uiop:file-exists-p path))

(defun missing-directory (path)
  "Return the name of the directory that PATH, a pathname or string, is in if there is none such, or
NIL."
  (let ((directory (uiop:pathname-directory-pathname (merge-pathnames path))))
    (unless (or (many-files-p directory) (uiop:directory-exists-p directory))
      (native-name directory))))

(defun replace-file (file by)
  "Let the file BY have the name FILE, in place of what is there, at one stroke. Both are pathnames;
only a directory is filled in. Signals an error if the system refuses."
  (sb-posix:rename (system-name by) (system-name file))
  (values))

(defun copy-permissions (file from)
  "Give FILE the permissions of the file FROM, if there is one."
  (let ((status (ignore-errors (sb-posix:stat (system-name from)))))
    (when status
      (sb-posix:chmod (system-name file) (logand #o777 (sb-posix:stat-mode status))))))

(defun plain-file-p (path)
  "True if PATH is a file of bytes: no directory, device or pipe. Signals an error if there is
nothing."
  (= sb-posix:s-ifreg
     (logand sb-posix:s-ifmt (sb-posix:stat-mode (sb-posix:stat (system-name path))))))

(defun write-protected-p (path)
  "True if nobody may write the file PATH, by its permissions, or this process may not."
  (let ((name (system-name path)))
    (or (zerop (logand #o222 (sb-posix:stat-mode (sb-posix:stat name))))
        (handler-case (progn (sb-posix:access name sb-posix:w-ok) nil)
          (sb-posix:syscall-error () t)))))

;; Renaming asks for the permissions of the directory only, and the superuser may write anything.
(defun check-unprotected (path)
  "Signal an error if there is a file PATH, a pathname, and it is write-protected."
  (when (and (existing-path path) (write-protected-p path))
    (error "it is write-protected")))

(defun dangling-link-p (path)
  "True if PATH, a pathname or string, is a link to something that there is not."
  (let ((name (system-name path)))
    (and (ignore-errors (sb-posix:lstat name))
         (not (ignore-errors (sb-posix:stat name))))))

(defparameter *many-files-text*
  "its name stands for many files; write \\\\ before each * ? and [ in a string of Lisp"
  "Why a name that stands for many files cannot be used.")

(defun unusable-file-text (path)
  "Return why PATH, a pathname or string, is the name of no file of bytes, in words, or NIL."
  (cond ((many-files-p path) *many-files-text*)
        ((string= "" (native-name path)) "that is no name; give the name of a file")
        ((not (ignore-errors (sb-posix:stat (system-name path))))
         "there is no such file, or none that may be seen")
        ((not (plain-file-p path)) "it is a directory or a device")))

(defun check-name-legible (path)
  "Signal an error if a byte in the name PATH could not be read as text: other names look the same."
  (when (find +illegible+ (native-name path))
    (error "its name has bytes that are not UTF-8; give it a name in UTF-8")))

;;; Text of whatever octets. (SBCL's streams of UTF-8 loop at some that are none.)

(defun encoded (text)
  "Return the octets of TEXT in UTF-8, as a string of characters read as Latin 1."
  (map 'string #'code-char (sb-ext:string-to-octets text :external-format :utf-8)))

(defun decoded (octets)
  "Return the text in UTF-8 whose octets the characters of OCTETS, read as Latin 1, stand for, with
+ILLEGIBLE+ for each that cannot be read."
  (sb-ext:octets-to-string (map '(vector (unsigned-byte 8)) #'char-code octets)
                           :external-format '(:utf-8 :replacement #.+illegible+)))

;;; Files that several processes may have.

(defun cut-file (path length)
  "Let the file PATH end after LENGTH octets."
  (sb-posix:truncate (system-name path) length)
  (values))

(defun make-directories (path)
  "Make the directory PATH and those that it is in, as far as there are none."
  ;; Lisp's own function makes others where a name has a star or the like.
  (unless (uiop:directory-exists-p path)
    (let ((parent (uiop:pathname-parent-directory-pathname path)))
      (unless (equal parent path) (make-directories parent)))
    (handler-case (sb-posix:mkdir (string-right-trim "/" (system-name path)) #o777)
      (sb-posix:syscall-error ()
        (unless (uiop:directory-exists-p path)
          (error "~A cannot be made; give the name of a directory that can be"
                 (native-name path)))))))

(defun make-new-directory (path)
  "Make the directory PATH, in one that is there. True if nothing of that name was there before."
  (handler-case (progn (sb-posix:mkdir (string-right-trim "/" (system-name path)) #o700) t)
    (sb-posix:syscall-error (condition)
      ;; Whoever had it may have removed it by now.
      (unless (= sb-posix:eexist (sb-posix:syscall-errno condition)) (error condition)))))

(defun call-with-file-lock (function path refused)
  "Call FUNCTION while no other process that asks so has the file PATH, which is made if there is
none; the system lets go of it when this process ends, in whatever way. Return true and what
FUNCTION returns, or NIL if another has it. If PATH cannot be written, call REFUSED instead."
  (let ((descriptor (handler-case (sb-posix:open (system-name path)
                                                 (logior sb-posix:o-creat sb-posix:o-rdwr) #o644)
                      (sb-posix:syscall-error () (funcall refused)))))
    (unwind-protect
         (when (handler-case (sb-posix:lockf descriptor sb-posix:f-tlock 0)
                 (sb-posix:syscall-error () nil))
           (values t (funcall function)))
      (sb-posix:close descriptor))))

(defun process-number ()
  "Return the number that the system has given to this process."
  (sb-posix:getpid))

(defun process-running-p (number)
  (handler-case (progn (sb-posix:kill number 0) t)
    (sb-posix:syscall-error (condition)
      (/= sb-posix:esrch (sb-posix:syscall-errno condition)))))

;;; A file is written under a temporary name and renamed when it is complete. The temporary name has
;;; the host and the process, so files of killed processes can be recognized.

(defun host-file-prefix ()
  "Return how the names of temporary files of this machine's processes begin."
  (format nil "ars-magna-~A-" (machine-instance)))

(defun temporary-file-prefix ()
  "Return how the names of temporary files of this process begin."
  (format nil "~A~D-" (host-file-prefix) (process-number)))

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
  "Return the value of the environment's variable called NAME, a string, or NIL if it is not set."
  (uiop:getenv name))

(defun real-microseconds ()
  "Return the real time in microseconds since some moment. No result may depend on it."
  ;; What Lisp itself has for that goes on in steps of 4000.
  (multiple-value-bind (seconds microseconds) (sb-ext:get-time-of-day)
    (+ (* 1000000 seconds) microseconds)))

(defun date-and-time ()
  "Return the date and the time in UTC, as text. No result may depend on it."
  (multiple-value-bind (second minute hour day month year)
      (decode-universal-time (get-universal-time) 0)
    (format nil "~D-~2,'0D-~2,'0D ~2,'0D:~2,'0D:~2,'0D UTC" year month day hour minute second)))

(defun run-command (program arguments &key input output)
  "Run PROGRAM, looked for where programs are, with the strings ARGUMENTS, and wait for its end.
INPUT is a stream for it to read, :INTERACTIVE to read what this Lisp would, or NIL. Return its exit
status, or NIL if it cannot be run, and as a string what it wrote if OUTPUT is :STRING."
  (handler-case
      (multiple-value-bind (text errors status)
          (uiop:run-program (cons program arguments)
                            :input input :output output :ignore-error-status t
                            :external-format :utf-8)
        (declare (ignore errors))
        (values status text))
    (error () nil)))

(defparameter *tied-start*
  "setpriv --pdeathsig TERM true 2>/dev/null && exec setpriv --pdeathsig TERM \"$@\"; exec \"$@\""
  "What a shell does to run a program that the system tells to end when this process ends, however
it does: where the system can.")

(defun run-tied (program arguments &rest streams)
  "Run PROGRAM, looked for where programs are, with the strings ARGUMENTS and STREAMS, keywords of
UIOP:LAUNCH-PROGRAM. Wait for its end; if this is left, or this process is killed, it is told to
end. Return its exit status, as of a shell, or NIL if no program can be run, and as a string what it
said of errors if STREAMS have that as :STREAM."
  (let ((process (handler-case (apply #'uiop:launch-program
                                      (list* "sh" "-c" *tied-start* "sh" program arguments)
                                      streams)
                   (error () (return-from run-tied nil))))
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
  "Do as RUN-TIED does with PROGRAM and ARGUMENTS: it reads and writes what this process would.
Return its exit status or NIL."
  (run-tied program arguments
            :input :interactive :output :interactive :error-output :interactive))

(defun run-filter (program arguments input output)
  "Do as RUN-TIED does with PROGRAM and ARGUMENTS: it reads the string INPUT and writes into the
stream OUTPUT to a file. Return its exit status, or NIL if there is no such program, and as a string
what it said of errors."
  (with-input-from-string (in input)
    (multiple-value-bind (status errors)
        (run-tied program arguments :input in :output output :error-output :stream
                                    :external-format :utf-8)
      ;; A shell that finds no program of a name ends so.
      (values (if (eql status 127) nil status) errors))))
