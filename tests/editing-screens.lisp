;;;; editing-screens.lisp -- what a terminal shows while a line is typed.

(in-package :ars-magna.tests)

(def-suite* editing-screens :in ars-magna)

;;; A simulated terminal that understands only the control codes we use. It has as many rows as it
;;; needs.

(defstruct (paper (:constructor make-paper (columns)) (:copier nil))
  "A terminal of COLUMNS. ROWS are strings; FULL-P is true when the last column has been written."
  columns (rows (make-array 1 :adjustable t :fill-pointer t :initial-element ""))
  (row 0) (column 0) (full-p nil))

(defun go-to-row (paper row)
  (setf (paper-row paper) row
        (paper-full-p paper) nil)
  (loop while (<= (length (paper-rows paper)) row) do (vector-push-extend "" (paper-rows paper))))

(defun begin-next-row (paper)
  (go-to-row paper (1+ (paper-row paper)))
  (setf (paper-column paper) 0))

(defun write-on-paper (paper char)
  (when (paper-full-p paper) (begin-next-row paper))
  (symbol-macrolet ((text (aref (paper-rows paper) (paper-row paper))))
    (let ((column (paper-column paper)))
      (setf text (format nil "~VA~C~A" column (subseq text 0 (min column (length text))) char
                         (subseq text (min (1+ column) (length text)))))
      (if (= (1+ column) (paper-columns paper))
          (setf (paper-full-p paper) t)
          (incf (paper-column paper))))))

(defun clear-paper-below (paper)
  (with-accessors ((rows paper-rows) (row paper-row) (column paper-column)) paper
    (setf (fill-pointer rows) (1+ row)
          (aref rows row) (subseq (aref rows row) 0 (min column (length (aref rows row)))))))

