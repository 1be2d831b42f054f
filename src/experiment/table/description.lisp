;;;; description.lisp -- experiment.txt: how to repeat an experiment, and what decides its trials.

(in-package :ars-magna.experiment)

(export '(experiment-file form-text-in-package))

;;; Origins. They do not affect trials, so they are not in fingerprints.

(defun dependency-names (system)
  "Return the names of the libraries on which the system named SYSTEM and its subsystems depend."
  (loop for name in (remove-if-not #'stringp (asdf:system-depends-on (asdf:find-system system)))
        if (string= "ars-magna" (asdf:primary-system-name name))
          append (dependency-names name)
        else collect name))

(defparameter *libraries*
  (and (asdf:find-system "ars-magna" nil)
       (loop for name in (dependency-names "ars-magna")
             for library = (asdf:registered-system name)
             collect (format nil "~A~@[ ~A~]" name
                             (and library (asdf:component-version library)))))
  "The names and versions of the libraries that the simulator is built with.")

(defun git-output (directory &rest arguments)
  "Return the trimmed output of git with ARGUMENTS in DIRECTORY; NIL if there is no git, or it
fails, as outside of a work tree."
  (multiple-value-bind (status text)
      (run-command "git" (list* "-C" (native-name directory) arguments) :output :string)
    (and (eql 0 status) (string-trim '(#\Space #\Newline) text))))

(defun commit-text (directory)
  "Return a text with the commit of DIRECTORY and whether its files have changed since, or NIL."
  (let ((commit (git-output directory "rev-parse" "HEAD")))
    (and commit
         (format nil "commit ~A~@[~A~]" commit
                 (and (string/= "" (or (git-output directory "status" "--porcelain"
                                                   "--untracked-files=no" "--" ".")
                                       ""))
                      ", and changes since")))))

(defun experiment-file (experiment)
  "Return the native name of the file with EXPERIMENT, or NIL."
  (let ((entry (lookup-entry (experiment-name experiment) *experiments*)))
    (and entry (source-file (entry-source entry)))))

(defun origin-lines (experiment)
  (let* ((file (experiment-file experiment))
         ;; A saved program may run where there are no sources.
         (system (asdf:registered-system "ars-magna"))
         (home (and system (asdf:system-source-directory system)))
         (commits (list (and file
                             (commit-text (uiop:pathname-directory-pathname (native-path file))))
                        (and home (probe-file home) (commit-text home)))))
    (remove nil
            (list (format nil "Written ~A by ~A ~A, ~A." (date-and-time)
                          (lisp-implementation-type) (lisp-implementation-version)
                          (machine-type))
                  (format nil "~@[Libraries: ~{~A~^, ~}.~]" *libraries*)
                  (and (first commits) (format nil "Its file: ~A." (first commits)))
                  (and (second commits) (format nil "The simulator: ~A." (second commits)))))))

;;;; The text

;;; The text is for people. Only some of it is read back: the parts of the fingerprints and the
;;; experiment's form, to report changes, the order of conditions, and the option --until.

(defun form-text-in-package (form package)
  "Return the text of FORM, in lower case, as written in PACKAGE."
  (printing-plainly ()
    (let ((*package* package) (*print-case* :downcase) (*print-pretty* t) (*print-right-margin* 90))
      (prin1-to-string form))))

(defun repetition-text (experiment trials until)
  (let* ((path (experiment-file experiment)) (file (and path (short-file-name path)))
         (name (experiment-name experiment)))
    (format nil "At a shell~:[, once its text is in a file~;~]:~%  ./cli/ars-magna experiment ~
                 ~:*~:[FILE~;~:*~A~] ~(~A~) ~:[--trials ~D~;--until ~:*~A~*~] --out DIRECTORY~%~
                 In Lisp, once it is loaded:~%  (run-experiment '~(~A~) ~:[:trials ~D~;:until ~
                 ~:*~A~*~] :directory \"...\")~%"
            file name (and until (value-text until)) trials
            name (and until (value-text until)) trials)))

(defun write-description (experiment parts trials until stream)
  "Write the description of EXPERIMENT to STREAM. TRIALS and UNTIL are the arguments of its run.
PARTS are lists of the parts of its conditions' fingerprints, in order."
  (format stream "The experiment ~(~A~).~@[~%~A~]~2%~A~%"
          (experiment-name experiment) (experiment-documentation experiment)
          (repetition-text experiment trials until))
  (format stream "Trial T has the seed ~D + T under all conditions, and at most ~D ticks.~%~
                  ARS MAGNA ~A.~%~{~A~%~}~%~A~2%"
          (experiment-seed experiment) (experiment-limit experiment) *simulator-version*
          (origin-lines experiment)
          (form-text-in-package (experiment-form experiment) (experiment-package experiment)))
  (format stream "What decides the trials of each condition:~%")
  (loop for condition in (experiment-conditions experiment)
        for its in parts
        do (format stream "~%~A~%= ~A~%~{  ~A~%~}" (condition-fingerprint condition)
                   (condition-name condition) (mapcar #'part-text its))))

;;; The last line has a checksum of all lines before it.

(defparameter *checksum-label* "Check sum: ")

(defun checksum-line (text)
  (format nil "~A~8,'0X~%" *checksum-label* (text-checksum text)))

(defun description-text (directory)
  "Return the text of experiment.txt in DIRECTORY, or NIL if it cannot be read."
  (ignore-errors (file-text (description-file directory))))

(defun intact-description-p (text)
  (let ((place (and text (search *checksum-label* text :from-end t))))
    (and place
         (string= (checksum-line (subseq text 0 place)) (subseq text place)))))

(defun warn-if-damaged (directory)
  (let ((file (description-file directory)))
    (unless (or (not (existing-path file))
                (intact-description-p (description-text directory)))
      (warn "~A is damaged or has been changed: its last line is not the check sum of its other ~
             lines. The rows beside it are read all the same. If you run the experiment again with ~
             that directory, the file is written anew."
            (native-name file)))))

(defun description-lines (directory)
  "Return the lines of experiment.txt in DIRECTORY; NIL if there is none."
  (let ((text (description-text directory)))
    (and text (uiop:split-string text :separator '(#\Newline)))))

(defun recorded-until (directory)
  "Return the width of intervals that --until gives in experiment.txt in DIRECTORY, or NIL."
  (let* ((command (find-if (lambda (line) (starts-with-subseq "  ./cli/ars-magna experiment" line))
                           (description-lines directory)))
         (place (and command (search "--until " command)))
         (start (and place (+ place (length "--until ")))))
    (and start (number-from-text (subseq command start (position #\Space command :start start))))))

(defun save-description (experiment parts trials until directory)
  (let ((text (with-output-to-string (stream)
                (printing-plainly ()
                  (write-description experiment parts trials until stream)))))
    (write-checked-text text (description-file directory))))

(defun write-checked-text (text file)
  (overwrite-file (lambda (stream)
                     (write-string text stream)
                     (write-string (checksum-line text) stream))
                   file "the description" :remedy "remove it, or give another directory"))

;;; Refused rows. Later readers of the table must know about them.

(defparameter *refusal-label* "Refused: ")

(defun recorded-refusal (directory)
  "Return the reason why the rows in DIRECTORY were refused after their run, or NIL."
  (let ((line (find-if (lambda (line) (starts-with-subseq *refusal-label* line))
                       (description-lines directory))))
    (and line (subseq line (length *refusal-label*)))))

(defun record-refusal (directory reason)
  "Record in experiment.txt in DIRECTORY that the rows beside it were refused for REASON, a text."
  (let* ((text (description-text directory))
         (place (and text (search *checksum-label* text :from-end t))))
    (when place
      (let ((text (format nil "~A~A~A~%" (subseq text 0 place) *refusal-label* (one-line reason))))
        (write-checked-text text (description-file directory))))))

(defun check-not-refused (directory)
  (let ((reason (recorded-refusal directory)))
    (when reason
      (reject-use "The rows in ~A were refused at the end of their run. Delete rows.csv there, or ~
                   give another directory. The reason was: ~A"
                  (native-name directory) reason))))

;;; What has changed.

(defun recorded-parts (condition directory)
  "Return the lines for the parts of CONDITION, a name, in experiment.txt in DIRECTORY, or NIL."
  (let ((lines (description-lines directory))
        (title (format nil "= ~A" condition)))
    (loop for line in (rest (member title lines :test #'string=))
          while (starts-with-subseq "  " line)
          collect (string-trim " " line))))

(defun recorded-form (directory)
  (loop for line in (member-if (lambda (line)
                                 (and (starts-with-subseq "(" line) (search "defexperiment" line)))
                               (description-lines directory))
        until (starts-with-subseq "What decides" line)
        unless (string= "" line) collect (string-trim " " line)))

(defun changed-parts (before now)
  "Return the names of the parts that are in only one of BEFORE and NOW, two lists of lines. If no
part of that name is in the other list, a note says so."
  (flet ((names (lines)
           (loop for line in lines collect (subseq line 0 (position #\Space line :from-end t)))))
    (let ((old (names (set-difference before now :test #'string=)))
          (new (names (set-difference now before :test #'string=))))
      (append (intersection old new :test #'string=)
              (loop for name in (set-difference new old :test #'string=)
                    collect (format nil "~A (new)" name))
              (loop for name in (set-difference old new :test #'string=)
                    collect (format nil "~A (no longer used)" name))))))

(defun recorded-conditions (directory)
  (loop for line in (description-lines directory)
        when (starts-with-subseq "= " line) collect (subseq line 2)))

(defun changed-parts-since-run (condition parts directory)
  "Return a list of names of the PARTS of CONDITION that differ from experiment.txt in DIRECTORY."
  (let ((before (recorded-parts (condition-name condition) directory)))
    (and before (changed-parts before (mapcar #'part-text parts)))))

(defun reject-foreign-rows (experiment condition parts directory)
  "Signal MISUSE: DIRECTORY has rows of CONDITION of EXPERIMENT with another fingerprint. PARTS are
the fingerprint parts of all conditions."
  (let ((its (nth (position condition (experiment-conditions experiment)) parts)))
    (reject-use "~A has rows of the condition ~A from other code or another configuration~@[; ~
                 changed since: ~{~A~^, ~}~]. Give another directory, or delete these rows."
                (native-name directory) (condition-name condition)
                (changed-parts-since-run condition its directory))))
