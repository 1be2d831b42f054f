;;;; ars-magna.asd -- the systems and the order in which their layers load.

(defsystem "ars-magna/core"
  :description "The simulator alone: worlds, robots, runs, plans, pictures."
  :depends-on ("alexandria" "bordeaux-threads" "closer-mop" "named-readtables" "sb-cltl2"
               "sb-introspect" "sb-posix")
  :serial t
  :components
  ((:module "src/host" :serial t
    :components ((:file "package") (:file "versions") (:file "language") (:file "memory")
                 (:file "classes") (:file "files") (:file "interrupts")
                 (:file "closures") (:file "code") (:file "environments")
                 (:file "compiler") (:file "debugger") (:file "threads")))
   (:module "src/basics" :serial t
    :components ((:file "package") (:file "text") (:file "records")
                 (:file "conditions") (:file "telling") (:file "fixed-point")
                 (:file "trigonometry") (:file "exponentials") (:file "dice") (:file "random")
                 (:file "files") (:file "formats") (:file "plain-values")))
   (:module "src/definitions" :serial t
    :components ((:file "package") (:file "sources") (:file "places-in-text")
                 (:file "definitions") (:file "user-macros") (:file "registry")
                 (:file "own-definitions") (:file "messages") (:file "troubles")
                 (:file "user-code") (:file "parameters") (:file "parameters-of-runs")
                 (:file "kinds") (:file "facts") (:file "operators") (:file "slips")
                 (:file "assignments")))
   (:module "src/copying" :serial t
    :components ((:file "package") (:file "copiers") (:file "copying") (:file "state")))
   (:module "base" :pathname "src" :components ((:file "base")))
   (:module "src/geometry" :serial t
    :components ((:file "package") (:file "types") (:file "points") (:file "intervals")
                 (:file "angles")))
   (:module "src/nisp" :serial t
    :components ((:file "package") (:file "control") (:file "binding") (:file "types")
                 (:file "reader")))
   (:module "src/world" :serial t
    :components ((:file "package") (:file "clauses") (:file "attributes") (:file "substances")
                 (:file "draw-functions") (:file "map") (:file "place-types") (:file "places")
                 (:file "built-in-places") (:file "map-clauses") (:file "walls")
                 (:file "map-cache") (:file "thing") (:file "stock") (:file "world")
                 (:file "kickers") (:file "reading-ahead") (:file "kicker-groups")
                 (:file "placing") (:file "recipes") (:file "thing-attributes") (:file "bodies")
                 (:file "forking")
                 (:file "residents") (:file "defmap") (:file "soundness")))
   (:module "src/time" :serial t
    :components ((:file "package") (:file "request") (:file "agenda") (:file "custody")
                 (:file "timeline") (:file "asking") (:file "pacing") (:file "clock")
                 (:file "schedule") (:file "soundness")))
   (:module "src/robot" :serial t
    :components ((:file "package") (:file "parts") (:file "bodies") (:file "odometer")
                 (:file "sight") (:file "designator") (:file "motion") (:file "tracks")
                 (:file "inside") (:file "making") (:file "defrobot") (:file "own-changes")
                 (:file "messages") (:file "thoughts") (:file "rays") (:file "matching")
                 (:file "ranging") (:file "sightings") (:file "scanning") (:file "tending")
                 (:file "track-matching")
                 (:file "soundness")))
   (:module "src/command" :serial t
    :components ((:file "package") (:file "command") (:file "error-codes") (:file "operation")
                 (:file "issuing") (:file "failures") (:file "define-command") (:file "turning")
                 (:file "driving") (:file "hands") (:file "inserting") (:file "giving")
                 (:file "patterns")
                 (:file "manipulations") (:file "manipulating") (:file "looking")
                 (:file "withdrawing") (:file "approaching") (:file "thinking") (:file "sending")
                 (:file "stepping") (:file "pushing")
                 (:file "soundness")))
   (:module "src/run" :serial t
    :components ((:file "package") (:file "participant") (:file "run")
                 (:file "plain-data") (:file "references") (:file "robot-list")
                 (:file "run-variables") (:file "run-variable-lists") (:file "journal")
                 (:file "fingerprint") (:file "past")
                 (:file "headers") (:file "joining")
                 (:file "tick") (:file "environments") (:file "shared-variables")
                 (:file "forking") (:file "passing") (:file "leaving") (:file "headless")
                 (:file "live") (:file "residents") (:file "sealed-lines") (:file "journal-text")
                 (:file "replay") (:file "redoing") (:file "rewinding") (:file "inventory")
                 (:file "saved-values") (:file "saving") (:file "restoring") (:file "loading")
                 (:file "status") (:file "measures")))
   (:module "src/display" :serial t
    :components ((:file "canvas-package") (:file "colors") (:file "canvas") (:file "drawing")
                 (:file "svg") (:file "package") (:file "layer") (:file "history")
                 (:file "snapshot") (:file "subjects") (:file "inks") (:file "terrain")
                 (:file "movers") (:file "senses") (:file "way-lines") (:file "name-boxes")
                 (:file "label-targets") (:file "names") (:file "live-view") (:file "layers")
                 (:file "legend") (:file "margins") (:file "displays")
                 (:file "text-blocks") (:file "text-sheet") (:file "text-map") (:file "picture")
                 (:file "moments") (:static-file "film.js") (:static-file "film.css")
                 (:file "film") (:file "animation") (:file "windows")))
   (:module "rpl/fluents" :serial t
    :components ((:file "package") (:file "realm") (:file "home") (:file "fluent")
                 (:file "network") (:file "propagation") (:file "operators")))
   (:module "rpl/tasks" :serial t
    :components ((:file "package") (:file "queues") (:file "failure") (:file "agents")
                 (:file "task") (:file "extras") (:file "trace") (:file "runner") (:file "ready")
                 (:file "charging") (:file "tracing") (:file "machine") (:file "ending")
                 (:file "stepping") (:file "calls") (:file "procedure") (:file "report")
                 (:file "care") (:file "reacting") (:file "engine") (:file "blocking")
                 (:file "variables") (:file "stillness")))
   (:module "rpl/language" :serial t
    :components ((:file "package") (:file "source") (:file "scope") (:file "suspension")
                 (:file "checking") (:file "mistakes") (:file "known-fluents") (:file "compiler")
                 (:file "construct") (:file "branching") (:file "binding") (:file "repeating")
                 (:file "tags") (:file "calling") (:file "definitions")))
   (:module "rpl/constructs" :serial t
    :components ((:file "package") (:file "waiting") (:file "failing") (:file "branches")
                 (:file "policy") (:file "thinking") (:file "suspension")
                 (:file "task-variables") (:file "ordering") (:file "valve") (:file "with-valve")
                 (:file "named-policies") (:file "goals") (:file "achieving")
                 (:file "at-location")))
   (:module "rpl/seeing" :serial t
    :components ((:file "package") (:file "describing") (:file "history") (:file "why")
                 (:file "stepping") (:file "tree")))
   (:module "rpl" :serial t
    :components ((:file "rpl")))
   (:module "rpl/robot" :serial t
    :components ((:file "package") (:file "fluents") (:file "interface") (:file "drivers")
                 (:file "under-way") (:file "clashes") (:file "reacting") (:file "forking")
                 (:file "thread") (:file "starting") (:file "outcomes") (:file "commands")
                 (:file "messages") (:file "choosing") (:file "runs") (:file "warnings")
                 (:file "on-robot") (:file "seeing")))
   (:module "src" :serial t
    :components ((:file "slots") (:file "faces") (:file "user-package") (:file "editors")
                 (:file "ars"))))
  ;; The packages are locked once they are loaded.
  :perform (prepare-op (operation system)
             (declare (ignore operation system))
             (when (find-package :ars-magna.faces)
               (symbol-call :ars-magna.faces :unlock-packages))))

