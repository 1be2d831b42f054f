;;;; defmap.lisp -- DEFMAP: from clauses to a map and the things in it (manual 5.1).

(in-package :ars-magna.world)

(export '(define-map))

;;; The obj clause of a map, a thing. A clause is data. The code in it, prototypes and the lambdas
;;; of draw functions, is compiled separately, in a list of (key function), each once. A key is
;;; (name form), with the name of a thing that is drawn. Code of clauses that were typed in a
;;; restart, or that come from another clause, is not in the list.

(defvar *compiled-map-code* '() "The compiled code of the map that is being defined.")

(defun compiled-code-form (code)
  `(list ,@(loop for (key form) in (remove-duplicates code :key #'first :test #'equal)
                 collect `(list ',key (lambda () ,form)))))

(defun code-value (name source form)
  "Return the value of FORM, by compiled code if there is any. FORM is made from SOURCE, code for
the thing named NAME or, if NAME is NIL, for a prototype."
  (let ((compiled (second (find (list name source) *compiled-map-code* :key #'first :test
                                #'equal))))
    (if compiled (funcall compiled) (eval form))))

(defun evaluated-descriptor (name descriptor)
  (loop for (key value) in descriptor
        collect (list key (if (contains-code-p key value)
                              (code-value name value (draw-function-form name value))
                              value))))

;;; Checking.

(defun check-thing-head (definition clause head)
  (let ((head (if (consp head) head (list head))))
    (unless (and (proper-list-p head) (first head) (symbolp (first head)))
      (reject-clause definition clause "a name, or (name :prototype thing)"))
    (check-options definition (rest head) '(:prototype :kickers))
    (unless (and (proper-list-p (getf (rest head) :kickers))
                 (every #'symbolp (getf (rest head) :kickers)))
      (reject-clause definition clause ":kickers (name ...), names in a list"))))

(defun check-thing-clause (definition clause head descriptor)
  "Return true. Signals MALFORMED-DEFINITION if HEAD or DESCRIPTOR, parts of CLAUSE, are invalid."
  (check-thing-head definition clause head)
  (or (descriptor-p descriptor)
      (reject-clause definition clause
                     "an object descriptor ((attribute value) ...), each attribute once")))

(defun check-content (definition clause)
  (when (keywordp (if (consp clause) (first clause) clause))
    (reject-clause definition clause
                   (format nil "contents: (name descriptor contents...); options stand beside ~
                                the name, as in (obj (ball :kickers (sway)) ...)")))
  (unless (and (proper-list-p clause) (<= 2 (length clause)))
    (reject-clause definition clause "contents: (name descriptor contents...)"))
  (check-thing-clause definition clause (first clause) (second clause)))

(defun check-position (map clause position)
  (unless (and (number-pair-p position) (apply #'map-index map position))
    (reject-clause (map-title map) clause
                   (format nil "a position (x y) in the map, from 0 to below ~D and ~D"
                           (map-width map) (map-height map)))))

(defun code-in-thing (definition head descriptor contents)
  "Return a list of (key form) for the code of a thing and its contents. Signals
MALFORMED-DEFINITION for invalid contents."
  (destructuring-bind (name &key prototype &allow-other-keys) (ensure-list head)
    (append (and prototype (list (list (list nil prototype) prototype)))
            (loop for (key value) in descriptor
                  when (contains-code-p key value)
                    collect (list (list name value) (draw-function-form name value)))
            (loop for inside in contents
                  do (check-content definition inside)
                  append (destructuring-bind (head descriptor . contents) inside
                           (code-in-thing definition head descriptor contents))))))

;;; Recipes.

(defun clause-recipe (definition clause name descriptor &rest options)
  (warn-of-misspellings definition name descriptor :clause clause)
  (handler-case (apply #'recipe-from-descriptor 'defmap name descriptor options)
    ((or wrong-argument unknown-name) (condition)
      (reject-clause definition clause
                     (format nil "a thing that can be made (~A)"
                             (string-right-trim "." (princ-to-string condition)))))))

(defun recipe-of-thing-clause (definition clause head descriptor contents &optional x y)
  "Return the recipe of the thing in CLAUSE, which has been checked and ends in CONTENTS."
  (destructuring-bind (name &key prototype kickers) (ensure-list head)
    (flet ((value () (code-value nil prototype prototype))
           (inside (content)
             (check-content definition content)
             (list (recipe-of-thing-clause definition content (first content) (second content)
                                           (cddr content)))))
      (clause-recipe definition clause name (evaluated-descriptor name descriptor)
                     :prototype (and prototype
                                     (call-clause-code
                                      #'value definition clause
                                      "a prototype: a form whose value is a thing"))
                     :kickers kickers :x x :y y
                     :contents (append-clause-results #'inside contents
                                                      (- (length clause) (length contents)))))))

(define-map-clause obj (map &whole clause head position descriptor &rest contents)
    "(obj name (x y) descriptor contents...)"
  :check (progn (check-position map clause position)
                (check-thing-clause (map-title map) clause head descriptor))
  :code (code-in-thing (map-title map) head descriptor contents)
  :things (destructuring-bind (x y) position
            (list (recipe-of-thing-clause (map-title map) clause head descriptor contents x y))))

;;; Evaluating the form executes the clauses in order; an error in one is MALFORMED-DEFINITION, with
;;; restarts for that clause. Macroexpansion only searches them for code, and for mistakes to warn
;;; about when a file is compiled.

(defun find-places (map path)
  "Find the places of MAP again. If no place type failed, cache MAP in the file PATH, if not NIL."
  (let ((whole (nth-value 1 (classify-places map))))
    (when (and path whole) (write-cache map path (cache-key map)))
    map))

(defun build-map (map)
  "Fill the grid of MAP from its clauses, or from its cache if the cache is valid."
  (let ((path (usable-cache-path map)))
    (unless (and path (restore-from-cache map path (cache-key map)))
      (clear-walls map)
      (dolist (clause (map-clauses map)) (clause-value :cells map clause))
      (find-places (record-wall-facts map) path))))

(addition rebuild-map)
(defun rebuild-map (map)
  "Find the places of MAP (a map or its name) again, by the current place types, and rewrite its
cache. Worlds of MAP see the change at once. Return the map."
  (let ((map (find-map map)))
    (find-places map (usable-cache-path map))))

;;; Warnings.

(defun warn-of-clause (map clause control &rest arguments)
  (warn-of-definition "~A~@[ (~A)~]: ~?" (map-title map) (clause-location clause)
                      control arguments))

(defun warn-of-walls-outside-map (map clause walls)
  (when (loop for wall in walls
                thereis (loop for (x y) in (clause-value :corners map wall)
                                thereis (not (and (<= 0 x (map-width map))
                                                  (<= 0 y (map-height map))))))
    (warn-of-clause map clause "~S goes beyond the map, which is ~D by ~D metres; the part outside ~
                                is drawn at the map's edge."
                    clause (map-width map) (map-height map)))
  (dolist (name (substances-of map walls))
    (let ((like (unless (find-substance name nil)
                  (find-if (lambda (other) (misspelling-p name other))
                           (defined-names *substances*)))))
      (when like
        (warn-of-clause map clause "the substance ~(~A~) is not defined; did you mean ~(~A~)?"
                        name like)))))

(defun warn-of-things-in-walls (map)
  (dolist (recipe (map-things map))
    (let ((x (recipe-x recipe)) (y (recipe-y recipe)) (name (recipe-name recipe)))
      (when (wall-at-p map x y)
        (warn-of-clause map name "~(~A~) at ~A is inside a wall, where robots may not see or reach ~
                                  it."
                        name (point-text x y))))))

;;; Making it.

(defun without-docstring (clauses)
  (if (stringp (first clauses)) (rest clauses) clauses))

(defun fill-map (map clauses)
  "Give MAP the walls and things of CLAUSES; a docstring may precede the clauses."
  (flet ((parts (clause)
           (let ((parts (parts-of-clause map clause)))
             (warn-of-walls-outside-map map clause (remove-if #'recipe-p parts))
             parts)))
    (let ((parts (append-clause-results #'parts (without-docstring clauses)
                                        (if (stringp (first clauses)) 4 3))))
      (setf (map-things map) (remove-if-not #'recipe-p parts)
            (map-attribute-names map) (recipe-attribute-names (map-things map))
            (map-clauses map) (remove-if #'recipe-p parts)))))

(defun define-map (name width height &key cache (frame '(1 0 0 0)) clauses code
                                       (package *package*))
  "Define or redefine the map NAME. DEFMAP expands to a call of this function. FRAME is a value of
MAP-FRAME, CODE the value of a form made by COMPILED-CODE-FORM, and PACKAGE the package that the
author writes in. Return the map."
  (unless (typep cache '(or null string pathname))
    (reject-clause (definition-title "defmap" name) (list :cache cache) "the name of a file"))
  (check-map-memory (definition-title "defmap" name) width height)
  (let ((map (%make-map :name name :width width :height height
                        :cache (and cache (cache-path cache))
                        :frame frame :package (package-name (find-package package))))
        (*compiled-map-code* code))
    (fill-map map clauses)
    (build-map map)
    (warn-of-things-in-walls map)
    (register-map map)))

;;; The form.

(defun check-frame (definition frame)
  (unless (and (proper-list-p frame)
               (= 4 (length frame))
               (every #'sane-number-p frame)
               (< 1d-9 (first frame)))
    (reject-clause definition (list :frame frame)
                   "(:frame (size x y yaw)): four numbers from -1e9 to 1e9, the first positive")))

(defun check-map-head (definition name size)
  (check-name definition name "map")
  (unless (and (proper-list-p size) (<= 2 (length size))
               (typep (first size) '(integer 1 32767)) (typep (second size) '(integer 1 32767)))
    (reject-clause definition size
                   "(width height), integers from 1 to 32767, and perhaps :cache and :frame"))
  (check-options definition (cddr size) '(:cache :frame))
  (check-frame definition (getf (cddr size) :frame '(1 0 0 0))))

(defun map-forms (name size clauses)
  (check-map-head (definition-title "defmap" name) name size)
  (destructuring-bind (width height &key cache (frame '(1 0 0 0))) size
    (let ((map (%make-map :name name :width width :height height)))
      `((define-map ',name ,width ,height
          :cache ,cache :frame ',frame :clauses ',clauses
          :code ,(compiled-code-form (loop for clause in (without-docstring clauses)
                                           append (code-in-clause map clause)))
          :package ,(package-name *package*))))))

(public defmap)
(define-user-macro defmap (&whole form name &optional size &body clauses &environment environment)
  "Define the map NAME (manual 5.1), and a special variable bound to it. SIZE is (width height), in
cells of one metre, then options:
- :cache file -- keep the built grid in this file, relative to the file of the DEFMAP; not used
  while a place type has a :checker
- :frame (size x y yaw) -- an addition, see MAP-FRAME
A string before the clauses is the map's documentation (an addition). Clauses of the manual:
  (wall (x0 y0) (x1 y1) substance parameter [parameter1]) -- a line of walls
  (rect (x0 y0) (x1 y1) substance parameter [parameter1 parameter2 parameter3]) -- an outline
  (circle (x y) radius substance parameter) -- an outline
  (obj name (x y) descriptor contents...) -- a thing; contents: (name descriptor contents...)
Options may stand beside a thing's name: (name :prototype form) or, an addition, (name :kickers
(kicker...)). DEFINE-MAP-CLAUSE adds kinds of clauses. Later walls overwrite earlier walls. If NAME
is a symbol of Common Lisp or of the simulator, such as ROOM, there is no variable: write 'ROOM. A
redefinition applies to runs that start later; a live simulation of the old map stops. Signals
MALFORMED-DEFINITION, with restarts for the clause. Return the name."
  (expand-definition form environment
                     (lambda () (values (map-forms name size clauses) (defvar-forms name)))))

(define-facts (map map)
  "Size" (format nil "~D x ~D metres" (map-width map) (map-height map))
  "Walls of" (comma-separated (coerce (remove nil (map-substance-types map)) 'list))
  "Things to start with" (comma-separated (mapcar #'recipe-name (map-things map)))
  "Place types" (comma-separated (remove-duplicates
                                      (loop for number across (map-places map)
                                            unless (zerop number)
                                              collect (place-type-name
                                                       (aref (map-place-types map) number))))))
