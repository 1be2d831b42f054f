;;;; tutorial.lisp -- the tutorial's examples are correct.

(in-package :ars-magna.tests)

(def-suite* tutorial :in ars-magna)

(defun tutorial-page () (project-file "worlds/tutorial/README.md"))

(defun blocks-of (kind path)
  "Return the blocks of KIND, such as \"text\", in the file PATH, of Markdown, as lists of lines."
  (loop with block = :none
        for line in (file-lines path)
        if (and (eq block :none) (string= line (format nil "```~A" kind)))
          do (setf block '())
        else if (and (listp block) (string= line "```"))
          collect (reverse (shiftf block :none))
        else if (listp block)
          do (push line block)))

;;; Sessions. A line that begins with the prompt was typed, unless a word with a colon follows: then
;;; it is the answer to a command.

(defun typed-line (line)
  "Return what was typed in LINE, of a session, or NIL."
  (let ((start (length "Robot> ")))
    (and (eql 0 (search "Robot> " line))
         (not (search ": " line :end2 (or (position #\( line) (length line))))
         (subseq line start))))

(defun answered-line (line)
  "Return what LINE, of a session, shows of an answer, or NIL."
  (cond ((typed-line line) nil)
        ((string= "..." line) nil)
        ((eql 0 (search "Robot> " line)) (subseq line (length "Robot> ")))
        (t line)))

(defun found-in-order-p (lines others)
  "True if LINES are among OTHERS, in this order."
  (loop for line in lines
        do (setf others (rest (or (member line others :test #'string=) (return nil))))
        finally (return t)))

(test tutorial.types-what-works
  "All that is typed into the tiny world, in one session."
  (let* ((lines (apply #'append (butlast (blocks-of "text" (tutorial-page)))))
         (typed (remove nil (mapcar #'typed-line lines)))
         (answers (remove nil (mapcar #'answered-line lines)))
         (written (apply #'type-to 'ars-worlds:dot typed)))
    (is (< 8 (length typed)))
    (is (< 20 (length answers)))
    (is (notany (lambda (line) (eql 0 (search "*ERROR*" line))) written))
    (is (found-in-order-p answers written) "~S~%is not what came:~%~S" answers written)))

;;; The hen yard.

(defun call-forgetting-henyard (function)
  "Call FUNCTION; forget what the tutorial defines."
  (call-with-suites-of-its-own
   (lambda ()
     (let ((*package* (find-package :ars-user)))
       (base:with-own-definitions () (funcall function))))
   :henyard))

(test tutorial.shows-what-is-so
  (let ((blocks (lisp-blocks (tutorial-page))))
    (is (< 12 (length blocks)))
    (call-forgetting-henyard
     (lambda ()
       (is (= 3 (reduce #'+ (mapcar #'run-block blocks))))
       (is-true (results-status (run (find-symbol "HENYARD" :henyard))))))))

(test tutorial.finds-what-it-says
  "The table of the experiment is what comes of it."
  (call-forgetting-henyard
   (lambda ()
     (mapc #'run-block (remove "is-success-rate" (lisp-blocks (tutorial-page)) :test #'search))
     (let* ((name (find-symbol "LOOKING-BEFORE-WANDERING" :henyard))
            (results (experiment:run-experiment name :trials 100 :stream nil))
            (table (lines-of (with-output-to-string (out)
                               (experiment:print-results results out))))
            (shown (mapcar (lambda (line) (subseq line (min 4 (length line))))
                           (file-lines (tutorial-page)))))
       (is (< 8 (length table)))
       (is (found-in-order-p table shown) "~{~A~%~}" table)))))

(test tutorial.has-lines-to-be-read
  (dolist (line (file-lines (tutorial-page)))
    (is (<= (length line) 112) line)))
