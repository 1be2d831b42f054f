;;;; testbeds.lisp -- testbeds: how they are defined and run, and what is claimed of Tileworld.

(in-package :ars-magna.tests)

(def-suite* testbeds :in ars-magna)

(defun agent-symbol (name) (find-symbol (string name) :ars-testbeds))

(defun knob-settings (settings)
  (loop for (name value) in settings collect (list (agent-symbol name) value)))

(defun tileworld-scores (agent settings &key (seeds 5))
  "Return the scores of AGENT, by seed."
  (let* ((results (experiment:run-testbed 'tileworld :agents (list agent)
                                                     :knobs settings
                                                     :seeds seeds :stream nil))
         (sample (first (experiment:results-samples results))))
    (is (every (lambda (text) (string= "" text)) (experiment:sample-errors sample)))
    (coerce (experiment:sample-measure results sample "effectiveness") 'list)))

(defun tileworld-holes (seed settings)
  "Return the holes of a game with SEED, lists (x y score begin end)."
  (run:with-simulation ('ars-testbeds:tiler :seed seed :clean t
                                            :parameters (knob-settings settings))
    (run:run-ticks 1)
    (world:run-kicker (first (world:thing-kickers (world:find-thing 'clock))))
    (ars-testbeds::future-holes)))

(test tileworld.plays-as-a-program-without-the-simulator
  "The same holes, the same rules: the same scores, whatever planning costs. Nothing is rounded."
  (loop for (agent boldness reaction gamma p directions)
          in '((bold nil nil 32 1 4) (cautious 1 nil 32 1/2 4) (normal-any 4 :any 24 2 4)
               (bold-nearer nil :nearer 21 1/2 8) (bold-target nil :target 8 4 8)
               (cautious-nearer 1 :nearer 2 1 4))
        for settings = `((dynamism* ,gamma) (planning-time* ,p) (directions* ,directions)
                         (holes* 120))
        do (loop for score in (tileworld-scores agent settings :seeds 3)
                 for seed from 1
                 for bare = (bare-effectiveness (tileworld-holes seed settings)
                                                gamma p boldness reaction directions)
                 do (is (< (abs (- score bare)) 1d-9) "~A, seed ~D: ~A, bare ~A" agent seed
                        score bare))))

(test tileworld.holes-do-not-depend-on-the-agent
  (flet ((possible (agent)
           (run:with-simulation ('ars-testbeds:tiler :seed 4 :clean t
                                                     :parameters '((ars-testbeds:holes* 40)))
             (ars-testbeds:play-holes (agent-symbol agent))
             (list ars-testbeds::*possible* ars-testbeds::*opened*))))
    (is (equal (possible 'bold) (possible 'random-walk)))))

(test tileworld.games-are-replayed-and-rewound
  (run:with-simulation ('ars-testbeds:tiler :seed 5 :clean t :thinking :charged :journal t :keep t
                                            :parameters (append (knob-settings '((holes* 12)
                                                                                 (dynamism* 16)))
                                                                '((base:max-speed* 2)
                                                                  (base:max-turn-angle* 4)
                                                                  (base:step-by-grid* t))))
    (ars-testbeds:play-holes 'ars-testbeds::bold-nearer)
    (flet ((state () (list (run:measure-value 'ars-testbeds:effectiveness) (run:state-digest))))
      (let ((journal (run:simulation-journal (time:current-simulation))) (end (state)))
        (is (plusp (first end)))
        (is (equal end (run:with-replay (journal) (state))))
        (run:rewind 500)
        (is (not (equal end (state))))))))

(test tileworld.random-walks-of-different-seeds-are-independent
  "No walk is the rest of another one, as if its dice depended on the sum of seed and tick."
  (flet ((moves (seed)
           (run:with-simulation ('ars-testbeds:tiler :seed seed :clean t
                                                     :parameters '((base:max-speed* 2)
                                                                   (base:max-turn-angle* 4)
                                                                   (base:step-duration* 2)
                                                                   (base:step-by-grid* t)))
             (let ((robot (first (run:simulation-robots (time:current-simulation)))))
               (command:robot-set-speed robot 2)
               (command:robot-set-turn-angle robot 4)
               (run:run-ticks 1)
               (ars-testbeds::random-walk)
               (loop for x = (robot:robot-x robot) for y = (robot:robot-y robot)
                     repeat 12
                     do (run:run-ticks 2)
                     collect (list (round (- (robot:robot-x robot) x))
                                   (round (- (robot:robot-y robot) y))))))))
    (let ((moves (moves 6)) (others (moves 8)))
      (is (notany (lambda (move) (equal '(0 0) move)) moves))
      (is (not (equal (rest moves) (butlast others)))))))

(test tileworld.no-agent-beats-the-bound
  (dolist (gamma '(16 48))
    (let* ((settings `((dynamism* ,gamma) (planning-time* 0) (holes* 60)))
           (bound (tileworld-scores 'omniscient settings :seeds 3)))
      (dolist (agent '(bold-nearer cautious adaptive look-ahead))
        (is (every #'<= (tileworld-scores agent settings :seeds 3) bound) "~A" agent)))
    (is (every #'= (tileworld-scores 'omniscient `((dynamism* 8) (holes* 60))) '(1 1 1 1 1)))))

(test tileworld.looking-ahead-helps
  (let ((settings '((dynamism* 32) (planning-time* 0) (holes* 60))))
    (is (< (reduce #'+ (tileworld-scores 'cautious settings))
           (reduce #'+ (tileworld-scores 'look-ahead settings))))))

(test tileworld.claims-hold
  (dolist (row (experiment:check-claims 'tileworld :seeds 8 :claims '(1 9)))
    (is (getf row :holds) "~S" row)))

;;; The other claims are checked by the program without the simulator, which plays as fast as many
;;; seeds require.

(defun boldness-and-reaction (agent)
  "Return the boldness and reaction of AGENT, a name such as BOLD-NEARER; NIL for others."
  (let* ((name (string agent)) (dash (position #\- name))
         (boldness (assoc (subseq name 0 dash) '(("CAUTIOUS" 1) ("NORMAL" 4) ("BOLD" nil))
                          :test #'string=)))
    (and boldness
         (list (second boldness) (and dash (intern (subseq name (1+ dash)) :keyword))))))

(defun bare-scores (game games)
  "Return the scores of GAME, (agent setting...), for GAMES, lists of holes."
  (flet ((knob (name) (second (find name (rest game) :key #'first :test #'string= :from-end t))))
    (loop for holes in games
          collect (apply #'bare-effectiveness holes (or (knob 'dynamism*) 32)
                         (or (knob 'planning-time*) 1) (boldness-and-reaction (first game))))))

(test tileworld.claims-hold-by-the-bare-program
  (let ((games (loop for seed from 1 to 60 collect (tileworld-holes seed '()))))
    (loop for (text all-settings . relations)
            in (ars-magna.experiment::testbed-claims (experiment:find-testbed 'tileworld))
          do (dolist (settings all-settings)
               (loop for relation in relations
                     for (kind a b) = relation
                     when (and (boldness-and-reaction a) (boldness-and-reaction b))
                       do (let ((row (ars-magna.experiment::relation-row
                                      relation settings
                                      (lambda (game) (bare-scores game games)) nil)))
                            (is (getf row :holds) "~A ~S: ~S ~S" text settings relation row)))))))

;;; The face.

(test testbed.tells-its-rules
  (let ((text (with-output-to-string (out) (experiment:testbed 'tileworld out))))
    (dolist (part '("Rules" "15 x 15" "dynamism*, an integer from 1 to 1000 world units"
                    "bold-nearer:" "Kinny" "Seeds"))
      (is (search part text) "~A" part))))

(test testbed.refuses-what-it-does-not-know
  (signals base:unknown-name (experiment:run-testbed 'tyleworld))
  (signals base:unknown-name (experiment:run-testbed 'tileworld :agents '(boldest)))
  (signals base:wrong-argument (experiment:run-testbed 'tileworld :agents 'bold))
  (signals base:unknown-name (experiment:run-testbed 'tileworld :knobs '((base:max-speed* 1))))
  (signals base:wrong-argument
    (experiment:run-testbed 'tileworld :agents '(bold)
                                       :knobs '((directions* 5)))))

(test testbed.runs-an-agent-of-the-user
  "A plan is an agent, too, and the seeds for tuning are others than those for testing."
  (with-own-definitions
    (eval '(rpl:def-interp-proc stand-still () (rpl:wait-time 10)))
    (flet ((rows (&rest options)
             (let* ((results (apply #'experiment:run-testbed 'tileworld
                                    :agents (list 'stand-still 'ars-testbeds::bold)
                                    :knobs '((holes* 10))
                                    :seeds 2 :stream nil options)))
               (mapcar (lambda (sample)
                         (coerce (experiment:sample-measure results sample "effectiveness")
                                 'list))
                       (experiment:results-samples results)))))
      (is (equal '(0 0) (first (rows))))
      (is (not (equal (rows) (rows :tuning t)))))))

(test testbed.page-is-the-same-for-any-number-of-workers
  (with-own-definitions
    (let ((testbed (experiment:find-testbed 'tileworld)))
      (flet ((page (workers)
               (with-output-to-string (out)
                 (ars-magna.experiment::write-testbed-page
                    (ars-magna.experiment::make-testbed
                     :name 'tileworld :documentation "d" :rules '("r") :knobs '()
                     :agents '((ars-testbeds::bold "b") (ars-testbeds::naive "n"))
                     :score 'ars-testbeds:effectiveness
                     :seeds '(:tuning 10 :testing 0)
                     :sweeps '(((ars-testbeds:dynamism* 16 64) (ars-testbeds:holes* 10)))
                     :package (find-package :ars-testbeds)
                     :title "t"
                     :deciding (ars-magna.experiment::testbed-deciding testbed)
                     :options (ars-magna.experiment::testbed-options testbed))
                    out 3 workers))))
        (let ((page (page 1)))
          (is (search "| bold | " page))
          (is (string= page (page 2))))))))

;;; Pictures.

(test testbed.picture-of-a-game-is-the-same-each-time
  (experiment::call-with-temporary-directory
   (lambda (directory)
     (flet ((picture (&rest options)
              (base:file-text (apply #'experiment:save-game-picture 'ars-testbeds:tileworld
                                     (uiop:subpathname directory "game.svg") options))))
       (let ((picture (picture :until 900)))
         (is (string= picture (picture :until 900)))
         (is (string= picture (picture :until 900 :agent 'bold)) "the agent of the first claim")
         (is (search "tileworld, bold, trial 1, tick 900" picture))
         (is (search "effectiveness" picture))
         (is (string/= picture (picture :until 900 :trial 2))))
       (signals base:unknown-name (picture :agent 'boldest))))))

;;; Tables.

(test run-testbed.records-the-knobs-that-were-set
  (flet ((conditions (knobs)
           (mapcar #'experiment:sample-condition
                   (experiment:results-samples
                    (experiment:run-testbed 'ars-testbeds:tileworld :stream nil :seeds 1
                                            :agents '(ars-testbeds::naive) :knobs knobs)))))
    (is (equal '("agent=naive holes*=10 dynamism*=4")
               (conditions '((holes* 10) (dynamism* 4)))))
    (is (equal '("agent=naive holes*=10 dynamism*=64")
               (conditions '((holes* 10) (dynamism* 64)))))))

(test run-testbed.tables-do-not-call-it-a-success-that-a-game-ended
  (with-own-definitions
    (flet ((table (agents)
             (with-output-to-string (out)
               (experiment:print-results
                (experiment:run-testbed 'ars-testbeds:tileworld
                                        :stream nil :seeds 2 :knobs '((holes* 2)) :agents agents)
                out))))
      (is (search "effectiveness" (table '(ars-testbeds::naive))))
      (is (not (search "success" (table '(ars-testbeds::naive)))))
      (eval '(defun break-off () (error "broken off")))
      (is (search "games ended %" (table '(break-off)))))))

;;; Agents of the command.

(defpackage :ars-test-bold (:use))
(setf (fdefinition (intern "BOLD" :ars-test-bold)) (lambda () nil))

(test testbed-command.finds-agents-by-name-and-refuses-those-of-two-packages
  (let* ((testbed (experiment:find-testbed 'ars-testbeds:tileworld))
         (names (mapcar #'first (experiment::testbed-agents testbed))))
    (flet ((found (text) (mapcar #'package-name
                                 (mapcar #'symbol-package (cli::agents-named text names)))))
      (is (equal '("ARS-TESTBEDS") (found "cautious")))
      (is (equal '("ARS-TESTBEDS") (found "ars-testbeds::bold")))
      (is (equal '("ARS-TEST-BOLD") (found "ars-test-bold::bold")))
      (is (= 2 (length (found "bold"))))
      (is (null (found "nowhere::bold"))))))
