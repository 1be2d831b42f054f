;;;; worlds.lisp -- the shipped worlds: their contents, and that all of it can be reached.

(in-package :ars-magna.tests)

(def-suite* worlds :in ars-magna)

;;; For each world: its robots; the numbers of its doorways and of its convex, concave and beak
;;; places; the metres per character of the map at the head of its file; the number of its things.

(defparameter *shipped-worlds*
  '((watson :robots (robbie) :places (9 6 36 1) :scale 1 :things 100)
    (office :robots (marvin gofer) :places (20 20 70 10) :scale 2 :things 170)
    (hall :robots (porter) :places (1 16 12 2) :scale 3 :things 20)
    (tiny :robots (dot) :places (0 4 4 0) :scale 1 :things 6)))

(defparameter *worlds-folder*
  (merge-pathnames "../worlds/" #.(or *compile-file-truename* *load-truename*)))

(defun shipped (name &rest keys)
  (let ((entry (rest (assoc name *shipped-worlds* :test #'base:same-name-p))))
    (values-list (loop for key in keys collect (getf entry key)))))

(defmacro do-shipped ((name &optional (world (gensym "WORLD"))) &body body)
  "Run BODY with NAME and a fresh WORLD of each shipped world."
  `(loop for (,name) in *shipped-worlds*
         for ,world = (world:make-world (world:find-map ,name))
         do (progn ,@body)))

(defun call-in-shipped (name seed function)
  "Call FUNCTION on the fresh world of a headless simulation of the shipped world NAME."
  (run:call-with-simulation (lambda () (funcall function world:*world*))
                              (shipped name :robots) :seed seed))

;;; Where one gets to.

(defun barred-p (world index)
  (logtest (logior world:+wall+ world:+obsmove+) (aref (world:world-flags world) index)))

(defun cells-reached (world x y)
  "Return a bit for each cell of WORLD: 1 where one gets to from the point (X, Y)."
  (let* ((map (world:world-map world))
         (reached (make-array (length (world:map-flags map)) :element-type 'bit :initial-element 0))
         (edge (list (list (floor x) (floor y)))))
    (loop for (x y) = (pop edge)
          while x
          do (let ((index (world:map-index map x y)))
               (unless (or (null index) (= 1 (aref reached index)) (barred-p world index))
                 (setf (aref reached index) 1)
                 (loop for (dx dy) in '((0 1) (1 0) (0 -1) (-1 0))
                       do (push (list (+ x dx) (+ y dy)) edge)))))
    reached))

(defun robot-start (name)
  (let ((body (robot::find-blueprint name)))
    (list (robot::blueprint-x body) (robot::blueprint-y body))))

(defun distance-to-cell (x y column row)
  (flet ((gap (coordinate cell) (max 0 (- cell coordinate) (- coordinate (1+ cell)))))
    (sqrt (+ (expt (gap x column) 2) (expt (gap y row) 2)))))

(defun within-reach-p (thing reached)
  "True if THING is local (less than a metre away) somewhere in the cells REACHED."
  (let ((map (world:world-map (world:thing-world thing))))
    (multiple-value-bind (x y) (world:thing-position thing)
      (loop for (dx dy) in '((0 0) (0 1) (1 0) (0 -1) (-1 0))
            for column = (+ (floor x) dx) and row = (+ (floor y) dy)
            for index = (world:map-index map column row)
            thereis (and index (= 1 (aref reached index))
                         (< (distance-to-cell x y column row) 1))))))

(test worlds.robots-reach-every-open-cell
  (do-shipped (name world)
    (dolist (robot (shipped name :robots))
      (destructuring-bind (x y) (robot-start robot)
        (let ((reached (cells-reached world x y)) (width (world:map-width (world:world-map world))))
          (is (null (loop for bit across reached for index from 0
                          when (and (zerop bit) (not (barred-p world index)))
                            collect (reverse (multiple-value-list (floor index width)))))
              "~A cannot get everywhere" robot))))))

(test worlds.robots-reach-every-thing
  (do-shipped (name world)
    (dolist (robot (shipped name :robots))
      (let ((reached (apply #'cells-reached world (robot-start robot))))
        (world:do-things (thing world)
          (is (within-reach-p thing reached) "~A is out of ~A's reach" thing robot))))))

(defun floor-things (world)
  (remove :floor (world:world-thing-list world) :key #'world:thing-location :test-not #'eq))

(defun things-in-walls (world)
  (remove-if-not (lambda (thing)
                   (world:wall-at-p (world:world-map world)
                                    (world:thing-x thing) (world:thing-y thing)))
                 (floor-things world)))

(test worlds.things-stand-in-the-open
  (do-shipped (name world)
    (is (null (things-in-walls world)) "in ~A" name)
    (is (null (world:world-invariant-violations world)))))

;;; What is in them.

(test worlds.hold-what-they-say
  (do-shipped (name world)
    (is (<= (shipped name :things) (world:world-live-count world))
        "~A holds ~D things" name (world:world-live-count world))))

(defun place-counts (map)
  (loop for name in '(doorway convex concave beak)
        for number = (world:place-type-index map (world:find-place-type name))
        collect (count number (world:map-places map))))

(test worlds.doorways-are-doorways
  (do-shipped (name world)
    (is (equal (shipped name :places) (place-counts (world:world-map world))) "in ~A" name)))

(test worlds.containers-hold-their-contents
  (do-shipped (name world)
    (world:do-things (thing world)
      (let ((contents (world:thing-contents thing)))
        (is (<= (reduce #'+ contents :key #'world:thing-size) (world:thing-capacity thing))
            "~A in ~A is too full" thing name)
        (is (<= (world:thing-capacity thing) (world:thing-size thing))
            "~A in ~A holds more than its size" thing name)))))

(defun shut-in-p (thing)
  "True if THING is in anything closed, directly or not."
  (loop for outer = (world:thing-location thing) then (world:thing-location outer)
        while (world:thing-p outer)
        thereis (world:thing-closed-p outer)))

(defun key-p (thing) (eq :key (world:get-attribute thing :type)))

(test worlds.locks-have-keys-outside
  (do-shipped (name world)
    (let ((things (world:world-thing-list world)))
      (loop for lock in (remove-if #'key-p things)
            for id = (world:get-attribute lock :lock-id)
            do (is (eq (world:get-attribute lock :locked) (and id t)) "~A in ~A" lock name)
               (is (or (null id)
                       (some (lambda (key)
                               (and (key-p key) (not (shut-in-p key))
                                    (eql id (world:get-attribute key :lock-id))))
                             things))
                   "~A in ~A has no key" lock name)))))

(defun depth (thing)
  (loop for outer = (world:thing-location thing) then (world:thing-location outer)
        while (world:thing-p outer) count t))

(test worlds.contents-are-deep
  (flet ((depth-of (name)
           (loop for thing in (world:world-thing-list (world:make-world (world:find-map name)))
                 maximize (depth thing))))
    (is (= 3 (depth-of 'watson)))
    (is (= 3 (depth-of 'office)))
    (is (= 3 (depth-of 'hall)))
    (is (= 2 (depth-of 'tiny)))))

;;; The pictures at the heads of the files.

(defun picture-lines (name)
  "Return the lines of the picture at the head of the file of the world NAME."
  (with-open-file (file (merge-pathnames (format nil "~(~A~).lisp" name) *worlds-folder*))
    (loop with prefix = ";;;   #"
          for line = (read-line file nil) while line
          when (and (< (length prefix) (length line)) (string= prefix line :end2 (length prefix)))
            collect (subseq line 6))))

(defun block-character (map column row scale)
  "Return # or + if there is a wall or doorway in a block of MAP, or a dot."
  (let ((types (loop for y from (* row scale) repeat scale
                     append (loop for x from (* column scale) repeat scale
                                  for index = (world:map-index map x y)
                                  for place = (and index (world:cell-type
                                                          (world:map-cell map x y)))
                                  collect (cond ((null index) #\.)
                                                ((world:wall-at-p map x y) #\#)
                                                ((and place
                                                      (base:same-name-p
                                                       'doorway (world:place-type-name
                                                                 (world:place-type place))))
                                                 #\+)
                                                (t #\.))))))
    (or (find #\+ types) (find #\# types) #\.)))

(test worlds.pictures-are-true
  (do-shipped (name world)
    (let ((map (world:world-map world)) (scale (shipped name :scale)) (lines (picture-lines name)))
      (is (= (length lines) (ceiling (world:map-height map) scale)))
      (loop for line in lines for row from 0
            do (is (string= (substitute-if #\. (lambda (char) (not (find char "#+")))
                                           (subseq line 0 (ceiling (world:map-width map) scale)))
                            (coerce (loop for column below (ceiling (world:map-width map) scale)
                                          collect (block-character map column row scale))
                                    'string))
                   "row ~D of ~A" row name)))))

(test worlds.pictures-show-the-robots
  (loop for (robot world mark) in '((robbie watson #\>) (marvin office #\>) (gofer office #\^)
                                    (porter hall #\>) (dot tiny #\>))
        do (destructuring-bind (x y) (robot-start robot)
             (let ((scale (shipped world :scale)))
               (is (eql mark (char (nth (floor y scale) (picture-lines world))
                                   (floor x scale))))))))

;;; Running.

(defun digest-after (name seed ticks)
  (call-in-shipped name seed
                   (lambda (world)
                     (run:run-ticks ticks)
                     (base:digest-value (base:digest-state world (base:make-digest))))))

(test worlds.stay-in-order
  "For 20,000 ticks nothing leaves the open or the index, and no kicker complains."
  (loop for (name) in *shipped-worlds*
        do (call-in-shipped
            name 1992
            (lambda (world)
              (loop repeat 20
                    do (run:run-ticks 1000)
                       (is (null (things-in-walls world)) "in ~A" name)
                       (is (null (world:world-invariant-violations world)) "in ~A" name))
              (is (null (mapcar #'base:message-text (base:take-messages))))))))

(test worlds.repeat-themselves
  (loop for (name) in *shipped-worlds*
        do (is (= (digest-after name 7 20000) (digest-after name 7 20000)) "~A" name)))

(test worlds.depend-on-the-seed
  (dolist (name '(watson office))
    (is (/= (digest-after name 7 1000) (digest-after name 8 1000)) "~A" name)))

(test worlds.hall-and-tiny-keep-still
  (dolist (name '(hall tiny))
    (call-in-shipped name 1 (lambda (world)
                              (is (not (world:world-has-kickers-p world)))
                              (is (run:idle-p))))))

;;; The robots.

(test robbie.is-as-the-manual-says
  "Manual 5.2."
  (let ((robbie (robot:find-robot 'robbie)))
    (is (eq robbie ars-worlds:robbie))
    (is (eq ars-worlds:watson (world:world-map (robot:robot-world robbie))))
    (is (equalp '(10 5) (robot-start 'robbie)))
    (is (= 0 (robot::blueprint-angle (robot:robot-blueprint robbie))))
    (is (equalp (list (list (/ pi 4) 3) (list (/ pi 2) 5))
                (cl:map 'list (lambda (camera) (list (robot:camera-field-of-view camera)
                                                     (robot:camera-resolution camera)))
                        (robot:robot-cameras robbie))))
    (is (equalp '(10 4) (cl:map 'list #'robot:hand-strength (robot:robot-hands robbie))))
    (is (equalp '(20 5) (cl:map 'list #'robot:storage-bin-capacity (robot:robot-bins robbie))))))

(test robbie.drives-through-the-doorway-into-the-kitchen
  (call-in-shipped
   'watson 1
   (lambda (world)
     (let ((robbie (first (world:world-robots world))) (ended nil))
       (command:robot-goto-wall robbie (lambda (code &rest results)
                                         (declare (ignore results))
                                         (setf ended (list code))))
       (is (run:run-until (lambda () ended) :limit 100))
       (is (equal '(nil) ended))
       (is (< 28.9 (robot:robot-x robbie) 29))))))

(test porter.stands-beside-what-the-session-needs
  "Manual E: names, numbers and what is where."
  (call-in-shipped
   'hall 0
   (lambda (world)
     (let ((here (world:things-at world 20 20)) (pen (world:find-thing "PEN#2" world)))
       (is (equal '("LAMP#1" "SMALL-BOX#3") (mapcar #'princ-to-string here)))
       (is (eq (second here) (world:thing-location pen)))
       (is (equalp '(20 20) (multiple-value-list (world:thing-position pen))))
       (is (= 5 (world:thing-capacity (second here)) (world:thing-size (second here))))
       (is (< 0.199 (world:thing-size pen) 0.201))
       (is (base:same-name-p 'wood (world:get-attribute (second here) :substance)))
       (is (= 0 (world:map-least-parameter (world:world-map world))))
       (is (= 30 (world:map-greatest-parameter (world:world-map world))))
       (is (equalp '(20 20) (robot-start 'porter)))))))

(test porter.is-built-like-robbie
  (flet ((parts (name)
           (robot::blueprint-parts (robot::find-blueprint name))))
    (is (equalp (parts 'robbie) (parts 'porter)))))

(test box.is-as-the-manual-says
  "Manual 5.3."
  (is (equalp '(8 8 2) (loop for key in '(:capacity :size :weight)
                             collect (world:get-attribute ars-worlds:box* key)))))

(test experiments.that-are-shipped-can-be-named
  (let ((names (remove (find-package :ars-worlds)
                       (mapcar #'ars-magna.experiment:experiment-name
                               (ars-magna.experiment:all-experiments))
                       :key #'symbol-package :test-not #'eq)))
    (is (<= 3 (length names)))
    (dolist (name names)
      (is (eq :external (nth-value 1 (find-symbol (symbol-name name) :ars-worlds))) "~A" name))))
