;;;; cli-building.lisp -- what the shell compiles and from what, and its messages about failures.

(in-package :ars-magna.tests)

(def-suite* cli-building :in ars-magna)

(defun lines-of-shell (script &rest variables)
  "Return the lines that SCRIPT prints, also of errors. It has what setup.sh defines, with $root for
a new directory and $cache for another in it; VARIABLES are texts NAME=VALUE of its environment."
  (call-in-new-directory
   (lambda (directory)
     (let ((setup (base:native-name (project-file "cli/setup.sh")))
           (place (string-right-trim "/" (base:native-name directory))))
       (lines-of
        (nth-value 1 (base:run-command
                      "env"
                      (append variables
                              (list "sh" "-c" (format nil "exec 2>&1
root=$1 project=$(dirname \"$2\")/..
cache=$root/cache
mkdir \"$cache\"
. \"$2\"
~A" script)
                                    "sh" place setup))
                      :output :string)))))))

(test version.tells-what-it-runs-on
  (let ((text (nth-value 1 (base:run-command (base:native-name (project-file "cli/ars-magna"))
                                             '("--version") :output :string))))
    (dolist (part (list "ARS MAGNA " (lisp-implementation-version) "bordeaux-threads "))
      (is (search part text) "~S lacks ~A" text part))))

(test version.has-what-is-cited-in-bibtex
  (let ((text (nth-value 1 (base:run-command (base:native-name (project-file "cli/ars-magna"))
                                             '("--version") :output :string)))
        (version (asdf:component-version (asdf:find-system "ars-magna"))))
    (dolist (part (list "@manual{engelson-bertani-1992," "@misc{ars-magna,"
                        (format nil "Version ~A}" version)))
      (is (search part text) "~S lacks ~A" text part))))

(test cores.take-the-directory-for-temporary-files-from-the-environment
  "Not from that of the process that built them."
  (call-in-new-directory
   (lambda (directory)
     (with-input-from-string (in "(princ (uiop:temporary-directory))")
       (is (search (base:native-name directory)
                   (nth-value 1 (base:run-command
                                 "env" (list (format nil "TMPDIR=~A" (base:native-name directory))
                                             (base:native-name (project-file "cli/ars-magna"))
                                             "--batch")
                                 :input in :output :string))))))))

(test cores.know-the-files-of-functions
  "Else each would be a function typed anew in each Lisp, and tables would not belong together."
  (with-input-from-string (in "(let ((names '()))
  (do-external-symbols (name :ars-worlds)
    (when (and (fboundp name) (not (macro-function name))) (push name names)))
  (out \"all \" (length names) \" without \"
       (remove-if (lambda (name) (ars-magna.host:function-file (fdefinition name))) names) t))")
    (let ((said (nth-value 1 (base:run-command (base:native-name (project-file "cli/ars-magna"))
                                               '("--batch") :input in :output :string))))
      (is (search " without NIL" said) "~A" said)
      (is (null (search "all 0 " said))))))

(test functions.have-their-file-by-their-code-alone
  "SBCL does not find all of them in a saved core by other means."
  (let ((count 0))
    (do-external-symbols (name :ars-worlds)
      (when (and (fboundp name) (not (macro-function name))
                 (not (typep (fdefinition name) 'generic-function)))
        (incf count)
        (is (equal (multiple-value-list (host:function-file (fdefinition name)))
                   (multiple-value-list (host::file-of-code (fdefinition name))))
            "~A" name)))
    (is (< 20 count))))

(test caches.are-one-for-each-sbcl
  (is (equal '("SBCL-1.2.3-odd" "no-SBCL" "SBCL-1.2.3-odd")
             (lines-of-shell "XDG_CACHE_HOME=$root/caches
said='SBCL 1.2.3-odd'
sbcl() { printf '%s\\n' \"$said\"; }
choose_cache; basename \"$cache\"
said=; choose_cache; basename \"$cache\"
said='SBCL 1.2.3-odd'; choose_cache; basename \"$cache\""))))

(test caches.that-cannot-be-written-are-told
  (is-true (has-words-p (joined (lines-of-shell "touch \"$root/file\"
XDG_CACHE_HOME=$root/file TMPDIR=$root
choose_cache; echo \"in ${cache#$root/}\""))
                        "cannot write to" "/file/ars-magna/" "; using" "in ars-magna-")))

(test homes.with-relative-names-are-made-absolute
  (is (equal '("/usr/some") (lines-of-shell "cd /usr; HOME=some; . \"$2\"; echo \"$HOME\""))))

;;; What is compiled of which sources and libraries.

(test compiled-files.with-warnings-are-not-for-the-tests
  "What a user's build has warned of is compiled anew where a warning is an error."
  (call-in-new-directory
   (lambda (directory)
     (let* ((ars-magna.build::*cache-directory* directory)
            (file (merge-pathnames "project/some.fasl" directory)))
       (flet ((kept-p ()
                (ensure-directories-exist file)
                (write-text "" file)
                (ars-magna.build:load-strictly "asdf")
                (and (probe-file file) t)))
         (is-true (kept-p))
         (ars-magna.build::make-warnings-marker)
         (is-false (kept-p))
         (is-true (kept-p)))))))

(test sources.with-an-old-date-count-as-changed-and-those-that-are-gone-as-missing
  (is (equal '("same.fasl")
             (lines-of-shell "cd \"$root\"
mkdir src rpl cli worlds tests
mkdir -p \"$cache/project/src\"
touch ars-magna.asd
ln -s nowhere src/.#same.lisp
for name in same changed gone; do
    echo one >src/$name.lisp
    touch \"$cache/project/src/$name.fasl\"
done
forget_changed
cd \"$cache/project/src\"; touch same.fasl changed.fasl gone.fasl; cd \"$root\"
rm src/gone.lisp
echo two >src/changed.lisp
touch -t 200001010000 src/changed.lisp
forget_changed
ls \"$cache/project/src\""))))

(defparameter *compiling*
  "echo '(in-package :cl-user)' >\"$root/lib.lisp\"
plain=$(printf 'file %s\\n' \"$root/lib.lisp\")
forget_changed() { :; }
sbcl() { printf '%s\\n' \"$plain\" >\"$ARS_MAGNA_LIBRARIES\"; touch \"$cache/libraries/lib.fasl\"; }
into() { : >\"$1\"; shift; \"$@\"; }
look() { forget_changed_libraries; ls \"$cache/libraries\" 2>/dev/null | tr '\\n' ' '; echo; }
mkdir \"$cache/libraries\"
compile tests '()'; compile prompt '()'
look
touch -d 2001-01-01 \"$root/lib.lisp\"
look"
  "A script that compiles twice, of a library in whose place an older one comes.")

(test libraries.that-are-older-than-what-was-compiled-are-compiled-anew
  (is (equal '("lib.fasl prompt.found prompt.list tests.found tests.list " "")
             (lines-of-shell *compiling*))))

;;; What goes wrong.

(test scripts.in-the-place-of-sbcl-may-print-what-they-like
  (is (equal '("SBCL-1.2.3" "none missing")
             (lines-of-shell "XDG_CACHE_HOME=$root/caches
sbcl() { printf 'banner\\nSBCL 1.2.3\\n'; }
choose_cache; basename \"$cache\"
ask_lisp() { printf 'banner\\nmissing: \\n'; }
root=$project
echo \"none missing$(missing_packages ars-magna)\""))))

(test compiled-files.that-are-damaged-are-made-again-at-once
  (is (equal '("build" "1" "build" "1" "build"
               "ars-magna: compiled files are damaged; compiling again" "build" "0")
             (lines-of-shell "build() { echo build; [ ! -e \"$cache/project\" ] || return $1; }
fail() { echo build; return 1; }
mkdir \"$cache/project\"; compile_anew build 2; echo $?
rm -r \"$cache/project\"; compile_anew fail; echo $?
mkdir \"$cache/project\"; compile_anew build 1; echo $?"))
      "sources are at fault; nothing was compiled before; what was compiled is damaged"))

(test caches.without-room-are-told-as-such
  (let ((script "forget_changed() { :; }
into() { file=$1; shift; \"$@\" >\"$file\"; }
sbcl() { ~A; return 1; }
compile tests '()' 2>&1 | sed 's/^.*no room.*$/no room/'"))
    (flet ((last-line (command) (car (last (lines-of-shell (format nil script command))))))
      (is (string= "no room" (last-line "echo 'No space left on device'")))
      (is-true (has-words-p (last-line "echo 'The variable X is unbound.'") "compiling failed")))))

(defun said-of-library (text &rest variables)
  "Return the lines that are said when a library is looked for whose definition is TEXT."
  (apply #'lines-of-shell
         (format nil "mkdir -p \"$root/src/alexandria\"
HOME=$root CL_SOURCE_REGISTRY=${registry:-$root/src//:}
export HOME CL_SOURCE_REGISTRY
printf '%s' '~A' >\"$root/src/alexandria/alexandria.asd\"
root=$project
(missing_packages ars-magna)" text)
         variables))

(test libraries.that-are-not-defined-rightly-are-told
  "What is said is one line, with the file and no trace of calls."
  (loop for (words . arguments) in '((("alexandria.asd" "end of file") "(defsystem alexandria (")
                                     (("alexandria.asd does not define alexandria" "remove it") "")
                                     (("CL_SOURCE_REGISTRY" "end of file")
                                      "" "registry=(:source-registry"))
        for lines = (apply #'said-of-library arguments)
        do (is (= 1 (length lines)) "~A" lines)
           (is-true (apply #'has-words-p (first lines) "ars-magna:" words) "~A" lines)))
