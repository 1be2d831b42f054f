;;;; public.lisp -- which names users see, which of them the manual does not have, and their texts.

(in-package :ars-magna.basics)

(export '(document-restarts all-restarts restart-documentation public addition settable
          settable-p addition-p public-symbols *marking-p*))

;;; A mark stands directly before the definition of a name: PUBLIC if the name is the manual's,
;;; ADDITION if it is ours. The packages that users see, the faces ARS and NISP, collect what is
;;; marked (see src/faces.lisp). What no mark names is the business of the layers alone.

(defstruct (mark (:constructor make-mark (symbol faces addition-p)) (:copier nil))
  "What is known of a public name: the FACES that show it, keywords, and whether it is ours."
  (symbol nil :type symbol :read-only t)
  (faces '() :type list :read-only t)
  (addition-p nil :type boolean :read-only t))

(defvar *marks* '() "All marks, in order of definition.")

(defparameter *layers-of-nisp*
  '("ARS-MAGNA.NISP" "ARS-MAGNA.CANVAS" "ARS-MAGNA.RPL.FLUENTS" "ARS-MAGNA.RPL.TASKS"
    "ARS-MAGNA.RPL.LANGUAGE" "ARS-MAGNA.RPL.CONSTRUCTS" "ARS-MAGNA.RPL.SEEING"
    "ARS-MAGNA.RPL-ROBOT" "ARS-MAGNA.RPL-PICTURES" "ARS-MAGNA.RPL-PROJECTING")
  "The packages whose public names NISP shows, unless a mark says otherwise; ARS shows all others.")

(defun face-of (symbol)
  "Return the face, :ARS or :NISP, that shows SYMBOL if its mark does not say."
  (let ((layer (package-name (symbol-package symbol))))
    (if (member layer *layers-of-nisp* :test #'string=) :nisp :ars)))

(defun find-mark (symbol)
  (find symbol *marks* :key #'mark-symbol :test #'eq))

(defun register-mark (mark)
  (let ((old (find-mark (mark-symbol mark))))
    (setf *marks* (if old
                      (substitute mark old *marks* :test #'eq)
                      (append *marks* (list mark))))))

(defvar *marking-p* t
  "True while the simulator is being loaded. What is defined later is a user's, and not marked.")

(defun mark-names (names addition-p)
  "Mark each of NAMES, a symbol or a list (symbol face...), and export it. What is marked as an
addition stays one."
  (when *marking-p*
    (dolist (name names)
      (destructuring-bind (symbol &rest faces) (ensure-list name)
        (export symbol (symbol-package symbol))
        (when (or addition-p (not (addition-p symbol)))
          (register-mark (make-mark symbol (or faces (list (face-of symbol))) addition-p)))))))

(defmacro public (&rest names)
  "Mark NAMES, which are defined next, as names of the manual that users see. A name may be a list
(name face...): of :ARS and :NISP, those that show it."
  `(mark-names ',names nil))

(defmacro addition (&rest names)
  "Mark NAMES, which are defined next, as names that users see and the manual does not have. A name
may be a list (name face...), as for PUBLIC."
  `(mark-names ',names t))

(defvar *settable* '() "The public symbols whose functions users may SETF, too.")

(defmacro settable (&rest names)
  "Let users SETF the functions NAMES, which are public. Of all others they see only that they read:
what belongs to a run is changed by functions that its journal notes."
  `(setf *settable* (union *settable* ',names)))

(defun settable-p (symbol)
  "True if users may SETF the function called SYMBOL."
  (and (member symbol *settable* :test #'eq) t))

(defun public-symbols (face)
  "Return a list of the symbols that are marked for FACE, :ARS or :NISP, in order of definition."
  (loop for mark in *marks*
        when (member face (mark-faces mark))
          collect (mark-symbol mark)))

(defun addition-p (symbol)
  "True if SYMBOL is marked as an addition to the manual."
  (let ((mark (find-mark symbol)))
    (and mark (mark-addition-p mark))))

;;; A restart has no place for its documentation in Lisp, so there is one here.

(defvar *restarts* '() "Lists (name text): the restarts that are documented.")

(defun document-restarts (&rest names-and-texts)
  "Let TEXTS say what whoever chooses the restarts NAMES gets, alternating."
  (loop for (name text) on names-and-texts by #'cddr
        do (setf *restarts* (append (remove name *restarts* :key #'first)
                                    (list (list name (one-line text)))))))

(defun all-restarts ()
  "Return a list of the names of the restarts that are documented."
  (mapcar #'first *restarts*))

(defun restart-documentation (name)
  "Return what the restart NAME, a symbol, does, in words; NIL if it is not documented."
  (second (find name *restarts* :key #'first)))
