;;;; page.lisp -- the page of results of a testbed, in Markdown, the same on each machine.

(in-package :ars-magna.experiment)

;;; The page and its pictures are made before anything is written, so a run that is stopped leaves
;;; the former page as it was.

(defun mean-cell (numbers)
  "Return the mean of NUMBERS, scores, and the reach of its 95 % interval, as a cell of a table."
  (multiple-value-bind (low high) (student-interval numbers)
    (format nil "~A~@[ ± ~A~]" (decimal-text (nearest-mean numbers) 3)
            (and low (decimal-text (/ (- high low) 2) 3)))))

(defun write-markdown-row (cells stream)
  (format stream "|~{ ~A |~}~%" cells))

(defun write-markdown-head (headings stream)
  (write-markdown-row headings stream)
  (format stream "|~{~A|~}~%" (mapcar (constantly "---") headings)))

(defun write-markdown-list (title items stream)
  (when items
    (format stream "~%## ~A~2%" title)
    (dolist (item items) (write-wrapped (one-line item) stream :first "* "))))

;;; Tables of all agents.

(defun all-agents (testbed) (mapcar #'first (testbed-agents testbed)))

(defun sweep-games (testbed sweep)
  "Return the games of SWEEP, ((knob value...) (knob value)...): for each agent those in a row."
  (destructuring-bind ((knob . values) . settings) sweep
    (loop for agent in (all-agents testbed)
          collect (loop for value in values
                        collect (list* agent (append settings (list (list knob value))))))))

(defun write-agents-table (testbed games stream seeds)
  "Write a table of the scores of all agents of TESTBED by default, the best first."
  (flet ((scores (agent) (game-scores games (list agent) (testbed-score testbed) seeds)))
    (format stream "~%### All knobs at their defaults, the best agent first~2%")
    (write-markdown-head (list "agent" (string-downcase (testbed-score testbed))) stream)
    (loop for (agent) in (best-first testbed (loop for agent in (all-agents testbed)
                                                   collect (cons agent
                                                                 (nearest-mean (scores agent)))))
          do (write-markdown-row (list (agent-name-text agent) (mean-cell (scores agent)))
                                 stream))))

(defun write-sweep (testbed sweep games stream seeds)
  "Write a table of the scores of all agents of TESTBED, for each value of the knob of SWEEP."
  (destructuring-bind ((knob . values) . settings) sweep
    (format stream "~%### ~A, by ~(~A~)~2%"
            (if settings (settings-text settings) "All other knobs at their defaults") knob)
    (write-markdown-head (cons "agent" (mapcar #'setting-text values)) stream)
    (loop for row in (sweep-games testbed sweep)
          do (write-markdown-row
              (cons (agent-name-text (first (first row)))
                    (loop for game in row
                          collect (mean-cell (game-scores games game (testbed-score testbed)
                                                          seeds))))
              stream))))

;;; Pictures, of a few agents each. A picture is a list (name caption chart).

(defun picture-point (x scores)
  (multiple-value-bind (low high) (student-interval scores)
    (list x (nearest-mean scores) low high)))

(defun sweep-chart (testbed sweep rows games seeds)
  "Return a chart of the scores in ROWS, lists of games of one agent, by the knob of SWEEP."
  (destructuring-bind ((knob . values) . settings) sweep
    (let ((score (string-downcase (testbed-score testbed)))
          (xs (loop for value in values collect (x-value (setting-text value)))))
      (line-chart (loop for row in rows
                        collect (cons (agent-name-text (first (first row)))
                                      (loop for game in row
                                            for x in xs
                                            collect (picture-point x (game-scores games game score
                                                                                  seeds)))))
                  :log-x (logarithmic-x-p xs)
                  :title (first-sentence (testbed-documentation testbed))
                  :subtitle (format nil "~@[~A. ~]Means over ~D seeds, with 95 % intervals."
                                    (and settings (settings-text settings)) seeds)
                  :x-label (string-downcase knob) :y-label (score-text testbed)
                  :legend-title "agent"))))

(defun sweep-pictures (testbed sweep number games seeds)
  "Return the pictures of SWEEP, which is the sweep of this NUMBER."
  (loop for rows in (split-evenly (sweep-games testbed sweep) +most-series+)
        for part from 1
        collect (list (format nil "sweep-~D-~D.svg" number part)
                      (format nil "~(~A~) by ~(~A~): ~{~(~A~)~^, ~}" (testbed-score testbed)
                              (first (first sweep))
                              (loop for row in rows collect (first (first row))))
                      (sweep-chart testbed sweep rows games seeds))))

(defun write-sweeps (testbed games stream seeds)
  "Write the tables of all agents of TESTBED to STREAM. Return the pictures."
  (format stream "~%## Results~2%")
  (write-wrapped (format nil "Means of ~A, over ~D seeds, with 95 % intervals."
                         (score-text testbed) seeds)
                 stream)
  (write-agents-table testbed games stream seeds)
  (loop for sweep in (testbed-sweeps testbed)
        for number from 1
        for pictures = (sweep-pictures testbed sweep number games seeds)
        do (write-sweep testbed sweep games stream seeds)
           (loop for (name caption) in pictures
                 do (format stream "~%![~A](~(~A~)/~A)~%" caption (testbed-name testbed) name))
        append pictures))

;;; Claims.

(defun write-claim-notes (testbed stream seeds)
  (write-wrapped (format nil "Differences in ~A, in pairs with ~D equal seeds, with 95 % ~
                              intervals; p by the permutation test. A claim holds if each of ~
                              its differences is as large as stated, with p at most .01."
                         (score-text testbed) seeds)
                 stream)
  (when (< seeds (seeds-for-claim-level))
    (terpri stream)
    (write-wrapped (format nil "With ~D seed~:P, p cannot be as low as .01; ~D seeds are needed."
                           seeds (seeds-for-claim-level))
                   stream)))

(defun write-claim (testbed claim number games stream seeds)
  (format stream "~%")
  (write-wrapped (first claim) stream :first (format nil "**~D.** " number))
  (when (find-if #'measure-part-p (cddr claim))
    (multiple-value-bind (measure less) (claim-measure testbed claim)
      (format stream "~%In ~(~A~)~:[~;, less is better~]:~%" measure less)))
  (terpri stream)
  (write-markdown-head '("knobs" "difference" "mean" "interval" "p" "") stream)
  (dolist (row (claim-rows testbed claim games seeds))
    (format stream "~A~%" (claim-row-text row))))

(defun write-claims (testbed games stream seeds)
  (when (testbed-claims testbed)
    (format stream "~%## Claims~2%")
    (write-claim-notes testbed stream seeds)
    (loop for claim in (testbed-claims testbed)
          for number from 1
          do (write-claim testbed claim number games stream seeds))))

;;; The page.

(defun run-games-of-page (testbed games seeds few)
  "Run the games of the page of TESTBED: claims with SEEDS, tables of all agents with FEW seeds."
  (run-claims testbed (testbed-claims testbed) games seeds)
  (run-games games
             (append (mapcar #'list (all-agents testbed))
                     (loop for sweep in (testbed-sweeps testbed)
                           append (apply #'append (sweep-games testbed sweep))))
             few))

(defun write-testbed-page (testbed stream seeds workers &optional progress)
  "Write the page of TESTBED to STREAM. Return its pictures, lists (name caption chart).
Write the progress to the stream PROGRESS unless that is NIL."
  (let ((games (make-games testbed workers progress)) (few (min seeds (max 2 (ceiling seeds 4)))))
    (run-games-of-page testbed games seeds few)
    (format stream "# ~(~A~)~2%" (testbed-name testbed))
    (write-wrapped (one-line (testbed-documentation testbed)) stream)
    (format stream "~%![A game](~(~A~)/game.svg)~%" (testbed-name testbed))
    (write-markdown-list "Rules" (testbed-rules testbed) stream)
    (write-markdown-list "Knobs" (mapcar #'knob-line (testbed-knobs testbed)) stream)
    (write-markdown-list "Agents" (loop for (name text) in (testbed-agents testbed)
                                        collect (format nil "`~(~A~)`: ~A" name text))
                         stream)
    (prog1 (write-sweeps testbed games stream few)
      (write-claims testbed games stream seeds)
      (write-markdown-list "Sources" (testbed-sources testbed) stream))))

(defun save-testbed-page (testbed directory seeds workers progress)
  "Write the page of TESTBED and its pictures into DIRECTORY, once they are complete. Return the
file of the page."
  (let* ((pictures '())
         (name (string-downcase (testbed-name testbed)))
         (text (with-output-to-string (stream)
                 (setf pictures (write-testbed-page testbed stream seeds workers progress))))
         (folder (merge-pathnames (format nil "~A/" name) directory))
         (file (merge-pathnames (format nil "~A.md" name) directory)))
    ;; Of a former page there may have been more pictures.
    (mapc #'delete-file (directory (merge-pathnames "sweep-*.svg" folder)))
    (save-game-picture (testbed-name testbed)
                       (merge-pathnames "game.svg" (ensure-store-directory folder)))
    (loop for (picture nil chart) in pictures
          do (save-chart (merge-pathnames picture folder) chart))
    (overwrite-file (lambda (stream) (write-string text stream))
                    file "the page of results" :remedy "give another directory")
    file))

(addition save-testbed-pages)
(defun save-testbed-pages (directory &key (names :all) (seeds 100) (workers 1) stream)
  "Run the testbeds NAMES, by default all, and write a page of results for each into DIRECTORY:
NAME.md, with pictures in NAME/. Each page is written once it is complete. Claims are checked on as
many SEEDS; tables of all agents have a quarter of them. The page is the same on each machine and
for any number of WORKERS. Progress is written to STREAM unless that is NIL. Return a list of the
files. Signals UNKNOWN-NAME, and MISUSE if DIRECTORY cannot be made or an agent has an error."
  (let ((directory (ensure-store-directory directory)))
    (loop for testbed in (if (eq :all names) (all-testbeds) (mapcar #'find-testbed names))
          collect (save-testbed-page testbed directory seeds workers stream))))
