;;;; package.lisp -- the time layer: what happens when, and who may make it happen.

(defpackage :ars-magna.time
  (:documentation "Events, resources and priorities; requests from any thread and the timeline that
they wait in; the pace of a live one. Knows nothing of worlds, robots and journals.")
  (:use :cl :ars-magna.base)
  ;; resource, event, agenda
  (:export #:resource #:resource-event #:resource-interruption #:resource-asked #:note-asked
           #:event #:event-pending-p
           #:event-resource #:event-time #:event-priority #:event-function #:event-interrupt
           #:agenda #:make-agenda #:agenda-tick #:agenda-pending #:queue-event
           #:queue-again #:+longest-delay+ #:cancel-event #:interrupt-event
           #:pending-event #:advance-agenda
           #:pending-events)
  ;; request
  (:export #:request #:make-request #:request-operator #:request-arguments #:request-entry
           #:request-asker #:request-forked-p #:request-phase #:perform)
  ;; interruptions
  (:export #:request-name #:note-interruption #:interruption #:interruption-tick #:interruption-what
           #:interruption-asker #:interruption-by #:interruption-by-asker)
  ;; phases
  (:export #:phase-number #:changing-phase-p #:telling-phase-p)
  ;; timeline
  (:export #:timeline #:make-timeline #:timeline-p #:timeline-of #:timeline-name #:timeline-tick
           #:timeline-agenda #:timeline-run #:timeline-over #:timeline-custody
           #:timeline-phase #:phase-here #:timeline-moments #:timeline-on-moment #:begin-moment
           #:timeline-ticking-p #:timeline-passing-p #:timeline-notifications #:timeline-untold
           #:timeline-tick-dice
           #:timeline-inbox #:timeline-pacing #:timeline-fork-p #:check-not-over
           #:check-own-run #:check-not-secluded #:secluded
           #:*simulation* #:current-simulation
           #:wake-owner #:post #:post-again #:take-requests #:asked-inside-p #:owner-p
           #:*repeated* #:untold-p
           #:notify-later #:deliver-notifications)
  ;; thinking
  (:export #:check-thinking #:thinking-modes-text #:thinking-mode-p
           #:timeline-thinking #:set-timeline-thinking
           #:give-threads #:thinking-charged-p #:thinking-budget #:timeline-real-p)
  ;; custody, asking
  (:export #:custody-questions #:custody-starter #:share-custody
           #:answer-questions #:call-with-custody #:mine-p
           #:ask #:asking #:have-done)
  ;; pacing, stopping, clock
  (:export #:answer-meanwhile)
  (:export #:timeline-thread #:pacer-p #:check-rate #:live-p #:paused-p #:clock-trouble #:pause
           #:stands-still-p #:*waits-while-paused-p* #:resume
           #:let-pass #:pace #:set-rate #:*default-rate* #:*hog-seconds*
           #:hog-seconds
           #:seconds-now #:users-code-under-way #:users-code-broken-p #:abort-hog #:stop-pacing
           #:claim-pacing #:claimed-p #:unclaim-pacing #:call-alone
           #:start-pacing)
  ;; schedule
  (:export #:schedule #:call-scheduled #:abandon #:grab-resource #:release-resource
           #:scheduled)
  ;; soundness
  (:export #:fill-agenda #:check-occupant #:check-request))
