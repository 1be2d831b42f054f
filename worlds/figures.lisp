;;;; figures.lisp -- runs the shipped experiments, and puts their results into their pages.

;;; The command worlds/figures calls SAVE-FIGURES. Tables go into a page between two comments, such
;;; as <!-- table of three-ways-of-searching --> and <!-- end of table -->. Pictures go into
;;; worlds/pictures/. The same code makes the same bytes.

(in-package :ars-worlds)

(defparameter *figures*
  '((choosing-by-rollouts "README.md" choosing-lines)
    (fetching-against-motion-noise "README.md" results-lines "success" "survival")
    (fetching-against-blindness-and-kicks "README.md" results-lines "success")
    (three-ways-of-searching "README.md" results-lines "success" "difference-in-success-by-way")
    (recognising-places "how-to/recognising-places/README.md" rate-table-lines
     "success-places-10" "success-places-40")
    (returning-by-views "how-to/recognising-places/README.md" rate-table-lines "success"))
  "Lists (experiment page function picture...): the page that shows the results of an experiment,
the function that makes the lines of the table, and the names of the pictures on the page.")

(defparameter *trials-with-ways*
  '((fetching-against-motion-noise "motion-noise*=0.6" 60 (52 12 120 46))
    (three-ways-of-searching "way=search-watchfully miss-thing-prob*=0.2" 20 nil))
  "Lists (experiment condition trials part): the trials whose ways the page shows, and the part of
the map to draw; NIL is the whole map.")

(defparameter *figures-directory* (asdf:system-relative-pathname "ars-magna" "worlds/")
  "The directory of the pictures and the page. Tests bind this variable to another directory.")

(defun worlds-path (name)
  "Return the path of the file NAME in worlds/. Create the directory of the file if there is none."
  (ensure-directories-exist (merge-pathnames name *figures-directory*)))

(defun pictures-directory (experiment)
  (worlds-path (format nil "pictures/~(~A~)/" experiment)))

