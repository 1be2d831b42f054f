;;;; search-index.lisp -- the index of the search: names, headings, words of the guide, synonyms.

(in-package :ars-magna.manual)

(defparameter *synonyms*
  '(;; Sensors
    ("A sensor" "sensor" "new sensor")
    ("rangefinder-read" "lidar" "laser" "sonar" "range" "range sensor" "range finder"
     "rangefinder" "distance sensor" "proximity sensor")
    ("camera-view" "scan" "depth image" "view")
    ("camera-get-object-designator" "vision" "detect object" "object detection" "recognition"
     "recognize" "find object" "search for object" "perception")
    ("camera-track" "tracking" "follow object")
    ("odometer" "odometry" "dead reckoning" "localization" "localisation" "slam" "encoder"
     "pose estimate" "position estimate")
    ("robot-position" "pose" "position" "location" "coordinates" "ground truth")
    ("robot-angle" "heading" "orientation" "yaw")
    ("clean-simulation" "no noise" "disable noise" "turn off noise" "noise off" "perfect sensors")
    ("motion-noise*" "noise" "slip" "wheel slip" "actuator noise")
    ;; Moving and handling
    (":robot-blocked" "collision" "crash" "obstacle" "bumper" "hit wall" "blocked" "stuck")
    ("robot-set-speed" "velocity" "linear velocity" "drive faster" "drive slower")
    ("max-speed*" "speed limit" "maximum speed")
    ("braking*" "acceleration" "deceleration" "brake")
    ("robot-turn" "rotate" "rotation" "steer" "steering")
    ("robot-set-turn-angle" "angular velocity" "turn rate" "rotation speed")
    ("robot-go-to" "drive to point" "move to" "navigate" "navigation" "waypoint")
    ("find-way" "path planning" "path planner" "motion planning" "pathfinding" "path finding"
     "astar" "a*" "dijkstra" "shortest path" "route")
    ("hand-grasp-desig" "grip" "gripper" "grasp" "pick up" "arm" "manipulator")
    ("hand-ungrasp" "release" "drop" "put down")
    ("doorway" "door" "doors" "gate")
    ;; Defining
    ("defmap" "define map" "define world" "new map" "new world" "walls" "environment" "floor plan")
    ("defrobot" "define robot" "new robot" "add robot")
    ("new-thing" "define thing" "define object" "new object" "add object" "spawn")
    ("defkicker" "define kicker" "kicker" "kickers" "new kicker" "add kicker" "exogenous event"
     "random event" "disturbance" "wind")
    ("wander-about" "moving obstacle" "dynamic obstacle" "pedestrian" "people")
    ("defmanipulation" "define manipulation" "define action" "new action" "own action")
    ("defattribute" "define attribute" "property")
    ("def-place-type" "define place type" "new place type")
    ("A command" "define command" "new command")
    ("undefine" "remove definition" "delete definition")
    ("import-map" "ros" "occupancy grid" "occupancy map" "map_server" "map server" "yaml" "pgm"
     "gazebo")
    ;; Plans and callbacks
    ("def-interp-proc" "define plan" "write plan" "new plan" "defplan")
    ("The plan language" "rpl" "behavior tree" "behaviour tree" "state machine" "reactive plan"
     "planner")
    ("unknown-name" "undefined plan" "unknown plan" "no such plan" "undefined function"
     "undefined name" "no plan")
    ("continuation" "callback" "asynchronous" "async" "promise")
    ("schedule" "timer" "periodic" "delayed call" "event queue")
    ("wait-time" "sleep" "delay" "wait")
    ("wait-for" "wait for condition" "wait until")
    ("whenever" "event handler" "event" "trigger" "react")
    ("par" "concurrent" "simultaneous" "in parallel" "parallel steps")
    ("try-in-order" "fallback" "selector" "alternatives")
    ("with-failure-handling" "handle failure" "catch failure" "recover" "exception handling")
    ("with-deadline" "deadline" "timeout" "time limit")
    ("evap-protect" "cleanup" "clean up" "unwind-protect" "finally")
    ("with-valve" "mutex" "semaphore" "exclusive" "resource")
    ("project-plan" "prediction" "predict" "lookahead" "simulate ahead")
    ;; Runs
    ("with-simulation" "headless" "no gui" "faster than real time" "run simulation")
    ("rate" "real time" "speed up" "slow motion" "simulation speed" "pace")
    ("tick-quantum*" "time step" "timestep" "dt")
    ("Runs you can repeat" "random" "random seed" "rng" "reproducible" "reproducibility"
     "deterministic" "determinism" "repeatable")
    ("save-journal" "log" "logging" "record" "recording" "rosbag")
    ("replay" "playback" "play back")
    ("rewind" "undo" "go back" "time travel")
    ("fork-simulation" "copy simulation" "clone" "what if" "branch")
    ("save-simulation" "checkpoint" "snapshot" "save state" "serialize" "persist")
    ("load-simulation" "restore" "restore state" "load state")
    ("save-trajectory" "trajectory" "csv of positions" "path log")
    ("Threads and time" "thread" "threads" "multithreading" "thread safety" "concurrency")
    ("Security: what is executed" "security" "sandbox" "untrusted")
    ;; Pictures
    ("Pictures, films and timelines" "gif" "video" "movie" "animation" "mp4" "png" "svg" "image"
     "screenshot" "picture" "plot" "figure" "graphics")
    ("The window" "gui" "graphical interface" "mcclim" "x11" "mouse")
    ;; Experiments
    ("defexperiment" "define experiment" "new experiment" "monte carlo" "parameter sweep")
    ("ars-magna experiment" "cluster" "slurm" "parallel" "distributed" "hpc" "many cores")
    ("compare-conditions" "significance" "significant" "p value" "hypothesis test" "t test")
    ("wilson-interval" "confidence interval" "error bars" "success rate")
    ;; The program
    ("Install and run" "install" "installation" "requirements" "dependencies" "docker"
     "getting started")
    ("Citing" "cite" "citation" "bibtex" "reference" "paper" "license" "authors")
    ("Numbers" "degrees" "radians" "unit" "units" "metres" "meters")
    ("Scripts" "script" "batch" "exit status" "exit code" "ci" "continuous integration")
    ("From other programs" "python" "json" "api" "subprocess" "remote control")
    ("quit" "exit" "leave" "close")
    ("When something goes wrong" "error" "errors" "troubleshooting" "exception" "bug" "problem")
    ("The debugger" "debug" "debugger" "breakpoint" "backtrace" "stack trace")
    ("step-plan" "single step" "stepper" "step through")
    ("Checks in FiveAM" "unit test" "testing" "regression test" "assertion")
    ("In an editor" "emacs" "slime" "sly" "ide" "vim" "vscode" "editor"))
  "Lists (name synonym...). A search for a synonym first shows the entry or heading called NAME.
