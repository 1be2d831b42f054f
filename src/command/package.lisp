;;;; package.lisp -- the command layer: what a program can tell a robot to do.

(defpackage :ars-magna.command
  (:documentation "DEFINE-COMMAND, and the robot's commands by family. Manual 3.1 and 3.4 to 3.6.")
  (:use :cl :ars-magna.base :ars-magna.geometry :ars-magna.world :ars-magna.time
        :ars-magna.robot)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.nisp #:matchvar-p #:matchvar-name)
  ;; command
  (:export #:command #:command-p #:command-name #:command-prompt-name #:command-family
           #:command-section #:command-resource #:command-parameters #:command-results
           #:command-errors #:command-documentation #:command-prefix
           #:parameter-spec #:spec-name #:spec-type #:spec-text
           #:error-code #:error-code-keyword #:error-code-text
           #:all-commands #:*commands* #:find-command #:command-of #:command-shape
           #:command-instant-p)
  ;; operation
  (:export #:operation #:operation-command #:operation-resource #:operation-arguments
           #:operation-p #:operation-world #:operation-finished-p #:operation-continuation
           #:operation-step #:operation-subject #:operation-count #:finish #:succeed
           #:fail-with #:notify #:report #:once-more #:go-on #:go-on-now)
  ;; issuing
  (:export #:issue #:*ticks-follow-p* #:between-runs-p #:*asked-with* #:parameters-bound
           #:doubt-asked-with #:asked-elsewhere-p)
  ;; ownership
  (:export #:under-way #:last-interruption #:under-way-text #:interruption-text)
  ;; error-codes
  (:export #:error-code-meaning #:error-code-remedy #:trouble-p)
  ;; failing
  (:export #:command-failure)
  ;; failures
  (:export #:last-failure #:failure-sentences)
  ;; define-command
  (:export #:define-command)
  ;; withdrawing
  (:export #:withdraw-command)
  ;; hands
  (:export #:check-grips)
  ;; thinking
  (:export #:think)
  ;; moving
  (:export #:robot-set-speed #:robot-set-turn-angle #:robot-turn #:robot-about-face
           #:robot-turn-left #:robot-turn-right #:robot-align-place #:robot-turn-corner
           #:robot-go-forward #:robot-go-distance #:robot-goto-wall #:robot-follow-wall
           #:robot-stop #:robot-place)
  ;; looking
  (:export #:camera-view #:camera-get-place-designator #:camera-get-all-place-designators
           #:camera-get-object-designator #:camera-get-all-object-designators
           #:camera-track #:camera-untrack #:camera-turn #:camera-align-robot
           #:camera-align-place #:robot-goto-designator)
  ;; handling
  (:export #:hand-grasp-desig #:hand-ungrasp #:hand-grasp-check #:hand-track #:grip-watched-p
           #:hand-insert
           #:hand-insert-bin #:hand-remove #:camera-insert #:camera-remove #:storage-bin-open
           #:storage-bin-close)
  ;; manipulations
  (:export #:defmanipulation #:define-manipulation #:manipulate #:run-manipulation
           #:find-manipulation #:all-manipulations #:manipulation-name
           #:manipulation-methods #:method-shape #:method-source #:method-digest
           #:manipulation-method
           #:manipulation-command-p #:command-for)
  ;; soundness
  (:export #:check-commands #:step-p #:withdrawal #:withdrawal-continuation))