(defsystem "ars-magna"
  :description "An abstract robot simulator for people who build reactive planners."
  :version "1.11.0"
  :license "MIT"
  :depends-on ("ars-magna/core" "chipz" "lparallel")
  :serial t
  :components
  ((:module "src/statistics" :serial t
    :components ((:file "package") (:file "samples") (:file "distributions")
                 (:file "intervals") (:file "tests") (:file "survival") (:file "designs")))
   (:module "src/ways" :serial t
    :components ((:file "package") (:file "terrain") (:file "field") (:file "chart")
                 (:file "descent") (:file "ways")))
   (:module "src/floors" :serial t
    :components ((:file "package") (:file "yaml") (:file "description") (:file "pgm")
                 (:file "png-chunks") (:file "png") (:file "grid") (:file "importing")
                 (:file "exporting")))
   (:module "rpl/pictures" :serial t
    :components ((:file "package") (:file "bars") (:file "timeline") (:file "task-tree")))
   (:module "src/plots" :serial t
    :components ((:file "package") (:file "figures") (:file "looks") (:file "axis")
                 (:file "plane") (:file "line-chart") (:file "survival-chart")
                 (:file "row-charts") (:file "time-series") (:file "time-chart")))
   (:module "src/trails" :serial t
    :components ((:file "package") (:file "trails") (:file "picture")
                 (:file "spots") (:file "run-picture")))
   (:module "rpl/projecting" :serial t
    :components ((:file "package") (:file "projection") (:file "question") (:file "rolling-out")
                 (:file "projecting") (:file "looking")))
   (:module "src/experiment" :serial t
    :components ((:file "package")))
   (:module "src/experiment/question" :serial t
    :components ((:file "values") (:file "experiment") (:file "clauses")
                 (:file "doubts") (:file "defexperiment")))
   (:module "src/experiment/trial" :serial t
    :components ((:file "outcome") (:file "data") (:file "trial") (:file "fingerprint")))
   (:module "src/experiment/table" :serial t
    :components ((:file "rows") (:file "lines") (:file "series") (:file "directory")
                 (:file "description") (:file "results") (:file "merging")))
   (:module "src/experiment/running" :serial t
    :components ((:file "workers") (:file "repeatable") (:file "renewing") (:file "running")))
   (:module "src/experiment/report" :serial t
    :components ((:file "estimates") (:file "text-table") (:file "report")))
   (:module "src/experiment/comparison" :serial t
    :components ((:file "differences") (:file "contrasts") (:file "verdicts")
                 (:file "designators") (:file "comparing")))
   (:module "src/experiment/pictures" :serial t
    :components ((:file "charts") (:file "pictures")))
   (:module "src/experiment/replay" :serial t
    :components ((:file "replaying") (:file "failures")))
   (:module "src/experiment/testbed" :serial t
    :components ((:file "relations") (:file "testbed") (:file "running") (:file "games")
                 (:file "claims") (:file "game-picture") (:file "page")))
   (:module "src" :components ((:file "all"))))
  ;; The packages are locked once they are loaded.
  :perform (prepare-op (operation system)
             (declare (ignore operation system))
             (when (find-package :ars-magna.faces)
               (symbol-call :ars-magna.faces :unlock-packages)))
  :perform (load-op :after (operation system)
             (declare (ignore operation system))
             (symbol-call :ars-magna.faces :greet))
  :in-order-to ((test-op (test-op "ars-magna/tests"))))