(defun save-page-pictures (experiment results names)
  (dolist (file (save-result-pictures results (pictures-directory experiment)))
    (unless (member (pathname-name file) names :test #'string=)
      (delete-file file))))

;;; The page.

(defun comment-line (what)
  (format nil "<!-- ~(~A~) -->" what))

(defun replace-table (lines experiment table)
  (let* ((start (position (comment-line (format nil "table of ~A" experiment)) lines
                             :test #'string=))
            (end (position (comment-line "end of table") lines :test #'string= :start start)))
    (append (subseq lines 0 (1+ start)) table (nthcdr end lines))))

(defun results-lines (results)
  "Return the lines of the page that show RESULTS as they are printed."
  (list "```"
        (string-right-trim '(#\Newline)
                           (with-output-to-string (out) (print-results results out)))
        "```"))

;;; Worlds.

(defun save-picture-of-layers ()
  "Save a picture of DOT in TINY that shows the layers of pictures."
  (with-simulation (dot :seed 4)
    (let ((camera (robot-camera dot 0)))
      (keep-history)
      (robot-turn dot -0.5d0)
      (run-ticks 20)
      (robot-go-forward dot 4)
      (run-ticks 12)
      (dolist (color '(red lightblue))
        (camera-get-object-designator camera :non-local `((:color ,color)))
        (run-ticks 12))
      (camera-view camera)
      (run-ticks 4))
    (save-picture dot (worlds-path "pictures/worlds/tiny-layers.svg")
                  :layers '(:names :places :grid :wedges :rays :trail :designators :coordinates
                            :legend :scale-bar :title))))

;;; Looking ahead.

(defun save-picture-of-rollouts ()
  "Save a picture of the ways of rollouts in which a trolley may block the way."
  (with-simulation (marvin :seed 3)
    (leave-trolleys)
    (save-projection-picture (project 'carry-messages :arguments '(:first)
                                                      :trials 25 :horizon 1200)
                             (worlds-path "pictures/looking-ahead/ways.svg")
                             :part '(28 2 100 46))))

;;; One fetch.

(defun save-pictures-of-fetch ()
  "Save pictures of a fetch: what happened where, and the tasks of its plan over time."
  (with-simulation (marvin :seed 7 :journal t)
    (let ((*trace-plans* t))
      (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24)))
      (save-plan-timeline (worlds-path "pictures/fetch/timeline.svg")))
    (save-run-picture (worlds-path "pictures/fetch/run.svg")
                      :title "marvin fetches a globe across the office")))

;;; Choosing by rollouts: what it is worth, and how good forecasts are.

(defparameter *choosing-labels*
  '("always the short way" "always the long way" "either, at random" "chosen by rollouts")
  "The labels on the page for the conditions of CHOOSING-BY-ROLLOUTS, in order.")

(defun succeeded-p (outcome)
  (string= "success" outcome))

(defun rate-text (successes trials)
  "Return SUCCESSES of TRIALS in percent, with Wilson's interval."
  (multiple-value-bind (low high) (wilson-interval successes trials)
    (format nil "~D % (~D to ~D)" (round (* 100 successes) trials) (round (* 100 low))
            (round (* 100 high)))))

(defun choosing-table-row (name results sample)
  "Return the row of the table for SAMPLE of RESULTS, with NAME as its first cell."
  (let* ((trials (length (sample-trials sample)))
         (rate (/ (count-if #'succeeded-p (sample-outcomes sample)) trials)))
    (format nil "| ~A | ~A | ~,3F | ~,3F |" name (sample-rate-text sample)
            (/ (reduce #'+ (sample-measure results sample 'miss)) trials)
            (* rate (- 1 rate)))))

(defun paired-comparison-lines (firsts bests)
  "Return lines that compare BESTS, outcomes with rollouts, with FIRSTS, outcomes by the short way."
  (let* ((more (count t (map 'list (lambda (first best)
                                     (and (succeeded-p best) (not (succeeded-p first))))
                             firsts bests)))
         (less (count t (map 'list (lambda (first best)
                                     (and (succeeded-p first) (not (succeeded-p best))))
                             firsts bests)))
         (p (mcnemar-test more less)))
    (list (format nil "In ~D pair~:P of trials with the same seed, only the rollouts were in time;"
                  more)
          (format nil "in ~D pair~:P only the short way was in time: p ~:[= ~,3F~;< .001~]."
                  less (< p 1/1000) p))))

(defun choosing-lines (results)
  "Return the lines of the page with the RESULTS of CHOOSING-BY-ROLLOUTS."
  (let ((samples (results-samples results)))
    (append (list (format nil "| of ~D trials, the same seeds for all | in time | Brier score of ~
                               the forecasts | of the mean rate |"
                          (length (sample-trials (first samples))))
                  "|---|---|---|---|")
            (loop for name in *choosing-labels*
                  for sample in samples
                  collect (choosing-table-row name results sample))
            (list "")
            (paired-comparison-lines (sample-outcomes (first samples))
                                     (sample-outcomes (first (last samples)))))))

;;; Rates of success.

(defun rate-table-lines (results)
  "Return the lines of a table of the rates in RESULTS, with a column for each value of the last
factor."
  (let* ((samples (results-samples results))
         (factors (results-factors results))
         (values (remove-duplicates (mapcar (lambda (sample) (first (last (sample-texts sample))))
                                            samples)
                                    :test #'string= :from-end t)))
    (append (list (format nil "| ~{`~A` | ~}~:{~A ~A |~:^ ~}" (butlast factors)
                          (loop for value in values collect (cons value (last factors))))
                  (format nil "|~{~*---|~}~{~*---|~}" (butlast factors) values))
            (loop while samples
                  collect (format nil "| ~{~A | ~}~{~A |~^ ~}"
                                  (butlast (sample-texts (first samples)))
                                  (loop for nil in values
                                        collect (sample-rate-text (pop samples))))))))

(defun sample-rate-text (sample)
  (rate-text (count-if #'succeeded-p (sample-outcomes sample)) (length (sample-trials sample))))

;;; The command.

(defun save-quick-figures ()
  "Save the pictures that take only seconds. Tests compare the shipped pictures with these."
  (save-picture-of-layers)
  (write-ward-files (worlds-path "floors/"))
  (save-picture-of-rollouts)
  (save-pictures-of-fetch))

(defun save-ways-pictures (experiment)
  (loop for (name condition trials part) in *trials-with-ways*
        when (eq name experiment)
          do (save-ways-picture experiment condition
                                (merge-pathnames "ways.svg" (pictures-directory experiment))
                                :trials trials :part part)))

(defun save-figure (experiment page function &rest pictures)
  "Run EXPERIMENT, put the table that FUNCTION makes of the results into PAGE, and save PICTURES."
  (let* ((results (run-experiment experiment))
         (path (worlds-path page))
         (lines (replace-table (uiop:read-file-lines path :external-format :utf-8) experiment
                               (funcall function results))))
    (when pictures (save-page-pictures experiment results pictures))
    (save-ways-pictures experiment)
    (with-open-file (out path :direction :output :if-exists :supersede :external-format :utf-8)
      (format out "~{~A~%~}" lines))))

(defun save-figures (&rest names)
  "Run the experiments with NAMES, strings; without NAMES, run all in *FIGURES*, draw the floor to
import, and save the other pictures. Put tables into the pages, and save the pictures."
  (dolist (name names)
    (unless (member name *figures* :key #'first :test #'string-equal)
      (ars-magna.base:reject-argument 'save-figures "name" name
                                      (format nil "one of ~{~(~A~)~^, ~}"
                                              (mapcar #'first *figures*)))))
  (unless names (save-quick-figures))
  (dolist (figure *figures*)
    (when (or (null names) (member (first figure) names :test #'string-equal))
      (apply #'save-figure figure))))
