;;;; package.lisp -- the time layer: what happens when, and who may make it happen.

(defpackage :ars-magna.time
  (:documentation "Events, resources and priorities; the tick; commands and questions from any
thread; the journal; the live clock. Knows nothing of worlds and robots.")
  (:use :cl :ars-magna.base)
  ;; resource, agenda
  (:export #:resource #:resource-event #:event #:event-pending-p #:event-resource
           #:agenda #:make-agenda #:agenda-tick #:agenda-pending #:queue-event #:queue-again
           #:cancel-event #:interrupt-event #:pending-event #:advance-agenda)
  ;; simulation
  (:export #:simulation #:make-simulation #:simulation-p #:simulation-name #:simulation-world
           #:simulation-tick #:simulation-seed #:simulation-agenda #:simulation-phases
           #:simulation-busy-tests #:simulation-observers #:simulation-journal
           #:simulation-messages #:simulation-over #:check-not-over
           #:simulation-thread #:simulation-ticking-p #:simulation-rate
           #:*simulation* #:current-simulation #:tick #:run-ticks #:run-until #:idle-p
           #:notify-later #:add-observer #:remove-observer)
  ;; inbox
  (:export #:post #:ask #:asking #:change-from-outside #:simulation-inbox)
  ;; schedule
  (:export #:schedule #:call-scheduled #:abandon #:grab-resource #:release-resource)
  ;; journal
  (:export #:journal #:make-journal #:journal-p #:journal-header #:journal-entries
           #:journal-end #:journal-length #:note #:externalize #:internalize #:make-reference
           #:internalize-reference #:write-journal #:read-journal #:apply-entry
           #:damaged-journal #:truncated-journal)
  ;; clock
  (:export #:start-clock #:stop-clock #:end-run #:live-p #:pause #:resume #:step-ticks #:set-rate
           #:paused-p #:*default-rate* #:*hog-seconds* #:await-idle #:call-watched #:call-as-owner
           #:seconds-now))
