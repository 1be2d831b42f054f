;;;; architecture.lisp -- rules for the sources: sizes, one file per library, defined names.

(in-package :ars-magna.tests)

(def-suite* architecture :in ars-magna)

;;; The sources.

(defun project-file (name)
  (asdf:system-relative-pathname "ars-magna" name))

(defun lisp-files (&rest directories)
  "Return a list of the Lisp files under DIRECTORIES, of the project."
  (loop for directory in directories
        append (directory (merge-pathnames "**/*.lisp" (project-file directory)))))

(defun file-lines (path)
  (with-open-file (in path :external-format :utf-8)
    (loop for line = (read-line in nil) while line collect line)))

(defun bare-code (text)
  "Return the Lisp code in TEXT, in lower case, without comments, strings and characters."
  (with-output-to-string (out)
    (loop with i = 0
          while (< i (length text))
          do (let ((end (definitions::skip-non-code text i)))
               (cond (end (setf i end))
                     (t (write-char (char-downcase (char text i)) out)
                        (incf i)))))))

(defvar *code* (make-hash-table :test #'equal) "The code in files, by path; see CODE-IN.")

(defun code-in (path)
  "Return the BARE-CODE of the file PATH, which is read once."
  (or (gethash path *code*)
      (setf (gethash path *code*) (bare-code (base:read-file-into-string path)))))

(defun place-in-code (word code &optional (start 0))
  "Return where the string WORD begins in CODE, a value of CODE-IN, from START on; or NIL."
  (let* ((word (coerce word '(simple-array character (*)))) (end (length word)))
    (declare (optimize speed (sb-ext:inhibit-warnings 3)) (type fixnum start)
             (type (simple-array character (*)) code word))
    (loop for place = (position (char word 0) code :start start)
          while (and place (<= (+ place end) (length code)))
          when (loop for i from 1 below end
                     always (char= (char word i) (char code (+ place i))))
            return place
          do (setf start (1+ place)))))

(defun files-mentioning (words directories)
  "Return the names of the files under DIRECTORIES whose code has one of the strings WORDS."
  (loop for path in (apply #'lisp-files directories)
        for code = (code-in path)
        when (some (lambda (word) (place-in-code word code)) words)
          collect (enough-namestring path (project-file ""))))

(test code.is-what-is-left-of-a-file
  (is (string= "(a    b)" (bare-code "(A \"x::y\" #\\\" |z::| B); c::d")))
  (is (string= "a  b" (bare-code "a #| :: |# b"))))

;;; Files.

(test files.begin-with-what-they-are-for
  (dolist (path (lisp-files "src/" "rpl/" "cli/" "worlds/" "tests/"))
    (let ((start (format nil ";;;; ~A.lisp -- " (pathname-name path)))
          (line (first (file-lines path))))
      (is (eql 0 (search start line)) "~A begins ~S" path line)
      (is (char= #\. (char line (1- (length line)))) "~A begins ~S" path line))))

(test files.are-of-a-size-to-be-read
  (dolist (path (lisp-files "src/" "rpl/" "cli/" "worlds/" "tests/"))
    (let ((lines (file-lines path)))
      (is (<= (length lines) 400) "~A has ~D lines" path (length lines))
      (is (notany (lambda (line) (> (length line) 100)) lines) "~A has long lines" path)
      (is (notany (lambda (line) (find #\Tab line)) lines) "~A has tabs" path))))

(test tests.have-names-of-their-own
  "A test of the same name would take the place of another without a word."
  (let ((seen (make-hash-table :test 'equal)))
    (dolist (path (lisp-files "tests/"))
      (dolist (line (file-lines path))
        (when (begins-with-p "(test " line)
          (let ((name (subseq line 6 (position #\Space line :start 6))))
            (is (null (gethash name seen)) "~A is in ~A and in ~A" name (gethash name seen) path)
            (setf (gethash name seen) path)))))))

(test files.are-all-in-a-system
  (let ((systems (base:read-file-into-string (project-file "ars-magna.asd"))))
    (dolist (path (set-difference (lisp-files "src/" "rpl/" "cli/" "worlds/" "tests/")
                                  (lisp-files "tests/benchmarks/" "tests/homes/"
                                              "tests/cluster/")
                                  :test #'equal))
      (unless (equal (project-file "cli/build.lisp") path)
        (is (search (format nil "(:file \"~A\")" (pathname-name path)) systems)
            "~A is in no system" path)))))

;;; Code.

(test code.uses-what-others-export
  (is (null (files-mentioning '("::") '("src/" "rpl/" "cli/" "worlds/")))))

(defun names-fiveam-p (code)
  "True if CODE names the library FiveAM; packages of ours, ars-...fiveam, are called after it."
  (loop for place = (place-in-code "fiveam" code) then (place-in-code "fiveam" code (1+ place))
        while place
        thereis (not (member (char code (1- place)) '(#\. #\-)))))

(test libraries.have-one-door-each
  (loop for (library . words) in '((alexandria "alexandria")
                                   (bordeaux-threads "bordeaux-threads" "bt:")
                                   (named-readtables "named-readtables")
                                   (lparallel "lparallel")
                                   (closer-mop "closer-mop")
                                   (chipz "chipz")
                                   (trivial-gray-streams "trivial-gray-streams"))
        for files = (files-mentioning words '("src/" "rpl/" "cli/" "worlds/"))
        do (is (<= (length files) 1) "~A is named in ~S" library files))
  (is (equal '("src/fiveam/package.lisp" "tests/package.lisp")
             (loop for path in (lisp-files "src/" "rpl/" "cli/" "worlds/" "tests/")
                   when (names-fiveam-p (code-in path))
                     collect (enough-namestring path (project-file ""))))))

;;; What is SBCL's own: its documented packages are free to use, all else is named in src/host.

(defparameter *documented-packages*
  '("sb-ext" "sb-mop" "sb-thread" "sb-introspect" "sb-posix" "sb-cltl2"))

(defparameter *calling-c* '("tests/benchmarks/rays-in-c.lisp")
  "The files that call C, as the manual of SBCL says.")

(defun name-char-p (char)
  (or (alphanumericp char) (find char "-:*+%!?")))

(defun implementation-names (code)
  "Return the names in CODE, in lower case, that are or are in packages of SBCL's."
  (remove-duplicates
   (loop for start = (search "sb-" code) then (search "sb-" code :start2 end)
         while start
         for end = (or (position-if-not #'name-char-p code :start start) (length code))
         unless (and (plusp start) (find (char code (1- start)) "abcdefghijklmnopqrstuvwxyz-*+%"))
           collect (subseq code start end))
   :test #'string=))

(defun package-part (name)
  (subseq name 0 (position #\: name)))

(defun sbcls-package-p (name)
  "True if NAME, in lower case, is that of a package of SBCL's."
  (and (find-package (string-upcase name)) (< 3 (length name)) t))

(defun internal-names (text)
  "Return the names in TEXT, strings and comments included, that are of SBCL's internal packages."
  (remove-if (lambda (name)
               (or (not (sbcls-package-p (package-part name)))
                   (and (member (package-part name) *documented-packages* :test #'string=)
                        (null (search "::" name)))))
             (implementation-names (string-downcase text))))

(defun text-without-comments (path)
  (format nil "~{~A~%~}" (remove-if (lambda (line) (begins-with-p ";" (string-left-trim " " line)))
                                    (file-lines path))))

(test internals.are-named-in-the-host-layer
  (let ((files 0))
    (dolist (path (lisp-files "src/" "rpl/" "cli/" "worlds/" "tests/"))
      (let ((file (enough-namestring path (project-file "")))
            (names (internal-names (text-without-comments path))))
        (if (begins-with-p "src/host/" file)
            (when names (incf files))
            (unless (member file (list* "tests/architecture.lisp" *calling-c*) :test #'string=)
              (is (null names) "~A names ~{~A~^, ~}" file names)))))
    (is (< 10 files))))

(defun host-names (path)
  "Return the internal names, as strings, that the file PATH of the host layer looks up."
  (let ((code (code-in path)))
    (remove-duplicates
     (loop for start = (search "#:" code) then (search "#:" code :start2 end)
           while start
           for end = (position-if-not #'name-char-p code :start (+ 2 start))
           collect (subseq code (+ 2 start) end))
     :test #'string=)))

(defun host-files ()
  "Return the files of the host layer that look up internal names."
  (remove-if-not (lambda (path) (search "(internal" (code-in path))) (lisp-files "src/host/")))

(test internals.are-named-in-one-file-each
  (let ((seen (make-hash-table :test 'equal)))
    (dolist (path (host-files))
      (dolist (name (host-names path))
        (is (null (gethash name seen)) "~A is named in ~A and in ~A" name (gethash name seen) path)
        (setf (gethash name seen) (pathname-name path))))
    (is (< 50 (hash-table-count seen)))))

(test internals.are-in-the-table-of-the-page
  (let ((page (base:read-file-into-string (project-file "src/host/README.md"))))
    (dolist (path (host-files))
      (is (search (format nil "| `~A` |" (pathname-name path)) page) "~A is in no table" path))))

(test internals.are-found-by-the-first-name-that-there-is
  (is (eq 'car (host::internal-name :cl '#:no-such-name '#:car)))
  (handler-case (host::internal-name :sb-kernel '#:no-such-name)
    (error (condition)
      (is (search "has no SB-KERNEL:NO-SUCH-NAME" (princ-to-string condition))))
    (:no-error (name) (fail "~S was found" name))))

(test versions.that-were-not-tried-are-told
  (is (null (host:untested-version-text "2.2.9.debian")))
  (is (null (host:untested-version-text "2.4")))
  (is (search "newer" (host:untested-version-text "2.6.5")))
  (is (search "newer" (host:untested-version-text "2.10.0-abc")))
  (is (search "newer" (host:untested-version-text "3")))
  (is (search "older" (host:untested-version-text "2.2.8")))
  (is (search "older" (host:untested-version-text "1.5.9"))))

(test implementation.names-are-found-in-code
  (is (equal '("sb-ext:gc" "sb-posix" "sb-c")
             (implementation-names "(sb-ext:gc) '#:sb-posix usb-stick (f :sb-c)")))
  (is (equal '() (implementation-names "(usb-port x)")))
  (is (equal '("sb-kernel" "sb-thread::x")
             (internal-names "(find-symbol \"A\" \"SB-KERNEL\") (sb-thread::x) (sb-ext:gc)"))))

(test chance-and-clock.come-from-where-they-should
  (is (null (files-mentioning '("(sleep ") '("src/" "rpl/" "cli/" "worlds/"))))
  (is (equal '("src/basics/random.lisp")
             (files-mentioning '("(random " "*random-state*") '("src/" "rpl/" "cli/" "worlds/"))))
  (is (equal '("src/host/files.lisp" "src/time/pacing.lisp")
             (files-mentioning '("get-internal-real-time" "get-universal-time"
                                 "get-time-of-day" "get-internal-run-time")
                               '("src/" "rpl/" "worlds/")))))

(defparameter *elementary-calls*
  (loop for name in '("sin" "cos" "tan" "asin" "acos" "atan" "sinh" "cosh" "tanh" "asinh" "acosh"
                      "atanh" "exp" "log" "cis")
        collect (format nil "(~A " name)
        collect (format nil "#'~A)" name)
        collect (format nil "#'~A " name))
  "Calls of Lisp's functions whose last bits depend on the machine.")

(defun binds-elementary-p (code place)
  "True if what begins at PLACE in CODE binds a variable, as in (let ((cos (cosine x))) ...), or
describes a slot."
  (let ((value (string-left-trim " " (subseq code (position #\Space code :start place)))))
    (or (begins-with-p "(cosine " value)
        (begins-with-p "(sine " value)
        (and (digit-char-p (char value 0)) (search " double-float " value :end2 30)))))

(defun powers-of-floats (code)
  "Return the calls of EXPT in CODE, but for powers of the integers 2 and 10, and for squares."
  (loop for place = (place-in-code "(expt " code) then (place-in-code "(expt " code (1+ place))
        while place
        for (base exponent) = (let ((*read-eval* nil) (end (min (length code) (+ place 200))))
                                (rest (ignore-errors
                                       (read-from-string code nil nil :start place :end end))))
        unless (or (member base '(2 10)) (eql 2 exponent))
          collect (list base exponent)))

(test elementary-functions.are-our-own
  (is (equal '()
             (loop for path in (lisp-files "src/" "rpl/" "worlds/")
                   for code = (code-in path)
                   when (or (some (lambda (call)
                                    (loop for place = (place-in-code call code)
                                            then (place-in-code call code (1+ place))
                                          while place
                                          thereis (not (binds-elementary-p code place))))
                                  *elementary-calls*)
                            (powers-of-floats code))
                     collect (enough-namestring path (project-file ""))))))

(test escape-codes.are-known-to-one-file-of-the-prompt
  ;; The line that an experiment writes over must do without the prompt.
  (is (equal '("src/experiment/running/workers.lisp" "cli/terminal/escapes.lisp")
             (loop for path in (lisp-files "src/" "rpl/" "cli/" "worlds/")
                   for text = (base:read-file-into-string path)
                   when (or (search "#\\Escape" text :test #'char-equal)
                            (search "(code-char 27)" text :test #'char-equal))
                     collect (enough-namestring path (project-file ""))))))

(test prompt.sets-nothing-at-load-but-the-front-end
  "What asks people has methods for the prompts, which are the front end."
  (dolist (path (lisp-files "cli/"))
    (dolist (line (uiop:split-string (code-in path) :separator '(#\Newline)))
      (is (or (not (begins-with-p "(setf *" line)) (begins-with-p "(setf *front-end*" line))
          "~A: ~A" path line))))

(test cli.alone-ends-the-process
  ;; One refuses to.
  (is (equal '("src/basics/conditions.lisp")
             (files-mentioning '("sb-ext:exit" "sb-ext:quit" "uiop:quit" "end-process")
                               '("src/" "rpl/" "worlds/")))))

;;; What the shell calls.

(defun names-after (prefix text)
  "Return the names that follow PREFIX in TEXT."
  (loop for start = (search prefix text) then (search prefix text :start2 end)
        while start
        for end = (position-if-not #'name-char-p text :start (+ start (length prefix)))
        collect (subseq text (+ start (length prefix)) end)))

(test scripts.call-what-build-lisp-exports
  (let ((names (loop for file in '("cli/ars-magna" "cli/setup.sh" "cli/cores.sh" "tests/run"
                                   "worlds/figures" "tests/newcomer/record"
                                   "tests/benchmarks/run"
                                   "tests/benchmarks/peers/run")
                     append (names-after "ars-magna.build:"
                                         (base:read-file-into-string (project-file file))))))
    (is (< 8 (length names)))
    (dolist (name (remove-duplicates names :test #'string=))
      (unless (string= "" name)  ; one of the shell's variables
        (is (eq :external (nth-value 1 (find-symbol (string-upcase name) :ars-magna.build)))
            "~A is not exported" name)))))

;;; Undefined names. The compiler does not warn of those in code that is *HOT*.

(defun names-in-use (package test)
  "Return the symbols of PACKAGE itself for which TEST is true."
  (remove-if-not (lambda (symbol) (and (eq package (symbol-package symbol)) (funcall test symbol)))
                 (names-in package)))

(defun undefined-variable-p (symbol)
  "True if SYMBOL is written like a special variable or constant, and is none."
  (let* ((name (symbol-name symbol)) (first (char name 0)))
    (and (< 2 (length name)) (find first "+*") (char= first (char name (1- (length name))))
         (not (boundp symbol))
         (null (sb-cltl2:variable-information symbol)))))

(defun undefined-function-p (symbol)
  "True if code calls SYMBOL, which is not defined."
  (and (not (fboundp symbol)) (sb-int:find-fdefn symbol)))

(defun calls-are-known-p ()
  "True if this SBCL tells whether code calls a symbol. Later versions than 2.2.9 may not."
  (ignore-errors (sb-int:find-fdefn 'car)))

(test names.that-code-uses-are-defined
  (dolist (package (layers)) (is (equal '() (names-in-use package #'undefined-variable-p)))))

(test names.that-are-not-defined-are-found
  (compile nil '(lambda () (declare #.host:*hot*) (doze-for-ever *hour-of-doom*)))
  (is-true (undefined-variable-p '*hour-of-doom*))
  (cond ((calls-are-known-p)
         (is-true (undefined-function-p 'doze-for-ever))
         (dolist (package (layers))
           (is (equal '() (remove 'doze-for-ever
                                  (names-in-use package #'undefined-function-p))))))
        (t (skip "This SBCL does not tell which functions code calls."))))
