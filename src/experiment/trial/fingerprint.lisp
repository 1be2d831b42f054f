;;;; fingerprint.lisp -- one number for everything that decides the trials of a condition.

(in-package :ars-magna.experiment)

(export '(freeze-file-digests prepare-condition))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *deciding-folders*
    '("src/host/" "src/basics/" "src/definitions/" "src/copying/" "src/geometry/"
      "src/nisp/" "src/world/" "src/time/" "src/robot/" "src/command/" "src/run/"
      "rpl/fluents/" "rpl/tasks/" "rpl/language/" "rpl/constructs/" "rpl/robot/")
    "The folders of the simulator whose code affects runs.")

  (defun digest-of-folders (root)
    "Return one number for all code in *DECIDING-FOLDERS* under ROOT."
    (ldb (byte 64 0)
         (loop for folder in *deciding-folders*
               sum (loop for file in (directory (merge-pathnames "*.lisp"
                                                                 (merge-pathnames folder root)))
                         sum (file-digest file))))))

;; These files are compiled before this one, and when one is recompiled, so is this one.
(defparameter *simulator-digest*
  (macrolet ((digest ()
               (digest-of-folders
                (merge-pathnames "../../../" (or *compile-file-truename* *load-truename*)))))
    (digest))
  "A number for the simulator's own code.")

(defparameter *simulator-version*
  (macrolet ((version () (asdf:component-version (asdf:find-system "ars-magna"))))
    (version)))

;;;; Which users' code a function can reach

;;; A function leads to what its compiled code refers to. A symbol leads to the function, macro and
;;; value that it names, and to all definitions of that name. A plan leads to the symbols of its
;;; source. Symbols of the simulator and of Lisp, which are in locked packages, are skipped. What is
;;; looked up in other ways is missed: by a computed name, or as a function in a table or structure.

