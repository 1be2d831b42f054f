;;;; architecture.lisp -- what holds of the sources: exports documented, one door per library.

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
          do (let ((end (base::skip-text text i)))
               (cond (end (setf i end))
                     (t (write-char (char-downcase (char text i)) out)
                        (incf i)))))))

(defun code-in (path)
  (bare-code (base:read-file-into-string path)))

(defun files-mentioning (words directories)
  "Return the names of the files under DIRECTORIES whose code has one of the strings WORDS."
  (loop for path in (apply #'lisp-files directories)
        for code = (code-in path)
        when (some (lambda (word) (search word code)) words)
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
  (loop for place = (search "fiveam" code) then (search "fiveam" code :start2 (1+ place))
        while place
        thereis (not (member (char code (1- place)) '(#\. #\-)))))

(test libraries.have-one-door-each
  (loop for (library . words) in '((alexandria "alexandria")
                                   (bordeaux-threads "bordeaux-threads" "bt:")
                                   (named-readtables "named-readtables")
                                   (lparallel "lparallel")
                                   (closer-mop "closer-mop")
                                   (trivial-gray-streams "trivial-gray-streams"))
        for files = (files-mentioning words '("src/" "rpl/" "cli/" "worlds/"))
        do (is (<= (length files) 1) "~A is named in ~S" library files))
  (is (equal '("src/fiveam/package.lisp" "tests/package.lisp")
             (loop for path in (lisp-files "src/" "rpl/" "cli/" "worlds/" "tests/")
                   when (names-fiveam-p (code-in path))
                     collect (enough-namestring path (project-file ""))))))

;;; What is SBCL's own. Each of its packages has one door, but for packages of many ideas, such as
;;; SB-EXT: there each name has one, and only the files listed here may have any of SB-EXT.

(defparameter *sb-ext-doors*
  '("src/base/policy.lisp" "src/base/floats.lisp" "src/base/globals.lisp" "src/base/atomic.lisp"
    "src/base/packages.lisp" "src/base/environments.lisp" "src/base/interrupts.lisp"
    "src/base/debuggers.lisp" "src/base/exits.lisp" "src/base/files.lisp" "src/base/tables.lisp"
    "src/base/processes.lisp" "src/base/weak.lisp" "cli/shell/executable.lisp")
  "The files that may name SB-EXT.")

(defparameter *before-the-doors*
  '("cli/build.lisp")
  "The files that may name what they like: build.lisp runs in a bare SBCL, to which none of the
project's systems has been loaded.")

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

(defun names-of-files (exempt)
  "Return a list of lists (file name...): what of SBCL's each file but those in EXEMPT names."
  (loop for path in (lisp-files "src/" "rpl/" "cli/" "worlds/")
        for file = (enough-namestring path (project-file ""))
        for names = (implementation-names (code-in path))
        when (and names (not (member file exempt :test #'string=)))
          collect (cons file names)))

(defun package-part (name)
  (subseq name 0 (position #\: name)))

(defun unit-of (name)
  "Return what has one door: NAME's package, or NAME itself if it is in one of many ideas."
  (if (find (package-part name)
            '("sb-ext" "sb-sys" "sb-kernel" "sb-vm" "sb-c" "sb-int" "sb-posix" "sb-thread")
            :test #'string=)
      name
      (package-part name)))

(test implementation.has-one-door-for-each-idea
  (let ((doors (make-hash-table :test #'equal)))
    (loop for (file . names) in (names-of-files *before-the-doors*)
          do (dolist (name names)
               (pushnew file (gethash (unit-of name) doors) :test #'string=)
               (when (string= "sb-ext" (package-part name))
                 (is (member file *sb-ext-doors* :test #'string=) "~A names ~A" file name))))
    (is (plusp (hash-table-count doors)))
    (loop for unit being the hash-keys of doors using (hash-value files)
          do (is (= 1 (length files)) "~A is named in ~S" unit files))))

(test implementation.exceptions-are-needed
  (let ((files (mapcar #'first (names-of-files '()))))
    (dolist (file (append *sb-ext-doors* *before-the-doors*))
      (is (member file files :test #'string=) "~A names nothing of SBCL's" file))))

(test implementation.names-are-found-in-code
  (is (equal '("sb-ext:gc" "sb-posix" "sb-c")
             (implementation-names "(sb-ext:gc) '#:sb-posix usb-stick (f :sb-c)")))
  (is (equal '() (implementation-names "(usb-port x)"))))

(test chance-and-clock.come-from-where-they-should
  (is (null (files-mentioning '("(sleep ") '("src/" "rpl/" "cli/" "worlds/"))))
  (is (equal '("src/base/random.lisp")
             (files-mentioning '("(random " "*random-state*") '("src/" "rpl/" "cli/" "worlds/"))))
  (is (equal '("src/base/processes.lisp" "src/time/pacing.lisp")
             (files-mentioning '("get-internal-real-time" "get-universal-time"
                                 "get-time-of-day" "get-internal-run-time")
                               '("src/" "rpl/" "worlds/")))))

(test escape-codes.are-known-to-one-file-of-the-prompt
  ;; The line that an experiment writes over must do without the prompt.
  (is (equal '("src/experiment/running/progress.lisp" "cli/terminal/escapes.lisp")
             (loop for path in (lisp-files "src/" "rpl/" "cli/" "worlds/")
                   for text = (base:read-file-into-string path)
                   when (or (search "#\\Escape" text :test #'char-equal)
                            (search "(code-char 27)" text :test #'char-equal))
                     collect (enough-namestring path (project-file ""))))))

(test cli.alone-ends-the-process
  ;; One refuses to.
  (is (equal '("src/base/exits.lisp")
             (files-mentioning '("sb-ext:exit" "sb-ext:quit" "uiop:quit" "end-process")
                               '("src/" "rpl/" "worlds/")))))

;;; Packages.

(defun project-packages ()
  "Return the layers' packages and the faces that there are."
  (remove-if-not (lambda (package)
                   (let ((name (package-name package)))
                     (or (member name '("ARS" "NISP" "ARS-WORLDS") :test #'string=)
                         (and (eql 0 (search "ARS-MAGNA." name))
                              (string/= name "ARS-MAGNA.TESTS")
                              (string/= name "ARS-MAGNA.BUILD")))))
                 (list-all-packages)))

(defun external-symbols (package)
  (sort (loop for symbol being the external-symbols of package collect symbol)
        #'string<))

(defun ours-p (symbol)
  (let ((package (symbol-package symbol)))
    (and package (member package (project-packages)))))

(defun undocumented-as (symbol)
  "Return as what SYMBOL is bound but not documented, a list."
  (loop for (kind bound-p) in `((function ,(fboundp symbol))
                                (variable ,(and (boundp symbol) (not (keywordp symbol))))
                                (type ,(or (find-class symbol nil)
                                           (sb-int:info :type :expander symbol))))
        when (and bound-p (null (documentation symbol kind)))
          collect kind))

(test exports.are-documented
  (dolist (package (project-packages))
    (dolist (symbol (remove-if-not #'ours-p (external-symbols package)))
      (let ((kinds (undocumented-as symbol)))
        (is (null kinds) "~A:~A has no documentation as ~{~(~A~)~^, ~}"
            (package-name package) symbol kinds)))))

(test packages.say-what-they-are
  (dolist (package (project-packages))
    (is (plusp (length (documentation package t))) "~A" (package-name package))))

;;; What users see.

(defun documentations (symbol)
  "Return all that is said of SYMBOL, a list of strings."
  (loop for kind in '(function variable type)
        for text = (documentation symbol kind)
        when text collect text))

(defun says-addition-p (text)
  (let ((sentence (format nil "~%An addition to the manual.")))
    (eql (search sentence text) (- (length text) (length sentence)))))

(defun face-package (face)
  "Return the package FACE; in here :NISP is a nickname of a layer."
  (find (string face) (list-all-packages) :key #'package-name :test #'string=))

(test public.is-what-is-marked
  (dolist (face '(:ars :nisp))
    (is (null (set-exclusive-or (base:public-symbols face)
                                (external-symbols (face-package face))
                                :test #'string=)))))

(defun users-symbol (symbol)
  "Return what users see of SYMBOL, which a layer exports."
  (find-symbol (symbol-name symbol)
               (face-package (first (base::mark-faces (base::find-mark symbol))))))

(test public.readers-only-read
  "Whoever could set one would change a run behind the back of its journal."
  (let ((settable '()) (readers 0))
    (dolist (symbol (append (base:public-symbols :ars) (base:public-symbols :nisp)))
      (let ((shown (users-symbol symbol)))
        (cond ((not (fboundp `(setf ,shown))))
              ((eq shown symbol) (push symbol settable))
              (t (incf readers)
                 (is (eq (fdefinition symbol) (fdefinition shown)))
                 (signals base:misuse (funcall (fdefinition `(setf ,shown)) 1 2))))))
    (is (< 50 readers))
    (is (null (set-exclusive-or settable
                                '("PARAMETER-VALUE" "GET-ATTRIBUTE" "FLUENT-VALUE" "VREF"
                                  "PT-X" "PT-Y" "INTERVAL-MIN" "INTERVAL-MAX"
                                  "PT-INTERVAL-X" "PT-INTERVAL-Y")
                                :test #'string=)))))

(test public.is-told-apart-from-the-manual
  (dolist (symbol (append (base:public-symbols :ars) (base:public-symbols :nisp)))
    (let ((texts (documentations symbol)))
      (if (base:addition-p symbol)
          (is (every #'says-addition-p texts) "~S does not say that the manual lacks it" symbol)
          (is (or (null texts) (some (lambda (text) (search "anual" text)) texts))
              "~S does not cite the manual" symbol)))))

(test public.must-be-exported-by-its-layer
  (signals base:misuse
    (ars-magna.faces::show 'ars-magna.base::find-mark :ars)))
