;;;; src-readme.lisp -- the page on extending works as shown; cited readings exist.

(in-package :ars-magna.tests)

(def-suite* src-readme :in ars-magna)

;;; The examples.

(defun lisp-blocks (path)
  "Return the lines of Lisp in the file PATH, of Markdown: a list of strings, one for each block."
  (loop with block = :none
        for line in (file-lines path)
        if (and (eq block :none) (string= line "```lisp"))
          do (setf block '())
        else if (and (listp block) (string= line "```"))
          collect (format nil "~{~A~%~}" (reverse (shiftf block :none)))
        else if (listp block)
          do (push line block)))

(defun lines-from (text position)
  "Return the lines of TEXT from POSITION on, without the space before the first."
  (let ((start (position-if-not (lambda (char) (find char '(#\Space #\Newline))) text
                                :start position)))
    (and start (uiop:split-string (subseq text start) :separator '(#\Newline)))))

(defun begins-with-p (start line)
  (eql 0 (search start line)))

(defun promise-at (text position)
  "Return what a comment that follows POSITION of TEXT promises, on one line or more, or NIL."
  (destructuring-bind (&optional (first "") &rest others) (lines-from text position)
    (when (begins-with-p "; => " first)
      (format nil "~A~{ ~A~}" (subseq first 5)
              (loop for line in others
                    while (begins-with-p ";    " line)
                    collect (string-left-trim "; " line))))))

(defun shown (value)
  "Return VALUE as the README shows it."
  (let ((*print-case* :downcase) (*print-pretty* nil))
    (prin1-to-string value)))

(defun run-example (form)
  "Return the value of FORM. A warning is a failure."
  (handler-bind ((warning (lambda (warning)
                            (fail "~S warns: ~A" form warning)
                            (muffle-warning warning))))
    (eval form)))

(defun run-block (text)
  "Evaluate the forms in TEXT, in order, and check what is promised. Return how much that was."
  (loop with position = 0 and form and promises = 0
        do (setf (values form position)
                 (read-from-string text nil text :start position :preserve-whitespace t))
           (when (eq form text) (return promises))
           (let ((value (run-example form)) (promise (promise-at text position)))
             (when promise
               (incf promises)
               (is (string= promise (shown value)) "~S~%is ~A, not ~A"
                   form (shown value) promise)))))

(defun call-with-examples (function)
  "Call FUNCTION; forget the package of the page, and what is defined there."
  (let ((*package* (find-package :ars-user)))
    (unwind-protect (base:with-own-definitions () (funcall function))
      (when (find-package :glasshouse) (delete-package :glasshouse)))))

(defparameter *page-on-extending* "worlds/how-to/extend/README.md")

(test src-readme.shows-what-is-so
  (let ((blocks (lisp-blocks (project-file *page-on-extending*))))
    (is (<= 9 (length blocks)))
    (call-with-examples
     (lambda ()
       (is (<= 8 (reduce #'+ (mapcar #'run-block blocks))))))))

(test src-readme.leaves-nothing-behind
  (let ((kinds (base:all-kinds)) (commands (command:all-commands)))
    (call-with-examples
     (lambda ()
       (mapc #'run-block (lisp-blocks (project-file *page-on-extending*)))
       (is (< (length kinds) (length (base:all-kinds))))))
    (is (equal kinds (base:all-kinds)))
    (is (equal commands (command:all-commands)))
    (is (null (find-package :glasshouse)))))

(test src-readme.has-lines-to-be-read
  (dolist (file (list "src/README.md" "src/readings.md" *page-on-extending*))
    (dolist (line (file-lines (project-file file)))
      (unless (begins-with-p "|" line)
        (is (<= (length line) 112) "~A: ~A" file line)))))

;;; The readings.

(defun reading-numbers ()
  "Return the numbers of the readings in src/readings.md, in their order there."
  (loop for line in (file-lines (project-file "src/readings.md"))
        when (begins-with-p "**" line)
          collect (parse-integer line :start 2 :junk-allowed t)))

(defun gap-end (text position)
  "Return where what may stand between a citation's words ends: space and the signs of comments."
  (or (position-if-not (lambda (char) (find char '(#\Space #\Newline #\;))) text :start position)
      (length text)))

(defun numbers-at (text position)
  "Return the whole numbers in TEXT from POSITION on, between which are commas or AND."
  (loop for start = (gap-end text position)
        for (number end) = (multiple-value-list
                            (parse-integer text :start start :junk-allowed t))
        while (and number
                   (digit-char-p (char text start))
                   (not (alpha-char-p (char text end)))) ; 0d0 is a value
        collect number
        do (setf position (cond ((eql #\, (char text end)) (1+ end))
                                ((eql (gap-end text end) (search "and " text :start2 end))
                                 (+ 4 (gap-end text end)))
                                (t end)))
        until (= position end)))

(defun cited-readings (text)
  "Return the numbers of the readings that TEXT, of a source file, cites."
  (loop with word = "reading"
        for start = (search word text :test #'char-equal)
          then (search word text :test #'char-equal :start2 (1+ start))
        while start
        append (let ((end (+ start (length word))))
                 (numbers-at text (if (eql end (search "s" text :start2 end)) (1+ end) end)))))

(test readings.are-found-where-code-cites-them
  (is (equal '(12 40 7) (cited-readings (format nil "(readings 12,~%;;; 40 and 7) readings, 8."))))
  (is (equal '(12) (cited-readings "A reading, as Reading 12 says.")))
  (is (null (cited-readings "(readings 'x) 5"))))

(test readings.are-numbered-without-gap
  (is (equal (loop for number from 1 to 246 collect number) (sort (reading-numbers) #'<))))

(test readings.that-code-cites-exist
  (let ((readings (reading-numbers)) (cited '()))
    (dolist (path (lisp-files "src/" "rpl/" "cli/" "worlds/"))
      (dolist (number (cited-readings (base:read-file-into-string path)))
        (pushnew number cited)
        (is (member number readings) "~A cites reading ~D" path number)))
    (is (<= 200 (length cited)) "only ~D readings are cited" (length cited))))
