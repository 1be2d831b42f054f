;;;; quantities.lisp -- numbers with units: 90 deg, pi/2, 5 m.

(in-package :ars-magna.cli)

;;; An angle, length, speed or time may be typed with pi, and a unit, joined or as the next word. A
;;; number alone is in the simulator's own units: radians, metres (widths of cells), ticks.

(defparameter *quantities*
  '((angle     :angle  "0.5, pi/2 or 90 deg")
    (metres    :length "2.5, or 2.5 m")
    (distance  :length "2.5, or 2.5 m")
    (speed     :speed  "0.5, or 0.5 m/tick")
    (ticks     :time   "20, or 20 ticks")
    (tick-span :time   "20, or 20 ticks")
    (duration  :time   "20, 1/4, or 20 ticks")
    (steps     :time   "20, or 20 ticks"))
  "Lists (argument-type dimension examples).")

(defparameter *units*
  `((:angle  "an angle"             (1 "rad" "radian" "radians" "rad/tick")
                                    (,(/ pi 180) "deg" "degree" "degrees" "°" "deg/tick" "°/tick")
                                    (,(* 2 pi) "turn" "turns") (,pi "pi"))
    (:length "a length"             (1 "m" "metre" "metres" "meter" "meters" "cell" "cells")
                                    (1/100 "cm"))
    (:speed  "a speed"              (1 "m/tick" "cell/tick" "cells/tick") (1/100 "cm/tick"))
    (:time   "a time"               (1 "tick" "ticks"))
    (:clock  "a time of the clock"  (nil "s" "sec" "second" "seconds" "min" "minute" "minutes"))
    (:pace   "a speed by the clock" (nil "m/s" "km/h" "cells/s" "rad/s" "deg/s")))
  "Lists (dimension words (factor name...)...): FACTOR is a unit's value in simulator units.")

(defparameter *dimension-advice*
  '((:time   :length "GO 5 m drives 5 metres.")
    (:time   :clock  "Time is counted in ticks; RATE says how many ticks pass in a second.")
    (:speed  :pace   "Time is counted in ticks; RATE says how many ticks pass in a second.")
    (:length :time   "GO-FORWARD 5 drives for 5 ticks.")
    (:angle  :length "GO 5 m drives 5 metres."))
  "Lists (expected-dimension typed-dimension sentence): advice for a wrong dimension.")

(defun dimension-of (type)
  (second (find type *quantities* :key #'first :test #'same-name-p)))

(defun quantity-examples (type)
  "Return how to type an argument of TYPE, such as \"pi/2 or 90 deg\"; NIL if TYPE is no quantity."
  (third (find type *quantities* :key #'first :test #'same-name-p)))

(defun find-unit (name)
  "Return a list (dimension factor) for the unit named NAME, or NIL."
  (loop for (dimension nil . units) in *units*
        do (loop for (factor . names) in units
                 when (find name names :test #'string-equal)
                   do (return-from find-unit (list dimension factor)))))

;;; A unit joined to the number is read by Lisp as a symbol: 90DEG, PI/2, -3PI/4, 5M.

(defun parse-plain-number (text)
  "TEXT consists of digits, signs, points and slashes. Return the number that it denotes, or NIL."
  (let ((*read-eval* nil))
    (let ((value (ignore-errors (read-from-string text))))
      (and (realp value) value))))

(defun leading-number (text)
  "Return the number at the beginning of TEXT, and the position of its end. If TEXT begins without
digits, the number is 1, or -1 after a minus sign."
  (let ((end (or (position-if-not (lambda (char) (find char "0123456789.+-/")) text)
                 (length text))))
    (values (cond ((zerop end) 1)
                  ((find (subseq text 0 end) '("+" "-") :test #'string=)
                   (if (char= #\- (char text 0)) -1 1))
                  (t (parse-plain-number (subseq text 0 end))))
            end)))

(defun parse-pi (text)
  "If TEXT begins with PI or PI/number, return that value and the rest of TEXT; else 1 and TEXT."
  (if (starts-with-subseq "PI" text)
      (let* ((over-p (starts-with-subseq "PI/" text))
             (start (if over-p 3 2))
             (end (or (and over-p (position-if-not #'digit-char-p text :start start))
                      (if over-p (length text) start)))
             (divisor (if over-p (parse-plain-number (subseq text start end)) 1)))
        (and divisor (/= 0 divisor) (values (/ pi divisor) (subseq text end))))
      (values 1 text)))

(defun joined-quantity (name)
  "Divide NAME into a number and a unit: 90DEG, 2PI ... Return NIL if NAME is no such quantity."
  (multiple-value-bind (number end) (leading-number name)
    (when (and number (< end (length name)))
      (multiple-value-bind (factor rest)
          (parse-pi (string-left-trim "*" (string-upcase (subseq name end))))
        (let ((unit (and rest (string/= rest "") (find-unit rest))))
          (when (and factor (or unit (equal rest "")) (or (plusp end) (string= rest "")))
            (values (* number factor) unit)))))))

;;; As the next word.

(defun unit-after (text position)
  "Return the unit, a list, after POSITION and blanks in TEXT, and its end; NIL without a unit."
  (let* ((start (or (position-if-not #'blank-character-p text :start position) (length text)))
         (end (word-end text start))
         (unit (find-unit (subseq text start end))))
    (and unit (values unit end))))

(defun unit-names (dimension)
  (loop for (nil . names) in (cddr (assoc dimension *units*))
        append names))

(defun dimension-text (dimension)
  "Return the words for a quantity of DIMENSION, such as \"an angle\"."
  (second (assoc dimension *units*)))

(defun convert-to-own-units (number unit dimension said reject)
  "Convert NUMBER from UNIT to the simulator's unit of DIMENSION. If UNIT has another dimension,
call the function REJECT with a message. SAID is the text that was typed."
  (destructuring-bind (&optional (other dimension) (factor 1)) unit
    (unless (eq dimension other)
      (funcall reject (format nil "~A is ~A, but the argument is ~A.~@[ ~A~]"
                              said (dimension-text other) (dimension-text dimension)
                              (third (find-if (lambda (way)
                                                (and (eq dimension (first way))
                                                     (eq other (second way))))
                                              *dimension-advice*)))))
    (* number factor)))

(defun read-quantity (datum text start end type reject)
  "Return the quantity that begins with DATUM, as an argument of TYPE, and the position of its end.
DATUM was read in TEXT from START to END. Return DATUM if DATUM or TYPE is no quantity. If the unit
is wrong, call the function REJECT with a message."
  (let ((dimension (dimension-of type)))
    (multiple-value-bind (number unit)
        (cond ((null dimension) nil)
              ((realp datum) datum)
              ((and datum (symbolp datum)) (joined-quantity (symbol-name datum))))
      (if (null number)
          (values datum end)
          (multiple-value-bind (next-unit next-end) (if unit nil (unit-after text end))
            (let ((end (or next-end end)))
              (values (convert-to-own-units number (or unit next-unit) dimension
                                            (subseq text start end) reject)
                      end)))))))
