;;;; reaching.lisp -- which code of users' a function can reach: that decides a trial, too.

(in-package :ars-magna.experiment)

;;; From a function one reaches what its compiled code refers to; from a symbol the function, macro
;;; and value that it names, and whatever definitions are called so; from a plan the words of its
;;; text. What belongs to the simulator and to Lisp is known by its locked package and left alone.
;;; What is looked up in other ways, by a name put together from pieces or in a table, is not
;;; reached.

(defstruct (reach (:constructor make-reach ()) (:copier nil))
  "What has been reached: definitions, lists (kind name number); the files that it is from."
  (seen (make-hash-table :test 'eq) :read-only t)
  (parts '() :type list)
  (files '() :type list)
  (random-p nil :type boolean))

(defun lisps-own-package-p (package)
  (or (package-locked-p package) (eq package (find-package :keyword))))

(defun users-symbol-p (symbol)
  (let ((package (symbol-package symbol)))
    (and package (not (lisps-own-package-p package)))))

(defun note-part (kind name number reach)
  (pushnew (list kind name number) (reach-parts reach) :test #'equal))

(defun note-file (file written reach)
  "Note that something reached is from FILE, which was loaded as WRITTEN at that time, if known."
  (let ((known (find file (reach-files reach) :key #'first :test #'string=)))
    (cond ((null known) (push (list file written) (reach-files reach)))
          (written (setf (second known) written)))))

;;; Visiting.

(defun visit-function (function name reach)
  "Visit FUNCTION, called NAME, or NIL if it is only a part of another."
  (unless (gethash function (reach-seen reach))
    (setf (gethash function (reach-seen reach)) t)
    (when name
      (multiple-value-bind (file written) (function-file function)
        (if file
            (note-file file written reach)
            (note-part :typed (safe-text name) 0 reach))))
    (dolist (object (code-references function)) (visit object reach))))

(defun plain-value-p (value)
  (typep value '(or number string character symbol cons)))

(defun visit-variable (symbol reach)
  "Visit the value of the special variable SYMBOL; if that is plain, it is a part."
  (let ((value (ignore-errors (global-value symbol))))
    (cond ((functionp value) (visit-function value nil reach))
          ((and (plain-value-p value) (value-p value))
           (note-part :variable (qualified symbol) (form-digest value) reach)
           (visit value reach)))))

;; What an experiment varies, and how often it is tried, decides no trial.
(defun visit-definition (entry reach)
  "Visit what ENTRY, of a registry, says, if that is a user's."
  (let ((object (entry-object entry)))
    (unless (or (gethash entry (reach-seen reach)) (experiment-p object) (not (users-p entry)))
      (setf (gethash entry (reach-seen reach)) t)
      (note-part (type-of object) (qualified (entry-name entry)) (or (entry-digest entry) 0) reach)
      (let ((file (source-file (entry-source entry))))
        (when file (note-file (native-name file) nil reach)))
      (if (procedure-p object)
          (visit (procedure-source object) reach)
          (visit-slots object reach)))))

(defun visit-slots (object reach)
  "Visit the functions that the slots of OBJECT, a definition, hold."
  (dolist (slot (class-slot-names (class-of object)))
    (let ((value (slot-value object slot)))
      (cond ((functionp value) (visit-function value nil reach))
            ((consp value) (visit-holders value reach))))))

(defun visit-holders (list reach)
  "Visit the functions in LIST, and those that structures in it hold, as methods do."
  (when (proper-list-p list)
    (dolist (element list)
      (cond ((functionp element) (visit-function element nil reach))
            ((and (typep element 'structure-object)
                  (not (gethash element (reach-seen reach))))
             (setf (gethash element (reach-seen reach)) t)
             (dolist (slot (class-slot-names (class-of element)))
               (let ((value (slot-value element slot)))
                 (when (functionp value) (visit-function value nil reach)))))))))

(defun qualified (symbol)
  (format nil "~(~@[~A:~]~A~)" (and (symbol-package symbol) (package-name (symbol-package symbol)))
          (symbol-name symbol)))

(defun visit-name (symbol reach)
  "Visit what SYMBOL names."
  (let ((entries (entries-meant symbol)))
    (dolist (entry entries) (visit-definition entry reach))
    (cond ((special-operator-p symbol))
          ((macro-function symbol) (visit-function (macro-function symbol) symbol reach))
          ((and (fboundp symbol) (notany #'procedure-p (mapcar #'entry-object entries)))
           (visit-function (fdefinition symbol) symbol reach)))
    (when (boundp symbol) (visit-variable symbol reach))))

(defun visit-symbol (symbol reach)
  (unless (gethash symbol (reach-seen reach))
    (setf (gethash symbol (reach-seen reach)) t)
    (cond ((lisps-dice-p symbol) (setf (reach-random-p reach) t))
          ((users-symbol-p symbol) (visit-name symbol reach)))))

(defun visit-list (list reach)
  (unless (gethash list (reach-seen reach))
    (loop while (and (consp list) (not (gethash list (reach-seen reach))))
          do (setf (gethash list (reach-seen reach)) t)
             (visit (pop list) reach))
    (visit list reach)))

(defun visit-setter (name reach)
  "Visit the function called NAME, as (setf symbol)."
  (when (and (symbolp (second name)) (users-symbol-p (second name)) (fboundp name))
    (visit-function (fdefinition name) name reach)))

(defun visit (object reach)
  "Note in REACH all that OBJECT leads to."
  (typecase object
    (null)
    (symbol (visit-symbol object reach))
    (function (visit-function object nil reach))
    (cons (if (and (eq 'setf (first object)) (proper-list-p object) (= 2 (length object))
                   (symbolp (second object)))
              (visit-setter object reach)
              (visit-list object reach)))))
