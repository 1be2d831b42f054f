;;;; package.lisp -- the run layer: worlds with robots in them, as time goes by.

(defpackage :ars-magna.run
  (:documentation "A run: its tick, its journal and replay, its digest; headless or live, and what
takes part in it. Manual 2.3 and appendix A.")
  (:use :cl :ars-magna.base :ars-magna.world :ars-magna.time :ars-magna.robot :ars-magna.command)
  (:import-from :ars-magna.geometry #:pt #:interval #:pt-interval)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map)
  ;; participant
  (:export #:participant-after-tick #:participant-after-ticks #:participant-origin
           #:participant-busy-p #:participant-at-work-p
           #:participant-reseed #:participant-digest
           #:participant-copy #:participant-end #:participant-clock-stopped #:participant-unfinished
           #:participant-cut-off #:participant-around-p)
  ;; run
  (:export #:simulation #:simulation-p #:simulation-name #:simulation-world #:simulation-timeline
           #:simulation-tick #:simulation-seed #:simulation-robots #:simulation-journal
           #:simulation-gate #:simulation-observers #:simulation-trails #:simulation-participants
           #:simulation-messages #:simulation-over #:simulation-agenda #:simulation-ticking-p
           #:simulation-rate #:simulation-thinking #:simulation-thread #:latest
           #:add-observer #:remove-observer #:add-participant #:remove-participant
           #:idle-p #:robot-simulation #:fresh-simulation #:headless-p
           #:set-seed #:end-simulation)
  ;; environments, forking
  (:export #:environment-of #:note-environment #:fork-p #:fork-simulation #:release-fork
           #:with-fork #:call-with-fork #:call-in-fork #:*fork-asker* #:refuse-fork
           #:participant-at-rest #:check-forkable
           #:call-as-participant-makes-way #:participant-place #:counterpart-here #:counterpart)
  ;; thinking
  (:export #:set-thinking)
  ;; past, keeping, rewinding
  (:export #:simulation-past #:simulation-plans-dice-p #:note-doing #:let-fork-be-kept
           #:keep-forks #:*forks-to-keep*
           #:rewind #:earliest-tick #:*rewind-hooks* #:*rewound-end-hooks*)
  ;; journal
  (:export #:journal #:make-journal #:journal-p #:journal-header #:journal-entries
           #:journal-end #:journal-length #:journal-remarks #:remark #:unremark #:*journal-limit*
           #:note #:begin-journal
           #:end-of-journal #:truncated-journal)
  ;; plain-data
  (:export #:tree-p)
  ;; references
  (:export #:externalize #:internalize #:dereference)
  ;; fingerprint
  (:export #:definitions-of #:definition-entry)
  ;; tick, headless
  (:export #:tick #:run-ticks #:run-until #:step-ticks #:with-simulation #:call-with-simulation
           #:simulation-errors #:undone-text #:note-lines-typed
           #:*simulation-variables* #:variables-among)
  ;; live
  (:export #:simulator #:stop-simulator #:start-clock #:stop-clock #:await-idle #:doubt-wait
           #:call-as-owner #:*simulator-hooks* #:*hook-options*)
  ;; state, replay
  (:export #:state-digest #:replay #:with-replay #:call-with-replay #:replaying #:repeated-words
           #:journal-meant
           #:save-journal #:load-journal
           #:write-journal #:read-journal #:damaged-file #:damaged-journal
           #:different-definitions #:replay-anyway)
  ;; saving, loading
  (:export #:save-simulation #:load-simulation #:with-loaded-simulation
           #:call-with-loaded-simulation #:damaged-simulation #:unsavable #:unsavable-parts
           #:save-without #:load-anyway)
  ;; status
  (:export #:status #:designator-status #:robot-meant))
