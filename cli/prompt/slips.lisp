;;;; slips.lisp -- what is typed as Lisp and is a line, or the other way round, and the like.

(in-package :ars-magna.cli)

;;; Functions that nobody has defined.

(defun advice-on-function (condition)
  "Return in a sentence what may be meant by the name that CONDITION says is of no function; NIL of
other conditions."
  (let ((name (and (typep condition 'undefined-function) (cell-error-name condition))))
    (when (and name (symbolp name))
      (or (plan-advice name)
          (line-advice (symbol-name name))
          (multiple-value-bind (symbol status) (find-symbol (symbol-name name) :ars-worlds)
            (and (eq :external status)
                 (fboundp symbol)
                 (format nil "There is ARS-WORLDS:~A." symbol)))))))

;;; Calls.

(defun check-typed-call (form)
  "Signal BAD-LINE if FORM, as typed, calls a function with another number of arguments than it
takes."
  (when (and (typep form '(cons symbol))
             (proper-list-p form)
             (fboundp (first form))
             (not (macro-function (first form)))
             (not (special-operator-p (first form))))
    (multiple-value-bind (parameters known-p) (function-arguments (first form))
      (let ((trouble (and known-p (misfit (shape-of parameters) (rest form)))))
        (when trouble
          (reject-line "~(~A~) takes ~A, not ~A.~@[ ~A~]" (first form)
                       (shape-text (lambda-list-of (first form))) trouble
                       (line-advice (symbol-name (first form)))))))))

;; Of Lisp's own that are called like lines, STEP and GO do nothing with a number. What is called
;; like no function is looked at before its arguments, such as DEG, are evaluated.
(defun check-line-in-parentheses (form)
  "Signal BAD-LINE if FORM, as typed, is a line in parentheses, such as (step 5) or (turn 90 deg)."
  (when (and (typep form '(cons symbol))
             (or (typep form '(cons (member step go) (or null (cons real))))
                 (not (fboundp (first form))))
             (line-called (symbol-name (first form))))
    (reject-line "~A" (line-advice (symbol-name (first form))))))

;;; New variables.

(defun starred-p (name)
  "True if the symbol NAME ends in a star, as special variables' do."
  (let ((place (position #\* (symbol-name name) :from-end t)))
    (and place (plusp place) (= place (1- (length (symbol-name name)))))))

(defun tell-of-new-variable (name)
  "Tell of the variable NAME, which something typed has set and nobody has defined, if it may be a
slip or is called as defined ones are."
  (let ((meant (variable-slip name)))
    (when (or meant (starred-p name))
      (warning-set (format nil "~(~A~) is a new variable, as nobody has defined it before.~@[ Did ~
                                you mean ~A?~] (defvar ~:*~:*~(~A~) ...) defines one."
                           name meant)))))

;;; A second command in a line.

(defun command-in-comment (text)
  "Return the comment in TEXT, a line of no Lisp, that begins right behind a word, as in
turn 1; go 3, with the name of a line command; or NIL."
  (let ((start (position #\; text)))
    (when (and start
               (plusp start)
               (not (find #\" text :end start))
               (not (blank-p (char text (1- start)))))
      (let ((comment (string-trim " ;" (subseq text start))))
        (and (string/= "" comment)
             (line-called (split-line comment))
             comment)))))

(defun tell-of-comment (text)
  (let ((comment (command-in-comment text)))
    (when comment
      (warning-set (format nil "What follows ; is a comment: ~A was left out. Type one command a ~
                                line."
                           comment)))))
