;;;; telling.lisp -- what goes wrong, as a line that any terminal can show.

(in-package :ars-magna.cli)

;;; Whoever makes a mistake may have typed a list without an end, an object that cannot be printed,
;;; or bytes that a terminal would obey.

(defun format-briefly (destination control &rest arguments)
  "Do as FORMAT does. Of ARGUMENTS that are deep, long or circular, only a part is shown."
  (let ((*print-circle* t) (*print-length* 100) (*print-level* 20) (*print-pretty* nil))
    (apply #'format destination control arguments)))

(define-condition bad-line (ars-magna-error)
  ((text :initarg :text :reader bad-line-text))
  (:report (lambda (condition stream) (write-string (bad-line-text condition) stream)))
  (:documentation "A line typed at the prompt makes no sense."))

(defun reject-line (control &rest arguments)
  "Signal BAD-LINE with a text formatted from CONTROL and ARGUMENTS; it should name the remedy."
  (error 'bad-line :text (apply #'format-briefly nil control arguments)))

;;; Conditions.

(defun lock-text (condition)
  "Return what CONDITION, that a locked name was to be defined, means to a user."
  (let ((symbol (locked-symbol condition)))
    (if symbol
        (format nil "~A is a name of ~A. Call yours otherwise, or begin with (shadow '~A)."
                symbol (package-name (symbol-package symbol)) symbol)
        (format-briefly nil "~A" condition))))

(defun storage-text (condition)
  "Return what CONDITION, that there is no room for something, means to a user."
  (if (search "STACK" (string (type-of condition)))
      "The stack has overflowed: functions call each other too deeply, or lists stand too deeply ~
       in lists. Mend what has no end."
      "There is not enough memory for that. Ask for less at a time."))

(defun own-text (condition)
  (handler-case (format-briefly nil "~A" condition)
    ((or error storage-condition) () "")))

(defun condition-text (condition)
  "Return what CONDITION says, or what it is if it cannot say that."
  (let ((text (typecase condition
                (lock-violation (lock-text condition))
                (storage-condition (format nil (storage-text condition)))
                (t (own-text condition)))))
    (if (string= text "") (string-downcase (type-of condition)) text)))

;;; Lines.

(defun blank-p (char)
  (member char '(#\Space #\Tab #\Return #\Page #\Newline)))

(defun one-line (text)
  "Return TEXT with each run of blanks as one space."
  (string-trim " " (with-output-to-string (out)
                     (loop for previous = #\Space then char
                           for char across text
                           for blank = (blank-p char)
                           unless (and blank (blank-p previous))
                             do (write-char (if blank #\Space char) out)))))

(defun obeyed-p (char)
  "True if a terminal does something else with CHAR than to show it."
  (let ((code (char-code char)))
    (or (< code 32) (<= 127 code 159) (<= #x202A code #x202E) (<= #x2066 code #x2069))))

(defun visible (text)
  "Return TEXT with ^ and a letter, or a question mark, for each character that a terminal would
obey, but for newlines and tabs."
  (if (some #'obeyed-p text)
      (with-output-to-string (out)
        (loop for char across text
              do (cond ((or (not (obeyed-p char)) (find char '(#\Newline #\Tab)))
                        (write-char char out))
                       ((< (char-code char) 32)
                        (format out "^~C" (code-char (+ 64 (char-code char)))))
                       (t (write-char #\? out)))))
      text))

(defun cut (text length)
  "Return TEXT, or its beginning if it is longer than LENGTH."
  (if (> (length text) length)
      (concatenate 'string (subseq text 0 (- length 3)) "...")
      text))

(defparameter *longest-complaint* 1000 "How many characters are shown of what goes wrong, at most.")

(defun complaint-text (text)
  "Return TEXT, of what goes wrong, on one line that is not too long."
  (visible (cut (one-line (cut text (* 3 *longest-complaint*))) *longest-complaint*)))
