;;;; command-entries.lisp -- entries of commands, of their error codes, and of the prompt's lines.

(in-package :ars-magna.manual)

(defun in-code (name)
  (format nil "`~(~A~)`" name))

(defun heading-of (keyword)
  "Return KEYWORD as the words of a heading."
  (let ((words (substitute #\Space #\- (string-downcase keyword))))
    (string-upcase words :end 1)))

;;; Commands.

(defun argument-facts (specifications)
  (loop for spec in specifications
        collect (list (string-downcase (spec-name spec))
                      (format nil "~A~@[; ~A~]" (argument-type-text (spec-type spec))
                              (and (string/= "" (spec-text spec)) (spec-text spec))))))

(defun result-fact (command)
  (list "Continuation gets"
        (format nil "an error code or NIL; the ~(~A~)~{; ~A~}"
                (spec-name (command-resource command))
                (mapcar #'spec-text (command-results command)))))

(defun error-fact (command)
  (list "Error codes"
        (format nil "~{~A, ~}~A"
                (loop for code in (command-errors command)
                      collect (in-code (format nil ":~A" (error-code-keyword code))))
                (in-code ":interrupt"))))

(defun plan-function-of (command)
  (multiple-value-bind (symbol status)
      (find-symbol (format nil "RPL-~A" (command-name command)) :nisp)
    (and (eq :external status) symbol)))

(defun elsewhere-facts (command)
  (append (list (list "At the prompt" (in-code (command-prompt-name command))))
          (when (plan-function-of command)
            (list (list "In plans" (in-code (plan-function-of command)))))
          (when (command-section command)
            (list (list "Cited" (format nil "Manual ~A" (command-section command)))))))

(defun command-entry (command)
  (make-entry :name (string-downcase (command-name command)) :chapter :commands
              :section (heading-of (command-family command)) :symbol (command-name command)
              :use (format nil "(~(~A ~A~{ ~A~}~) [continuation])" (command-name command)
                           (spec-name (command-resource command))
                           (mapcar #'spec-name (command-parameters command)))
              :facts (append (argument-facts (cons (command-resource command)
                                                   (command-parameters command)))
                             (list (result-fact command) (error-fact command))
                             (elsewhere-facts command))
              :text (format nil "~A It takes effect in the next tick and returns nothing."
                            (command-documentation command))
              :file (file-of-symbol (command-name command))))

(defun own-commands ()
  "Return the commands that users see, and not those that only this Lisp has."
  (remove-if-not (lambda (command) (packages-showing (command-name command))) (all-commands)))

(defun command-entries () (mapcar #'command-entry (own-commands)))

;;; Error codes.

(defun commands-failing-with (keyword commands)
  (remove-if-not (lambda (command)
                   (find keyword (command-errors command) :key #'error-code-keyword))
                 commands))

(defun messages-of (keyword commands)
  (remove-duplicates
   (loop for command in commands
         for text = (error-code-text (find keyword (command-errors command)
                                           :key #'error-code-keyword))
         when (stringp text) collect text)
   :test #'string=))

(defun error-entry (keyword commands)
  (let* ((failing (commands-failing-with keyword commands))
         (messages (messages-of keyword failing)))
    (make-entry :name (format nil "~(~S~)" keyword) :chapter :error-codes
                :use (format nil "~(~S~)" keyword)
                :facts `(,@(when messages
                             (list (list "Message" (format nil "~{~A~^; ~}." messages))))
                         ("Told by" ,(format nil "~{~A~^, ~}"
                                             (mapcar (lambda (command)
                                                       (in-code (command-name command)))
                                                     failing))))
                :text (format nil "~@[~A ~]~@[~A ~]The continuation of a command gets it as its ~
                                   first argument."
                              (error-code-meaning keyword) (error-code-remedy keyword)))))

(defun interrupt-entry ()
  (make-entry :name ":interrupt" :chapter :error-codes :use ":interrupt"
              :facts '(("Told by" "every command"))
              :text "What the continuation of a command gets that was under way when a newer one
took its robot, camera, hand or bin over, or the run ended (manual 3.1.1)."))

(defun error-entries ()
  (let* ((commands (own-commands))
         (keywords (remove-duplicates (loop for command in commands
                                            append (mapcar #'error-code-keyword
                                                           (command-errors command))))))
    (cons (interrupt-entry)
          (mapcar (lambda (keyword) (error-entry keyword commands))
                  (sort keywords #'string<)))))

;;; The prompt's lines.

(defun line-entry (line)
  (make-entry :name (string-downcase (line-name line)) :chapter :prompt
              :section (heading-of (line-family line)) :use (usage line)
              :facts (append (when (line-full-name line)
                               (list (list "Stands for"
                                           (in-code (line-full-name line)))))
                             (mapcar (lambda (slot) (list "" (slot-help slot)))
                                     (line-parameters line))
                             (mapcar (lambda (detail) (list "" detail)) (line-details line)))
              :text (line-sentence line)
              :file (project-name (function-file (line-action line)))))

(defun own-lines ()
  "Return the prompt's lines, but for those of commands that only this Lisp has."
  (let ((others (mapcar #'command-prompt-name (set-difference (all-commands) (own-commands)))))
    (remove-if (lambda (line) (member (line-name line) others :test #'string-equal))
               (all-lines))))

(defun line-entries () (mapcar #'line-entry (own-lines)))
