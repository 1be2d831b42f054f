;;;; games.lisp -- the games that claims and pages are about, each run once.

(in-package :ars-magna.experiment)

;;; Claims and sweeps share many games. All that are needed are the cases of one experiment, so that
;;; no processor waits for the last game of a claim. More seeds serve those who need fewer.

(defstruct (games (:constructor make-games (testbed workers &optional stream)) (:copier nil))
  "The games of TESTBED that have been run in WORKERS threads, with the progress on STREAM."
  (testbed nil :type testbed :read-only t)
  (workers 1 :type integer :read-only t)
  (stream nil :read-only t)
  ;; By the text of a game, a cons of results and the sample of the game.
  (table (make-hash-table :test 'equal) :read-only t))

(defun default-setting-p (setting testbed)
  "True if SETTING, (knob value), is what a game of TESTBED has without it."
  (destructuring-bind (name value) setting
    (let ((parameter (parameter-of-variable name)))
      (and parameter
           (eq :setting (parameter-kind parameter))
           (equalp value (parameter-default parameter))
           (not (assoc name (testbed-parameters testbed)))))))

(defun plain-game (game testbed)
  "Return GAME, (agent setting...), with each knob once, in order, without defaults of TESTBED."
  (list* (first game)
         (sort (remove-if (lambda (setting) (default-setting-p setting testbed))
                          (remove-duplicates (rest game) :key #'first))
               #'string< :key #'first)))

(defun game-text (game)
  (format nil "~(~A~)~@[ ~A~]" (first game)
          (and (rest game) (settings-text (rest game)))))

(defun reject-errors (games results)
  "Signal MISUSE if a trial of RESULTS had an error."
  (loop for sample in (results-samples results)
        for place = (position "" (sample-errors sample) :test #'string/=)
        do (when place
             (reject-use "~(~A~), ~A, seed ~D: ~A" (testbed-name (games-testbed games))
                         (sample-condition sample) (aref (sample-seeds sample) place)
                         (aref (sample-errors sample) place)))))

(defun games-missing (games wanted seeds)
  "Return those of the games WANTED, each once, that have not been run for so many SEEDS."
  (remove-if (lambda (game)
               (let ((known (gethash (game-text game) (games-table games))))
                 (and known (<= seeds (length (sample-trials (cdr known)))))))
             (remove-duplicates (loop for game in wanted
                                      collect (plain-game game (games-testbed games)))
                                :test #'string= :key #'game-text :from-end t)))

(defun run-games (games wanted seeds)
  "Run the games WANTED, lists (agent setting...), for so many SEEDS, unless that has been done.
Signals MISUSE if an agent has an error."
  (let ((missing (games-missing games wanted seeds)))
    (when missing
      (let ((results (run-experiment-object (testbed-experiment (games-testbed games) '()
                                                                :games missing)
                                            seeds (games-workers games) nil
                                            (games-stream games))))
        (reject-errors games results)
        (loop for game in missing
              for sample in (results-samples results)
              do (setf (gethash (game-text game) (games-table games)) (cons results sample)))))))

(defun game-scores (games game measure seeds)
  "Return the values of MEASURE in GAME, which has been run, a list of numbers by seed."
  (destructuring-bind (results . sample)
      (gethash (game-text (plain-game game (games-testbed games))) (games-table games))
    (loop for value across (sample-measure results sample measure)
          repeat seeds
          collect (score-number value measure))))
