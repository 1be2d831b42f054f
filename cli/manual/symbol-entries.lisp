;;;; symbol-entries.lisp -- entries of what users' packages export, and all entries together.

(in-package :ars-magna.manual)

(export '(all-entries))

;;; The chapter of a symbol follows from what it is.

(defun definer-p (symbol)
  (let ((name (symbol-name symbol)))
    (and (fboundp symbol)
         (or (and (starts-with-subseq "DEF" name)
                  (not (search "WARNING" name)))
             (member name '("UNDEFINE" "WITH-OWN-DEFINITIONS" "NEW-THING" "THING-DESCRIPTOR"
                            "MAKE-ODOMETER" "MAKE-POLICY" "MAKE-VALVE" "INTERP-LAMBDA" "MAKE-PLAN"
                            "SET-KICKER" "PUT-KICKER" "REBUILD-MAP")
                     :test #'string=)))))

(defun colour-p (symbol)
  (and (string= "ARS-MAGNA.CANVAS" (package-name (symbol-package symbol)))
       (boundp symbol)
       (typep (symbol-value symbol) '(or simple-vector (unsigned-byte 24)))
       (not (string= "GRAPHICS-SCALE*" (symbol-name symbol)))))

(defparameter *words*
  '((("NUMERIC") "The domain of an attribute whose values are numbers; see DEFATTRIBUTE.")
    (("RED" "GREEN" "BLUE" "VIOLET" "LIGHTRED" "LIGHTGREEN" "LIGHTBLUE" "LIGHTVIOLET")
     "A value of the attribute :COLOR.")
    (("VOID" "LST" "~" "THING-DESCRIPTOR" "ROBOT-CONTINUATION")
     "A word of Nisp's for types, which DEFFUNC, DEFPROC and LET take and pass over (manual 3.1)."))
  "Lists (names text): words that are users' symbols, and no more.")

(defun word-text (symbol)
  (second (find-if (lambda (names) (member (symbol-name symbol) names :test #'string=))
                   *words* :key #'first)))

(defun restart-name-p (symbol)
  "True if SYMBOL is no more than the name of a restart."
  (and (null (sorts-of-symbol symbol)) (null (word-text symbol))))

(defun condition-name-p (symbol)
  (and (find-class symbol nil) (subtypep symbol 'condition)))

(defun plan-function-p (symbol)
  (and (fboundp symbol) (starts-with-subseq "RPL-" (symbol-name symbol))))

(defun chapter-of-symbol (symbol)
  (cond ((member symbol (all-constructs)) :constructs)
        ((assoc symbol (all-fluent-variables)) :fluents)
        ((plan-function-p symbol) :plan-functions)
        ((colour-p symbol) :colours)
        ((or (condition-name-p symbol) (restart-name-p symbol)) :conditions)
        ((definer-p symbol) :definers)
        ((string= "ARS-WORLDS" (package-name (symbol-package symbol))) :worlds-names)
        (t :names)))

(defun section-of-symbol (symbol chapter)
  (case chapter
    (:names (let* ((package (package-name (symbol-package symbol)))
                   (start (if (starts-with-subseq "ARS-MAGNA." package) (length "ARS-MAGNA.") 0)))
              (string-downcase (subseq package start))))
    (:fluents (format nil "Of the ~(~A~)" (or (second (assoc symbol (all-fluent-variables)))
                                              'robot)))
    (:conditions (if (restart-name-p symbol) "Restarts" "Conditions"))
    (t "")))

(defun value-facts (symbol)
  "Return the fact that says what value the variable SYMBOL has, if that is short."
  (when (and (boundp symbol) (not (constantp symbol)))
    (let ((value (symbol-value symbol)) (*print-case* :downcase))
      (when (typep value '(or real keyword boolean))
        (list (list "Value" (prin1-to-string value)))))))

(defun restart-text (symbol)
  (format nil "~@[~A ~]The name of a restart: (invoke-restart '~(~A~))."
          (restart-documentation symbol) symbol))

(defun symbol-entry (symbol)
  (let ((chapter (chapter-of-symbol symbol)))
    (make-entry :name (string-downcase symbol) :chapter chapter :symbol symbol
                :section (section-of-symbol symbol chapter)
                :use (if (fboundp symbol)
                         (plain-use symbol (lambda-list-of symbol))
                         (string-downcase symbol))
                :facts (append (symbol-facts symbol)
                               (unless (member chapter '(:fluents :colours)) (value-facts symbol)))
                :text (or (first-text symbol) (word-text symbol) (restart-text symbol))
                :file (file-of-symbol symbol))))

;;; Which symbols.

(defun exported-symbols (package)
  (let ((found '()))
    (when (find-package package)
      (do-external-symbols (symbol package)
        (push symbol found)))
    (sort found #'string<)))

(defun users-symbols ()
  "Return the symbols that users see: those that are marked, and what the packages of worlds and of
checks for tests export."
  (remove-duplicates (append (public-symbols :ars) (public-symbols :nisp)
                             (exported-symbols :ars-worlds) (exported-symbols :ars-fiveam))
                     :from-end t))

(defun named-elsewhere-p (symbol entries)
  "True if SYMBOL is only a word that one of ENTRIES, of substances or place types, tells of."
  (and (null (sorts-of-symbol symbol))
       (find (symbol-name symbol) entries :key #'entry-name :test #'string-equal)))

(defun symbol-entries (others)
  (let ((told (let ((table (make-hash-table :test 'eq)))
                (dolist (entry others table)
                  (when (entry-symbol entry) (setf (gethash (entry-symbol entry) table) t))))))
    (loop for symbol in (users-symbols)
          unless (or (gethash symbol told) (named-elsewhere-p symbol others))
            collect (symbol-entry symbol))))

;;; All.

(defun chapter-rank (entry)
  (position (entry-chapter entry) *chapters* :key #'first))

(defun all-entries ()
  "Return all entries of the reference, by chapters."
  (let ((entries (append (command-entries) (error-entries) (line-entries) (parameter-entries)
                         (shipped-entries))))
    (stable-sort (append entries (symbol-entries entries)) #'< :key #'chapter-rank)))
