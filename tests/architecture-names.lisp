;;;; architecture-names.lisp -- packages and exports are documented, and say who may use them.

(in-package :ars-magna.tests)

(in-suite architecture)

;;; Packages.

(defun project-packages ()
  "Return the layers' packages and the faces that there are."
  (remove-if-not (lambda (package)
                   (let ((name (package-name package)))
                     (or (member name '("ARS" "NISP" "ARS-WORLDS") :test #'string=)
                         (and (eql 0 (search "ARS-MAGNA." name))
                              (string/= name "ARS-MAGNA.TESTS")
                              (string/= name "ARS-MAGNA.BUILD")))))
                 (list-all-packages)))

(defun external-symbols (package)
  (sort (loop for symbol being the external-symbols of package collect symbol)
        #'string<))

(defun ours-p (symbol)
  (let ((package (symbol-package symbol)))
    (and package (member package (project-packages)))))

(defun undocumented-as (symbol)
  "Return as what SYMBOL is bound but not documented, a list."
  (loop for (kind bound-p) in `((function ,(fboundp symbol))
                                (variable ,(and (boundp symbol) (not (keywordp symbol))))
                                (type ,(sb-ext:valid-type-specifier-p symbol)))
        when (and bound-p (null (documentation symbol kind)))
          collect kind))

(test exports.are-documented
  (dolist (package (project-packages))
    (dolist (symbol (remove-if-not #'ours-p (external-symbols package)))
      (let ((kinds (undocumented-as symbol)))
        (is (null kinds) "~A:~A has no documentation as ~{~(~A~)~^, ~}"
            (package-name package) symbol kinds)))))

(test packages.say-what-they-are
  (dolist (package (project-packages))
    (is (plusp (length (documentation package t))) "~A" (package-name package))))

;;; What users see.

(defun documentations (symbol)
  "Return all that is said of SYMBOL, a list of strings."
  (loop for kind in '(function variable type)
        for text = (documentation symbol kind)
        when text collect text))

(defun says-addition-p (text)
  (let ((sentence (format nil "~%An addition to the manual.")))
    (eql (search sentence text) (- (length text) (length sentence)))))

(defun face-package (face)
  "Return the package FACE; in here :NISP is a nickname of a layer."
  (find (string face) (list-all-packages) :key #'package-name :test #'string=))

(test public.is-what-is-marked
  (dolist (face '(:ars :nisp))
    (is (null (set-exclusive-or (base:public-symbols face)
                                (external-symbols (face-package face))
                                :test #'string=)))))

(defun users-symbol (symbol)
  "Return what users see of SYMBOL, which a layer exports."
  (find-symbol (symbol-name symbol)
               (face-package (first (basics::mark-faces (basics::find-public-mark symbol))))))

(test public.readers-only-read
  "A user who could set one would change a run without an entry in its journal."
  (let ((settable '()) (readers 0))
    (dolist (symbol (append (base:public-symbols :ars) (base:public-symbols :nisp)))
      (let ((shown (users-symbol symbol)))
        (cond ((not (fboundp `(setf ,shown))))
              ((eq shown symbol) (push symbol settable))
              (t (incf readers)
                 (is (eq (fdefinition symbol) (fdefinition shown)))
                 (signals base:misuse (funcall (fdefinition `(setf ,shown)) 1 2))))))
    (is (< 50 readers))
    (is (null (set-exclusive-or settable
                                '("PARAMETER-VALUE" "GET-ATTRIBUTE" "FLUENT-VALUE" "VREF"
                                  "PT-X" "PT-Y" "INTERVAL-MIN" "INTERVAL-MAX"
                                  "PT-INTERVAL-X" "PT-INTERVAL-Y")
                                :test #'string=)))))

(test public.is-told-apart-from-the-manual
  (dolist (symbol (append (base:public-symbols :ars) (base:public-symbols :nisp)))
    (let ((texts (documentations symbol)))
      (if (base:addition-p symbol)
          (is (every #'says-addition-p texts) "~S does not say that the manual lacks it" symbol)
          (is (or (null texts) (some (lambda (text) (search "anual" text)) texts))
              "~S does not cite the manual" symbol)))))

(test marks.export
  (let ((symbol (intern "NEWLY-MARKED" :ars-magna.tests)) (marks basics::*public-marks*))
    (unwind-protect (progn (let ((base:*loading-simulator-p* t)) (eval `(base:addition ,symbol)))
                           (is (member symbol (external-symbols (find-package :ars-magna.tests)))))
      (setf basics::*public-marks* marks)
      (unintern symbol :ars-magna.tests))))
