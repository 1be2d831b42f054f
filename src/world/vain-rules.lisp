;;;; vain-rules.lisp -- match forms that can never make a place, as their author should be told.

(in-package :ars-magna.world)

;;; A place is a free cell, and is of the type that was defined first. So a form in which the place
;;; itself is a wall is in vain, and so is a type all of whose forms fit only what is taken.

(defun entry-at (form dx dy)
  "Return the entry of FORM that is DX, DY from its middle; :ANY if it is outside."
  (multiple-value-bind (width height) (form-size form)
    (let ((column (+ dx (floor width 2))) (row (+ dy (floor height 2))))
      (if (and (< -1 column width) (< -1 row height))
          (nth column (nth row form))
          :any))))

(defun walled-p (rule)
  "True if RULE wants a wall where it has the place."
  (eq t (entry-at (rule-form rule) (rule-dx rule) (rule-dy rule))))

(defun form-text (form)
  "Return FORM in the abbreviations of manual 5.1.1."
  (format nil "(~{(~{~A~^ ~})~^ ~})"
          (loop for row in form
                collect (loop for entry in row
                              collect (case entry ((t) "*") ((nil) "-") (t "x"))))))

(defun warn-of-walled (definition rule)
  (let ((dx (rule-dx rule)) (dy (rule-dy rule)))
    (warn-of-definition "~A: the match form ~A can never fit a place, as ~A is a wall, and only ~
                         free cells are places; write - there, or give the free cell beside it ~
                         that is the place: (match-form direction dx dy)"
                        definition (form-text (rule-form rule))
                        (if (= 0 dx dy)
                            "its middle"
                            (format nil "the cell ~D ~D from its middle" dx dy)))))

;;; What is taken.

(defun free-codes (rule)
  "Return the codes of the neighbourhoods, around a free cell, that RULE, which is small, fits."
  (multiple-value-bind (mask value) (form-bits (rule-form rule))
    (loop for code below 512
          when (and (= value (logand code mask)) (not (logbitp 4 code))) collect code)))

(defun taker (code types)
  "Return the first of TYPES that takes a cell with the neighbourhood CODE for itself, or NIL."
  (find-if (lambda (type)
             (let ((number (if (place-type-table type) (aref (place-type-table type) code) 0)))
               (and (plusp number)
                    (let ((rule (nth (1- number) (place-type-rules type))))
                      (= 0 (rule-dx rule) (rule-dy rule))))))
           types))

(defun takers (rules types)
  "Return those of TYPES that take all that RULES fit; NIL if something is left."
  (let ((takers '()))
    (dolist (rule rules takers)
      (unless (= 0 (rule-dx rule) (rule-dy rule)) (return '()))
      (dolist (code (free-codes rule))
        (pushnew (or (taker code types) (return-from takers '())) takers)))))

(defun warn-of-taken (definition type)
  "Warn if types defined before TYPE leave nothing for it."
  (let* ((types (registry-objects *place-types*))
         (rules (remove-if #'walled-p (place-type-rules type)))
         (takers (and (place-type-table type)
                      (takers rules (ldiff types (member type types))))))
    (when takers
      (doubt-definition "~A: all that it fits is of the type ~{~(~A~)~^ or ~} already; what was ~
                         defined before wins; to let this one win, say :before ~(~A~)"
                        definition (mapcar #'place-type-name takers)
                        (place-type-name (find-if (lambda (other) (member other takers))
                                                  types))))))

(defun warn-of-vain-rules (definition type)
  "Warn of what in TYPE, which has been registered, can never make a place."
  (mapc (lambda (rule) (warn-of-walled definition rule))
        (remove-if-not #'walled-p (place-type-rules type)))
  (warn-of-taken definition type))
