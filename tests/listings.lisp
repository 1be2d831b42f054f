;;;; listings.lisp -- the manual's listings work as printed; how they are run (manual 5).

(in-package :ars-magna.tests)

(def-suite* listings :in ars-magna)

;;; The listings are not part of the project. They are read from the directory ARS_MAGNA_LISTINGS,
;;; or from beside the project. Without them each test is skipped, with a message. A program is
;;; loaded from its file into a package of its own. A fragment is read and evaluated with its
;;; variables bound. Neither is changed. Each file begins with its known errors; tests that depend
;;; on one say so.

(defun listings-directory ()
  "Return the directory of the manual's listings, or NIL if it is not here."
  (let ((directory (or (uiop:getenvp "ARS_MAGNA_LISTINGS")
                       (merge-pathnames "../shared/manual/listings/" (project-file "")))))
    (uiop:directory-exists-p (uiop:ensure-directory-pathname directory))))

(defparameter *programs*
  '("5-3-box" "5-1-big-room" "5-1-1-doorway" "5-1-1-convex" "5-2-robbie" "5-4-color" "5-4-size"
    "5-5-lock" "d1-scan-for-object" "d2-rpl-scan-for-object" "d3-go-to-object"
    "d4-rpl-go-to-object" "d5-grab-object" "d6-rpl-grab-object" "d7-rpl-put-down-object"
    "d8-with-odometric-return" "d9-get-object-and-return")
  "The listings that are definitions, in the manual's order; but the big room needs box* of 5.3.")

(defparameter *fragments*
  '("3-1-3-documentation-example" "3-3-descriptor-red-box" "3-3-descriptor-blue-column"
    "3-4-2-attribute-specifications" "5-5-2-manipulate" "5-5-2-run-manipulation" "a-running"
    "b1-graphics" "c-fluent-vectors")
  "The other listings.")

