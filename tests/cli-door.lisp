;;;; cli-door.lisp -- --window without an X server or without McCLIM.

(in-package :ars-magna.tests)

(def-suite* cli-door :in ars-magna)

;;; The program starts in a new home directory, in which nothing is installed or compiled. It never
;;; gets so far as to open a window, so no X server is needed.

(defvar *no-libraries* "CL_SOURCE_REGISTRY=(:source-registry :ignore-inherited-configuration)"
  "What in the environment lets ASDF find nothing.")

(defun start-with-window (&rest variables)
  "Start ./cli/ars-magna --window with VARIABLES in the environment, texts like DISPLAY=:0, and
without McCLIM for ASDF to find. Return its error output and status."
  (multiple-value-bind (output errors status)
      (uiop:run-program `("env" ,@variables ,*no-libraries*
                               ,(namestring (project-file "cli/ars-magna")) "--window")
                        :error-output :string :ignore-error-status t)
    (declare (ignore output))
    (values errors status)))

(defun start-with-window-at-home ()
  "Start ./cli/ars-magna --window, with what is in the home directory and nothing else."
  (start-with-window "DISPLAY=:0" (format nil "XDG_CACHE_HOME=~A.cache" (uiop:getenv "HOME"))))

(defun pretend-quicklisp (form)
  "Let the home directory have a Quicklisp that does FORM when it is loaded."
  (let ((file (uiop:subpathname (user-homedir-pathname) "quicklisp/setup.lisp")))
    (ensure-directories-exist file)
    (with-open-file (stream file :direction :output)
      (prin1 form stream))))

(test window.option-says-that-there-is-no-display
  (multiple-value-bind (errors status) (start-with-window "DISPLAY=")
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

(test window.line-says-why-quicklisp-could-not-get-mcclim
  "And not that McCLIM is there."
  (call-with-home-directory
   (lambda ()
     (pretend-quicklisp '(error "no road leads there"))
     (let ((text (handler-case (cli::load-window-system t)
                   (cli::bad-line (condition) (princ-to-string condition)))))
       (is (mentions-p text "could not get McCLIM (no road leads there)"))
       (is (mentions-p text "Check the network"))))))
