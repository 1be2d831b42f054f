;;;; worlds.lisp -- the worlds that the prompt can enter, and the names of their robots.

(in-package :ars-magna.cli)

(export '(package-of-caller))

;;; The variable of a robot is a symbol of the package in which its world was written. ARS-USER
;;; imports the robots that the prompt may command, so that (robot-turn robbie 1 nil) works. A
;;; user's own definition of such a name stays as it is; a robot that the user defines under it is
;;; another one.

(defun user-package () (find-package :ars-user))

(defun defined-p (symbol)
  (or (boundp symbol) (fboundp symbol)))

(defun other-robot-p (symbol)
  (and (not (eq (symbol-package symbol) (user-package)))
       (boundp symbol)
       (robot-p (symbol-value symbol))))

(defun call-by-its-name (name)
  "Import NAME, a robot's variable, into ARS-USER, unless its name means something else there."
  (multiple-value-bind (known status) (find-symbol (symbol-name name) (user-package))
    (unless (eq known name)
      ;; A symbol that has only been read, or is a robot's of another world, is replaced.
      (when (and (member status '(:internal :external))
                 (or (not (defined-p known)) (other-robot-p known)))
        (unintern known (user-package))
        (setf status nil))
      (unless status (import (list name) (user-package))))))

(defun call-by-name (names)
  (mapc #'call-by-its-name names))

(defun with-own-name (form)
  "Return FORM, with a name of ARS-USER's own if it would redefine another world's robot."
  (if (and (consp form)
           (eq 'defrobot (first form))
           (consp (rest form))
           (symbolp (second form))
           (eq (second form) (find-symbol (symbol-name (second form)) (user-package)))
           (other-robot-p (second form)))
      (destructuring-bind (operator name &rest clauses) form
        (unintern name (user-package))
        (list* operator (intern (symbol-name name) (user-package)) clauses))
      form))

;;;; Worlds

;;; The shipped worlds, in the directory worlds/, are always there and have the names of their maps.
;;; Others come from files: Lisp files that define a map and at least one robot in it.

(defun package-of-caller ()
  "Return the package for a prompt opened here: the current one if it uses the simulator's."
  (if (eq 'simulator (find-symbol (string 'simulator) *package*))
      *package*
      (user-package)))

(defun call-with-syntax (float-format function &optional (package (user-package)))
  "Call FUNCTION with PACKAGE and the syntax for users; numbers with a point are of FLOAT-FORMAT."
  (let ((*package* package)
        (*readtable* *readtable*)
        (*read-default-float-format* float-format))
    (nisp:in-readtable :nisp)
    (funcall function)))

;;; A file is read with the floats of (load ...), so that it defines the same world however it is
;;; loaded.

(defun load-lisp (path)
  "Load the Lisp file at PATH as users write it: in ARS-USER and Nisp's syntax, unless it says
otherwise. Signals BAD-LINE if it is something else."
  (check-lisp-file path)
  (call-with-syntax 'single-float
                    (lambda () (call-quietly (lambda () (load-forms path))))))

(defun blueprints-defined-by (function)
  "Call FUNCTION. Return, in order, the blueprints that it defined and that are still defined."
  (let* ((defined '())
         (*definition-listener* (lambda (object) (push object defined))))
    (funcall function)
    (let ((blueprints (all-blueprints)))
      (remove-if-not (lambda (object) (member object blueprints)) (reverse defined)))))

(defun load-world (path)
  "Load the Lisp file at PATH. Return the names of the robots that it defines, in its order. Signals
BAD-LINE if there are none."
  (or (mapcar #'blueprint-name (blueprints-defined-by (lambda () (load-lisp path))))
      (reject-line "~A defines no robot; a world's file has a DEFROBOT."
                   (native-name path))))

(defun robot-names ()
  (mapcar #'blueprint-name (all-blueprints)))

(defun current-robot-names ()
  (and *simulation* (mapcar #'robot-name (simulation-robots *simulation*))))

(defun world-of (robot-name)
  (find-map (blueprint-map (find-blueprint robot-name))))

(defun robots-of (map)
  "Return the names of the robots that are defined in MAP, or in the map so named."
  (loop for body in (all-blueprints)
        when (eq (find-map map) (find-map (blueprint-map body) nil))
          collect (blueprint-name body)))

(defun all-worlds ()
  (remove-if-not #'robots-of (all-maps)))

(defun world-robots-called (name)
  "Return the names of the robots in the world NAME: a map, or else a Lisp file that defines a
world. Signals BAD-LINE."
  (let ((map (find name (all-worlds) :key #'map-name :test #'same-name-p))
        (file (existing-file name)))
    (cond (map (robots-of map))
          (file (load-world file))
          ((find-map name nil)
           (reject-line "No robot is defined in ~(~A~). Define one: (defrobot NAME ~
                         (~:*~(~A~) (X Y) ANGLE))."
                        name))
          (t (reject-line "There is no world ~A, nor a file of that name. Known: ~{~(~A~)~^, ~}."
                          name (mapcar #'map-name (all-worlds)))))))

(defun robots-of-same-world (robot-name)
  (cons robot-name (remove robot-name (robots-of (world-of robot-name)))))

(defun write-worlds ()
  (dolist (map (all-worlds))
    (format t "~(~16A~) ~3D x ~3D   ~{~A~^, ~}~%" (map-name map) (map-width map) (map-height map)
            (robots-of map))))