(defsystem "ars-magna/worlds"
  :description "Worlds, robots and plans to start with."
  :depends-on ("ars-magna" "ars-magna/rap")
  :serial t
  :components
  ((:module "worlds" :serial t
    :components ((:file "package") (:file "prototypes") (:file "kickers")
                 (:file "manipulations") (:file "watson") (:file "office") (:file "hall")
                 (:file "tiny") (:file "doorways") (:file "plans-reckoning")
                 (:file "traffic") (:file "plans-moving") (:file "plans-looking")
                 (:file "plans-handling")
                 (:file "plans-errands") (:file "plans-locks") (:file "trials")
                 (:file "plans-searching") (:file "recognising") (:file "plans-recognising")
                 (:file "going") (:file "errand") (:file "experiments") (:file "choosing")))
   (:module "worlds/testbeds/tileworld" :serial t
    :components ((:file "package") (:file "holes") (:file "agents") (:file "cameras")
                 (:file "foresight")))
   (:module "worlds/testbeds/tileworld-tiles" :serial t
    :components ((:file "package") (:file "tiles") (:file "agents") (:file "camera")))
   (:module "worlds/testbeds/tileworld-wind" :serial t
    :components ((:file "package") (:file "wind") (:file "agents")))
   (:module "worlds/testbeds/pursuit" :serial t
    :components ((:file "package") (:file "pursuit") (:file "playing") (:file "modelling")))
   (:module "worlds/testbeds/truckworld" :serial t
    :components ((:file "package") (:file "country") (:file "events") (:file "actions")
                 (:file "work") (:file "agents") (:file "raps") (:file "testbed")))))

