;;;; residents.lisp -- the world that a name or map means, and finding things in it.

(in-package :ars-magna.world)

(export '(map-resident-world))

;;; A map has one resident world, made when first asked for: the one that top-level code works
;;; in. Headless simulations bind *WORLD* to their own worlds.

(defvar *residents-lock* (make-lock "resident worlds"))

(defun map-resident-world (map)
  "Return the resident world of MAP, where top-level code works. The first call makes this world."
  (or (map-resident map)
      (with-lock (*residents-lock*)
        (or (map-resident map)
            (setf (map-resident map) (make-world map))))))

(addition current-world)
(defun current-world (map)
  "Return the world of MAP (a map or its name) that code works in now: *WORLD* if it is a world of
MAP, else the resident world of MAP. If MAP is a world, return MAP."
  (if (world-p map)
      map
      (let ((map (find-map map)))
        (if (and *world* (eq map (world-map *world*)))
            *world*
            (map-resident-world map)))))

;;; Finding.

(defun worlds-to-search (world)
  "Return a list of the worlds to search: WORLD, else *WORLD*, else all maps' resident worlds."
  (cond (world (list (current-world world)))
        (*world* (list *world*))
        (t (mapcar #'map-resident-world (registry-objects *maps*)))))

(defun thing-named-p (thing name)
  "True if NAME denotes THING: NAME is the name of THING, a symbol or string, with or without
#serial, or its serial number."
  (if (integerp name)
      (= name (thing-serial thing))
      (or (same-name-p name (thing-name thing))
          (string-equal name (princ-to-string thing)))))

(addition find-things)
(defun find-things (name &optional world)
  "Return the things named NAME (a symbol or string, perhaps \"PEN#2\", or a serial number) in
WORLD, in order of creation. WORLD may be a map. By default, search the world of the current
simulation or, without one, the resident worlds of all maps. Signals WRONG-ARGUMENT."
  (check-argument find-things name (typep name '(or symbol string integer))
                  "a symbol, a string such as \"PEN#2\", or a serial number")
  (loop for each in (worlds-to-search world)
        append (loop for rank below (world-rank-count each)
                     for thing = (thing-of-rank rank each)
                     when (and thing (not (robot-body-p thing)) (thing-named-p thing name))
                       collect thing)))

;;; An unknown name may be a misspelling. Names that differ only in their digits, or in the number
;;; of a thing, such as "PEN#2", are names of several things.

(defun misspelt-thing-name-p (name other)
  (flet ((without-digits (name)
           (remove-if (lambda (char) (or (digit-char-p char) (char= char #\#))) (string name))))
    (and (misspelling-p name other)
         (not (string-equal (without-digits name) (without-digits other))))))

(defun similar-thing-name (name world)
  "Return the name of a thing in WORLD that NAME probably misspells, or NIL. A name that a thing of
the map had at first is no misspelling."
  (unless (find-recipe-if (lambda (recipe) (same-name-p name (recipe-name recipe)))
                          (map-things (world-map world)))
    (do-things (thing world)
      (when (misspelt-thing-name-p name (thing-name thing))
        (return-from similar-thing-name (thing-name thing))))))

;; Looking through all things takes time, so it is done only for the first request of each name.
(defun warn-of-unknown-thing (name world)
  "Warn if NAME, which no thing in WORLD has, is probably a misspelling of a thing's name."
  (let ((like (and (first-warning-for-key-p (list :thing name) world)
                   (similar-thing-name name world))))
    (when like
      (warn-once (list :thing-like name) world
                 (format nil "No thing here is called ~(~A~). Did you mean ~(~A~)?" name like)))))

(defun missed-name-text ()
  "Return a text about the last name that FIND-THING looked for in vain in the current world, with a
similar name if there is one. Return NIL if there was no such name."
  (let* ((noted (and *world* (world-noted-names *world*)))
         (name (second (find-if (lambda (key) (typep key '(cons (eql :thing)))) noted))))
    (and name (format nil "nothing here is called ~(~A~)~@[; did you mean ~(~A~)?~]"
                      name (similar-thing-name name *world*)))))

(addition find-thing)
(defun find-thing (name &optional world)
  "Return the first thing that FIND-THINGS finds with the same arguments, or NIL. Warn once in a run
if NAME is unknown and resembles the name of a thing."
  (let ((things (find-things name world)))
    (when (and (null things) (typep name '(or (and symbol (not null)) string)))
      (dolist (each (worlds-to-search world)) (warn-of-unknown-thing name each)))
    (first things)))

(defun not-a-thing-text (value)
  "Return an explanation of how to refer to a thing, for a caller who passed VALUE instead."
  (format nil "such as the value of (find-thing '~:[NAME~;~:*~(~A~)~])~:[~;, but this value is NIL ~
               if nothing is called NAME~@[: ~A~]~]"
          (and value (symbolp value) (not (keywordp value)) value)
          (null value)
          (missed-name-text)))

(define-argument-type 'thing #'thing-p "a thing" #'not-a-thing-text)
