;;;; package.lisp -- what people see of plans that run, and have run.

(defpackage :ars-magna.rpl.seeing
  (:documentation "Shows plans: tasks with their stacks and variables, what came of them and why,
the debugger's side of plans. Changes nothing.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents :ars-magna.rpl.tasks :ars-magna.rpl.language
        :ars-magna.rpl.constructs)
  ;; variables
  (:export #:task-stack #:task-variables)
  ;; subjects
  (:export #:*runner-in-use* #:*still* #:runner-to-see #:all-tasks #:task-numbered #:task-with)
  ;; tree
  (:export #:print-tasks)
  ;; history
  (:export #:task-ancestry #:task-commands #:task-failures #:task-history #:trace-of)
  ;; why
  (:export #:why #:reasons)
  ;; spans
  (:export #:bar #:bar-call-p #:bar-commands #:bar-depth #:bar-end #:bar-failure #:bar-form
           #:bar-label #:whole-bar-label #:bar-name #:bar-outcome #:bar-parent #:bar-parts
           #:bar-serial #:bar-spans #:bar-start #:bars #:span #:span-error
           #:span-end #:span-kind #:span-start #:span-text)
  ;; breaking
  (:export #:*break-on-plan-failures* #:plan-break #:plan-break-p #:plan-break-frame
           #:plan-break-task)
  ;; stepping
  (:export #:*step-plans* #:step-task)
  ;; images
  (:export #:image-of-tasks #:runner-mark #:task-image #:task-image-p #:task-image-serial
           #:task-image-depth #:task-image-look #:task-image-state #:task-image-name
           #:task-image-form #:task-image-calls #:task-image-awaits #:task-image-since
           #:task-image-path
           #:task-image-parts #:task-image-folded-p #:tree-image #:tree-image-p
           #:tree-image-tick #:tree-image-rows #:tree-image-plans #:tree-image-tasks))