(defun listing-file (name)
  (merge-pathnames (concatenate 'string name ".lisp") (listings-directory)))

;;; Their package.

(defvar *home* nil "The package that the listings at hand are loaded into.")

(defun own (name)
  "Return the symbol called NAME, a string or symbol, of the listings."
  (intern (string name) *home*))

(defun call-own (name &rest arguments)
  "Call the listings' function called NAME."
  (apply (own name) arguments))

(defun make-home ()
  "Return a new package for listings. What they take from elsewhere is in ARS-WORLDS."
  ;; Not from here, where NISP is the nickname of a layer.
  (let ((*package* (find-package :ars-user)))
    (eval '(ars:define-user-package :ars-test-listings
            (:import-from :ars-worlds #:watson #:table*)))))

(defun call-at-home (function)
  "Call FUNCTION while a package for listings is current, and the readtable is Nisp's."
  (let ((*home* (make-home)))
    (unwind-protect
         (let ((*package* *home*)
               (*readtable* (named-readtables:find-readtable :nisp))
               (*error-output* (make-broadcast-stream)))
           (funcall function))
      (delete-package *home*))))

(defun call-in-home-directory (function directory)
  "Call FUNCTION while ~ means DIRECTORY, which is new, and deleted afterwards."
  (let ((old (uiop:getenv "HOME")))
    (ensure-directories-exist directory)
    (setf (uiop:getenv "HOME") (uiop:native-namestring directory))
    (unwind-protect (funcall function)
      (setf (uiop:getenv "HOME") (or old ""))
      (uiop:delete-directory-tree directory :validate t))))

(defun call-with-home-directory (function)
  "Call FUNCTION while ~ means an empty directory."
  (uiop:with-temporary-file (:pathname file)
    (call-in-home-directory function (uiop:ensure-directory-pathname
                                      (format nil "~A-home" (uiop:native-namestring file))))))

;;; Loading and reading.

(defun load-listing (name)
  (load (listing-file name)))

(defun load-quietly (name)
  (warnings-of (lambda () (load-listing name))))

(defun listing-forms (name)
  "Return the forms of the listing called NAME."
  (with-open-file (in (listing-file name) :external-format :utf-8)
    (loop for form = (read in nil in) until (eq form in) collect form)))

(defun listing-function (name &rest parameters)
  "Return a function of PARAMETERS, names of variables, that does what the fragment NAME says."
  (compile nil `(lambda ,(mapcar #'own parameters) ,@(listing-forms name))))

(defun call-with-listings (names function)
  "Call FUNCTION where the listings NAMES have been loaded; skip it without them."
  (if (listings-directory)
      (with-own-definitions
        (call-with-home-directory
         (lambda ()
           (call-at-home
            (lambda ()
              (mapc #'load-quietly names)
              (funcall function))))))
      (skip "The manual's listings are not here: ARS_MAGNA_LISTINGS names no directory, and there ~
             is no ../shared/manual/listings/.")))

(defmacro with-listings ((&rest names) &body body)
  "Run BODY where the listings NAMES, forms, have been loaded; skip it if they are not here."
  `(call-with-listings (list ,@names) (lambda () ,@body)))

(defmacro with-all-listings (() &body body)
  "Run BODY where all definitions of the manual have been loaded, in order."
  `(call-with-listings *programs* (lambda () ,@body)))

;;; All of them.

(test listings.are-all-tested
  (with-listings ()
    (is (null (set-exclusive-or
               (loop for path in (directory (merge-pathnames "*.lisp" (listings-directory)))
                     collect (pathname-name path))
               (append *programs* *fragments*)
               :test #'string=)))))

(defun warning-of (name)
  "Load the listing NAME; return the one warning about definitions that this makes, or NIL."
  (let ((texts (warnings-of (lambda () (load-listing name)))))
    (is (null (rest texts)))
    (first texts)))

(test listings.load-in-order
  "Warnings say what is replaced, and that the manual's big box stands in the wall of its big room."
  (with-listings ()
    (flet ((words-for (name)
             (cond ((string= name "5-1-big-room") '("big-box" "inside a wall"))
                   ;; ARS-WORLDS has a robot of that name, too: of its own.
                   ((string= name "5-2-robbie") '())
                   ((string= name "5-5-lock") '("lock" "methods from" "worlds/manipulations"))
                   ((find (char name 0) "5") '("is redefined" "5-")))))
      (dolist (name *programs*)
        (let ((text (warning-of name))
              (words (unless (string= name "5-3-box") (words-for name))))
          (is (if words
                  (and text (apply #'has-words-p text words))
                  (null text))
              "~A: ~A" name text))))
    (is (null (message-texts)))))

(defun all-definitions ()
  (mapcar #'definitions::registry-entries definitions::*registries*))

(test listings.leave-nothing-behind
  (let ((kept (all-definitions)))
    (with-all-listings ()
      (is (eq *home* (symbol-package (robot:robot-name (robot:find-robot "ROBBIE"))))))
    (when (listings-directory)
      (is (equal kept (all-definitions)))
      (is (null (find-package :ars-test-listings)))
      (is (eq ars-worlds:robbie (robot:find-robot "ROBBIE"))))))

;;; 5.1: a map.

(defun parameters-of-cells (map &rest cells)
  "Return the substance parameters of CELLS, lists (x y), of MAP."
  (loop for (x y) in cells collect (parameter-at map x y)))

(defun big-room () (world:find-map "BIG-ROOM"))

(test big-room.has-its-walls
  "Its corners (75 75) lie one beyond the last cells: these are the walls."
  (with-listings ("5-3-box" "5-1-big-room")
    (let ((map (big-room)))
      (is (= 75 (world:map-width map) (world:map-height map)))
      (is (= (+ (* 4 74) 41) (count 1 (world:map-flags map))))
      (is (loop for i below 75
                always (and (world:wall-at-p map i 0) (world:wall-at-p map i 74)
                            (world:wall-at-p map 0 i) (world:wall-at-p map 74 i))))
      (is (loop for y from 1 below 74
                always (eq (<= 10 y 50) (world:wall-at-p map 30 y))))
      (is (base:same-name-p 'bricks (substance-at map 0 40)))
      (is (base:same-name-p 'slate (substance-at map 30 40))))))

(test big-room.interpolates-its-parameters
  (with-listings ("5-3-box" "5-1-big-room")
    (flet ((parameters (&rest cells) (apply #'parameters-of-cells (big-room) cells)))
      (is (equalp '(0 10 30 25) (parameters '(0 0) '(74 0) '(74 74) '(0 74))))
      (is (equalp '(5 20 27.5 12.5) (parameters '(37 0) '(74 37) '(37 74) '(0 37))))
      (is (equalp '(10 15 20 25 30)
                  (parameters '(30 10) '(30 20) '(30 30) '(30 40) '(30 50)))))))

(defun described-things (world)
  "Return for each thing of WORLD its name with number, position, and attributes."
  (loop for thing in (world:world-thing-list world)
        collect (list (princ-to-string thing)
                      (multiple-value-list (world:thing-position thing))
                      (world:thing-attributes thing))))

(defparameter *big-room-things*
  '(("LAMP#1" (20 20) ((:size 2) (:weight 1) (:color lightred) (:substance metal)))
    ("PEN#2" (20 20) ((:size .2) (:color green)))
    ("SMALL-BOX#3" (20 20) ((:capacity 5) (:size 5) (:weight 2) (:color lightblue)
                            (:substance wood)))
    ("A-BOX#4" (30 20) ((:capacity 8) (:size 6) (:weight 3) (:color blue) (:substance wood)))
    ("BIG-BOX#5" (30 20) ((:capacity 11) (:obsview t) (:size 12) (:weight 4) (:color red)
                          (:substance wood)))
    ("TABLE#6" (40 15) ((:obsmove t) (:size 30) (:weight 20) (:color violet) (:substance wood))))
  "The things of 5.1 with the numbers that the session of appendix E shows, where box* is that of
5.3: what a prototype says holds unless the thing says otherwise.")

(test big-room.has-its-things
  (with-listings ("5-3-box" "5-1-big-room" "5-2-robbie")
    (let ((world (world:map-resident-world (big-room))))
      (flet ((contents (name)
               (mapcar #'princ-to-string
                       (world:thing-contents (world:find-thing name world)))))
        (is (base:value-equal *big-room-things* (described-things world)))
        (is (equal '("PEN#2") (contents 'small-box)))
        (is (equal '("A-BOX#4") (contents 'big-box)))
        (is (null (contents 'lamp)))))))

(defun cache-of-big-room ()
  (probe-file (merge-pathnames "cache/big-room" (user-homedir-pathname))))

(defun spoil-walls (map)
  "Let the cache of MAP have another parameter for its first wall. Return that parameter."
  (setf (aref (world:map-parameters map) 0) 99d0)
  (world::write-cache map (cache-of-big-room) (world::cache-key map))
  99d0)

(test big-room.is-cached
  "The file is made in the home directory, and what it says is taken the next time."
  (with-listings ("5-3-box")
    (is (null (cache-of-big-room)))
    (load-quietly "5-1-big-room")
    (is-true (cache-of-big-room))
    (let ((built (grid-of (big-room))))
      (load-quietly "5-1-big-room")
      (is (equalp built (grid-of (big-room))))
      (let ((parameter (spoil-walls (big-room))))
        (load-quietly "5-1-big-room")
        (is (= parameter (parameter-at (big-room) 0 0)) "the cache was used")))
    ;; Other place types: the cache is stale.
    (load-quietly "5-1-1-doorway")
    (base:take-messages)
    (load-quietly "5-1-big-room")
    (is (search "is stale" (first (message-texts))))
    (is (= 0 (parameter-at (big-room) 0 0)) "the walls were built anew")))

;;; 5.2 and 5.3: a robot, a prototype.

(defun parts-of (robot)
  "Return what ROBOT has: cameras as (field-of-view resolution), strengths, capacities."
  (list (loop for camera across (robot:robot-cameras robot)
              collect (list (robot:camera-field-of-view camera)
                            (robot:camera-resolution camera)))
        (cl:map 'list #'robot:hand-strength (robot:robot-hands robot))
        (cl:map 'list #'robot:storage-bin-capacity (robot:robot-bins robot))))

(test robbie.has-his-parts
  (with-listings ("5-2-robbie")
    (run:call-with-simulation
     (lambda ()
       (let ((robbie (symbol-value (own 'robbie))))
         (is (base:value-equal `(((,(/ pi 4) 3) (,(/ pi 2) 5)) (10 4) (20 5))
                               (parts-of robbie)))
         (is (equalp '(10 5 0) (list (robot:robot-x robbie) (robot:robot-y robbie)
                                     (robot:robot-angle robbie))))
         (is (eq (world:find-map 'ars-worlds:watson)
                 (world:world-map (robot:robot-world robbie))))
         (is (near 1 (third (call-once 'command:robot-turn robbie 1)) .05) "he turns")))
     (list (own 'robbie)) :seed 1)))

(test box*.is-a-prototype
  (with-listings ("5-3-box")
    (let ((box (symbol-value (own 'box*))))
      (is (world:thing-p box))
      (is (string= "BOX" (princ-to-string box)))
      (is (null (world:thing-world box)))
      (is (equal '((:capacity 8) (:size 8) (:weight 2)) (world:thing-attributes box)))
      (with-cook ()
        (let ((copy (world:make-new-thing 'crate (list 'kitchen 5.5 5.5) '((:weight 3))
                                          :prototype box)))
          (is (equal '(8 8 3) (loop for key in '(:capacity :size :weight)
                                    collect (world:get-attribute copy key)))))))))
