;;;; defmap.lisp -- DEFMAP: from clauses to a map (manual 5.1).

(in-package :ars-magna.world)

;;; Clauses are checked when the form is expanded, what they evaluate (prototypes, sizes of
;;; things, kickers) when it is loaded; either signals MALFORMED-DEFINITION with the clause.

(defun build-map (map)
  "Fill the grid of MAP from its clauses, or from its cache if that holds them."
  (let* ((path (and (map-cache map) (cache-path (map-cache map))))
         (key (and path (cache-key map))))
    (unless (and path (restore-from-cache map path key))
      (draw-walls map)
      (classify-places map)
      (when path (write-cache map path key)))
    map))

(addition rebuild-map)
(defun rebuild-map (map)
  "Find the places of MAP (a map or its name) anew, by the place types that are defined now, and
rewrite its cache. Worlds of MAP see the change at once. Return the map."
  (let ((map (find-map map)))
    (classify-places map)
    (when (map-cache map)
      (write-cache map (cache-path (map-cache map)) (cache-key map)))
    map))

(defun define-map (name width height &key cache clauses things)
  "Define or redefine the map NAME; what DEFMAP expands to. CLAUSES are walls, rects and circles,
THINGS functions that return recipes. Return the map."
  (unless (typep cache '(or null string pathname))
    (reject-clause (format nil "defmap ~(~A~)" name) (list :cache cache) "the name of a file"))
  (register-map
   (build-map (%make-map :name name :width width :height height :clauses clauses :cache cache
                         :things (loop for thing in things collect (funcall thing))))))

;;; Things.

(defun clause-recipe (definition clause &rest arguments)
  "Return the recipe for CLAUSE; trouble is the definition's."
  (handler-case (apply #'write-recipe 'defmap arguments)
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
      (reject-clause definition clause ":kickers (name ...)"))))

(defun recipe-form (definition clause head descriptor contents &optional x y)
  "Return a form that makes the recipe of a thing."
  (check-head definition clause head)
  (unless (descriptor-p descriptor)
    (reject-clause definition clause
                   "an object descriptor ((attribute value) ...), each attribute once"))
  (destructuring-bind (name &key prototype kickers) (ensure-list head)
    `(clause-recipe ,definition ',clause ',name ',descriptor
                    :prototype ,prototype :kickers ',kickers :x ,x :y ,y
                    :contents (list ,@(loop for inside in contents
                                            collect (contents-form definition inside))))))

(defun contents-form (definition clause)
  (unless (and (proper-list-p clause) (<= 2 (length clause)))
    (reject-clause definition clause "contents: (name descriptor contents...)"))
  (destructuring-bind (head descriptor &rest contents) clause
    (recipe-form definition clause head descriptor contents)))

(defun object-form (definition clause width height)
  "Return a form that makes the recipe for CLAUSE, an obj."
  (unless (<= 4 (length clause))
    (reject-clause definition clause "(obj name (x y) descriptor contents...)"))
  (destructuring-bind (head position descriptor &rest contents) (rest clause)
    (unless (and (point-form-p position)
                 (<= 0 (first position)) (< (first position) width)
                 (<= 0 (second position)) (< (second position) height))
      (reject-clause definition clause
                     (format nil "a position (x y) in the map, from 0 to below ~D and ~D"
                             width height)))
    (recipe-form definition clause head descriptor contents
                 (first position) (second position))))

;;; The clauses.

(defun clause-kind (definition clause)
  "Return the kind of CLAUSE: :WALL, :RECT, :CIRCLE or :OBJ."
  (let ((kind (and (proper-list-p clause) (first clause))))
    (or (and kind (symbolp kind)
             (find kind '(:wall :rect :circle :obj) :test #'same-name-p))
        (reject-clause definition clause "a clause: wall, rect, circle or obj"))))

(defun check-grid-clause (definition clause kind)
  (if (eq kind :circle)
      (check-circle-clause definition clause)
      (check-wall-clause definition clause kind))
  clause)

(defun check-size (definition name size)
  "Return width, height and :cache form of the SIZE of a map."
  (unless (and name (symbolp name) (not (constantp name)))
    (reject-clause definition name "a symbol as the name of the map"))
  (unless (and (proper-list-p size) (<= 2 (length size))
               (typep (first size) '(integer 1 32767)) (typep (second size) '(integer 1 32767)))
    (reject-clause definition size "(width height), integers from 1 to 32767, and perhaps :cache"))
  (check-options definition (cddr size) '(:cache))
  (values (first size) (second size) (getf (cddr size) :cache)))

(public defmap)
(defmacro defmap (name size &body clauses)
  "Define the map NAME (manual 5.1), a special variable bound to it. SIZE is (width height), in
cells of a metre, and perhaps :cache with the name of a file to keep the built grid in. Clauses:
  (wall (x0 y0) (x1 y1) substance parameter [parameter1]) -- a line of walls
  (rect (x0 y0) (x1 y1) substance parameter [parameter1 parameter2 parameter3]) -- an outline
  (circle (x y) radius substance parameter) -- likewise
  (obj name (x y) descriptor contents...) -- a thing; contents: (name descriptor contents...)
Instead of a thing's name: (name :prototype form) and, ours, (name :kickers (kicker...)). Later
walls overwrite earlier ones. Redefinition makes a new map. Signals MALFORMED-DEFINITION. Return
the name."
  (let ((definition (format nil "defmap ~(~A~)" name)))
    (multiple-value-bind (width height cache) (check-size definition name size)
      (loop for clause in clauses
            for kind = (clause-kind definition clause)
            if (eq kind :obj)
              collect `(lambda () ,(object-form definition clause width height)) into things
            else
              collect (check-grid-clause definition clause kind) into walls
            finally (return
                      `(progn
                         (defvar ,name)
                         (setf (symbol-value ',name)
                               (define-map ',name ,width ,height
                                 :cache ,cache :clauses ',walls :things (list ,@things)))
                         ',name))))))
