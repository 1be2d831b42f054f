;;;; package.lisp -- the run layer: worlds with robots in them, as time goes by.

(defpackage :ars-magna.run
  (:documentation "A run: its tick, its journal and replay, its digest; headless or live, and what
takes part in it. Manual 2.3 and appendix A.")
  (:use :cl :ars-magna.base :ars-magna.world :ars-magna.time :ars-magna.robot :ars-magna.command)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map)
  ;; participant
  (:export #:participant-after-tick #:participant-busy-p #:participant-reseed #:participant-digest
           #:participant-copy #:participant-end)
  ;; run
  (:export #:simulation #:simulation-p #:simulation-name #:simulation-world #:simulation-timeline
           #:simulation-tick #:simulation-seed #:simulation-robots #:simulation-journal
           #:simulation-gate #:simulation-observers #:simulation-participants
           #:simulation-messages #:simulation-over #:simulation-agenda #:simulation-ticking-p
           #:simulation-rate #:simulation-thread
           #:add-observer #:remove-observer #:add-participant #:remove-participant
           #:idle-p #:robot-simulation #:resident-simulation #:fresh-simulation #:headless-p
           #:copy-simulation #:set-seed #:end-simulation)
  ;; journal
  (:export #:journal #:make-journal #:journal-p #:journal-header #:journal-entries
           #:journal-end #:journal-length #:*journal-limit* #:note #:begin-journal
           #:end-of-journal #:truncated-journal)
  ;; plain-data
  (:export #:tree-p)
  ;; references
  (:export #:externalize #:internalize #:dereference)
  ;; fingerprint
  (:export #:definitions-of #:definition-entry)
  ;; tick, headless
  (:export #:tick #:run-ticks #:run-until #:step-ticks #:with-simulation #:call-with-simulation
           #:*simulation-variables* #:variables-among)
  ;; live
  (:export #:simulator #:stop-simulator #:start-clock #:stop-clock #:await-idle #:call-as-owner
           #:*simulator-hooks*)
  ;; state, replay
  (:export #:state-digest #:replay #:with-replay #:call-with-replay #:save-journal #:load-journal
           #:write-journal #:read-journal #:damaged-journal #:different-definitions
           #:replay-anyway))
