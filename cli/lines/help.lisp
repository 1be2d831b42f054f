;;;; help.lisp -- HELP, APROPOS and the menus: descriptions of lines, from their definitions.

(in-package :ars-magna.cli)

(defparameter *line-families*
  '((:general . "The prompt") (:seeing . "The robot and its world") (:planning . "Plans")
    (:running . "Running")
    (:moving . "Moving and turning") (:manipulating . "Manipulating"))
  "The families of the main menu, with their titles.")

(defun write-menu (lines)
  (dolist (line lines)
    (write-filled (first-clause (line-sentence line)) 27
                  (format nil "  ~A" (line-command-usage line)))))

(defun other-testbeds-line-p (line)
  "True if LINE is a command of a testbed in which the robot of the prompt does not play."
  (let* ((command (find-command (line-name line) nil))
         (home (and command (symbol-package (command-name command)))))
    (and home
         (find-if (lambda (testbed)
                    (and (eq home (symbol-package (testbed-name testbed)))
                         (not (member *prompt-robot* (testbed-robots testbed)))))
                  (all-testbeds)))))

(defun lines-in-family (family)
  (remove-if #'other-testbeds-line-p
             (remove family (all-line-commands) :key #'line-family :test-not #'eq)))

(defun write-main-menu ()
  (loop for (family . title) in *line-families*
        for lines = (lines-in-family family)
        do (when lines
             (format t "~A~%" title)
             (write-menu lines)))
  (terpri)
  (write-filled "MENU-CAMERA, MENU-HAND and MENU-BIN list the commands of those parts, PLAN lists
the plans. HELP name describes a command, a plan, or anything else with a name; APROPOS word
searches. The beginning of a command's name is enough. A line in parentheses is Lisp. HELP KEYS
lists the keys that edit a line. Scroll up in your terminal for what has left the screen." 0))

(defun line-parameter-help (parameter)
  (let ((texts (list (line-parameter-text parameter) (parameter-description parameter))))
    (format nil "~A: ~{~A~^; ~}~:[~; (may be left out)~]." (line-parameter-name parameter)
            (remove "" (remove-duplicates texts :test #'string=) :test #'string=)
            (line-parameter-optional-p parameter))))

(defun write-help (line)
  (format t "~A~%" (line-command-usage line))
  (write-filled (line-sentence line) 2)
  (dolist (parameter (line-parameters line)) (write-filled (line-parameter-help parameter) 4))
  (dolist (detail (line-details line)) (write-filled detail 2)))

(defun write-help-about (name)
  (let ((line (find name (all-line-commands) :key #'line-name :test #'string-equal))
        (alias (assoc name *aliases* :test #'string-equal))
        (plan (find-plan-named name)))
    (cond (line (write-help line))
          (alias (format t "~{~A is an alias of ~A~}~%" alias))
          (plan (write-plan-help plan))
          (t (let ((topics (topics-named name)))
               (if topics
                   (mapc #'write-topic topics)
                   (write-help (find-line-for-help name))))))))

(defun find-line-for-help (name)
  "Return the line of the prompt whose name begins with NAME. Signals BAD-LINE if there is none."
  (handler-bind ((bad-line (lambda (condition)
                             (reject-line "~A APROPOS ~(~A~) searches all names."
                                          (bad-line-text condition) name))))
    (find-line-command name)))

(define-line "HELP" (session (name :topic "a command, a plan, or whatever has a name" :optional))
    (:general)
    "List the commands of the prompt and of the robot, or describe NAME: a command, plan, parameter,
place type, attribute, value, error code, name of Lisp ..."
  (if name (write-help-about name) (write-main-menu)))

(define-line "MENU-BIN" (session) (:general)
    "List the commands of storage bins."
  (write-menu (lines-in-family :storage-bin)))

(define-line "MENU-CAMERA" (session) (:general)
    "List the commands of cameras."
  (write-menu (lines-in-family :camera)))

(define-line "MENU-HAND" (session) (:general)
    "List the commands of hands."
  (write-menu (lines-in-family :hand)))

;;; Searching.

(defparameter *largest-topic-count* 40
  "The largest number of topics with the word only in their descriptions that APROPOS lists.")

(defun topics-matching (word)
  "Return two lists: topics with WORD in their names, and those with WORD only in descriptions."
  (flet ((in-p (text) (search word text :test #'char-equal)))
    (let ((topics (all-topics)))
      (values (remove-if-not (lambda (topic) (in-p (topic-name topic))) topics)
              (remove-if-not (lambda (topic)
                               (and (not (in-p (topic-name topic)))
                                    (in-p (topic-description topic))))
                             topics)))))

(defun write-topics (topics)
  (dolist (topic topics)
    (write-trimmed-line "~A" (cut (format nil "  ~24A ~13A ~A" (topic-name topic)
                                          (topic-title topic)
                                          (one-line (topic-description topic)))
                                  *text-width*))))

(define-line "APROPOS" (session (word :rest "a word, or a part of one"))
    (:general)
    "List everything with WORD in its name, then with WORD in its description: lines, plans,
parameters, place types, attributes, error codes, names of Lisp. HELP shows the whole description."
  (multiple-value-bind (named others) (topics-matching word)
    (let ((more (- (length others) *largest-topic-count*)))
      (unless (or named others) (reject-line "No name or description contains ~A." word))
      (write-topics named)
      (when others
        (format t "~:[In the description~;Also in the description~]:~%" named)
        (write-topics (subseq others 0 (min *largest-topic-count* (length others)))))
      (when (plusp more) (format t "  and ~D more.~%" more)))))