;;; Loaded by worlds/figures.
(defsystem "ars-magna/figures"
  :description "Tables and pictures of the shipped experiments, for worlds/README.md."
  :depends-on ("ars-magna/worlds")
  :components ((:module "worlds" :serial t :components ((:file "ward") (:file "figures")))))

(defsystem "ars-magna/cli"
  :description "The prompt Robot>."
  :depends-on ("ars-magna" "ars-magna/worlds" "trivial-gray-streams")
  :serial t
  :components
  ((:module "cli" :serial t
    :components
    ((:file "package")
     (:module "terminal" :serial t
      :components ((:file "process") (:file "layout") (:file "input") (:file "escapes")
                   (:file "drawn-line") (:file "console") (:file "screen") (:file "json")))
     (:module "editing" :serial t
      :components ((:file "keys") (:file "changes") (:file "history") (:file "kinds-of-lines")
                   (:file "editor") (:file "typing")))
     (:module "prompt" :serial t
      :components ((:file "loading") (:file "quantities") (:file "reporting") (:file "worlds")
                   (:file "listener") (:file "session") (:file "open-trial") (:file "clx")
                   (:file "compiling")
                   (:file "listening") (:file "jobs") (:file "line") (:file "finding")
                   (:file "arguments") (:file "plans") (:file "break-requests")
                   (:file "reading") (:file "carrying-out") (:file "debugger")
                   (:file "completing") (:file "recordings")
                   (:file "plotting") (:file "prompt")))
     (:module "lines" :serial t
      :components ((:file "own-lines") (:file "robots-lines") (:file "running-lines")
                   (:file "status-lines")
                   (:file "map-lines") (:file "world-lines") (:file "plan-lines")
                   (:file "acting-lines") (:file "message-lines") (:file "measure-lines")
                   (:file "topics") (:file "help")
                   (:file "picture-lines") (:file "film-lines") (:file "plot-lines")
                   (:file "trials") (:file "other-runs")))
     (:module "shell" :serial t
      :components ((:file "options") (:file "experiments") (:file "spreading")
                   (:file "experiment-command") (:file "testbeds") (:file "scripts")
                   (:file "main")))))))

(defsystem "ars-magna/clim"
  :description "The displays in a window."
  ;; The smallest of McCLIM's systems that shows a frame; whoever has the whole has it too.
  :depends-on ("ars-magna" "ars-magna/cli" "mcclim/looks")
  :serial t
  :components
  ((:module "src/clim" :serial t
    :components ((:file "package") (:file "plan-look") (:file "watcher") (:file "arrangement")
                 (:file "looks") (:file "magnification") (:file "fallback-fonts") (:file "canvas")
                 (:file "panes") (:file "world-pane")
                 (:file "transcript") (:file "clipboard") (:file "transcript-pane")
                 (:file "prompt") (:file "rate-slider") (:file "bar") (:file "popup")
                 (:file "pointing") (:file "suggestions") (:file "interactor") (:file "offers")
                 (:file "plan-pane") (:file "parameter-pane") (:file "plot-pane")
                 (:file "world-mouse") (:file "layout-pane") (:file "choosing")
                 (:file "keyboard") (:file "window") (:file "commands") (:file "recording")
                 (:file "menus") (:file "opening")
                 (:file "x-server") (:file "following")))))

(defsystem "ars-magna/rap"
  :description "Reactive action packages on the plan language."
  :depends-on ("ars-magna")
  :serial t
  :components
  ((:module "rpl/rap" :serial t
    :components ((:file "package") (:file "memory") (:file "queries") (:file "rules")
                 (:file "reading") (:file "task-nets") (:file "trying") (:file "awaiting")
                 (:file "define-rap") (:file "agenda") (:file "working")))))

