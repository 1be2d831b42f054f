;;;; cli-door.lisp -- --window without an X server or without McCLIM.

(in-package :ars-magna.tests)

(def-suite* cli-door :in ars-magna)

;;; The program starts in a new home directory, in which nothing is installed or compiled. It never
;;; gets so far as to open a window, so no X server is needed.

(defvar *no-libraries* "CL_SOURCE_REGISTRY=(:source-registry :ignore-inherited-configuration)"
  "What in the environment lets ASDF find nothing.")

(defun start-with-window (variables &rest arguments)
  "Start ./cli/ars-magna --window and ARGUMENTS, with VARIABLES in the environment, texts like
DISPLAY=:0, and without McCLIM for ASDF to find. Return its error output and status."
  (multiple-value-bind (output errors status)
      (uiop:run-program `("env" ,@variables ,*no-libraries*
                               ,(namestring (project-file "cli/ars-magna")) "--window"
                               ,@arguments)
                        :error-output :string :ignore-error-status t)
    (declare (ignore output))
    (values errors status)))

(defparameter *lisp-that-makes-no-core*
  "#!/bin/sh
case \"$*\" in
    *print-missing-libraries*) echo 'missing: ' ;;
    *save-prompt*)
        mkdir -p \"${ARS_MAGNA_LIBRARIES%/*}\"
        printf 'file %s\\n' \"$HOME/bin/runtime\" >\"$ARS_MAGNA_LIBRARIES\"
        : >\"$ARS_MAGNA_CORE\" ;;
    *) exec ~A \"$@\" ;;
esac
"
  "A script that runs as SBCL, ~A, except that it finds all libraries and makes an empty core.")

(defparameter *runtime-for-that-core*
  "#!/bin/sh
for argument; do
    [ \"$argument\" != --robt ] || { echo 'no such option' >&2; exit 2; }
done
"
  "A script that, as the runtime of that core, rejects the option --robt.")

(defun write-home-program (name text)
  (let ((path (uiop:subpathname (user-homedir-pathname) (format nil "bin/~A" name))))
    (ensure-directories-exist path)
    (write-text text path)
    (uiop:run-program (list "chmod" "+x" (namestring path)))))

(defun start-with-window-at-home (&rest arguments)
  "Start ./cli/ars-magna --window and ARGUMENTS, with what is in the home directory, and with a
prompt that was not compiled. Return its error output and status."
  (write-home-program "sbcl" (format nil *lisp-that-makes-no-core*
                                     (uiop:run-program "command -v sbcl"
                                                       :output '(:string :stripped t))))
  (write-home-program "runtime" *runtime-for-that-core*)
  (let ((home (uiop:getenv "HOME")))
    (apply #'start-with-window (list "DISPLAY=:0" (format nil "XDG_CACHE_HOME=~A.cache" home)
                                     (format nil "PATH=~Abin:~A" home (uiop:getenv "PATH")))
           arguments)))

(defun pretend-quicklisp (form)
  "Let the home directory have a Quicklisp that does FORM when it is loaded."
  (let ((file (uiop:subpathname (user-homedir-pathname) "quicklisp/setup.lisp")))
    (ensure-directories-exist file)
    (with-open-file (stream file :direction :output)
      (prin1 form stream))))

(test window.option-says-that-there-is-no-display
  (multiple-value-bind (errors status) (start-with-window '("DISPLAY="))
    (is (mentions-p errors "DISPLAY names no X server"))
    (is (= 1 status))))

(test window.what-to-do-without-mcclim-is-said-in-full
  (call-with-home-directory
   (lambda ()
     (multiple-value-bind (errors status) (start-with-window-at-home)
       (is (= 1 status))
       (dolist (part '("sudo apt-get install cl-quicklisp" "(quicklisp-quickstart:install)"
                       "ocicl setup && ocicl install mcclim"))
         (is (mentions-p errors part))
         (is (mentions-p cli::*mcclim-installation-text* part)))))))

(test window.option-says-why-quicklisp-could-not-get-mcclim
  "And nothing of a prompt that could not be made, which there is."
  (call-with-home-directory
   (lambda ()
     (pretend-quicklisp '(error "no road leads there"))
     (multiple-value-bind (errors status) (start-with-window-at-home)
       (is (= 1 status))
       (dolist (part '("no road leads there" "Is the network there?" "Without --window"))
         (is (mentions-p errors part)))
       (is-false (mentions-p errors "could not make"))))))

(test window.option-is-checked-with-the-others-before-mcclim-is-got
  (call-with-home-directory
   (lambda ()
     (pretend-quicklisp '(error "no road leads there"))
     (multiple-value-bind (errors status) (start-with-window-at-home "--robt" "x")
       (is (= 2 status))
       (is (mentions-p errors "no such option"))
       (is-false (mentions-p errors "Quicklisp"))))))

(defun refusal-text-for (arguments)
  "Return what the program says against ARGUMENTS if McCLIM is there already."
  (let ((cli::*display-opener* #'identity))
    (nth-value 2 (call-as-process arguments))))

(defun early-refusal-text-for (arguments)
  "Return what the program says against ARGUMENTS before McCLIM is compiled; NIL if nothing."
  (handler-case (progn (cli::check-arguments arguments) nil)
    (cli::usage-error (condition) (princ-to-string condition))))

(test window.options-are-checked-before-mcclim-as-after-it
  (loop for (word . arguments)
          in '(("--robt" "--window" "--robt" "x") ("takes a value" "--window" "--robot")
               ("takes an integer" "--window" "--seed" "x") ("takes no value" "--window=3")
               ("live run" "--window" "--batch") ("no world" "--window" "--world" "nowhere")
               ("no robot" "--window" "--robot" "nobody" "--world" "watson")
               ("NOBODY" "--robot" "nobody" "--window") ("no command" "nowhere" "--window"))
        for text = (early-refusal-text-for arguments)
        do (is (search word text) "~S: ~S" arguments text)
           (is (equal text (refusal-text-for arguments))
               "~S: ~S" arguments text)))

(test window.options-are-not-refused-because-of-files-that-were-not-loaded
  (loop for arguments in '(("--window") ("--window" "--batch" "--rate" "5")
                           ("--robot" "robbie" "--window") ("--window" "--list" "--batch")
                           ("--window" "--load" "some.lisp" "--robot" "nobody"))
        do (is (null (early-refusal-text-for arguments)) "~S" arguments)))

(test window.line-says-why-quicklisp-could-not-get-mcclim
  "And not that McCLIM is there."
  (call-with-home-directory
   (lambda ()
     (pretend-quicklisp '(error "no road leads there"))
     (let ((text (handler-case (cli::load-window-system t)
                   (cli::bad-line (condition) (princ-to-string condition)))))
       (is (mentions-p text "could not get McCLIM (no road leads there)"))
       (is (mentions-p text "Check the network"))))))
