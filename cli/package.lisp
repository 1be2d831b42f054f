;;;; package.lisp -- the command-line face: the prompt Robot> and its commands.

(defpackage :ars-magna.cli
  (:documentation "Arguments of ./cli/ars-magna, the prompt, the line commands. The only code that
ends the Lisp that it runs in. Manual 3.7, A and E.")
  (:use :cl :ars-magna.base :ars-magna.world :ars-magna.time :ars-magna.robot
        :ars-magna.command :ars-magna.display)
  (:shadowing-import-from :ars-magna.world #:map)
  ;; line, names
  (:export #:line #:line-name #:line-parameters #:line-sentence #:define-line #:all-lines
           #:all-line-names #:find-line #:bad-line)
  ;; arguments
  (:export #:read-argument #:argument-words)
  ;; session, prompt
  (:export #:session #:make-session #:session-robot #:session-errors #:run-session #:prompt)
  ;; worlds
  (:export #:all-worlds)
  ;; main
  (:export #:main))
