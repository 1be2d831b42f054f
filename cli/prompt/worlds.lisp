;;;; worlds.lisp -- the worlds that the prompt can enter, and the names of their robots.

(in-package :ars-magna.cli)

(export '(package-for-new-prompt label-in-run))

;;; The variable of a robot is a symbol of the package in which its world was written. ARS-USER
;;; imports the robots that the prompt may command, so that (robot-turn robbie 1 nil) works. A
;;; user's own definition of such a name stays; a robot that the user defines under it is another.

(defun user-package () (find-package :ars-user))

(defun symbol-defined-p (symbol)
  (or (boundp symbol) (fboundp symbol)))

(defun robot-of-other-world-p (symbol)
  (and (not (eq (symbol-package symbol) (user-package)))
       (boundp symbol)
       (robot-p (symbol-value symbol))))

(defun import-robot-name (name)
  "Import NAME, a robot's variable, into ARS-USER, unless ARS-USER defines the name otherwise."
  (multiple-value-bind (known status) (find-symbol (symbol-name name) (user-package))
    (unless (eq known name)
      ;; A symbol that has only been read, or is a robot's of another world, is replaced.
      (when (and (member status '(:internal :external))
                 (or (not (symbol-defined-p known)) (robot-of-other-world-p known)))
        (unintern known (user-package))
        (setf status nil))
      (unless status (import (list name) (user-package))))))

(defun import-robot-names (names)
  "Import NAMES, the variables of the robots of a run, into ARS-USER, except those of robots with
one name: these need their packages."
  (dolist (name names)
    (if (rest (robots-meant (symbol-name name) names :key #'identity))
        (when (and (eq name (find-symbol (symbol-name name) (user-package)))
                   (robot-of-other-world-p name))
          (unintern name (user-package)))
        (import-robot-name name))))

(defun replace-robot-symbol (form)
  "Return FORM. If FORM is a DEFROBOT that would redefine a robot of another world, replace the
robot's name by a new symbol of ARS-USER."
  (if (and (consp form)
           (eq 'defrobot (first form))
           (consp (rest form))
           (symbolp (second form))
           (eq (second form) (find-symbol (symbol-name (second form)) (user-package)))
           (robot-of-other-world-p (second form)))
      (destructuring-bind (operator name &rest clauses) form
        (unintern name (user-package))
        (list* operator (intern (symbol-name name) (user-package)) clauses))
      form))

;;;; Worlds

;;; The shipped worlds, in the directory worlds/, are always there and have the names of their maps.
;;; Others come from files: Lisp files that define a map and at least one robot in it.

(defun package-for-new-prompt ()
  "Return a new prompt's package: the current package if it uses the simulator's, else ARS-USER."
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

;;; A file is read with the floats of (load ...), so that it always defines the same world.

(defun load-lisp (path)
  "Load the Lisp file at PATH in the package ARS-USER and Nisp's syntax, unless the file says
otherwise. Signals BAD-LINE if the file is not Lisp."
  (check-lisp-file path)
  (call-with-syntax 'single-float
                    (lambda () (call-quietly (lambda () (load-forms path))))))

(defun blueprints-defined-by (function)
  "Call FUNCTION. Return, in order, the blueprints defined by FUNCTION that are still defined."
  (let* ((defined '())
         (*definition-listener* (lambda (object) (push object defined))))
    (funcall function)
    (let ((blueprints (all-blueprints)))
      (remove-if-not (lambda (object) (member object blueprints)) (reverse defined)))))

(defun load-world (path)
  "Load the Lisp file at PATH. Return its robots' names in order. Signals BAD-LINE if it has none."
  (or (mapcar #'blueprint-name (blueprints-defined-by (lambda () (load-lisp path))))
      (reject-line "~A defines no robot; a world's file needs a DEFROBOT."
                   (native-name path))))

(defun labels-of-names (names)
  "Return a list of texts by which NAMES, names of robots, are told apart."
  (mapcar (lambda (name) (name-label name names)) names))

(defun label-in-run (name simulation)
  "Return the text for NAME, the name of a robot of SIMULATION, which may be NIL."
  (name-label name (and simulation (mapcar #'robot-name (simulation-robots simulation)))))

(defun find-robot-name (name names)
  "Return the element of NAMES, symbols, that the typed NAME means, or NIL. NAME is a full name or
one without package. Signals BAD-LINE if NAME could mean several robots."
  (let ((meant (robots-meant name names :key #'identity)))
    (when (rest meant)
      (reject-line "~A could be ~{~A~#[~; or ~:;, ~]~}. Type the full name." (string-upcase name)
                   (labels-of-names meant)))
    (first meant)))

(defun robot-names ()
  (mapcar #'blueprint-name (all-blueprints)))

(defun current-robot-names ()
  (and *simulation* (mapcar #'robot-name (simulation-robots *simulation*))))

(defun map-of-robot (robot-name)
  (find-map (blueprint-map (find-blueprint robot-name))))

(defun robot-names-in-map (map)
  (loop for body in (all-blueprints)
        when (eq (find-map map) (find-map (blueprint-map body) nil))
          collect (blueprint-name body)))

(defun maps-with-robots ()
  (remove-if-not #'robot-names-in-map (all-maps)))

(defun robot-names-in-world (name)
  "Return the names of the robots in the world NAME: a map, or else a Lisp file that defines a
world. Signals BAD-LINE if there is no such world."
  (let ((map (find name (maps-with-robots) :key #'map-name :test #'same-name-p))
        (file (existing-lisp-file name)))
    (cond (map (robot-names-in-map map))
          (file (load-world file))
          ((find-map name nil)
           (reject-line "No robot is defined in ~(~A~). Define one: (defrobot NAME ~
                         (~:*~(~A~) (X Y) ANGLE))."
                        name))
          (t (reject-line "There is no world ~A, nor a file of that name. Known: ~{~(~A~)~^, ~}."
                          name (mapcar #'map-name (maps-with-robots)))))))

(defun robot-names-in-same-world (robot-name)
  (cons robot-name (remove robot-name (robot-names-in-map (map-of-robot robot-name)))))

(defun testbed-maps ()
  "Return the maps on which games of testbeds are played."
  (loop for testbed in (all-testbeds)
        append (loop for robot in (testbed-robots testbed)
                     when (find-blueprint robot nil) collect (map-of-robot robot))))

(defun write-maps (maps)
  (dolist (map maps)
    (format t "~(~16A~) ~3D x ~3D   ~{~A~^, ~}~%" (map-name map) (map-width map) (map-height map)
            (robot-names-in-map map))))

(defun write-worlds ()
  (let* ((maps (maps-with-robots)) (known (testbed-maps))
         (games (remove-if-not (lambda (map) (member map known)) maps)))
    (write-maps (remove-if (lambda (map) (member map known)) maps))
    (when games
      (format t "~%Worlds of testbeds (./cli/ars-magna testbed lists the testbeds):~%")
      (write-maps games))))
