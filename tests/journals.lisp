;;;; journals.lisp -- journals as files: whole, damaged, hostile, and of other definitions.

(in-package :ars-magna.tests)

(def-suite* journals :in ars-magna)

;;; A run, and its file.

(defun ride-about ()
  "Do something of every kind to the world of ROVER in the present run."
  (let ((rover (first (run:simulation-robots))) (*read-default-float-format* 'single-float))
    (wander rover (base:make-dice 8))
    (run:run-ticks 40)
    (setf base:motion-noise* 0.5)
    (let ((ball (world:make-new-thing '|a "ball\\" \|; (| (list 'arena 3 3)
                                      '((:size 1) (:weight 1/3)))))
      (world:set-kicker ball 'jitter)
      (world:set-attribute ball :color 'world:red)
      (run:run-ticks 20)
      (world:move-thing ball 4.5 6.25d0)
      (world:kick-thing ball 1 1.5 t))
    (robot:make-odometer rover 'trip)
    (robot:place-robot rover 5 5 1)
    (run:set-seed (expt 7 70))
    (time:grab-resource (robot:robot-hand rover 1))
    (run:run-ticks 40)))

(defun recorded-ride ()
  "Return the journal of RIDE-ABOUT, and the digest at its end."
  (with-rover (:seed 31 :journal t)
    (ride-about)
    (values (end-journal time:*simulation*) (run:state-digest))))

(defun journal-lines (file)
  (uiop:read-file-lines file :external-format :utf-8))

(defun write-text (text file)
  (with-open-file (out file :direction :output :if-exists :supersede :external-format :utf-8)
    (write-string text out)))

(defun write-lines (lines file)
  (write-text (format nil "~{~A~%~}" lines) file))

(defun sealed-lines (texts)
  "Return TEXTS, the forms of a journal, as its lines, with the check sums that they ought to have."
  (let ((sum 0))
    (loop for text in texts
          do (setf sum (base:text-checksum text sum))
          collect (format nil "~A ;~8,'0X" text sum))))

(defun forged-journal (&rest entries)
  "Return the texts of a journal of nothing with ENTRIES, texts, put into it."
  (with-rover (:journal t)
    (let ((texts (mapcar #'run::datum-text
                         (run::journal-data (end-journal time:*simulation*)))))
      (append (butlast texts) entries '("(end 9)")))))

(defun write-forged (file &rest entries)
  "Let FILE be what FORGED-JOURNAL returns, with the right check sums."
  (write-lines (sealed-lines (apply #'forged-journal entries)) file))

(defun replay-outcome (file &rest options)
  "Return the digest after a replay of FILE, or the condition of ours that it signals. What else may
be signalled is not caught."
  (handler-case (nth-value 1 (apply #'run:replay file options))
    (base:ars-magna-error (trouble) trouble)))

(defun says-p (words outcome)
  "True if OUTCOME is a condition of ours that says WORDS."
  (and (typep outcome 'base:ars-magna-error)
       (search words (princ-to-string outcome) :test #'char-equal)
       t))

(test file.has-all-that-the-run-was
  (multiple-value-bind (journal digest) (recorded-ride)
    (with-temporary-file (file)
      (run:write-journal journal file)
      (let ((again (run:read-journal file)))
        (is (= (run:journal-length journal) (run:journal-length again)))
        (is (= digest (replay-outcome file)))
        (is (= digest (nth-value 1 (run:replay again))))
        (with-temporary-file (copy)
          (run:write-journal again copy)
          (is (equal (journal-lines file) (journal-lines copy))))))))

(test file.has-things-made-from-prototypes
  (with-temporary-file (file)
    (with-rover (:journal t)
      (let ((box (world:make-new-thing 'box nil '((:size 2) (:capacity 1)))))
        (world:make-new-thing 'lid box '((:size 0.5)))
        (world:make-new-thing 'chest (list world:*world* 3 3) '((:weight 2))
                              :prototype box :kickers '(jitter)))
      (run:run-ticks 20)
      (run:save-journal file)
      (is (eql (run:state-digest) (replay-outcome file))))))

(test data.come-back-as-they-were
  (dolist (datum (list '() '(t nil) 0 -7 (expt 3 500) 2/3 -1/1000 .1d0 -0d0 1d308 5d-324 1.5 -3.1e-9
                       1d23 most-positive-double-float least-positive-double-float
                       "" "a\"b\\c|d;e" (format nil "two~%lines~C~C" #\Return #\Nul)
                       (string (code-char #xD800)) (string (code-char #x10FFFF)) "Bär"
                       :key :|odd key| 'car '|a::b| '|| :t :nil '(:end) '((1 (2 (3)))) '|x y|))
    (let ((text (run::datum-text datum)))
      (is (null (find #\Newline text)))
      (multiple-value-bind (again end) (run::read-datum text)
        (is (= end (length text)))
        (is (equal datum again) "~S became ~S" datum again)))))

(test data.nobody-can-read-are-refused
  (let ((circle (list 1)) (deep '()))
    (setf (cdr circle) circle)
    (dotimes (i 100000) (setf deep (list deep)))
    (dolist (datum (list circle deep (expt 10 100000) (list 'a (lambda ())) '(1 . 2)
                         (make-array 3) sb-ext:double-float-positive-infinity))
      (is (not (null (run::unprintable-in datum)))))))

(test references.tell-data-from-names
  "Lists that look like references, dotted ones, and what has no end."
  (with-rover (:journal t)
    (let ((circle (list 1)) (crate (world:find-thing 'crate)))
      (setf (cdr circle) circle)
      (dolist (datum (list '(:the best) '(:the) '(a :the robot) '(1 . 2) (cons :slot rover)
                           (list* :the 1 crate) (list (robot:robot-hand rover 1) "x" crate)
                           '(:the :list :the)))
        (is (equal datum (run:internalize (run:externalize datum) time:*simulation*))))
      (is (eq circle (run:internalize (run:externalize circle) time:*simulation*))))))

;;; Damage.

(defun recorded-lines (file)
  "Write the journal of RIDE-ABOUT to FILE. Return its lines and the digest."
  (multiple-value-bind (journal digest) (recorded-ride)
    (run:write-journal journal file)
    (values (journal-lines file) digest)))

(defun damaged-text (text dice)
  "Return TEXT with some damage that DICE choose."
  (let ((i (base:roll-index (length text) dice)) (j (base:roll-index (length text) dice))
        (char (base:roll-element (list #\Nul #\( #\) #\" #\| #\; #\\ #\# #\: #\0 #\9 #\a #\Space
                                       #\Newline #\Return (code-char #xFEFF) (code-char #x10FFFF))
                                 dice)))
    (ecase (base:roll-index 5 dice)
      (0 (subseq text 0 i))
      (1 (concatenate 'string (subseq text 0 i) (subseq text (1+ i))))
      (2 (concatenate 'string (subseq text 0 i) (string char) (subseq text i)))
      (3 (concatenate 'string (subseq text 0 i) (string char) (subseq text (1+ i))))
      (4 (concatenate 'string (subseq text 0 (min i j)) (subseq text (max i j)))))))

(test damage.is-found-and-named
  "500 damages: each is found, or did no harm."
  (with-temporary-file (file)
    (multiple-value-bind (lines digest) (recorded-lines file)
      (let ((text (format nil "~{~A~%~}" lines)) (dice (base:make-dice 77)) (found 0))
        (dotimes (i 500)
          (write-text (damaged-text text dice) file)
          (let ((outcome (replay-outcome file)))
            (if (typep outcome 'run:damaged-journal)
                (incf found)
                (is (eql digest outcome) "damage ~D: ~A" i outcome))))
        (is (< 400 found))))))

(test damage.of-bytes-is-found
  (with-temporary-file (file)
    (multiple-value-bind (lines digest) (recorded-lines file)
      (declare (ignore lines))
      (let ((bytes (alexandria:read-file-into-byte-vector file)) (dice (base:make-dice 78)))
        (dotimes (i 200)
          (let ((copy (copy-seq bytes)))
            (setf (aref copy (base:roll-index (length copy) dice)) (base:roll-index 256 dice))
            (alexandria:write-byte-vector-into-file copy file :if-exists :supersede))
          (let ((outcome (replay-outcome file)))
            (is (or (typep outcome 'run:damaged-journal) (eql digest outcome))
                "damage ~D: ~A" i outcome)))))))

(test damage.of-lines-names-the-entry
  (with-temporary-file (file)
    (let* ((lines (recorded-lines file)) (third (nth 4 lines)) (fourth (nth 5 lines)))
      (flet ((says-entry-3-p (lines)
               (write-lines lines file)
               (says-p "entry 3 is damaged" (replay-outcome file))))
        (is-true (says-entry-3-p (remove third lines)))
        (is-true (says-entry-3-p (append (subseq lines 0 4) (list fourth third) (nthcdr 6 lines))))
        (is-true (says-entry-3-p (append (subseq lines 0 4) (list fourth) (nthcdr 5 lines))))
        (is-true (says-entry-3-p (append (subseq lines 0 4) (list (subseq third 0 9)))))
        (is-true (says-p "end of the file is missing"
                         (progn (write-lines (butlast lines) file) (replay-outcome file))))
        (is-true (says-p "head is damaged"
                         (progn (write-lines (cons (format nil "(ars-magna-journal 2 (map")
                                                   (rest lines))
                                             file)
                                (replay-outcome file))))))))

(test line-ends.may-be-those-of-others
  "Carriage returns, a byte order mark, no newline at the end, comments and empty lines."
  (with-temporary-file (file)
    (multiple-value-bind (lines digest) (recorded-lines file)
      (dolist (text (list (format nil "~{~A~C~%~}" (loop for line in lines
                                                         collect line collect #\Return))
                          (format nil "~C~{~A~%~}" (code-char #xFEFF) lines)
                          (format nil "~{~A~^~%~}" lines)
                          (format nil "~{~A~%; Mine.~%~%~}" lines)))
        (write-text text file)
        (is (eql digest (replay-outcome file)))))))

(test files.that-are-none
  (with-temporary-file (file)
    (loop for (text words) in `(("" "begin like a journal") ("hello" "begin like a journal")
                                (,(make-string 3 :initial-element #\Nul) "begin like a journal")
                                (,(make-string 2000000 :initial-element #\() "begin like a journal")
                                ("; nothing" "begin like a journal")
                                ("(:ARS-MAGNA-JOURNAL 1 (:MAP \"A\"))" "repeat the run")
                                ("(ars-magna-journal 3 ())" "head is damaged"))
          do (write-text text file)
             (is-true (says-p words (replay-outcome file)) "~A" words))
    (is-true (says-p "directory" (replay-outcome (uiop:temporary-directory))))
    (is-true (says-p "no such file" (replay-outcome "/no-such-directory/journal")))
    (is-true (says-p "usable" (replay-outcome "/tmp/*.journal")))))

(test until.is-a-tick-of-the-journal
  (let ((journal (recorded-ride)))
    (dolist (until '(-1 101 1.5 "x" :end (1)))
      (signals base:wrong-argument (run:replay journal :until until)))
    (dolist (until '(0 1 50 100))
      (is (= until (run:with-replay (journal :until until) (run:simulation-tick)))))))

;;; What reading leaves behind.

(defun count-symbols ()
  (let ((count 0))
    (dolist (package (list-all-packages) count)
      (do-symbols (symbol package)
        (when (eq package (symbol-package symbol)) (incf count))))))

(test reading.interns-nothing
  (with-temporary-file (file)
    (write-forged file "(1 grab (|NO-SUCH-PACKAGE::X| |ARS-MAGNA.TESTS::no such name| no-such-key))"
                  "(1 no-such-operator)")
    (let ((before (count-symbols)) (packages (length (list-all-packages))))
      (is (typep (replay-outcome file) 'run:damaged-journal))
      (write-forged file "(1 grab (|NO-SUCH-PACKAGE::X| |ARS-MAGNA.TESTS::no such name| no-such))")
      (is (integerp (replay-outcome file)))
      (is (= before (count-symbols)))
      (is (= packages (length (list-all-packages)))))))

(test reading.executes-nothing
  (with-temporary-file (file)
    (with-temporary-file (witness)
      (delete-file witness)
      (let ((command (format nil "touch ~A" (uiop:native-namestring witness))))
        (dolist (entry (list (format nil "(1 :world uiop/run-program:run-program ~S)" command)
                             (format nil "(1 |UIOP/RUN-PROGRAM::RUN-PROGRAM| ~S)" command)
                             (format nil "(1 grab #.(uiop:run-program ~S))" command)
                             (format nil "(1 call-put-kicker (the thing 1) k body ~
                                          |UIOP/RUN-PROGRAM::RUN-PROGRAM|)")))
          (write-forged file entry)
          (is (typep (replay-outcome file) 'base:ars-magna-error))
          (is-false (probe-file witness)))))))

;;; Writing.

(test writing.that-fails-leaves-what-was-there
  (with-temporary-file (file)
    (let* ((lines (recorded-lines file))
           (others (directory (merge-pathnames "ars-magna*.*" file))))
      (with-rover (:journal t)
        (time:schedule (rover) 7)
        (run:run-ticks 2)
        (signals base:misuse (run:save-journal file)))
      (with-rover (:journal t)
        (run:set-seed (expt 10 1000000))
        (signals base:misuse (run:save-journal file)))
      (with-rover (:journal t)
        (dotimes (i 2)
          (time:grab-resource (make-string (* 300000 (1+ i)) :initial-element #\Nul)))
        (run:run-ticks 1)
        (signals base:misuse (run:save-journal file)))
      (is (equal lines (journal-lines file)))
      (is (equal others (directory (merge-pathnames "ars-magna*.*" file)))))))

(test writing.needs-a-place-for-a-file
  (with-rover (:journal t)
    (signals base:misuse (run:save-journal "/no-such-directory/journal"))
    (signals base:misuse (run:save-journal (uiop:temporary-directory)))
    (with-temporary-file (file)
      (uiop:with-current-directory ((uiop:pathname-directory-pathname file))
        (is (equal (truename file) (run:save-journal (file-namestring file))))))))

(test limit.ends-the-journal-and-not-the-run
  (with-temporary-file (file)
    (let ((run:*journal-limit* 3) digest)
      (with-rover (:journal t)
        (dotimes (i 10)
          (when (= 3 (run:simulation-tick)) (setf digest (run:state-digest)))
          (run:set-seed i)
          (run:run-ticks 1))
        (run:save-journal file)
        (is (= 10 (run:simulation-tick)))
        (is (= 1 (count :warning (base:take-messages) :key #'base:message-kind))))
      (let ((journal (run:load-journal file)))
        (is (= 3 (run:journal-length journal) (run:journal-end journal)))
        (is (= digest (nth-value 1 (run:replay journal))))))))

(test no-journal.says-how-to-get-one
  (with-rover ()
    (handler-case (progn (run:save-journal "/no-such-directory/x") (fail "There was one."))
      (base:misuse (trouble) (is-true (says-p ":journal t" trouble))))))

(test journals.that-are-none-are-refused-by-who-was-called
  "Not by a function that nobody called."
  (loop for (name call) in `((replay ,(lambda () (run:replay 7)))
                             (with-replay ,(lambda () (run:with-replay (7) t)))
                             (load-journal ,(lambda () (run:load-journal 7)))
                             (journal-moments ,(lambda () (display:journal-moments 7)))
                             (save-animation
                              ,(lambda () (display:save-animation 7 "/tmp/none.html"))))
        do (handler-case (progn (funcall call) (fail "~A" name))
             (base:wrong-argument (trouble)
               (is-true (search (string-downcase name) (text-of trouble)) "~A" name)))))
