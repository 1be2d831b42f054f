;;;; defmap.lisp -- DEFMAP: from clauses to a map (manual 5.1).

(in-package :ars-magna.world)

;;; Clauses are checked when the form is expanded, what they evaluate (prototypes, sizes of
;;; things, kickers) when it is loaded; either signals MALFORMED-DEFINITION with the clause.

(defun find-places (map path key)
  "Find the places of MAP anew and keep it in the file PATH, if that is one and all code of place
types worked."
  (let ((whole (nth-value 1 (classify-places map))))
    (when (and path whole) (write-cache map path key))))

(defun build-map (map)
  "Fill the grid of MAP from its clauses, or from its cache if that holds them."
  (let* ((path (usable-cache-path map))
         (key (and path (cache-key map))))
    (unless (and path (restore-from-cache map path key))
      (draw-walls map)
      (find-places map path key))
    map))

(addition rebuild-map)
(defun rebuild-map (map)
  "Find the places of MAP (a map or its name) anew, by the place types that are defined now, and
rewrite its cache. Worlds of MAP see the change at once. Return the map."
  (let* ((map (find-map map)) (path (usable-cache-path map)))
    (find-places map path (and path (cache-key map)))
    map))

(defun define-map (name width height &key cache (frame '(1 0 0 0)) clauses things
                                       (package *package*))
  "Define or redefine the map NAME; what DEFMAP expands to. FRAME is as MAP-FRAME says. CLAUSES are
walls, rects and circles; THINGS is a list of recipes, and of NIL for those that are left out.
PACKAGE is the one that the author writes in. Return the map."
  (unless (typep cache '(or null string pathname))
    (reject-clause (format nil "defmap ~(~A~)" name) (list :cache cache) "the name of a file"))
  (check-room (format nil "defmap ~(~A~)" name) width height)
  (let* ((recipes (remove nil things))
         (map (build-map
               (%make-map :name name :width width :height height :clauses clauses
                          :cache (and cache (cache-path cache))
                          :frame frame :package (package-name (find-package package))
                          :things recipes
                          :attribute-names (attribute-names recipes)))))
    (warn-of-outside map)
    (warn-of-things-in-walls map)
    (register-map map)))

;;; What is doubtful.

(defun outside-p (map point)
  (destructuring-bind (x y) point
    (not (and (<= 0 x (map-width map)) (<= 0 y (map-height map))))))

(defun clause-outside-p (map clause)
  "True if CLAUSE, a wall, rect or circle, goes beyond MAP."
  (destructuring-bind (kind start end &rest others) clause
    (declare (ignore others))
    (if (same-name-p kind "CIRCLE")
        (destructuring-bind (x y) start
          (or (outside-p map (list (- x end) (- y end)))
              (outside-p map (list (+ x end) (+ y end)))))
        (or (outside-p map start) (outside-p map end)))))

(defun warn-of-outside (map)
  (dolist (clause (map-clauses map))
    (when (clause-outside-p map clause)
      (warn-of-definition "defmap ~(~A~)~@[ (~A)~]: ~S goes beyond the map, which is ~D by ~D ~
                           metres; what is outside is pressed against its edge."
                          (map-name map) (clause-place clause) clause
                          (map-width map) (map-height map)))))

(defun warn-of-things-in-walls (map)
  (dolist (recipe (map-things map))
    (let ((x (recipe-x recipe)) (y (recipe-y recipe)) (name (recipe-name recipe)))
      (when (wall-at-p map x y)
        (warn-of-definition "defmap ~(~A~)~@[ (~A)~]: ~(~A~) at ~A is inside a wall, where ~
                             robots may not see or reach it."
                            (map-name map) (clause-place name) name (point-in-text x y))))))

;;; Things.

(defun clause-recipe (definition clause name descriptor &rest options)
  "Return the recipe for CLAUSE; trouble is the definition's."
  (warn-of-slips definition name descriptor :map-p t)
  (handler-case (apply #'write-recipe 'defmap name descriptor options)
    ((or wrong-argument unknown-name) (condition)
      (reject-clause definition clause
                     (format nil "a thing that can be made (~A)"
                             (string-right-trim "." (princ-to-string condition)))))))

(defun check-head (definition clause head)
  "Signal unless HEAD is a name or (name [:prototype form] [:kickers (name...)])."
  (let ((head (if (consp head) head (list head))))
    (unless (and (proper-list-p head) (first head) (symbolp (first head)))
      (reject-clause definition clause "a name, or (name :prototype thing)"))
    (check-options definition (rest head) '(:prototype :kickers))
    (unless (and (proper-list-p (getf (rest head) :kickers))
                 (every #'symbolp (getf (rest head) :kickers)))
      (reject-clause definition clause ":kickers (name ...), names in a list"))))

;;; A clause of a thing is data. Its author's code in it, prototypes and the lambdas of draw
;;; functions, is compiled beside it: in a list of (key function), each once. A key is (name form),
;;; with the name of a thing that is drawn. A clause that the user chose instead has none there.

(defvar *code* '() "The compiled code of the map that is being defined.")

(defun code-p (key value)
  "True if VALUE, of the attribute KEY, has code that is to be evaluated."
  (and (consp value) (same-name-p key :draw-function)))

(defun code-in-thing (head descriptor contents)
  "Return a list of (key form) for the code in the parts of a thing's clause."
  (destructuring-bind (name &key prototype &allow-other-keys) (ensure-list head)
    (append (and prototype (list (list (list nil prototype) prototype)))
            (loop for (key value) in descriptor
                  when (code-p key value)
                    collect (list (list name value) (draw-function-form name value)))
            (loop for (head descriptor . contents) in contents
                  append (code-in-thing head descriptor contents)))))

(defun code-form (objects)
  "Return a form that makes the list of the code in the clauses OBJECTS."
  (let ((code (loop for (head nil descriptor . contents) in (mapcar #'rest objects)
                    append (code-in-thing head descriptor contents))))
    `(list ,@(loop for (key form) in (remove-duplicates code :key #'first :test #'equal)
                   collect `(list ',key (lambda () ,form))))))

(defun code-value (name source form)
  "Return the value of SOURCE, code of the thing called NAME or NIL, which FORM, evaluated, has."
  (let ((compiled (second (find (list name source) *code* :key #'first :test #'equal))))
    (if compiled (funcall compiled) (eval form))))

(defun descriptor-value (name descriptor)
  "Return DESCRIPTOR, of the thing called NAME, with the values of the code in it."
  (loop for (key value) in descriptor
        collect (list key (if (code-p key value)
                              (code-value name value (draw-function-form name value))
                              value))))

(defun recipe-of-thing (definition clause path head descriptor contents &optional x y)
  "Return the recipe of the thing in CLAUSE at PATH, which has been checked and ends in CONTENTS."
  (destructuring-bind (name &key prototype kickers) (ensure-list head)
    (flet ((value () (code-value nil prototype prototype)))
      (clause-recipe definition clause name (descriptor-value name descriptor)
                     :prototype (and prototype
                                     (call-for-value #'value definition clause
                                                     "a prototype: a form whose value is a thing"))
                     :kickers kickers :x x :y y
                     :contents (loop for inside in contents
                                     for position from (- (length clause) (length contents))
                                     for recipe = (recipe-for 'content definition inside
                                                              (append path (list position)))
                                     when recipe collect recipe)))))

(defun recipe-of (kind definition clause path)
  "Return the recipe of CLAUSE at PATH, of KIND OBJECT or CONTENT."
  (if (eq kind 'object)
      (destructuring-bind (head (x y) descriptor &rest contents) (rest clause)
        (recipe-of-thing definition clause path head descriptor contents x y))
      (destructuring-bind (head descriptor &rest contents) clause
        (recipe-of-thing definition clause path head descriptor contents))))

(defun recipe-for (kind definition clause path &rest size)
  "Return the recipe of CLAUSE, which has been checked, or of another that the user puts in its
place if that signals; NIL if it is left out. The rest are as for RECIPE-OF and CHECKED-THING."
  (call-with-clause (lambda (chosen)
                      (recipe-of kind definition
                                 (if (eq chosen clause)
                                     clause
                                     (apply #'checked-thing kind definition chosen path size))
                                 path))
                    clause path))

(defun recipes-for (definition objects width height code)
  "Return the recipes for OBJECTS, a list of (position clause) in DEFINITION of a map of WIDTH by
HEIGHT. CODE is as CODE-FORM makes it."
  (let ((*code* code))
    (loop for (position clause) in objects
          collect (recipe-for 'object definition clause (list position) width height))))

;;; Checking clauses of things.

(defun check-thing-parts (definition clause head descriptor)
  (check-head definition clause head)
  (unless (descriptor-p descriptor)
    (reject-clause definition clause
                   "an object descriptor ((attribute value) ...), each attribute once")))

(defun with-checked-contents (definition clause contents path)
  "Return CLAUSE at PATH, which ends in CONTENTS, with those that the user puts in their place."
  (let* ((first (- (length clause) (length contents)))
         (checked (loop for inside in contents
                        for position from first
                        collect (call-checked 'content definition inside
                                              (append path (list position))))))
    (if (every #'eq contents checked)
        clause
        (append (subseq clause 0 first) (remove nil checked)))))

(defun checked-content (definition clause path)
  (when (keywordp (if (consp clause) (first clause) clause))
    (reject-clause definition clause
                   (format nil "contents: (name descriptor contents...); options stand beside ~
                                the name, as in (obj (ball :kickers (sway)) ...)")))
  (unless (and (proper-list-p clause) (<= 2 (length clause)))
    (reject-clause definition clause "contents: (name descriptor contents...)"))
  (destructuring-bind (head descriptor &rest contents) clause
    (check-thing-parts definition clause head descriptor)
    (with-checked-contents definition clause contents path)))

(defun checked-object (definition clause path width height)
  (unless (and (eq :obj (clause-kind definition clause)) (<= 4 (length clause)))
    (reject-clause definition clause "(obj name (x y) descriptor contents...)"))
  (destructuring-bind (head position descriptor &rest contents) (rest clause)
    (unless (and (number-pair-p position)
                 (<= 0 (first position)) (< (first position) width)
                 (<= 0 (second position)) (< (second position) height))
      (reject-clause definition clause
                     (format nil "a position (x y) in the map, from 0 to below ~D and ~D"
                             width height)))
    (check-thing-parts definition clause head descriptor)
    (with-checked-contents definition clause contents path)))

(defun checked-thing (kind definition clause path &rest size)
  "Return CLAUSE at PATH, of KIND OBJECT, in a map of that SIZE, or CONTENT, with contents that are
right. Signals MALFORMED-DEFINITION."
  (if (eq kind 'object)
      (apply #'checked-object definition clause path size)
      (checked-content definition clause path)))

(defun call-checked (kind definition clause path &rest size)
  "Return what CHECKED-THING does of CLAUSE, or of another that the user puts in its place; NIL if
it is left out."
  (call-with-clause (lambda (clause)
                      (apply #'checked-thing kind definition clause path size))
                    clause path))

;;; The clauses.

(defun clause-kind (definition clause)
  "Return the kind of CLAUSE: :WALL, :RECT, :CIRCLE or :OBJ."
  (let* ((name (and (consp clause) (first clause)))
         (kind (and name (symbolp name)
                    (find name '(:wall :rect :circle :obj) :test #'same-name-p))))
    (cond ((null kind) (reject-clause definition clause "a clause: wall, rect, circle or obj"))
          ((proper-list-p clause) kind)
          (t (reject-clause definition clause
                            "a clause without a dot before its last element")))))

(defun warn-of-substance (definition clause)
  "Warn if the substance of CLAUSE may be a slip for one that is defined."
  (let* ((name (clause-substance clause))
         (like (unless (find-substance name nil)
                 (find-if (lambda (other) (resembles-p name other))
                          (defined-names *substances*)))))
    (when like
      (warn-of-definition "~A~@[ (~A)~]: the substance ~(~A~) is not defined; did you mean ~(~A~)?"
                          definition (clause-place clause) name like))))

(defun check-grid-clause (definition clause kind)
  (if (eq kind :circle)
      (check-circle-clause definition clause)
      (check-wall-clause definition clause kind))
  (warn-of-substance definition clause)
  clause)

(defun frame-p (form)
  "True if FORM can be the frame of a map: (size x y yaw)."
  (and (proper-list-p form)
       (= 4 (length form))
       (every #'within-reason-p form)
       (< 1d-9 (first form))))

(defun check-frame (definition frame)
  "Signal MALFORMED-DEFINITION unless FRAME, the value of :frame, can be the frame of a map."
  (unless (frame-p frame)
    (reject-clause definition (list :frame frame)
                   "(:frame (size x y yaw)): four numbers from -1e9 to 1e9, the first positive")))

(defun check-size (definition name size)
  "Return width and height of the SIZE of a map, and the plist of its options."
  (check-name definition name "map")
  (unless (and (proper-list-p size) (<= 2 (length size))
               (typep (first size) '(integer 1 32767)) (typep (second size) '(integer 1 32767)))
    (reject-clause definition size
                   "(width height), integers from 1 to 32767, and perhaps :cache and :frame"))
  (check-options definition (cddr size) '(:cache :frame))
  (check-frame definition (getf (cddr size) :frame '(1 0 0 0)))
  (values (first size) (second size) (cddr size)))

(defun option-forms (options)
  "Return the arguments for DEFINE-MAP that OPTIONS, of the size of a map, stand for."
  (loop for (key value) on options by #'cddr
        collect key
        collect (if (eq key :frame) `',value value)))

(defun parse-clause (definition clause path width height)
  "Return a list (kind clause) for CLAUSE, at PATH of DEFINITION, when it is right. NIL if it is to
be left out."
  (call-with-clause (lambda (clause)
                      (let ((kind (clause-kind definition clause)))
                        (list kind
                              (if (eq kind :obj)
                                  (checked-object definition clause path width height)
                                  (check-grid-clause definition clause kind)))))
                    clause path))

(defun map-forms (name size clauses)
  "Return the forms that DEFMAP expands to."
  (let ((definition (title "defmap" name)))
    (multiple-value-bind (width height options) (check-size definition name size)
      (loop for clause in clauses
            for position from 3
            for (kind chosen) = (unless (and (stringp clause) (= position 3))
                                  (parse-clause definition clause (list position) width height))
            if (eq kind :obj) collect (list position chosen) into objects
            else if kind collect chosen into walls
            finally (return
                      `((define-map ',name ,width ,height
                          ,@(option-forms options) :clauses ',walls
                          :things (recipes-for ,definition ',objects ,width ,height
                                               ,(code-form (mapcar #'second objects)))
                          :package ,(package-name *package*))))))))

(public defmap)
(define-user-macro defmap (&whole form name &optional size &body clauses &environment environment)
  "Define the map NAME (manual 5.1), a special variable bound to it. SIZE is (width height), in
cells of a metre, and perhaps :cache with the name of a file to keep the built grid in, unless a
place type has a :checker; it is looked for from the directory of the file in which DEFMAP stands.
Ours is :frame with a list (size x y yaw), as MAP-FRAME says, and a
string before the clauses, the map's documentation. Clauses:
  (wall (x0 y0) (x1 y1) substance parameter [parameter1]) -- a line of walls
  (rect (x0 y0) (x1 y1) substance parameter [parameter1 parameter2 parameter3]) -- an outline
  (circle (x y) radius substance parameter) -- likewise
  (obj name (x y) descriptor contents...) -- a thing; contents: (name descriptor contents...)
Instead of a thing's name: (name :prototype form) and, ours, (name :kickers (kicker...)). Later
walls overwrite earlier ones. A map called by a symbol of Common Lisp's, such as ROOM, or ours has
no variable: write 'ROOM. Redefinition makes a new map, for what is started from then on; a live
simulation of the old one stops. Signals MALFORMED-DEFINITION, with restarts for the clause.
Return the name."
  (expand-definition form environment
                     (lambda () (values (map-forms name size clauses) (variable-forms name)))))
