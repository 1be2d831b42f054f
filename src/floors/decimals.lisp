;;;; decimals.lisp -- numbers as others write them, read without Lisp's reader, and written.

(in-package :ars-magna.floors)

(defconstant +longest-decimal+ 60 "How many characters a number has at most.")
(defconstant +largest-exponent+ 330
  "How large the exponent of a number is at most: no double-float's is larger.")

(defun digits-end (text start)
  "Return where the decimal digits that begin in TEXT at START end."
  (or (position-if-not (lambda (char) (find char "0123456789")) text :start start)
      (length text)))

(defun sign-at (text start)
  "Return 1 or -1 for the sign in TEXT at START, and where that ends; 1 and START without one."
  (case (and (< start (length text)) (char text start))
    (#\+ (values 1 (1+ start)))
    (#\- (values -1 (1+ start)))
    (t (values 1 start))))

(defun whole-between (text start end)
  (if (< start end) (parse-integer text :start start :end end) 0))

(defun exponent-at (text start)
  "Return the exponent that TEXT ends with from START on, 0 if it ends there; NIL if neither."
  (cond ((= start (length text)) 0)
        ((char-equal #\e (char text start))
         (multiple-value-bind (sign digits) (sign-at text (1+ start))
           (when (and (< digits (length text)) (= (length text) (digits-end text digits)))
             (let ((size (whole-between text digits (length text))))
               (and (<= size +largest-exponent+) (* sign size))))))))

(defun decimal-at (text start)
  "Return the number without a sign that is in TEXT from START on, exactly, or NIL."
  (let* ((point (digits-end text start))
         (pointed (and (< point (length text)) (char= #\. (char text point))))
         (end (if pointed (digits-end text (1+ point)) point))
         (places (if pointed (- end point 1) 0))
         (exponent (exponent-at text end)))
    (when (and exponent (plusp (+ places (- point start))))
      (* (+ (whole-between text start point)
            (/ (whole-between text (1+ point) end) (expt 10 places)))
         (expt 10 exponent)))))

(defun read-decimal (text)
  "Return the number, exactly, that TEXT stands for, such as -12.5, .5 or 1e-2; NIL if none."
  (when (<= (length text) +longest-decimal+)
    (multiple-value-bind (sign start) (sign-at text 0)
      (let ((number (decimal-at text start)))
        (and number (* sign number))))))

(defun decimal (number)
  "Return the shortest text that READ-DECIMAL makes NUMBER, as a double-float, of again."
  (let ((*read-default-float-format* 'double-float)
        (value (double number)))
    (if (and (= value (ftruncate value)) (< (abs value) 1d15))
        (format nil "~D.0" (truncate value))
        (prin1-to-string value))))
