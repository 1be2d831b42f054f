;;;; telling.lisp -- what goes wrong, as a line that any terminal can show.

(in-package :ars-magna.cli)

(export '(bad-line))

;;; Whoever makes a mistake may have typed a list without an end, an object that cannot be printed,
;;; or bytes that a terminal would obey.

(define-condition bad-line (ars-magna-error)
  ((text :initarg :text :reader bad-line-text))
  (:report (lambda (condition stream) (write-string (bad-line-text condition) stream)))
  (:documentation "A line typed at the prompt makes no sense."))

(defun reject-line (control &rest arguments)
  "Signal BAD-LINE with a text formatted from CONTROL and ARGUMENTS; it should name the remedy."
  (error 'bad-line :text (apply #'format-briefly nil control arguments)))

;;; Conditions.

(define-constant +unprintable+
    "What was to be said cannot be printed. Perhaps a method for PRINT-OBJECT fails."
  :test #'string=
  :documentation "What is said where not even an error can be.")

(defun ending-text (condition)
  "Return what CONDITION, which ends this process, says, if that can be printed."
  (if (string= "" (own-text condition)) +unprintable+ (condition-text condition)))

(defun condition-text (condition)
  "Return what CONDITION says, or what it is if it cannot say that."
  (if (typep condition 'lock-violation)
      (let ((symbol (locked-symbol condition)))
        (if symbol
            (format nil "~A is a name of ~A. Call yours otherwise, or begin with (shadow '~A)."
                    symbol (package-name (symbol-package symbol)) symbol)
            (format-briefly nil "~A" condition)))
      (text-of-condition condition)))

;;; Lines.

(defparameter *longest-complaint* 1000 "How many characters are shown of what goes wrong, at most.")

(defun complaint-text (text)
  "Return TEXT, of what goes wrong, on one line that is not too long."
  (visible (cut (one-line (cut text (* 3 *longest-complaint*))) *longest-complaint*)))