(defsystem "ars-magna/fiveam"
  :description "Checks for regression suites: plans that are held to their rates of success."
  :depends-on ("ars-magna" "fiveam")
  :serial t
  :components
  ((:module "src/fiveam" :serial t
    :components ((:file "package") (:file "deciding") (:file "trying") (:file "checking")))))

;;; Loaded by ./cli/ars-magna --manual.
(defsystem "ars-magna/manual"
  :description "Writes the manual as HTML pages."
  :depends-on ("ars-magna" "ars-magna/worlds" "ars-magna/cli" "ars-magna/fiveam")
  :serial t
  :components
  ((:module "cli/manual" :serial t
    :components ((:file "package") (:file "html") (:file "guide") (:file "examples")
                 (:file "entries") (:file "definition-entries") (:file "linking")
                 (:file "search-index") (:file "writing")))))

;;; Loaded after the tests where McCLIM is found: see load-tests in cli/build.lisp.
(defsystem "ars-magna/clim-tests"
  :description "What the window claims."
  :depends-on ("ars-magna/tests" "ars-magna/clim" "fiveam")
  :serial t
  :components ((:module "tests" :serial t
                :components ((:file "clim-client") (:file "clim-window") (:file "clim-layout")
                             (:file "clim-view") (:file "clim-pointing")
                             (:file "clim-holding") (:file "clim-robots") (:file "clim-choosing")
                             (:file "clim-menus")
                             (:file "clim-progress") (:file "clim-plans") (:file "clim-plots")
                             (:file "clim-truths")
                             (:file "clim-talking") (:file "clim-going-on")
                             (:file "clim-awaiting")
                             (:file "clim-x-server") (:file "clim-magnification")
                             (:file "clim-clipboard") (:file "clim-keyboard")
                             (:file "clim-controls") (:file "clim-names")))))

