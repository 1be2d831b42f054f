;;;; editing-history.lisp -- the history of typed lines, in a session and in files.

(in-package :ars-magna.tests)

(in-suite editing)

;;; The history.

(test history.goes-back-and-on
  (types-p ("one" "two" "one") "one" :enter "two" :enter :up :up :enter)
  (types-p ("one" "two" "two") "one" :enter "two" :enter :up :up :down :enter)
  (types-p ("one" "draft") "one" :enter "draft" :up :down :enter)
  (types-p ("one" "onetwo" "onetwo") "one" :enter #\P "two" :enter :up :enter)
  (types-p ("one" "one") "one" :enter :up :up :up :enter))

(test history.has-no-blanks-and-nothing-twice-in-a-row
  (types-p ("one" "two" "two" "  " "" "one")
           "one" :enter "two" :enter "two" :enter "  " :enter :enter :up :up :enter))

(test history.is-searched
  (types-p ("turn 1" "go 5" "turn 1") "turn 1" :enter "go 5" :enter #\R "tur" :enter)
  (types-p ("turn 1" "turn 2" "turn 1") "turn 1" :enter "turn 2" :enter #\R "turn" #\R :enter)
  (types-p ("turn 1" "x turn 1") "turn 1" :enter #\R "1" #\A "x " :enter)
  (types-p ("turn 1" "draft") "turn 1" :enter "draft" #\R "turn" #\G :enter)
  (types-p ("turn 1" "draft" "turn 1")
           "turn 1" :enter "draft" #\R "zz" :enter #\R "tuq" :rubout :enter))

(test history.brings-back-forms-of-several-lines
  (let ((stream (typed-text-for (keyboard-for '("(list 1" :enter "2)" :enter :up :enter :up :up :end
                                                " ; x" :enter))
                                (terminal-console))))
    (flet ((take (before)
             (let ((line (read-line stream)))
               (cli::add-to-history stream line before)
               line)))
      (is (equal "(list 1" (take nil)))
      (is (equal "2)" (take "(list 1")))
      (is (equal "(list 1" (take nil)))
      (is (equal "2)" (take "(list 1")))
      (is (equal "(list 1 ; x" (take nil)))
      (is (equal "2)" (take "(list 1 ; x"))))
    (is (equal (list (format nil "(list 1 ; x~%2)") (format nil "(list 1~%2)"))
               (cli::history-entries (cli::edited-history stream))))))

(defmacro with-history-file ((file) &body body)
  `(uiop:with-temporary-file (:pathname ,file) ,@body))

(defun type-into-history (file &rest entries)
  (let ((history (cli::make-history file)))
    (dolist (entry entries) (cli::add-entry history entry))
    (cli::save-newest-entry history)))

(test history.is-not-added-to-where-it-is-write-protected
  (with-history-file (file)
    (type-into-history file "go")
    (sb-posix:chmod file #o444)
    (type-into-history file "turn 1")
    (is (equal '("go") (cli::history-entries (cli::make-history file))))))

(test history.is-there-in-the-next-session
  (with-history-file (file)
    (let ((entries (list "turn 1" (format nil "(list 1~%  \"a\\nb\")") "größer" "\\")))
      (apply #'type-into-history file entries)
      (is (equal (reverse entries) (cli::history-entries (cli::make-history file))))
      (type-into-history file "go")
      (is (equal (cons "go" (reverse entries))
                 (cli::history-entries (cli::make-history file)))))))

(test history.keeps-forms-of-many-lines
  "Neither the stack nor the memory that it takes grows out of proportion."
  (with-history-file (file)
    (let ((history (cli::make-history file)) (text (cli::extensible-text "(list")))
      (cli::add-entry history "(list")
      (is (> 100000000 (bytes-consed-by (lambda ()
                                          (dotimes (i 20000)
                                            (cli::extend-newest-entry history "a line" text)
                                            (cli::extend-text text "a line")))
                                        1)))
      (cli::save-newest-entry history)
      (is (equal (list text) (cli::history-entries (cli::make-history file)))))))

(test history.is-kept-before-the-next-line-is-typed
  (with-history-file (file)
    (let ((stream (make-instance 'cli::edited-text :octets (make-concatenated-stream)
                                                   :console (terminal-console)
                                                   :history (cli::make-history file))))
      (cli::add-to-history stream "go" nil)
      (is (null (cli::history-entries (cli::make-history file))) "it may go on")
      (cli::save-history stream)
      (is (equal '("go") (cli::history-entries (cli::make-history file)))))))

(test history.of-two-sessions-at-once-is-that-of-both
  (with-history-file (file)
    (let ((one (cli::make-history file)) (two (cli::make-history file)))
      (cli::add-entry one "a")
      (cli::add-entry two "b")
      (mapc #'cli::save-newest-entry (list one two))
      (is (equal '("b" "a") (cli::history-entries (cli::make-history file)))))))

(test history.does-without-a-file-that-cannot-be-used
  (let ((history (cli::make-history #p"/no/such/directory/history")))
    (cli::add-entry history "a")
    (finishes (cli::save-newest-entry history))
    (is (equal '("a") (cli::history-entries history)))))

(test history.does-not-grow-for-ever
  (with-history-file (file)
    (let ((cli::*history-limit* 10))
      (apply #'type-into-history file (loop for i below 30 collect (format nil "turn ~D" i)))
      (is (= 10 (length (cli::history-entries (cli::make-history file)))))
      (is (= 10 (length (lines-of (base:file-text file)))))
      (is (equal "turn 29" (first (cli::history-entries (cli::make-history file))))))))
