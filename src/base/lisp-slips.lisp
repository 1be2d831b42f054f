;;;; lisp-slips.lisp -- what was meant where Lisp finds no function, or an object of another type.

(in-package :ars-magna.base)

(defun functions-like (name package)
  "Return the functions and macros, not Lisp's, that PACKAGE sees and for which NAME may be a slip."
  (let ((symbols '()) (lisp (find-package "COMMON-LISP")))
    (do-symbols (symbol package)
      (when (and (fboundp symbol)
                 (not (eq lisp (symbol-package symbol)))
                 (<= (abs (- (length (symbol-name symbol)) (length (symbol-name name)))) 2)
                 (resembles-p name symbol))
        (pushnew symbol symbols)))
    (sort symbols #'string<)))

(defun ours-called (name)
  "Return the function of ours that is called like NAME, another symbol, and the name of the package
that exports it; or NIL."
  ;; A user's package may have nicknames of its own for others.
  (let ((*package* (find-package "KEYWORD")))
    (dolist (package '("ARS" "NISP"))
      (multiple-value-bind (symbol status)
          (and (find-package package) (find-symbol (symbol-name name) package))
        (when (and (eq :external status) (fboundp symbol)) (return (values symbol package)))))))

;; The layer that knows commands sets it.
(defvar *function-meant* (constantly nil)
  "A function of a symbol that is the name of no function: it returns that of one which is called so
elsewhere, as at the prompt, or NIL.")

(defun function-slip-text (name)
  "Return in a sentence what NAME, of no function, may be a slip for, or NIL."
  (when (and (symbolp name) (symbol-package name))
    (multiple-value-bind (ours package)
        (ours-called (or (funcall *function-meant* name) name))
      (if ours
          (if (eq ours (find-symbol (symbol-name ours) (symbol-package name)))
              (format nil "In Lisp it is ~(~A~)." ours)
              (format nil "There is one in ~A: write ~(~:*~A:~A~), or type (in-package :ars-user) ~
                           first."
                      package ours))
          (let ((like (nearest-name name (functions-like name (symbol-package name)))))
            (and like (format nil "Did you mean ~(~A~)?" (unqualified-text like))))))))

(defun type-slip-text (datum type)
  "Return in a sentence how to have an object of TYPE, for somebody who gave DATUM; NIL if there is
no more to say."
  (let* ((type (and (symbolp type) (find-argument-type type nil)))
         (trouble (and type (argument-type-trouble type))))
    (when (and trouble (funcall trouble datum))
      (sentence (format nil "Give ~A" (argument-type-text type datum))))))

(defun report-addition (condition)
  "Return what is to stand behind the report of CONDITION, an error of Lisp's own, or NIL."
  (typecase condition
    (undefined-function (function-slip-text (cell-error-name condition)))
    (type-error (type-slip-text (type-error-datum condition)
                                (type-error-expected-type condition)))))

(setf *report-addition* #'report-addition)
