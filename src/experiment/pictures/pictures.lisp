;;;; pictures.lisp -- SAVE-RESULT-PICTURES: what came of an experiment, as pictures in files.

(in-package :ars-magna.experiment)

(defparameter *pictures*
  '((:success . success-pictures) (:ticks . ticks-pictures) (:measures . measure-pictures)
    (:survival . survival-pictures) (:differences . difference-pictures))
  "An alist from what may be shown to functions of results and summaries that return pictures.")

;;; Files are called by what is in them.

(defun file-word (text)
  "Return TEXT as the part of a file's name: at most 100 letters, digits, points and single dashes."
  (let* ((text (substitute-if #\- (lambda (char)
                                    (not (or (and (< (char-code char) 128) (alphanumericp char))
                                             (char= #\. char))))
                              (string-downcase text)))
         (words (remove "" (uiop:split-string text :separator "-") :test #'string=))
         (name (format nil "~{~A~^-~}" words)))
    (subseq name 0 (min 100 (length name)))))

(defun new-name (name where names)
  "Return the name for the picture called NAME, of WHERE, which is none of NAMES."
  (let ((name (file-word (format nil "~A~@[-~A~]" name where))))
    (if (member name names :test #'string=)
        (loop for number from 2
              for other = (format nil "~A-~D" name number)
              unless (member other names :test #'string=) return other)
        name)))

(defun save-pictures (pictures directory kind)
  "Save PICTURES in DIRECTORY, as files of KIND. Return their truenames."
  (let ((names '()))
    (loop for (title where chart) in pictures
          for name = (new-name title where names)
          do (push name names)
          collect (save-chart (file-in directory (format nil "~A.~(~A~)" name kind)) chart))))

(addition save-result-pictures)
(define-with-keywords save-result-pictures
    (results directory &key (kind :svg) (which (mapcar #'first *pictures*)))
  "Save pictures of RESULTS in DIRECTORY, made if there is none, as KIND says, :SVG or, where the
program rsvg-convert is installed, :PNG. WHICH says of what, a list of some of these:
  :SUCCESS      how often trials succeed, against what varies, with 95 % intervals
  :TICKS        how many ticks those take that succeed, likewise: medians
  :MEASURES     what was measured: rates, or means, and how all numbers lie
  :SURVIVAL     which share of trials is not yet done after so many ticks
  :DIFFERENCES  in success and ticks, between the values of what varies, seed by seed
The first of what varies whose values are numbers runs along the picture; the rest makes series of
it, and where that were more than six, pictures. What there is no data for is left out. The title is
what the experiment asks, if it is loaded. Return a list of the files, which are called by what they
show. Signals WRONG-ARGUMENT, and MISUSE without that program or if there is no such directory."
  (check-argument save-result-pictures results (results-p results) "results")
  (check-argument save-result-pictures directory (typep directory '(or string pathname))
                  "the name of a directory")
  (check-argument save-result-pictures kind (member kind '(:svg :png)) ":svg or :png")
  (check-argument save-result-pictures which
                  (and (proper-list-p which)
                       (every (lambda (key) (assoc key *pictures*)) which))
                  (format nil "a list of some of ~{~(~S~)~^, ~}" (mapcar #'first *pictures*)))
  (when (results-samples results)
    (let ((summaries (summarize-results results)))
      (save-pictures (loop for (key . function) in *pictures*
                           when (member key which)
                             append (funcall function results summaries))
                     (ensure-store-directory directory) kind))))