Synonyms leave out a, an, the and my, because the search ignores these words.")

(defstruct (index-row (:constructor make-index-row
                                    (name kind address sentence &optional (words "")))
                      (:copier nil))
  "A row of the search: NAME, linked to ADDRESS, then KIND and SENTENCE. WORDS are searched, too."
  (name "" :type string :read-only t)
  (kind "" :type string :read-only t)
  (address "" :type string :read-only t)
  (sentence "" :type string :read-only t)
  (words "" :type string :read-only t))

(defun distinct-words (text)
  "Return the words of TEXT, each once, in lower case and without punctuation around them."
  (remove-duplicates
   (loop for word in (uiop:split-string (string-downcase text)
                                        :separator '(#\Space #\Newline #\Tab))
         for bare = (string-trim ".,;:()'`\"[]{}" word)
         when (< 1 (length bare)) collect bare)
   :test #'string= :from-end t))

(defun page-rows (page)
  "Return rows for the headings of PAGE. On pages of the guide, a row has the words of its section."
  (loop for (nil id text words) in (headings (page-tokens page))
        collect (make-index-row text (page-title page) (format nil "~A#~A" (page-file page) id) ""
                                (if (member (contents-part page) '(:learning :guide))
                                    (format nil "~{~A~^ ~}" (distinct-words words))
                                    ""))))

(defun entry-row (entry)
  (make-index-row (entry-name entry) (chapter-title (entry-chapter entry)) (entry-address entry)
                  (first-full-sentence (entry-text entry))))

(defun synonym-rows (rows)
  (loop for (name . synonyms) in *synonyms*
        for target = (find name rows :key #'index-row-name :test #'string-equal)
        when target
          append (loop for synonym in synonyms
                       collect (make-index-row synonym (format nil "see ~A" (index-row-name target))
                                               (index-row-address target)
                                               (index-row-sentence target)))))

(defun row-text (row)
  (format nil "[~{~A~^,~}]"
          (mapcar #'javascript-string
                  (list (index-row-name row) (index-row-kind row) (index-row-address row)
                        (index-row-sentence row)
                        (index-row-words row)))))

(defun write-index (out book)
  "Write the search index to OUT as JavaScript: synonyms first, before equally good rows."
  (let ((rows (append (mapcar #'entry-row (book-entries book))
                      (mapcan #'page-rows (copy-list (book-pages book))))))
    (format out "var SEARCH_INDEX = [~%~{~A~^,~%~}~%];~%"
            (mapcar #'row-text (append (synonym-rows rows) rows)))))
