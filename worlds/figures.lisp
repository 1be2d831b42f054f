;;;; figures.lisp -- runs the shipped experiments, and brings worlds/README.md up to date with them.

;;; The command worlds/figures calls SAVE-FIGURES. Tables go into the page between two comments,
;;; such as <!-- table of three-ways-of-searching --> and <!-- end of table -->; pictures into a
;;; directory beside it. The same code makes the same bytes.

(in-package :ars-worlds)

(defparameter *pictures-kept*
  '((fetching-against-motion-noise "success" "survival")
    (fetching-against-blindness-and-kicks "success")
    (three-ways-of-searching "success" "difference-in-success-by-way"))
  "For each experiment the names of those of its pictures that the page shows.")

(defparameter *ways-shown*
  '((fetching-against-motion-noise "motion-noise*=0.6" 60 (52 12 120 46))
    (three-ways-of-searching "way=search-watchfully miss-thing-prob*=0.2" 20 nil))
  "Lists (experiment condition trials part): the ways that the page shows, and of which part of the
map.")

(defun in-worlds (name)
  "Return the path of the file NAME in worlds/."
  (asdf:system-relative-pathname "ars-magna" (format nil "worlds/~A" name)))

(defun pictures-of (experiment)
  "Return the directory of the pictures of EXPERIMENT."
  (in-worlds (format nil "pictures/~(~A~)/" experiment)))

(defun save-pictures-kept (experiment results names)
  "Save the pictures called NAMES of the RESULTS of EXPERIMENT, and no others."
  (dolist (file (save-result-pictures results (pictures-of experiment)))
    (unless (member (pathname-name file) names :test #'string=)
      (delete-file file))))

;;; The page.

(defun page-lines (page)
  (with-open-file (in page :external-format :utf-8)
    (loop for line = (read-line in nil)
             while line collect line)))

(defun comment-line (what)
  (format nil "<!-- ~(~A~) -->" what))

(defun with-table (lines experiment table)
  "Return LINES of a page with TABLE, a text, where they have that of EXPERIMENT."
  (let* ((start (position (comment-line (format nil "table of ~A" experiment)) lines
                             :test #'string=))
            (end (position (comment-line "end of table") lines :test #'string= :start start)))
    (append (subseq lines 0 (1+ start))
            (list "```" (string-right-trim '(#\Newline) table) "```")
            (nthcdr end lines))))

(defun save-page (lines page)
  (with-open-file (out page :direction :output :if-exists :supersede :external-format :utf-8)
    (format out "~{~A~%~}" lines)))

;;; Looking ahead.

(defun save-ways-ahead ()
  "Save a picture of where the rollouts of an errand go whose way may be barred."
  (with-simulation (marvin :seed 3)
    (leave-trolleys)
    (save-projection-picture (project 'carry-messages :arguments '(:first)
                                                      :trials 25 :horizon 1200)
                             (ensure-directories-exist
                              (in-worlds "pictures/looking-ahead/ways.svg"))
                             :part '(28 2 100 46))))

;;; The whole.

(defun save-figures ()
  "Draw the floor to import, run the shipped experiments, put their tables into worlds/README.md,
and save their pictures."
  (draw-ward (in-worlds "floors/"))
  (save-ways-ahead)
  (let* ((page (in-worlds "README.md")) (lines (page-lines page)))
    (loop for (experiment . names) in *pictures-kept*
             do (let ((results (run-experiment experiment)))
                  (setf lines (with-table lines experiment
                                          (with-output-to-string (out)
                                            (print-results results out))))
                  (save-pictures-kept experiment results names)))
    (loop for (experiment condition trials part) in *ways-shown*
             do (save-ways-picture experiment condition
                                   (merge-pathnames "ways.svg" (pictures-of experiment))
                                   :trials trials :part part))
    (save-page lines page)))
