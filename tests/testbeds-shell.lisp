;;;; testbeds-shell.lisp -- testbeds of users: their claims and pages, and the command `testbed`.

(in-package :ars-magna.tests)

(def-suite* testbeds-shell :in ars-magna)

;;; A race of one tick: what agents score is the seed and what they add, or a knob.

(defpackage :ars-test-race
  (:use :cl)
  (:import-from :ars #:define-testbed #:define-knob #:define-run-variable #:defmeasure)
  (:export #:race #:left* #:metres #:slow #:quick #:odd #:broken #:sleepy #:won))

(defparameter *race*
  '((ars-test-race::define-knob ars-test-race:left* 3 "metres" (integer 0 9) "What is left.")
    (ars-test-race::define-run-variable ars-test-race::*metres* 0 "How far the agent came.")
    (defun ars-test-race::run-for (metres)
      (setf ars-test-race::*metres* (+ metres ars-test-race:left*)))
    (defun ars-test-race:slow () (ars-test-race::run-for 1))
    (defun ars-test-race:quick ()
      (ars-test-race::run-for (+ 5 (mod (world:world-seed world:*world*) 3))))
    (defun ars-test-race:broken ()
      (if (oddp (world:world-seed world:*world*)) (error "Lame.") (ars-test-race::run-for 2)))
    (defun ars-test-race:sleepy () (loop))
    (ars-test-race::defmeasure ars-test-race:metres "How far." ars-test-race::*metres*)
    (ars-test-race::defmeasure ars-test-race:won "Whether it won." (< 5 ars-test-race::*metres*)))
  "The definitions of a testbed's world and agents.")

(defun race-form (&rest clauses)
  "Return the definition of a testbed with CLAUSES beside the usual ones."
  `(ars-test-race::define-testbed ars-test-race:race "Who comes far?"
     (:rules "Run.")
     (:knobs ars-test-race:left*)
     (:agents (ars-test-race:slow "Walks.") (ars-test-race:quick "Runs."))
     (:seeds :tuning 1000 :testing 0)
     (:robots ars-worlds:dot)
     (:measure ars-test-race:won)
     (:run (progn (experiment:start-agent ars-test-race::agent) (run:run-ticks 1) t))
     ,@clauses))

(defun call-with-race (function clauses)
  (with-own-definitions
    (let ((*package* (find-package :ars-test-race)))
      (mapc #'eval *race*)
      (eval (apply #'race-form clauses)))
    (funcall function)))

(defmacro with-race ((&rest clauses) &body body)
  `(call-with-race (lambda () ,@body) ',clauses))

(defun race-rows (&rest options)
  (loop for row in (apply #'experiment:check-claims 'ars-test-race:race options)
        collect (list (getf row :holds) (getf row :seeds-needed) (getf row :difference))))

(defun line-said-by (function)
  "Return what the error says that FUNCTION signals, on one line."
  (base:one-line (said-by function)))

(test testbeds.knobs-have-names-of-their-own
  (with-race ((:score ars-test-race:metres))
    (flet ((definition (name)
             (list 'ars-test-race::define-knob name 1 "metres" '(integer 0 9) "Another.")))
      (is (search "left* is a parameter" (line-said-by (lambda () (eval (definition 'left*))))))
      (is (search "left* is a parameter"
                  (line-said-by (lambda () (eval (definition 'ars-test-race:left*))))))
      (let ((*package* (find-package :ars-test-race)))
        (is (eq 'ars-test-race:left* (eval (definition 'ars-test-race:left*))))))))

;;; Claims.

(test claims.tell-their-relations
  (flet ((text (&rest relation) (experiment::relation-text relation nil)))
    (is (equal "a - b, at least 0" (text :better 'a 'b 0)))
    (is (equal "a - b, at least 0.5" (text :better 'a 'b 0.5)))
    (is (equal "a - b, within 2" (text :within 'a 'b 2)))
    (is (equal "a - b, interval above -2" (text :not-worse 'a 'b 2)))
    (is (equal "a - b, at most -2" (experiment::relation-text '(:better a b 2) t)))
    (is (equal "a - b, at most 0" (experiment::relation-text '(:better a b 0) t)))))

(test claims.need-enough-seeds
  "With 7 seeds no p is as low as .01."
  (with-race ((:score ars-test-race:metres)
              (:claims ("Quick is better." (()) (:better ars-test-race:quick ars-test-race:slow 1)
                                           (:not-worse ars-test-race:quick ars-test-race:slow 1)
                                           (:within ars-test-race:slow ars-test-race:slow 0))))
    (is (equal '((nil 8) (t nil) (t nil)) (mapcar (lambda (row) (subseq row 0 2))
                                                  (race-rows :seeds 7))))
    (is (equal '((t nil) (t nil) (t nil)) (mapcar (lambda (row) (subseq row 0 2))
                                                  (race-rows :seeds 8))))
    (is (equal '((nil 8) (nil 2) (t nil)) (mapcar (lambda (row) (subseq row 0 2))
                                                  (race-rows :seeds 1))))))

(test claims.know-when-less-is-better
  (with-race ((:score ars-test-race:metres :less)
              (:claims ("Slow is better." (()) (:better ars-test-race:slow ars-test-race:quick 4)
                                          (:better ars-test-race:quick ars-test-race:slow 4)
                                          (:not-worse ars-test-race:slow ars-test-race:quick 0)
                                          (:not-worse ars-test-race:quick ars-test-race:slow 0))))
    (is (equal '((t nil -5d0) (nil nil 5d0) (t nil -5d0) (nil nil 5d0)) (race-rows :seeds 9)))
    (is-true (experiment:testbed-less-is-better (experiment:find-testbed 'ars-test-race:race)))))

(test claims.compare-an-agent-under-two-settings
  (with-race ((:score ars-test-race:metres)
              (:claims ("More is left." (((ars-test-race:left* 1)))
                        (:better (ars-test-race:slow (ars-test-race:left* 8))
                                 (ars-test-race:slow (ars-test-race:left* 2)) 0)
                        (:better (ars-test-race:slow (ars-test-race:left* 8))
                                 ars-test-race:slow 7))))
    (is (equal '((t nil 6d0) (t nil 7d0)) (race-rows :seeds 8)))))

(test claims.can-be-about-another-measure
  (with-race ((:score ars-test-race:metres)
              (:claims ("Quick wins." (()) (:measure ars-test-race:won)
                        (:better ars-test-race:quick ars-test-race:slow 1))
                       ("Nothing." (()) (:measure ars-test-race::style)
                        (:within ars-test-race:quick ars-test-race:slow 1))))
    (is (equal '((t nil 1d0)) (race-rows :seeds 8 :claims '(1))))
    (signals base:unknown-name (race-rows :seeds 8 :claims '(2)))
    (signals base:wrong-argument (race-rows :seeds 8 :claims '(3)))
    (signals base:wrong-argument (race-rows :seeds 8 :claims 1))))

(test define-testbed.refuses-claims-that-say-nothing
  (loop for (part words)
          in '(((:better slow fast 1) "where A and B are agents")
               ((:better (slow) quick 1) "lists (agent (knob value)...)")
               ((:better slow quick -1) "(:better a b margin)")
               ((:narrows slow quick (left* 1)) "(:narrows a b (knob v w))")
               ((:better (slow (right* 1)) quick 1) "left*; not right*")
               ((:measure metres :more) "(:measure name :less)"))
        do (let ((part (subst-race part)))
             (with-own-definitions
               (mapc #'eval *race*)
               (let ((text (line-said-by (lambda ()
                                         (eval (race-form '(:score ars-test-race:metres)
                                                          `(:claims ("Said." (()) ,part
                                                                     (:within ars-test-race:slow
                                                                      ars-test-race:slow
                                                                      0)))))))))
                 (is (search words text) "~S: ~A" part text))))))

(defun subst-race (tree)
  "Return TREE with its symbols, except keywords, in the package of the race."
  (cond ((consp tree) (mapcar #'subst-race tree))
        ((and tree (symbolp tree) (not (keywordp tree)))
         (intern (string tree) :ars-test-race))
        (t tree)))

;;; Pages.

(defun race-page (seeds)
  (with-directories (directory)
    (let ((files (experiment:save-testbed-pages directory :names '(ars-test-race:race)
                                                          :seeds seeds)))
      (values (base:file-text (first files))
              (mapcar #'file-namestring (directory (merge-pathnames "race/*.*" directory)))
              (mapcar #'file-namestring (directory (merge-pathnames "*.*" directory)))))))

(test page.has-a-table-without-sweeps-and-says-which-way-is-better
  (with-race ((:score ars-test-race:metres :less)
              (:claims ("Slow is better." (()) (:better ars-test-race:slow ars-test-race:quick 4))))
    (let ((page (race-page 3)))
      (dolist (part '("metres, less is better" "slow - quick, at most -4" "too few seeds"
                      "8 seeds are needed"))
        (is (search part page) "~A" part))
      (is (< (search "| slow | 4.000" page) (search "| quick | " page))))))

(test page.names-the-agents-of-its-pictures-and-leaves-nothing-else
  (with-race ((:score ars-test-race:metres) (:sweeps ((ars-test-race:left* 1 3 5))))
    (multiple-value-bind (page pictures files) (race-page 4)
      (is (search "![metres by left*: slow, quick](race/sweep-1-1.svg)" page))
      (is (equal '("game.svg" "sweep-1-1.svg") pictures))
      (is (equal '("race.md") (remove "" files :test #'string=))))))

(test page.stays-if-an-agent-has-an-error
  (with-race ((:score ars-test-race:metres))
    (with-directories (directory)
      (flet ((text () (base:file-text (merge-pathnames "race.md" directory)))
             (save () (experiment:save-testbed-pages directory :names '(ars-test-race:race)
                                                               :seeds 2)))
        (save)
        (let ((page (text)))
          (eval '(defun ars-test-race:slow () (error "Lame.")))
          (signals base:misuse (save))
          (is (string= page (text))))))))

;;; The command.

(defun testbed-said (&rest arguments)
  "Return what the command `testbed` writes, and its exit status."
  (let* ((status nil)
         (text (with-output-to-string (out)
                 (let ((*standard-output* out) (*error-output* out))
                   (setf status (cli::run-with-arguments (cons "testbed" arguments)))))))
    (values text status)))

(test testbed-command.refuses-options-without-effect
  (dolist (arguments '(("--all") ("--all" "--out" "o" "--agent" "bold")
                       ("--all" "--out" "o" "--tuning") ("--seeds" "3") ("--quiet")
                       ("tileworld" "pursuit") ("tileworld" "--knob" "dynamism=")
                       ("tileworld" "--knob" "=3") ("tileworld" "--knob" "dynamism")
                       ("tileworld" "--knob" "dynamism=3" "--knob" "dynamism*=4")))
    (signals cli::usage-error (apply #'testbed-said arguments) "~S" arguments)))

(test testbed-command.names-the-option-with-a-wrong-value
  (loop for (option value) in '(("--workers" "0") ("--seeds" "x") ("--seeds" "1.5") ("--out" ""))
        for text = (line-said-by (lambda () (testbed-said "tileworld" option value)))
        do (is (eql 0 (search (format nil "~A takes " option) text)) "~A" text)))

(test testbed-command.says-what-a-knob-can-be
  (is (search "dynamism* cannot be 0. Give an integer from 1 to 1000"
              (line-said-by (lambda () (testbed-said "tileworld" "--knob" "dynamism=0")))))
  (signals base:wrong-argument
    (experiment:run-testbed 'ars-testbeds:tileworld :knobs '((ars-testbeds:dynamism* 0))))
  (signals base:misuse
    (experiment:run-testbed 'ars-testbeds:tileworld :knobs '((ars-testbeds:holes* 1)
                                                             (ars-testbeds:holes* 2)))))

(test testbed-command.compares-and-orders-agents
  (with-race ((:score ars-test-race:metres :less))
    (with-directories (directory)
      (multiple-value-bind (text status)
          (testbed-said "race" "--seeds" "4" "--quiet" "--out" (namestring directory))
        (is (eql 0 status))
        (is (search "Best first, by metres, less is better: slow 4.000, quick 9.000."
                    (base:one-line text)))
        (is (search "compare it with" text))))))

(test testbed-command.tells-of-errors-once-with-status-1
  (with-race ((:score ars-test-race:metres))
    (with-directories (directory)
      (multiple-value-bind (text status)
          (testbed-said "race" "--agent" "ars-test-race:broken" "--agent" "slow" "--seeds" "4"
                        "--quiet" "--out" (namestring directory))
        (is (eql 1 status))
        (is (= 1 (count-if (lambda (line) (search "Lame." line)) (lines-of text))))
        (is (search "(run-testbed 'ars-test-race:race :seeds 1 :agents '(ars-test-race:broken))"
                    text))
        (is (search "(replay-trial 'ars-test-race:race 1 1)" text))
        (is (not (search "No significant" text)))))))

(test testbed-command.ends-games-that-take-too-long
  (with-race ((:score ars-test-race:metres))
    (with-directories (directory)
      (multiple-value-bind (text status)
          (testbed-said "race" "--agent" "ars-test-race:sleepy" "--seeds" "1" "--quiet"
                        "--time-limit" ".01" "--out" (namestring directory))
        (is (eql 1 status))
        (is (search "limit of time" text))))))

(test testbed-command.gives-the-right-advice-on-rows-of-other-seeds
  (with-race ((:score ars-test-race:metres))
    (with-directories (directory)
      (flet ((said (&rest options)
               (apply #'testbed-said "race" "--seeds" "2" "--quiet" "--out" (namestring directory)
                      options)))
        (said)
        (let ((text (line-said-by (lambda () (said "--tuning")))))
          (is (search "Give another directory" text))
          (is (not (search "Delete" text))))))))

(test omniscient.needs-a-game
  (signals error
    (run:with-simulation ('ars-testbeds:tiler :seed 1 :errors :signal)
      (experiment:start-agent 'ars-testbeds::omniscient))))

(test list.shows-worlds-of-testbeds-apart
  (let ((text (with-output-to-string (*standard-output*) (cli::write-worlds))))
    (is (< (search "tiny " text) (search "Worlds of testbeds" text) (search "tileworld " text)))))

;;; Agents whose code has changed.

(defun define-race-agent (metres)
  (eval `(defun ars-test-race::mine () (ars-test-race::run-for ,metres))))

(defun race-scores (directory &optional (stream nil))
  (let ((results (experiment:run-testbed 'ars-test-race:race
                                         :agents '(ars-test-race::mine ars-test-race:slow) :seeds 2
                                         :directory directory :stream stream)))
    (loop for sample in (experiment:results-samples results)
          collect (coerce (experiment:sample-measure results sample "metres") 'list))))

(test run-testbed.plays-games-again-only-of-agents-that-have-changed
  (with-race ((:score ars-test-race:metres))
    (with-directories (directory)
      (flet ((lines (name agent)
               (remove-if-not (lambda (line) (search agent line))
                              (lines-of (base:file-text (merge-pathnames name directory)))))
             (old-p (name) (uiop:file-exists-p (merge-pathnames name directory))))
        (define-race-agent 2)
        (is (equal '((5 5) (4 4)) (race-scores directory)))
        (let ((slow (lines "machine.csv" "slow"))
              (table (base:file-text (merge-pathnames "rows.csv" directory))))
          (define-race-agent 3)
          (let ((said (with-output-to-string (out)
                        (is (equal '((6 6) (4 4)) (race-scores directory out))))))
            (is (search "Code has changed since the trials of agent=mine: " said))
            (is (search "old-1/" said)))
          (is (equal slow (lines "machine.csv" "slow")))
          (is (= 2 (length (lines "machine.csv" "mine"))))
          (is (string= table (base:file-text (merge-pathnames "old-1/rows.csv" directory))))
          (is (string= "" (with-output-to-string (out) (race-scores directory out))))
          (is (not (old-p "old-2/rows.csv"))))))))

(test run-testbed.keeps-a-damaged-table-as-it-is
  (with-race ((:score ars-test-race:metres))
    (with-directories (directory)
      (define-race-agent 2)
      (race-scores directory)
      (change-line (merge-pathnames "rows.csv" directory) 2
                   (lambda (line) (with-cell line 1 "123")))
      (let ((damaged (base:file-text (merge-pathnames "rows.csv" directory))))
        (signals experiment:damaged-table (race-scores directory))
        (is (string= damaged (base:file-text (merge-pathnames "rows.csv" directory))))))))

;;; Agents that cannot play.

(defun race-complaint (&rest arguments)
  "Return what USAGE-ERROR says of the command `testbed race` with ARGUMENTS."
  (line-said-by (lambda () (apply #'testbed-said "race" "--seeds" "1" "--quiet" arguments))))

(test testbed-command.tells-agents-with-arguments-from-unknown-ones
  (with-race ((:score ars-test-race:metres))
    (let ((*package* (find-package :ars-test-race)))
      (eval '(defun ars-test-race::run-to (place) place))
      (eval '(rpl:def-interp-proc ars-test-race::saunter (place) place)))
    (loop for (name definer) in '(("run-to" "(defun my-agent () (run-to ...))")
                                  ("saunter" "(def-interp-proc my-agent () (saunter ...))"))
          for text = (race-complaint "--agent" name)
          do (is (search "takes arguments, (place), but agents are called without any" text)
                 "~A" text)
             (is (search definer text)))
    (is (search "no plan or function has that name" (race-complaint "--agent" "run-off")))
    (is (search "takes arguments"
                (line-said-by (lambda ()
                                (experiment:run-testbed 'ars-test-race:race :seeds 1 :stream nil
                                                        :agents '(ars-test-race::saunter))))))))

(test testbed-command.finds-agents-of-names-with-small-letters
  (with-race ((:score ars-test-race:metres))
    (setf (fdefinition (intern "my agent" :ars-test-race)) (lambda () nil))
    (with-directories (directory)
      (is (eql 0 (nth-value 1 (testbed-said "race" "--agent" "|my agent|" "--seeds" "1" "--quiet"
                                            "--out" (namestring directory))))))))

(test testbed-command.asks-which-agent-of-a-loaded-file-is-to-play
  (with-race ((:score ars-test-race:metres))
    (with-directories (directory)
      (let ((file (uiop:native-namestring
                   (ensure-directories-exist (merge-pathnames "mine.lisp" directory)))))
        (with-open-file (out file :direction :output :if-exists :supersede)
          (write-string "(cl:defun cl-user::mine () nil)" out))
        (is (search "--load needs --agent" (race-complaint "--load" file)))
        (is (eql 0 (nth-value 1 (testbed-said "race" "--load" file "--agent" "cl-user::mine"
                                              "--seeds" "1" "--quiet" "--out"
                                              (namestring directory)))))))))

(test run-testbed.says-which-of-its-arguments-is-wrong
  (with-race ((:score ars-test-race:metres))
    (loop for (arguments words)
            in '(((:seeds 0) "run-testbed: seeds is 0")
                 ((:agents slow) "run-testbed: agents is SLOW; give a list")
                 ((:agents (ars-test-race:slow ars-test-race:slow)) "different names")
                 ((:knobs 3) "run-testbed: knobs is 3"))
          for text = (line-said-by (lambda ()
                                     (apply #'experiment:run-testbed 'ars-test-race:race
                                            :stream nil arguments)))
          do (is (search words text) "~A" text))))

(test run-testbed.does-not-redefine-anything
  (with-race ((:score ars-test-race:metres))
    (flet ((play () (experiment:run-testbed 'ars-test-race:race :seeds 1 :stream nil)))
      (handler-bind ((warning (lambda (warning) (fail "~A" warning))))
        (let ((*load-truename* #p"/nowhere/mine.lisp")) (play))
        (is (experiment:results-p (play)))))))
