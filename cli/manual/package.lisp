;;;; package.lisp -- the manual as a set of HTML pages: ./cli/ars-magna --manual.

(ars-magna.host:define-package :ars-magna.manual
  (:documentation "Writes the manual: a guide from the README.md files, and a reference from
definitions.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:shadow #:entry-name)                        ; an entry here is of the reference
  (:import-from :ars-magna.world
                #:attribute-name #:attribute-kind #:attribute-domain #:attribute-success
                #:attribute-base #:attribute-max-mult #:attribute-noticed #:attribute-supporters
                #:substance-parameter
                #:place-type-rank #:place-type-confusion #:place-type-invisible-p
                #:kicker-prob #:map-width #:map-height #:world-map #:map-name)
  (:import-from :ars-magna.robot
                #:find-robot #:robot-world #:robot-cameras #:robot-hands #:robot-bins)
  (:import-from :ars-magna.command
                #:all-commands #:command-name #:command-prompt-name #:command-family
                #:command-section #:command-documentation #:command-resource
                #:command-parameters #:command-results #:command-errors
                #:spec-name #:spec-type #:spec-text #:error-code-keyword #:error-code-text
                #:error-code-meaning #:error-code-remedy
                #:manipulation-name #:manipulation-methods #:method-signature)
  (:import-from :ars-magna.rpl #:all-constructs #:procedure-lambda-list)
  (:import-from :ars-magna.rpl-robot #:all-fluent-variables)
  (:import-from :ars-magna.experiment #:experiment-documentation)
  (:import-from :ars-magna.cli
                #:all-line-commands #:line-name #:line-family #:line-sentence #:line-details
                #:line-parameters #:line-full-name #:line-action #:line-command-usage
                #:line-parameter-help
                #:manipulation-usages #:documentation-texts #:first-full-sentence))
