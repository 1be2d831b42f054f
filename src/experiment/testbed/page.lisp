;;;; page.lisp -- the page of results of a testbed, in Markdown, the same on each machine.

(in-package :ars-magna.experiment)

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

(defun samples-by-agent (results agents)
  "Return the samples of RESULTS of a testbed as lists (agent sample...), in the order of AGENTS."
  (loop for agent in agents
        collect (cons agent (remove (agent-name-text agent) (results-samples results)
                                    :key (lambda (sample) (first (sample-texts sample)))
                                    :test-not #'string=))))

(defun write-score-pictures (testbed results name stream directory)
  "Save pictures of the score in RESULTS in the folder NAME of DIRECTORY. Show them on STREAM."
  (let ((prefix (format nil "measure-~(~A~)" (testbed-score testbed))))
    (terpri stream)
    (dolist (file (save-result-pictures results (merge-pathnames (format nil "~A/" name) directory)
                                        :which '(:measures)))
      (if (starts-with-subseq prefix (pathname-name file))
          (format stream "![~(~A~) of some agents](~A/~A.svg)~%" (testbed-score testbed) name
                  (pathname-name file))
          (delete-file file)))))

(defun write-sweep (testbed sweep picture stream directory seeds workers)
  "Write a table of the scores of all agents of TESTBED to STREAM, for each value of the knob that
SWEEP varies, and a picture of the name PICTURE into DIRECTORY."
  (destructuring-bind ((knob . values) . settings) sweep
    (let* ((agents (mapcar #'first (testbed-agents testbed)))
           (results (run-experiment-object
                     (testbed-experiment testbed agents :settings settings :sweep (first sweep))
                     seeds workers nil nil)))
      (format stream "~%### ~A, by ~(~A~)~2%"
              (if settings (settings-text settings) "All other knobs at their defaults") knob)
      (write-markdown-head (cons "agent" (mapcar #'value-text values)) stream)
      (loop for (agent . samples) in (samples-by-agent results agents)
            do (write-markdown-row
                (cons (agent-name-text agent)
                      (loop for sample in samples
                            collect (mean-cell (sample-measure results sample
                                                               (testbed-score testbed)))))
                stream))
      (write-score-pictures testbed results picture stream directory))))

(defun write-claims (testbed stream seeds workers)
  (when (testbed-claims testbed)
    (format stream "~%## Claims~2%")
    (write-wrapped (format nil "Differences in ~(~A~), in pairs with ~D equal seeds, with 95 % ~
                                intervals; p by the permutation test. A claim holds if each of ~
                                its differences is as large as stated, with p at most .01."
                           (testbed-score testbed) seeds)
                   stream)
    (loop for (text) in (testbed-claims testbed)
          for number from 1
          do (format stream "~%")
             (write-wrapped text stream :first (format nil "**~D.** " number))
             (terpri stream)
             (write-markdown-head '("knobs" "difference" "mean" "interval" "p" "") stream)
             (dolist (row (check-claims (testbed-name testbed) :seeds seeds :workers workers
                                                               :claims (list number)))
               (format stream "~A~%" (claim-row-text row))))))

(defun write-testbed-page (testbed stream directory seeds workers)
  (format stream "# ~(~A~)~2%" (testbed-name testbed))
  (write-wrapped (one-line (testbed-documentation testbed)) stream)
  (write-markdown-list "Rules" (testbed-rules testbed) stream)
  (write-markdown-list "Knobs" (mapcar #'knob-line (testbed-knobs testbed)) stream)
  (write-markdown-list "Agents" (loop for (name text) in (testbed-agents testbed)
                                      collect (format nil "`~(~A~)`: ~A" name text))
                       stream)
  (let ((few (max 2 (ceiling seeds 4))))
    (format stream "~%## Results~2%")
    (write-wrapped (format nil "Means of ~(~A~) over ~D seeds, with 95 % intervals."
                           (testbed-score testbed) few)
                   stream)
    (loop for sweep in (testbed-sweeps testbed)
          for number from 1
          do (write-sweep testbed sweep (format nil "~(~A~)-~D" (testbed-name testbed) number)
                          stream directory few workers)))
  (write-claims testbed stream seeds workers)
  (write-markdown-list "Sources" (testbed-sources testbed) stream))

(addition save-testbed-pages)
(defun save-testbed-pages (directory &key (names :all) (seeds 100) (workers 1))
  "Run the testbeds NAMES, by default all, and write a page of results for each into DIRECTORY:
NAME.md, with pictures beside it. Claims are checked on as many SEEDS; tables of all agents have a
quarter of them. The page is the same on each machine and for any number of WORKERS. Return a list
of the files. Signals UNKNOWN-NAME, and MISUSE if DIRECTORY cannot be made."
  (let ((directory (ensure-store-directory directory)))
    (loop for testbed in (if (eq :all names) (all-testbeds) (mapcar #'find-testbed names))
          for file = (merge-pathnames (format nil "~(~A~).md" (testbed-name testbed)) directory)
          do (overwrite-file (lambda (stream)
                               (write-testbed-page testbed stream directory seeds workers))
                             file "the page of results" :remedy "give another directory")
          collect file)))