(defstruct (reach (:constructor make-reach ()) (:copier nil))
  "The definitions that a trial can reach. PARTS are lists (kind name number). FILES are the files
that contain the parts. VARIABLES are special variables. WEAK-PARTS has lists (kind name number) for
objects that variables hold weakly."
  (seen (make-hash-table :test 'eq) :read-only t)
  (parts '() :type list)
  (files '() :type list)
  (variables '() :type list)
  (weak-parts (make-hash-table :test 'equal) :read-only t))

(defun note-part (kind name number reach)
  (pushnew (list kind name number) (reach-parts reach) :test #'equal))

(defun note-file (file written reach)
  "Note in REACH that FILE has a definition that a trial can reach. WRITTEN is the write date of
FILE when it was loaded, or NIL."
  (let ((known (find file (reach-files reach) :key #'first :test #'string=)))
    (cond ((null known) (push (list file written) (reach-files reach)))
          (written (setf (second known) written)))))

;;; Functions typed at the prompt have no file, and no source is left. So each has its own number:
;;; typed again, or in another Lisp, it is a different function.

(defvar *prompt-function-numbers* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "Numbers of functions that were typed at the prompt.")

;;; Visiting.

(defun first-visit-p (object reach)
  (not (shiftf (gethash object (reach-seen reach)) t)))

(defun visit-function (function name reach)
  "Visit FUNCTION. NAME is the function's name, or NIL if it is part of another function."
  (when (first-visit-p function reach)
    (cond ((typep function 'generic-function)
           (dolist (method (code-references function)) (visit-function method name reach)))
          (t (when name (note-source-file function name reach))
             (dolist (object (code-references function)) (visit object reach))))))

(defun note-source-file (function name reach)
  (multiple-value-bind (file written) (function-file function)
    (if file
        (note-file file written reach)
        (note-part :typed (safe-text name)
                   (or (gethash function *prompt-function-numbers*)
                       (setf (gethash function *prompt-function-numbers*) (random-identifier)))
                   reach))))

(defun note-function (function name reach)
  "Note FUNCTION, the definition of NAME, in REACH if its file does not determine it. The file does
not determine closures, or functions that were set otherwise, for example by a trial."
  (let ((own-name (nth-value 2 (function-lambda-expression function)))
        (values (closed-over-values function)))
    (unless (or (typep function 'generic-function)
                (and (eq name own-name) (null values)))
      (note-part :function (qualified-symbol-name name) (data-digest values) reach))))

(defun note-weak-references (object symbol reach)
  "OBJECT is a part of the value of the variable SYMBOL. Note in REACH what OBJECT holds weakly."
  (when (and (weak-object-p object) (first-visit-p object reach))
    (dolist (number (weak-digests object (lambda (atom) (note-weak-references atom symbol reach))))
      (setf (gethash (list :variable (qualified-symbol-name symbol) number)
                     (reach-weak-parts reach)) t))))

(defun visit-variable (symbol reach)
  "Visit the variable SYMBOL and its value. A value that is data is noted as a part in REACH. NIL
and an empty table are not noted, because variables for data often have such values first."
  (unless (eq :global (variable-kind symbol)) (push symbol (reach-variables reach)))
  (let ((value (global-value symbol)))
    (flet ((visit-atom (atom)
             (if (typep atom '(or symbol function))
                 (visit atom reach)
                 (note-weak-references atom symbol reach))))
      (cond ((functionp value) (visit-function value symbol reach))
            ((empty-or-not-data-p value) (note-weak-references value symbol reach))
            (t (let ((number (map-data-atoms value #'visit-atom)))
                 (when number
                   (note-part :variable (qualified-symbol-name symbol) number reach))))))))

(defgeneric affects-trials-p (definition)
  (:documentation "True if DEFINITION, an object, can affect a trial that refers to its name. The
factors and numbers of trials of an experiment do not.")
  (:method (definition) (declare (ignore definition)) t)
  (:method ((experiment experiment)) nil))

(defun visit-definition (entry reach)
  (let ((object (entry-object entry)))
    (when (and (affects-trials-p object) (users-entry-p entry) (first-visit-p entry reach))
      (note-part (type-of object) (qualified-symbol-name (entry-name entry))
                 (or (entry-digest entry) 0) reach)
      (let ((file (source-file (entry-source entry))))
        (when file (note-file file nil reach)))
      (if (procedure-p object)
          (visit (procedure-source object) reach)
          (visit-slots object reach)))))

(defun visit-slots (object reach)
  (dolist (slot (class-slot-names (class-of object)))
    (let ((value (slot-value object slot)))
      (cond ((functionp value) (visit-function value nil reach))
            ((consp value) (visit-functions-in-list value reach))))))

(defun visit-functions-in-list (list reach)
  "Visit the functions in LIST, such as methods, and those in slots of structures in LIST."
  (when (proper-list-p list)
    (dolist (element list)
      (cond ((functionp element) (visit-function element nil reach))
            ((and (typep element 'structure-object) (first-visit-p element reach))
             (dolist (slot (class-slot-names (class-of element)))
               (let ((value (slot-value element slot)))
                 (when (functionp value) (visit-function value nil reach)))))))))

(defun qualified-symbol-name (symbol)
  (format nil "~(~@[~A:~]~A~)" (and (symbol-package symbol) (package-name (symbol-package symbol)))
          (symbol-name symbol)))

(defun visit-name (symbol reach)
  (let ((entries (users-entries-named symbol)))
    (dolist (entry entries) (visit-definition entry reach))
    (cond ((special-operator-p symbol))
          ((macro-function symbol) (visit-function (macro-function symbol) symbol reach))
          ((and (fboundp symbol) (notany #'procedure-p (mapcar #'entry-object entries)))
           (note-function (fdefinition symbol) symbol reach)
           (visit-function (fdefinition symbol) symbol reach)))
    (dolist (method (methods-on-class symbol)) (visit-function (method-code method) symbol reach))
    (loop for (file written) in (files-of-other-definitions symbol)
          do (note-file file written reach))
    ;; Some variables are set and never declared. The values of parameters are the condition's.
    (when (and (null entries)
               (member (variable-kind symbol) '(nil :special :global))
               (not (parameter-of-variable symbol))
               (ignore-errors (global-value symbol) t))
      (visit-variable symbol reach))))

(defun visit-symbol (symbol reach)
  (when (and (first-visit-p symbol reach) (users-symbol-p symbol))
    (visit-name symbol reach)))

(defun visit-list (list reach)
  (unless (gethash list (reach-seen reach))
    (loop while (and (consp list) (first-visit-p list reach))
          do (visit (pop list) reach))
    (visit list reach)))

(defun visit (object reach)
  (typecase object
    (null)
    (symbol (visit-symbol object reach))
    (function (visit-function object nil reach))
    (simple-vector (when (first-visit-p object reach)
                     (loop for element across object do (visit element reach))))
    ((cons (eql setf) (cons symbol null))
     (when (and (users-symbol-p (second object)) (fboundp object))
       (visit-function (fdefinition object) object reach)))
    (cons (visit-list object reach))))

;;;; The number

;;; The parts of a fingerprint are lists (kind name number): the experiment's text, the condition's
;;; values, the simulator, the definitions in a journal of such a run, and what the forms can reach.
;;; Rows with equal fingerprints should be equal functions of the seed; a resumed experiment checks
;;; this with a trial. All other code in the parts' files counts, except other experiments.

(defparameter *file-digests* (make-hash-table :test 'equal :synchronized t)
  "A table from names of files to digests. A saved Lisp needs the table if its files are gone.")

(defvar *file-digests-frozen-p* nil
  "True in a Lisp that was saved with its experiments: later changes of their files do not count.")

(defun short-file-name (file)
  (file-base-name (native-path file)))

(defun digest-of-file (file written)
  "Return a digest of the code in FILE. Signals MISUSE if the file's write date has changed since it
was loaded. WRITTEN is the date at loading, or NIL."
  (let ((now (ignore-errors (file-write-date (native-path file)))))
    (cond ((and *file-digests-frozen-p* (gethash file *file-digests*)))
          ((and now (or (null written) (= now written)))
           (setf (gethash file *file-digests*) (file-digest (native-path file) "defexperiment")))
          ((gethash file *file-digests*))
          (now (reject-use "~A has changed since it was loaded. Load the file again."
                           file))
          (t 0))))

(defun file-parts (files)
  (let ((parts '()))
    (loop for (file written) in files
          for part = (find (short-file-name file) parts :key #'second :test #'string=)
          for number = (digest-of-file file written)
          ;; Source files of Lisp itself do not exist here.
          do (cond ((zerop number))
                   (part (setf (third part) (ldb (byte 64 0) (+ number (third part)))))
                   (t (push (list :file (short-file-name file) number) parts))))
    parts))

(defun configuration-parts (experiment condition)
  (list (list :simulator *simulator-version* *simulator-digest*)
        (list :experiment (string-downcase (experiment-name experiment))
              (form-digest (experiment-deciding experiment)))
        (list :condition (condition-name condition)
              (data-digest (list* (condition-robots condition)
                                  (condition-thinking condition)
                                  (coerce (condition-parameters condition) 'list)
                                  (condition-arguments condition)
                                  (and (experiment-ghosts experiment) '(:ghosts)))))))

(defun definitions-in-trial (experiment condition)
  "Return the definitions in use when a trial of CONDITION begins; see DEFINITIONS-DEPENDED-ON."
  (call-in-trial (lambda () (definitions-depended-on (current-simulation))) experiment condition 1))

(defun compute-reach (experiment condition definitions)
  (let ((reach (make-reach)))
    (dolist (entry (remove nil (mapcar #'definition-registry-entry definitions)))
      (visit-definition entry reach))
    (dolist (function (list* (experiment-run experiment) (experiment-until experiment)
                             (experiment-success experiment)
                             (mapcar #'second (append (experiment-measures experiment)
                                                      (experiment-series experiment)))))
      (visit function reach))
    (visit (experiment-deciding experiment) reach)
    (visit (mapcar #'second (condition-settings condition)) reach)
    reach))

(defun fingerprint-parts (experiment condition)
  "Return the sorted fingerprint parts of CONDITION of EXPERIMENT, and the condition's REACH."
  (let* ((definitions (definitions-in-trial experiment condition))
         (reach (compute-reach experiment condition definitions)))
    (values
     (sort (remove-duplicates (append (configuration-parts experiment condition)
                                      (reach-parts reach)
                                      ;; Manipulations and undefined names have no entry.
                                      (remove :file
                                              (remove-if #'definition-registry-entry definitions)
                                              :key #'first)
                                      (file-parts (reach-files reach)))
                              :test #'equal)
           #'string< :key #'part-text)
     reach)))

(defun part-text (part)
  (destructuring-bind (kind name number) part
    (format nil "~(~A~) ~A ~16,'0X" kind (plain-text (princ-to-string name))
            (if (integerp number) number (text-checksum (princ-to-string number))))))

(defun fingerprint-of (parts)
  (format nil "~16,'0X"
          (let ((digest (make-digest)))
            (dolist (part parts)
              (loop for char across (part-text part) do (digest-add digest char)))
            (digest-value digest))))

(defun set-reach (condition reach)
  (setf (condition-variables condition)
        (loop for symbol in (reach-variables reach)
              collect (list symbol (global-value symbol)))
        (condition-weak-parts condition) (reach-weak-parts reach)))

(defun prepare-condition (experiment condition)
  "Set fingerprint and variables of CONDITION of EXPERIMENT. Return the parts of the fingerprint."
  (call-with-trial-syntax
   (lambda ()
     (multiple-value-bind (parts reach) (fingerprint-parts experiment condition)
       (set-reach condition reach)
       (setf (condition-fingerprint condition) (fingerprint-of parts))
       parts))))

(defun prepare-trials (experiment condition)
  "Set the variables of CONDITION of EXPERIMENT, but not the fingerprint: files may have changed."
  (call-with-trial-syntax
   (lambda ()
     (set-reach condition
                (compute-reach experiment condition (definitions-in-trial experiment condition))))))

(defun prepare-experiment (experiment)
  "Call PREPARE-CONDITION for all conditions of EXPERIMENT; return a list of the values. Signals
MISUSE if a file has changed since it was loaded, and errors from making the worlds."
  (loop for condition in (experiment-conditions experiment)
        collect (prepare-condition experiment condition)))

(defun freeze-file-digests ()
  "Keep the present digests of experiments' files in a Lisp that will be saved, even if the files
change later. Signals MISUSE if a file has changed since it was loaded."
  (mapc #'prepare-experiment (all-experiments))
  (setf *file-digests-frozen-p* t))
