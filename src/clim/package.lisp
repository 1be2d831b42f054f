;;;; package.lisp -- the CLIM layer: the displays in a window. The one door to McCLIM.

(ars-magna.host:define-package :ars-magna.clim
  (:documentation "A window that shows a robot in its world and takes commands. Symbols of McCLIM
are written with package prefixes. Manual B.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.world :ars-magna.time :ars-magna.robot :ars-magna.run :ars-magna.canvas
        :ars-magna.display)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.rpl-robot
                #:*trace-plans* #:plans
                #:holding-plans-p #:interface-p #:interface-runner
                #:interface-simulation)
  (:import-from :ars-magna.rpl
                #:bar #:bar-serial #:bars #:image-of-tasks #:runner-change-mark #:runner-trace
                #:runner-client
                #:trace-so-far #:task-image #:task-image-serial #:task-image-folded-p
                #:task-image-name #:task-image-state #:task-image-form #:task-image-awaits
                #:task-image-since #:task-image-path #:task-image-calls #:task-image-parts
                #:task-image-look #:tree-image-rows #:tree-image-tasks #:tree-image-plans
                #:plan-runner-tasks #:plan-runner-tick #:task-label #:task-state #:task-result
                #:task-runner #:failure-text #:*plan-end-hooks*)
  (:import-from :ars-magna.plots
                #:+time-chart-height+ #:draw-time-charts #:sample-range-at #:sample-range-tick
                #:sample-text
                #:time-chart-series #:time-series-name)
  (:import-from :ars-magna.faces #:editor-server)
  (:import-from :ars-magna.rpl-pictures
                #:draw-task-tree #:fold-mark #:fold-mark-serial #:draw-timeline-page
                #:make-timeline-page
                #:timeline-page-scale #:tick-at)
  (:import-from :ars-magna.cli
                #:fundamental-character-output-stream
                #:stream-line-column #:stream-write-char #:stream-write-string))