(defsystem "ars-magna/tests"
  :description "All that ARS MAGNA claims."
  :depends-on ("ars-magna" "ars-magna/worlds" "ars-magna/figures" "ars-magna/cli"
               "ars-magna/manual" "ars-magna/fiveam" "ars-magna/rap" "fiveam")
  :serial t
  :components
  ((:module "tests" :serial t
    :components ((:file "package") (:file "base") (:file "base-doors") (:file "elementary")
                 (:file "geometry") (:file "geometry-limits")
                 (:file "nisp") (:file "world") (:file "world-caches") (:file "world-places")
                 (:file "world-things") (:file "world-kickers") (:file "world-large") (:file "ways")
                 (:file "ways-users") (:file "floors") (:file "floors-uses")
                 (:file "floors-hostile") (:file "floors-png")
                 (:file "floors-png-hostile") (:file "time") (:file "robot")
                 (:file "moving") (:file "random-driver") (:file "random-restarts")
                 (:file "determinism") (:file "lisps-dice") (:file "journals")
                 (:file "journals-forged")
                 (:file "journals-definitions") (:file "worlds") (:file "worlds-moving")
                 (:file "looking") (:file "looking-views") (:file "looking-tracks")
                 (:file "looking-hidden")
                 (:file "looking-cameras") (:file "looking-approach") (:file "corners")
                 (:file "approaching") (:file "handling") (:file "handling-inside")
                 (:file "handling-bins") (:file "handling-chance") (:file "manipulations")
                 (:file "shipped-manipulations") (:file "statistics")
                 (:file "inference-tables") (:file "inference-samples")
                 (:file "inference-comparing") (:file "inference-survival")
                 (:file "inference-coverage") (:file "rpl-fluents")
                 (:file "rpl-compiler") (:file "rpl-symbol-macros") (:file "rpl-plans")
                 (:file "rpl-policies")
                 (:file "rpl-failures") (:file "rpl-engine") (:file "rpl-control")
                 (:file "rpl-orders") (:file "rpl-valves") (:file "rpl-alone")
                 (:file "rpl-stress") (:file "rpl-valve-stress")
                 (:file "rpl-constructs") (:file "rpl-fairness") (:file "rpl-care")
                 (:file "rpl-telling") (:file "rpl-kills") (:file "rpl-hostile")
                 (:file "rpl-views") (:file "rpl-named-policies") (:file "rpl-goals")
                 (:file "rpl-at-location") (:file "rpl-replacing") (:file "rpl-examples")
                 (:file "rpl-robot-answers") (:file "rpl-agents")
                 (:file "seeing-robots") (:file "giving") (:file "rpl-robot") (:file "rpl-issue")
                 (:file "rpl-rushing") (:file "rpl-clashes") (:file "rpl-left")
                 (:file "rpl-robot-live") (:file "rpl-robot-published") (:file "rpl-gone")
                 (:file "rpl-text") (:file "rpl-text-places") (:file "rpl-examples-robot")
                 (:file "rpl-examples-goals") (:file "plans") (:file "plans-killed")
                 (:file "worlds-searching")
                 (:file "svg-reading") (:file "display") (:file "display-files")
                 (:file "palette") (:file "pictures") (:file "picture-margins")
                 (:file "picture-crowds") (:file "bundles") (:file "display-details")
                 (:file "live-views") (:file "display-drawing") (:file "films") (:file "run-pictures")
                 (:file "overlapping-ways") (:file "run-picture-parts")
                 (:file "moments") (:file "plots") (:file "plots-text") (:file "time-series")
                 (:file "clim") (:file "cli") (:file "cli-telling")
                 (:file "text-maps") (:file "cli-quantities")
                 (:file "editing") (:file "editing-history") (:file "editing-screens")
                 (:file "completing")
                 (:file "ways-going") (:file "robot-traffic") (:file "cli-plans")
                 (:file "cli-colour")
                 (:file "cli-rewinding")
                 (:file "cli-films") (:file "cli-plots")
                 (:file "cli-robots") (:file "cli-all-robots") (:file "cli-hostile")
                 (:file "cli-debugger") (:file "cli-answers") (:file "cli-sessions")
                 (:file "cli-going-on")
                 (:file "experiment-replay")
                 (:file "cli-trials") (:file "cli-games") (:file "cli-newcomers") (:file "cli-files")
                 (:file "cli-building") (:file "cli-plan-tree")
                 (:file "experiment-shell") (:file "experiment-shell-code")
                 (:file "rpl-seeing") (:file "rpl-breaking") (:file "rpl-timeline")
                 (:file "rpl-images") (:file "cli-tasks")
                 (:file "rpl-seeing-truth") (:file "thinking") (:file "thinking-runs")
                 (:file "skipping")
                 (:file "kinds") (:file "digests") (:file "same-bits") (:file "runs")
                 (:file "runs-replaced") (:file "rewinding")
                 (:file "several-robots") (:file "several-plans")
                 (:file "several-plans-model") (:file "several-plans-random")
                 (:file "several-plans-ten") (:file "several-joining")
                 (:file "several-rewinding") (:file "several-mistakes") (:file "messages")
                 (:file "messages-kept") (:file "messages-plans") (:file "steps")
                 (:file "pushing")
                 (:file "measures") (:file "track-matching") (:file "track-matching-kept")
                 (:file "rangefinders") (:file "doors") (:file "run-variables")
                 (:file "run-variables-asking")
                 (:file "run-variables-mistakes") (:file "run-variables-random")
                 (:file "recognising-places")
                 (:file "rewinding-words") (:file "rewinding-handles")
                 (:file "rewinding-values") (:file "rewinding-definitions")
                 (:file "forking-oracle") (:file "forking") (:file "forking-fluents")
                 (:file "forking-values") (:file "forking-unforkable") (:file "forking-uses")
                 (:file "forking-plans") (:file "forking-live") (:file "forking-borders")
                 (:file "repeating")
                 (:file "agreement-scripts") (:file "agreement-making") (:file "agreement")
                 (:file "robot-crowds") (:file "robot-turns") (:file "pursuit")
                 (:file "outliving") (:file "outliving-live") (:file "users-parts")
                 (:file "user-package") (:file "definitions") (:file "definitions-names")
                 (:file "definitions-mistakes") (:file "definitions-maps") (:file "homes")
                 (:file "saving") (:file "saving-hostile") (:file "saving-refused")
                 (:file "mutators") (:file "abuse-outcomes") (:file "abuse-definers")
                 (:file "abuse-data") (:file "abuse-calls") (:file "abuse") (:file "listings")
                 (:file "cli-door") (:file "cli-libraries")
                 (:file "listings-places") (:file "listings-sensing")
                 (:file "listings-programs") (:file "listings-plans") (:file "manual")
                 (:file "manual-2") (:file "manual-3-1") (:file "manual-3-1-commands")
                 (:file "manual-3-2") (:file "manual-3-2-intervals")
                 (:file "manual-3-2-odometry") (:file "manual-3-3") (:file "manual-3-4")
                 (:file "manual-3-4-2") (:file "manual-3-4-2-readings") (:file "manual-3-4-3")
                 (:file "manual-3-4-3-searches") (:file "manual-3-4-3-tracking")
                 (:file "manual-3-4-3-moving") (:file "manual-reach") (:file "manual-a")
                 (:file "manual-3-5") (:file "manual-3-5-stopping") (:file "manual-3-5-places")
                 (:file "manual-3-5-approach") (:file "manual-3-5-arrival")
                 (:file "manual-3-6") (:file "manual-3-6-containers") (:file "manual-3-7")
                 (:file "manual-3-8") (:file "manual-4") (:file "manual-4-motion")
                 (:file "manual-4-sensing") (:file "manual-4-handling") (:file "manual-5")
                 (:file "manual-5-1") (:file "manual-5-1-1") (:file "manual-5-2")
                 (:file "manual-5-3") (:file "manual-5-3-1") (:file "manual-5-4")
                 (:file "manual-5-5") (:file "manual-b") (:file "manual-b-1")
                 (:file "manual-c") (:file "manual-c-plans") (:file "manual-d")
                 (:file "manual-e") (:file "hostile-numbers") (:file "ownership") (:file "status")
                 (:file "users-hands") (:file "at-the-repl") (:file "src-readme")
                 (:file "readme") (:file "rpl-readme")
                 (:file "experiments-readme") (:file "tutorial") (:file "ways-readme")
                 (:file "floors-readme")
                 (:file "libraries") (:file "our-manual") (:file "examples")
                 (:file "tests-readme") (:file "architecture") (:file "architecture-names")
                 (:file "experiments")
                 (:file "lisp-errors")
                 (:file "experiments-tables") (:file "designs") (:file "experiments-files")
                 (:file "experiments-hanging") (:file "experiments-fingerprints")
                 (:file "experiments-series") (:file "experiments-series-tables")
                 (:file "thinking-experiments") (:file "tileworld-bare") (:file "testbeds")
                 (:file "pursuit-bare") (:file "testbeds-pursuit")
                 (:file "testbeds-tiles") (:file "testbeds-agents") (:file "testbeds-shell")
                 (:file "testbeds-trucks") (:file "rap") (:file "rap-memory") (:file "rap-random")
                 (:file "rap-seeing") (:file "rap-definitions") (:file "rap-rules")
                 (:file "rap-agenda") (:file "rap-resources")
                 (:file "experiments-report") (:file "experiment-compare")
                 (:file "experiments-pictures") (:file "pictures-kept")
                 (:file "experiment-compare-levels")
                 (:file "experiment-compare-versions") (:file "rates") (:file "troubles")
                 (:file "unseen")
                 (:file "beginners") (:file "beginners-more") (:file "beginners-slips")
                 (:file "beginners-words") (:file "beginners-ends")
                 (:file "beginners-unheard") (:file "beginners-hints") (:file "beginners-vain")
                 (:file "beginners-tests") (:file "beginners-forms")
                 (:file "projecting")
                 (:file "projecting-mistakes") (:file "projecting-apart") (:file "trying-best")
                 (:module "newcomer" :serial t
                  :components ((:file "terminal") (:file "pages") (:file "screens")
                               (:file "session") (:file "newcomer")))
                 (:file "cli-scripts") (:file "cli-forms") (:file "cli-batches")
                 (:file "printing") (:file "isolation")
                 (:file "budgets") (:file "children") (:file "children-uses")
                 (:file "main"))))
  :perform (test-op (operation system)
             (declare (ignore operation system))
             (symbol-call :ars-magna.tests :run-all)))
