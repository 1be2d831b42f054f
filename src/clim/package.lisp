;;;; package.lisp -- the CLIM layer: the displays in a window. The one door to McCLIM.

(defpackage :ars-magna.clim
  (:documentation "A window that shows a robot in its world while it runs, and takes commands.
McCLIM's symbols are written with their packages. Manual B.")
  (:use :cl :ars-magna.base :ars-magna.world :ars-magna.time :ars-magna.robot
        :ars-magna.run :ars-magna.canvas
        :ars-magna.display)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.rpl-robot #:plans)
  (:import-from :ars-magna.cli
                #:fundamental-character-output-stream #:fundamental-character-input-stream
                #:stream-line-column #:stream-write-char #:stream-write-string
                #:stream-read-char #:stream-read-line #:stream-unread-char)
  ;; watcher
  (:export #:watcher #:make-watcher #:start-watching #:stop-watching #:watch-simulation
           #:watcher-snapshot #:watcher-robot #:painted)
  ;; canvas
  (:export #:clim-canvas #:canvas-subjects #:subject-at)
  ;; frame
  (:export #:robot-window #:make-robot-window #:window-watcher #:window-layers #:refresh)
  ;; opening
  (:export #:open-window #:close-window #:find-window))