(defun obey (paper code)
  "Do what CODE, after escape and [, tells a terminal."
  (let ((count (parse-integer code :junk-allowed t)))
    (setf (paper-full-p paper) nil)
    (cond ((begins-with-p "?2004" code))
          (t (ecase (char code (1- (length code)))
               (#\A (go-to-row paper (max 0 (- (paper-row paper) count))))
               (#\C (setf (paper-column paper)
                          (min (1- (paper-columns paper)) (+ (paper-column paper) count))))
               (#\J (clear-paper-below paper)))))))

(defun print-on-paper (paper text)
  "Let PAPER get TEXT, with codes that terminals obey."
  (loop with position = 0
        while (< position (length text))
        do (let ((char (char text position)))
             (incf position)
             (case char
               (#\Return (setf (paper-column paper) 0
                               (paper-full-p paper) nil))
               (#\Newline (begin-next-row paper))
               (#\Escape (let ((end (position-if #'alpha-char-p text :start position)))
                           (obey paper (subseq text (1+ position) (1+ end)))
                           (setf position (1+ end))))
               (t (write-on-paper paper char))))))

(defun paper-lines (paper)
  (map 'list #'without-blanks-after (paper-rows paper)))

;;; What it is to show: all that was written, then the line.

(defun rows-in (text columns)
  "Return TEXT as rows of COLUMNS, as its reader breaks it."
  (loop for line in (uiop:split-string text :separator '(#\Newline))
        append (loop for start from 0 to (max 0 (1- (length line))) by columns
                     collect (without-blanks-after
                              (subseq line start (min (length line) (+ start columns)))))))

(defun ends-in-full-row-p (text columns)
  (let ((last (first (last (uiop:split-string text :separator '(#\Newline))))))
    (and (string/= "" last) (zerop (mod (length last) columns)))))

(defun expected-rows (written line columns)
  "Return what a terminal shows after WRITTEN while LINE, a drawn-line, is typed."
  (let ((text (concatenate 'string (cli::drawn-line-label line) (cli::drawn-line-text line))))
    (append (if (or (string= "" written) (ends-with-p (string #\Newline) written))
                (butlast (rows-in written columns))
                (rows-in written columns))
            (rows-in text columns)
            (when (ends-in-full-row-p text columns) '("")))))

(defun random-key (dice)
  (let ((keys '("turn 1" "a" " " "(list \"x\" 2)" :left :right :home :end :rubout :delete
                :word-left #\K #\U #\W #\Y :up :down #\R #\G)))
    (base:roll-element keys dice)))

(test screen.shows-what-was-written-and-below-it-the-line
  "Whatever is typed, and whatever arrives meanwhile."
  (loop for seed below 20
        do (let* ((dice (base:make-dice seed))
                  (columns (+ 9 (base:roll-index 20 dice)))
                  (paper (make-paper columns))
                  (written "")
                  (keys (append (loop repeat 60 collect (random-key dice)) '(#\G)))
                  (wrong nil))
             (multiple-value-bind (console out) (terminal-console columns 1000)
               (labels ((look ()
                          (print-on-paper paper (get-output-stream-string out))
                          (let ((rows (expected-rows written (cli::console-line console)
                                                     columns)))
                            (unless (equal rows (paper-lines paper))
                              (setf wrong (list rows (paper-lines paper))))))
                        (arrive (text)
                          (setf written (concatenate 'string written text))
                          (write-string text console)
                          (finish-output console))
                        (before-key ()
                          (look)
                          (case (base:roll-index 6 dice)
                            (0 (arrive (format nil "Robot turned~%")))
                            (1 (arrive "part ")))
                          (look)))
                 (cli::show-prompt console "Robot> ")
                 (read-line (typed-text-for (keyboard-for keys :before #'before-key) console) nil)
                 (is (null wrong) "Seed ~D: ~S" seed wrong))))))

(defun shown-while-typing (columns rows function &rest keys)
  "Return what a terminal of COLUMNS and ROWS shows after FUNCTION, of a console, is called when
KEYS have been pressed at Robot>."
  (let ((paper (make-paper columns)) (left (length (mapcan #'octets-of-key keys))))
    (multiple-value-bind (console out) (terminal-console columns rows)
      (flet ((before-key ()
               (when (minusp (decf left))
                 (funcall function console)
                 (print-on-paper paper (get-output-stream-string out)))))
        (cli::show-prompt console "Robot> ")
        (read-line (typed-text-for (keyboard-for keys :before #'before-key) console) nil)))
    (paper-lines paper)))

(defun tell-all (&rest kinds-and-texts)
  "Return a function that shows messages on a console."
  (lambda (console)
    (cli::write-messages (loop for (kind text) on kinds-and-texts by #'cddr
                               collect (definitions::make-message kind (list text)))
                         (cli::%make-session :console console))
    (finish-output console)))

(test screen.has-messages-above-what-is-typed
  (is (equal '("robot-turn: Robot turned" "Robot> go 5")
             (shown-while-typing 40 24 (tell-all :message "robot-turn: Robot turned") "go 5")))
  (is (equal '("*WARNING* -> hot" "Robot> go 5")
             (shown-while-typing 40 24 (tell-all :warning "hot") "go 5"))))

(test screen.has-messages-after-a-prompt-where-nothing-is-typed
  "As in the session of manual E."
  (is (equal '("Robot> robot-turn: Robot turned" "two" "Robot>")
             (shown-while-typing 40 24 (tell-all :message "robot-turn: Robot turned"
                                                 :message "two"))))
  (is (equal '("*WARNING* -> hot" "Robot>") (shown-while-typing 40 24 (tell-all :warning "hot")))))

(test screen.breaks-messages-between-words
  (is (equal '("Robot> The robot" "has turned a little" "  and a little more" "Robot>")
             (shown-while-typing 20 24 (tell-all :message (format nil "The robot has turned a ~
                                                                       little~%  and a little ~
                                                                       more")))))
  (is (equal '("aVeryLongWordThatIsN" "otBroken" "aa bb" "Robot> x")
             (shown-while-typing 20 24 (tell-all :message "aVeryLongWordThatIsNotBroken aa bb")
                                 "x"))))

(test screen.breaks-no-tables
  (is (equal "one two three  four" (cli::text-broken-at-blanks "one two three  four" 10)))
  (is (equal (format nil "  one two~%  three") (cli::text-broken-at-blanks "  one two three" 10)))
  (is (equal (format nil "~%one~%~%two three")
             (cli::text-broken-at-blanks (format nil "~%one~%~%two three")
                                                                10))))

(test screen.has-another-prompt-without-losing-what-is-typed
  (is (equal '("Break> tu")
             (shown-while-typing 40 24 (lambda (console) (cli::show-prompt console "Break> "))
                                 "tu"))))

(test screen.loses-no-half-of-a-line-that-comes-before-the-first-key
  "However it comes in between the prompt and what begins to read: another thread writes it."
  (dolist (finish-p '(nil t))
    (let ((paper (make-paper 40)))
      (multiple-value-bind (console out) (terminal-console 40 24)
        (setf (cli::console-edited-p console) t)
        (cli::show-prompt console "Robot> ")
        (write-string "on" console)
        (when finish-p (finish-output console))
        (cli::begin-typed-line console)
        (terpri console)
        (finish-output console)
        (print-on-paper paper (get-output-stream-string out)))
      (is (equal '("on" "Robot>") (paper-lines paper))))))

(test screen.shows-the-rows-around-the-cursor-of-what-is-too-long
  (let ((lines (apply #'shown-while-typing 40 5 (constantly nil)
                      (list :paste (format nil "~{~A~%~}" (loop for i below 20 collect i))
                            :pasted))))
    (is (equal '("15" "16" "17" "18" "19") (last lines 5))))
  (is (equal '("Robot> 0" "1" "2" "3" "4")
             (last (shown-while-typing
                    40 5 (constantly nil)
                    :paste (format nil "~{~A~%~}" (loop for i below 9 collect i)) :pasted
                    :up :up :up :up :up :up :up)
                   5))))

(test screen.shows-what-would-be-obeyed
  (is (equal '("Robot> a^Gb c")
             (shown-while-typing 40 24 (constantly nil)
                                 :paste (format nil "a~Cb~Cc" (code-char 7) #\Tab) :pasted))))

(test screen.counts-columns-as-they-are-seen
  (is (= 4 (cli::text-columns "漢字")))
  (is (= 1 (cli::text-columns (format nil "e~C" (code-char #x301)))))
  (multiple-value-bind (rows row column) (cli::break-into-rows "" "a漢字b" 4 4)
    (is (equal '(("a漢" :newline) ("字b" nil)) rows))
    (is (equal '(1 3) (list row column)))))

(test screen.counts-no-colours
  "A prompt may have some; what is typed shows that it has."
  (let ((red (format nil "~C[31mRobot> ~:*~C[0m" #\Escape)))
    (is (= 7 (cli::text-columns red)))
    (is (equal '(0 7) (rest (multiple-value-list (cli::break-into-rows red "" 0 20)))))
    (is (equal (list (list (format nil "~Ax^[[1m" red) nil))
               (cli::break-into-rows red (format nil "x~C[1m" #\Escape) 0 20)))
    (is (equal (format nil "~Aone~%two" red)
               (cli::text-broken-at-blanks (format nil "~Aone two" red) 10)))))

(test screen.shows-the-line-again-after-output-that-is-not-flushed
  "As of a user's own thread: the thread that reads the line looks after it."
  (multiple-value-bind (console out) (terminal-console 40)
    (let ((paper (make-paper 40)))
      (setf (cli::console-edited-p console) t)
      (cli::show-prompt console "Robot> ")
      (base:join-thread (base:start-thread (lambda () (format console "Turned.~%")) "printer"))
      (cli::redraw-if-outdated console)
      (print-on-paper paper (get-output-stream-string out))
      (is (equal '("Turned." "Robot>") (paper-lines paper)))
      (cli::redraw-if-outdated console)
      (is (equal "" (get-output-stream-string out))))))

(test screen.breaks-what-follows-a-label
  "As in STATUS; a table is left as it is."
  (is (equal (format nil "Time:     Tick 0,~%idle, else")
             (cli::text-broken-at-blanks "Time:     Tick 0, idle, else" 18)))
  (is (equal "a: one  two  three four" (cli::text-broken-at-blanks "a: one  two  three four" 12))))

(test screen.of-no-terminal-is-as-it-was-written
  "Nothing is broken, or moved, where nobody edits lines."
  (let* ((out (make-string-output-stream))
         (console (cli::make-console out))
         (text (format nil "~{~A~^ ~}" (loop for i below 100 collect i))))
    (cli::show-prompt console "Robot> ")
    (funcall (tell-all :message text) console)
    (is (string= (format nil "Robot> ~A~%" text) (get-output-stream-string out)))))
