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
               (%make-map :name name :width width :height height :clauses clauses :cache cache
                          :frame frame :package (package-name (find-package package))
                          :things recipes
                          :attribute-names (attribute-names recipes)))))
    (warn-of-outside map)
    (warn-of-things-in-walls map)
    (register-map map)))

(defun recipe-for-clause (function clause path compiler)
  "Return what FUNCTION, compiled for CLAUSE at PATH of the definition, returns: a recipe. If that
signals, the user may replace the clause by another, of which COMPILER makes a form."
  (call-with-clause (lambda (chosen)
                      (if (eq chosen clause)
                          (funcall function)
                          (eval (funcall compiler chosen))))
                    clause path))

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

(defun prototype-form (definition clause prototype)
  "Return a form for the value of the form PROTOTYPE, which stands in CLAUSE (reading 59)."
  (and prototype
       `(call-for-value (lambda () ,prototype) ,definition ',clause
                        "a prototype: a form whose value is a thing")))

(defun recipe-form (definition clause path head descriptor contents &optional x y)
  "Return a form that makes the recipe of a thing, from CLAUSE at PATH, which ends in CONTENTS."
  (check-head definition clause head)
  (unless (descriptor-p descriptor)
    (reject-clause definition clause
                   "an object descriptor ((attribute value) ...), each attribute once"))
  (destructuring-bind (name &key prototype kickers) (ensure-list head)
    (let ((first (- (length clause) (length contents))))
      `(clause-recipe ,definition ',clause ',name ,(descriptor-form name descriptor)
                      :prototype ,(prototype-form definition clause prototype)
                      :kickers ',kickers :x ,x :y ,y
                      :contents (remove nil (list ,@(contents-forms definition contents path
                                                                    first)))))))

(defun contents-forms (definition clauses path first)
  "Return forms that make the recipes for CLAUSES, which begin at the position FIRST of what is at
PATH."
  (loop for clause in clauses
        for position from first
        collect (thing-form definition clause (append path (list position)) 'contents-form)))

(defun contents-form (definition clause path)
  (when (keywordp (if (consp clause) (first clause) clause))
    (reject-clause definition clause
                   (format nil "contents: (name descriptor contents...); options stand beside ~
                                the name, as in (obj (ball :kickers (sway)) ...)")))
  (unless (and (proper-list-p clause) (<= 2 (length clause)))
    (reject-clause definition clause "contents: (name descriptor contents...)"))
  (destructuring-bind (head descriptor &rest contents) clause
    (recipe-form definition clause path head descriptor contents)))

(defun object-form (definition clause path width height)
  "Return a form that makes the recipe for CLAUSE, an obj, at PATH."
  (unless (and (eq :obj (clause-kind definition clause)) (<= 4 (length clause)))
    (reject-clause definition clause "(obj name (x y) descriptor contents...)"))
  (destructuring-bind (head position descriptor &rest contents) (rest clause)
    (unless (and (number-pair-p position)
                 (<= 0 (first position)) (< (first position) width)
                 (<= 0 (second position)) (< (second position) height))
      (reject-clause definition clause
                     (format nil "a position (x y) in the map, from 0 to below ~D and ~D"
                             width height)))
    (recipe-form definition clause path head descriptor contents
                 (first position) (second position))))

(defun thing-form (definition clause path compiler &rest arguments)
  "Return a form for the recipe of CLAUSE at PATH, which COMPILER, the name of a function of these
and of ARGUMENTS, makes. The user may replace the clause, now and when the form is evaluated."
  (call-with-clause (lambda (clause)
                      `(recipe-for-clause
                        (lambda () ,(apply compiler definition clause path arguments))
                        ',clause ',path
                        (lambda (clause) (,compiler ,definition clause ',path ,@arguments))))
                    clause path))

;;; The clauses.

(defun clause-kind (definition clause)
  "Return the kind of CLAUSE: :WALL, :RECT, :CIRCLE or :OBJ."
  (let ((kind (and (proper-list-p clause) (first clause))))
    (or (and kind (symbolp kind)
             (find kind '(:wall :rect :circle :obj) :test #'same-name-p))
        (reject-clause definition clause "a clause: wall, rect, circle or obj"))))

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
  "Return a list (kind form) for CLAUSE, at PATH of DEFINITION: of a thing, the form that makes its
recipe, of anything else the clause itself. NIL if it is to be left out."
  (call-with-clause (lambda (clause)
                      (let ((kind (clause-kind definition clause)))
                        (list kind
                              (if (eq kind :obj)
                                  (thing-form definition clause path 'object-form width height)
                                  (check-grid-clause definition clause kind)))))
                    clause path))

(defun map-forms (name size clauses)
  "Return the forms that DEFMAP expands to."
  (let ((definition (title "defmap" name)))
    (multiple-value-bind (width height options) (check-size definition name size)
      (loop for clause in clauses
            for position from 3
            for (kind form) = (unless (and (stringp clause) (= position 3))
                                (parse-clause definition clause (list position) width height))
            if (eq kind :obj) collect form into things
            else if kind collect form into walls
            finally (return
                      `((define-map ',name ,width ,height
                          ,@(option-forms options) :clauses ',walls :things (list ,@things)
                          :package ,(package-name *package*))))))))

(public defmap)
(define-user-macro defmap (&whole form name &optional size &body clauses &environment environment)
  "Define the map NAME (manual 5.1), a special variable bound to it. SIZE is (width height), in
cells of a metre, and perhaps :cache with the name of a file to keep the built grid in, unless a
place type has a :checker. Ours is :frame with a list (size x y yaw), as MAP-FRAME says, and a
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
