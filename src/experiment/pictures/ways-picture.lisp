;;;; ways-picture.lisp -- the ways of the trials of an experiment as a picture.

(in-package :ars-magna.experiment)

(defun ways-of-trial (experiment condition trial)
  "Run TRIAL of CONDITION of EXPERIMENT again. Return a list of the ways of its robots."
  (let ((trails '()) (watched-p nil))
    (flet ((look (simulation)
             (setf trails (note-places simulation trails))))
      (let ((result (run-trial experiment condition trial
                               :gate (lambda (simulation)
                                       (unless watched-p
                                         (setf watched-p t)
                                         (look simulation)
                                         (add-observer #'look simulation))
                                       +largest+))))
        (ways-along trails trial (result-outcome result))))))

(defun ways-of-trials (experiment condition trials)
  "Run the TRIALS, a list of numbers, of CONDITION of EXPERIMENT again. Return the ways of all."
  (prepare-trials experiment condition)
  (call-in-silence (lambda ()
                     (loop for trial in trials
                           append (ways-of-trial experiment condition trial)))))

(defun start-of-trial (experiment condition trial)
  "Return a snapshot of the world in which TRIAL begins."
  (call-in-silence (lambda ()
                     (call-in-trial (lambda ()
                                      (take-snapshot (simulation-world (current-simulation))))
                                    experiment condition trial))))

(defun trial-numbers (trials)
  "Return the numbers of the trials that TRIALS, an argument of SAVE-WAYS-PICTURE, means."
  (check-argument save-ways-picture trials
                  (or (whole-p trials 1 10000)
                      (and (consp trials) (proper-list-p trials)
                           (every (lambda (trial) (whole-p trial 1)) trials)))
                  "how many trials, from 1 to 10000, or a list of their numbers, from 1")
  (if (consp trials)
      trials
      (loop for trial from 1 to trials collect trial)))

(defun trials-in-words (trials)
  "Return whose ways a picture of TRIALS, a list of numbers, shows."
  (let ((count (length trials)))
    (cond ((= 1 count) (format nil "The way of each robot in trial ~D" (first trials)))
          ((<= count 8) (format nil "The ways of the trials ~{~D~^, ~}" trials))
          ((loop for trial in trials for number from 1 always (= trial number))
           (format nil "The ways of the first ~D trials" count))
          (t (format nil "The ways of ~D trials" count)))))

(addition save-ways-picture)
(define-with-keywords save-ways-picture
    (experiment condition file &rest options &key (trials 50) part title layers in-color scale)
  "Save in FILE, replacing it, a map of the world of CONDITION of EXPERIMENT with the ways that its
robots went in TRIALS, the first so many or a list of their numbers: in colours that say what became
of each trial, with a marker where it ended. The trials are run again for that. CONDITION is as for
FIND-CONDITION. PART (left top right bottom), in cells, is what is wanted of the map, by default
all. TITLE stands above instead of what the experiment asks. FILE and the other arguments are those
of SAVE-PICTURE. Return the file's truename. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE
without the program that PNG needs."
  (declare (ignore part title layers in-color scale))
  (picture-kind 'save-ways-picture file)
  (let* ((experiment (find-experiment experiment))
         (condition (find-condition experiment condition))
         (trials (trial-numbers trials))
         (start (start-of-trial experiment condition (first trials))))
    (apply #'save-bundle 'save-ways-picture "trial" file start
           (lambda () (ways-of-trials experiment condition trials))
           (or (question-of (experiment-name experiment))
               (string-downcase (experiment-name experiment)))
           (format nil "~A. ~A, with a marker ~:[at the end of each~;for each robot where ~
                        it ended~]. Robots and things are where ~:[the first of these~;the ~
                        trial~] begins."
                   (condition-name condition) (trials-in-words trials)
                   (rest (snapshot-robots start)) (null (rest trials)))
           (loop for (key value) on options by #'cddr
                 unless (eq :trials key) append (list key value)))))
