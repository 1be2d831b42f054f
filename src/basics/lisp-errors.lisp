;;;; lisp-errors.lisp -- texts for Common Lisp's own errors, the same on every version of SBCL.

(in-package :ars-magna.basics)

(export '(our-own-p))

;;; What SBCL reports of a wrong type differs between its versions: the type that its compiler has
;;; derived, the variable that was to be bound. Tables of experiments hold these texts, and two
;;; rows of one trial must be equal. So a type error names the value and the widest common type
;;; that the value is not of. Conditions that users define, and texts that they give, stay as they
;;; are.

(defparameter *common-types*
  '((number "a number") (real "a real number") (integer "an integer") ((integer 0) "0 or more")
    (rational "a rational number") (float "a float") (character "a character")
    (string "a string") ((or string symbol character) "a string")
    (cons "a list with elements") (list "a list") (symbol "a symbol")
    (hash-table "a hash table") (array "an array") (sequence "a list, vector or string")
    ((or function symbol) "a function") (stream "a stream") (pathname "a path"))
  "Lists (type words). Of the types that a wrong value does not have, the first one counts.")

(defparameter *arithmetic-texts*
  '((division-by-zero "A number is divided by 0.")
    (floating-point-overflow "A floating-point number is too large.")
    (floating-point-underflow "A floating-point number is too close to 0.")
    (floating-point-invalid-operation
     "An operation on floating-point numbers has no result, as 0 divided by 0."))
  "Lists (condition-type text).")

;;; Wrong types.

(defparameter *compilers-words*
  '("Argument is neither a positive integer" "Invalid function name" "malformed property list"
    "is not a string designator")
  "What stands in texts for type errors that only some versions of SBCL have.")

;; A type without elements, such as that of the indices of an empty vector, is part of any other.
(defun common-type-words (datum type)
  "Return words for the first of *COMMON-TYPES* that includes TYPE and not DATUM, or NIL."
  (unless (subtypep type nil)
    (loop for (common words) in *common-types*
          when (and (not (typep datum common)) (subtypep type common))
            return words)))

(defun integer-range (type)
  "Return the least and the greatest integer of TYPE, (integer LEAST GREATEST) or (mod N), NIL for
none; and true. Return false as a third value for other types."
  (flet ((bound (bound step)
           (cond ((integerp bound) bound)
                 ((and (consp bound) (integerp (first bound))) (+ (first bound) step)))))
    (cond ((and (consp type) (eq 'integer (first type)))
           (values (bound (second type) 1) (bound (third type) -1) t))
          ((and (consp type) (eq 'mod (first type)))
           (values 0 (bound (list (second type)) -1) t))
          (t (values nil nil nil)))))

(defun range-words (datum type)
  "Return words for the range TYPE of integers that does not include DATUM, an integer; or NIL."
  (multiple-value-bind (least greatest range-p) (integer-range type)
    (cond ((not (and range-p (integerp datum))) nil)
          ((and least greatest (< greatest least)) "in range: nothing is there")
          ((and least greatest) (format nil "from ~D to ~D" least greatest))
          (greatest (format nil "~D or less" greatest))
          (least (format nil "~D or more" least)))))

(defun class-words (type)
  (and (symbolp type)
       (find-class type nil)
       (format nil "of the type ~(~A~)" type)))

(defun compilers-text-p (condition)
  "True unless CONDITION, a type error, has a text that a program or CHECK-TYPE gave it."
  (or (not (typep condition 'simple-condition))
      ;; Texts of the compiler's are no strings; these were, in older versions.
      (let ((control (simple-condition-format-control condition)))
        (or (not (stringp control))
            (some (lambda (words) (search words control)) *compilers-words*)))))

(defun type-error-text (condition)
  (when (compilers-text-p condition)
    (let* ((datum (type-error-datum condition))
           (type (type-error-expected-type condition))
           (words (or (common-type-words datum type)
                      (range-words datum type)
                      (class-words type)))
           (value (safe-text datum :length 100)))
      (cond (words (format nil "The value ~A is not ~A.~@[ ~A~]"
                           value words (funcall *report-addition* condition)))
            ((member (type-of condition) '(type-error simple-type-error))
             (format nil "The value ~A is not one that can be used here." value))))))

;;; All of them.

(defun without-reference (text)
  "Return TEXT without the pages of the standard that SBCL refers to at its end."
  (let ((end (search (format nil "~%See also:") text)))
    (if end (subseq text 0 end) text)))

(defun named-text (condition)
  (format nil "The ~:[variable ~A has no value~;function ~A is undefined~].~@[ ~A~]"
          (typep condition 'undefined-function)
          (unqualified-text (cell-error-name condition))
          (funcall *report-addition* condition)))

(defun our-own-p (symbol)
  "True if SYMBOL is of a package of this system."
  (let ((package (symbol-package symbol)))
    (and package (starts-with-subseq "ARS-MAGNA." (package-name package)))))

(defun conflict-text (condition)
  "Return our text for CONDITION, that a package would have several symbols of one name, if one of
them is ours; or NIL."
  (let* ((symbols (sb-ext:name-conflict-symbols condition))
         (ours (find-if #'our-own-p symbols)))
    (when ours
      (format nil "~A would mean ~{~A:~A~^ and ~} here. Say before which is meant, as by ~
                   (shadowing-import 'ars:~(~A~)) or in a defpackage ~
                   (:shadowing-import-from :ars #:~(~:*~A~)); or write (ars:define-user-package ~
                   :mine) for a package without such conflicts."
              (symbol-name ours)
              ;; Their order depends on the version of SBCL.
              (loop for symbol in (cons ours (remove ours symbols))
                    collect (package-name (symbol-package symbol))
                    collect (symbol-name symbol))
              (symbol-name ours)))))

;; What Lisp says shows the stream.
(defun refusal-text (condition)
  "Return our text for the stream error CONDITION if the system refuses input or output; NIL of
others."
  (let* ((text (one-line (princ-to-string condition))) (place (search ": " text :from-end t))
         (file (ignore-errors (pathname (stream-error-stream condition))))
         (input-p (starts-with-subseq "couldn't read from" text)))
    (when (and place (or input-p (starts-with-subseq "Couldn't write to" text)))
      (format nil "~:[The ~:[out~;in~]put~*~;The file ~*~A~] cannot be ~:[written~;read~]: ~A."
              file input-p (and file (native-name file)) input-p
              (string-downcase (string-right-trim "." (subseq text (+ 2 place))))))))

(defun lisp-error-text (condition)
  "Return our text for CONDITION if it is one of Common Lisp's own errors; NIL if there is none."
  (ignore-errors
   (when (lisps-own-p (type-of condition))
     (typecase condition
       (arithmetic-error
        (second (assoc-if (lambda (type) (typep condition type)) *arithmetic-texts*)))
       (sb-ext:name-conflict (conflict-text condition))
       ((or undefined-function unbound-variable) (named-text condition))
       (stream-error (refusal-text condition))
       ;; That no clause of ECASE or the like was for a value is told by Lisp.
       (type-error (unless (string= "CASE-FAILURE" (type-of condition))
                     (type-error-text condition)))))))
