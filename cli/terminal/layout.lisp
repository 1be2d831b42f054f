;;;; layout.lisp -- how the prompt writes errors, numbers, values and running text.

(in-package :ars-magna.cli)

(export '(bad-line))

;;; An error message may have to show a list without an end, an object that cannot be printed, or
;;; bytes that a terminal would interpret.

(define-condition bad-line (ars-magna-error)
  ((text :initarg :text :reader bad-line-text))
  (:report (lambda (condition stream) (write-string (bad-line-text condition) stream)))
  (:documentation "A line typed at the prompt makes no sense."))

(defun reject-line (control &rest arguments)
  "Signal BAD-LINE with a text, from CONTROL and ARGUMENTS, that should name the remedy."
  (error 'bad-line :text (apply #'format-briefly nil control arguments)))

;;; Conditions.

(define-constant +unprintable+
    "The message cannot be printed. Perhaps a method for PRINT-OBJECT fails."
  :test #'string=
  :documentation "The message that replaces an error message which cannot be printed.")

(defun ending-condition-text (condition)
  "Return the message of CONDITION, which ends this process, or +UNPRINTABLE+."
  (if (string= "" (printable-report condition)) +unprintable+ (condition-text condition)))

(defun condition-text (condition)
  "Return the message of CONDITION, or its type if the message cannot be printed."
  (if (typep condition 'lock-violation)
      (let ((symbol (locked-symbol condition)))
        (if symbol
            (format nil "~A is a name of the package ~A. Choose another name, or begin with ~
                         (shadow '~A)."
                    symbol (package-name (symbol-package symbol)) symbol)
            (format-briefly nil "~A" condition)))
      (text-of-condition condition)))

;;; Lines.

(defparameter *longest-error-text* 1000
  "The largest number of characters of an error message to show.")

(defun short-error-text (text)
  "Return TEXT, an error message, on one line of at most *LONGEST-ERROR-TEXT* characters."
  (escape-controls (cut (one-line (cut text (* 3 *longest-error-text*))) *longest-error-text*)))

;;;; Values

;;; As in the session of manual E: positions and angles have two decimals, readings one; truth is
;;; Yes and No; symbols are capitalised; four attributes go on a line.

(defun plain-number-text (number)
  "Return NUMBER as text: an integer, or up to four decimals without zeros at the end."
  (if (= number (round number))
      (format nil "~D" (round number))
      (string-right-trim "0" (format nil "~,4F" number))))

(defun sensor-reading-text (number)
  (format nil "~,1F" number))

(defun value-text (value number-text)
  "Return an attribute's VALUE as text for STATUS and THINGS. NUMBER-TEXT formats numbers."
  (cond ((eq value t) "Yes")
        ((null value) "No")
        ((symbolp value) (string-capitalize value))
        ((realp value) (funcall number-text value))
        ((consp value) (format nil "(~{~A~^ ~})"
                               (loop for element in value
                                     collect (value-text element number-text))))
        (t (princ-to-string value))))

(defun write-descriptor (descriptor &optional (number-text #'sensor-reading-text))
  "Write DESCRIPTOR, a list of lists (attribute value), four attributes to a line."
  (loop for rest = descriptor then (nthcdr 4 rest)
        while rest
        do (format t "  ~{~{:~A ~A~}~^ ~}~%"
                   (loop for (key value) in rest repeat 4
                         collect (list key (value-text value number-text))))))

(defun designator-kind-text (designator)
  "Return text on the kind of DESIGNATOR, a property list from STATUS, such as Local Object."
  (format nil "~:(~A ~A~)" (getf designator :type) (getf designator :of)))

(defun designator-bearing-text (designator)
  "Return text on the distance and angle of DESIGNATOR, a property list from STATUS."
  (format nil "~,2F, ~,2F" (zero-if-tiny (getf designator :distance))
          (zero-if-tiny (getf designator :angle))))

(defun part-location-text (part)
  "Return a text that tells what PART is inside of, or NIL (manual E; reading 202)."
  (let ((location (part-location part)))
    (cond ((null location) nil)
          ((storage-bin-p location) "Located in storage-bin.")
          (t (format nil "Located in ~A." (location-name location))))))

(defun write-trimmed-line (control &rest arguments)
  (format t "~A~%" (string-right-trim " " (apply #'format nil control arguments))))

(defun rate-text (rate)
  (if (eq rate :free)
      "as fast as possible"
      (format nil "~A ticks a second" (plain-number-text rate))))

;;; Running text.

(defvar *text-width* 79 "The largest number of characters in a line of running text.")

(defun split-words (text)
  (remove "" (uiop:split-string (one-line text) :separator " ") :test #'string=))

(defun filled-lines (text width)
  (loop with line = ""
        for (word . more) on (split-words text)
        for longer = (if (string= line "") word (format nil "~A ~A" line word))
        if (<= (length longer) width)
          do (setf line longer)
        else
          collect (shiftf line word)
        unless more
          collect line))

(defun write-filled (text indent &optional (head ""))
  "Write TEXT in lines of at most *TEXT-WIDTH* characters, indented by INDENT columns. HEAD comes
before TEXT on the first line, or on a separate line if HEAD is too long."
  (when (and (plusp indent) (>= (length head) indent))
    (format t "~A~%" (shiftf head "")))
  (loop for line in (filled-lines text (- *text-width* indent))
        for start = head then ""
        do (format t "~VA~A~%" indent start line)))

(defun first-clause (text)
  "Return the first clause of TEXT: up to a period, colon or semicolon before a blank or the end."
  (let* ((text (one-line text))
         (end (loop for i from 0 below (length text)
                    when (and (find (char text i) ".:;")
                              (or (= (1+ i) (length text)) (blank-character-p (char text (1+ i)))))
                      return i)))
    (subseq text 0 end)))

(defun first-full-sentence (text)
  "Return the first sentence of TEXT, on one line."
  (let* ((text (one-line text)) (end (search ". " text)))
    (if end (subseq text 0 (1+ end)) text)))

;;; A live world is read between two ticks.

(defun call-with-time-stopped (function)
  "Call FUNCTION, which writes to the standard output, while no simulated time passes."
  (let ((simulation (current-simulation)))
    (write-string (asking (simulation)
                    (with-output-to-string (*standard-output*) (funcall function))))))

(defmacro with-time-stopped (&body body)
  "Run BODY, which writes to the standard output, while no simulated time passes."
  `(call-with-time-stopped (lambda () ,@body)))
