;;;; text-maps.lisp -- the world as characters: what fits where, letters, colours, layers.

(in-package :ars-magna.tests)

(def-suite* text-maps :in ars-magna)

;; Somewhat too large for a terminal, with more kinds of things than letters begin with.
(world:defmap ars-user::depot (130 90)
  (rect (0 0) (129 89) bricks 20)
  (wall (60 0) (60 60) glass 5)
  (obj crate (20.5 20.5) ((:size 9) (:color red)))
  (obj cup (21.5 20.5) ((:size 1)))
  (obj cart (20.5 24.5) ((:size 30) (:color lightblue)))
  (obj vase (30.5 20.5) ((:size 2)))
  (obj vat (32.5 20.5) ((:size 40))))

(robot:defrobot ars-user::clerk (ars-user::depot (10.5 20.5) 0)
  :cameras (((/ pi 4) 3)))

(defmacro in-depot ((robot) &body body)
  "Run BODY with ROBOT bound to the clerk of a fresh, clean depot."
  `(run:call-with-simulation
    (lambda () (let ((,robot (robot:find-robot 'ars-user::clerk))) ,@body))
    '(ars-user::clerk) :clean t))

(defun map-lines (robot &rest options)
  (lines-of (apply #'display:text-map robot options)))

(defun map-rows (lines)
  "Return those of LINES, of a text map, that are rows, without what stands to their left."
  (loop for line in (rest lines)
        while (and (< 4 (length line)) (digit-char-p (char line 3)))
        collect (subseq line 5)))

(defun shown-at (lines x y)
  "Return the character at the cell X, Y in LINES, of a text map whose characters are cells."
  (let ((row (nth y (map-rows lines))))
    (if (< x (length row)) (char row x) #\Space)))

(defun legend-has-p (lines entry)
  (search entry (joined lines)))

;;; Room.

(test text-map.fits-the-room-it-is-given
  (in-depot (robot)
    (dolist (columns '(40 79 120))
      (dolist (rows '(12 23 50))
        (dolist (layers '(() (:cones :way :belief)))
          (let ((lines (map-lines robot :columns columns :rows rows :layers layers)))
            (is (<= (length lines) rows) "~D x ~D: ~D lines" columns rows (length lines))
            (is (every (lambda (line) (<= (length line) columns)) lines))
            (is (legend-has-p lines "> CLERK"))))))))

(test text-map.says-its-scale
  (in-depot (robot)
    (is (legend-has-p (map-lines robot :columns 79) "Each character is 2 x 2 cells."))
    (is (legend-has-p (map-lines robot :columns 79 :rows 30) "Each character is 2 x 4 cells."))
    (is (not (legend-has-p (map-lines robot :columns 200) "Each character")))))

(defun add-kinds (robot count)
  "Put COUNT small things of as many kinds into the world of ROBOT."
  (loop for i below count
        for name = (intern (format nil "THING-~D" i) :ars-user)
        do (world:make-new-thing name (list (robot:robot-world robot) 40.5 (+ 2.5 i))
                                 '((:size 1)))))

(test text-map.counts-what-its-legend-has-no-room-for
  (in-depot (robot)
    (add-kinds robot 60)
    (let ((lines (map-lines robot :columns 60 :rows 20)))
      (is (legend-has-p lines "more: MAP LEGEND"))
      (is (<= (length lines) 20)))
    (let ((legend (map-lines robot :columns 60 :rows 20 :only-legend t)))
      (is (null (map-rows legend)))
      (dolist (name '("CART" "CRATE" "CUP" "VASE" "VAT" "THING-59"))
        (is (legend-has-p legend name))))))

(test text-map.shows-a-region
  (in-depot (robot)
    (let ((lines (map-lines robot :region '(18 19.5 26 25))))
      (is (eql 5 (search "18" (first lines))))
      (is (= 6 (length (map-rows lines))))
      (is (string= "  Cu" (second (map-rows lines))))
      (is (null (legend-has-p lines "VAT"))))
    (is (equal (map-lines robot :radius 3) (map-lines robot :region '(7 17 14 24))))
    (is (= 1 (length (map-rows (map-lines robot :region '(-50 -50 0.5 0.5))))))))

;;; Letters.

(test text-map.gives-each-kind-a-letter
  "The largest has the small initial, the next the large one; v is a robot that looks down."
  (in-depot (robot)
    (let ((legend (joined (map-lines robot :only-legend t))))
      (dolist (entry '("c CART" "C CRATE" "u CUP" "V VAT" "a VASE"))
        (is (search entry legend) "~A in ~A" entry legend))
      (is (< (search "VASE" legend) (search "CART" legend) (search "CRATE" legend)
             (search "CUP" legend) (search "VAT" legend))
          "sorted by letter"))))

(test text-map.keeps-letters-wherever-one-looks
  (in-depot (robot)
    (is (legend-has-p (map-lines robot :region '(21 19 25 22)) "u CUP"))
    (is (char= #\* (char (nth 10 (map-rows (map-lines robot :columns 79))) 10))
        "several things in one character")))

(test text-map.has-an-end-to-its-letters
  (in-depot (robot)
    (add-kinds robot 60)
    (let ((legend (joined (map-lines robot :only-legend t :columns 1000))))
      (is (search "& THING-" legend))
      (is (search "c CART" legend) "what is large keeps its letter"))))

;;; Colours.

(defun tagged (text ink)
  (if ink (format nil "<~(~A~) ~A>" ink text) text))

(test text-map.paints-things-and-walls
  (in-depot (robot)
    (let ((shown (display:text-map robot :columns 200 :paint #'tagged)))
      (is (search "<red C>" shown))
      (is (search "<lightblue c>" shown))
      (is (search "<reverse >>" shown))
      (is (search "<red #> bricks" shown))
      (is (search "<lightcyan #> glass" shown))
      (is (not (search "# wall" shown))))))

(test text-map.is-the-same-but-for-its-colours
  (in-depot (robot)
    (flet ((plain (text ink) (declare (ignore ink)) text))
      (is (equal (map-rows (map-lines robot :columns 100))
                 (map-rows (map-lines robot :columns 100 :paint #'plain)))))))

;;; Layers.

(test text-map.shows-what-cameras-have-in-view
  (in-depot (robot)
    (let ((lines (map-lines robot :columns 200 :layers '(:cones))))
      (is (char= #\` (shown-at lines 15 20)))
      (is (char= #\` (shown-at lines 40 12)))
      (is (char= #\Space (shown-at lines 15 10)) "beside the field of view")
      (is (char= #\Space (shown-at lines 5 20)) "behind the robot")
      (is (char= #\Space (shown-at lines 70 20)) "behind the wall")
      (is (char= #\C (shown-at lines 20 20)) "things stay to be seen")
      (is (legend-has-p lines "` in view of CLERK")))))

(test text-map.shows-the-way
  (in-depot (robot)
    (display:keep-history)
    (command:robot-go-forward robot 5)
    (run:run-ticks 20)
    (let ((lines (map-lines robot :columns 200 :layers '(:way))))
      (is (char= #\+ (shown-at lines 11 20)))
      (is (char= #\Space (shown-at lines 9 20)))
      (is (legend-has-p lines "+ way of CLERK")))
    (is (char= #\Space (shown-at (map-lines robot :columns 200) 11 20)))))

(test text-map.shows-the-planned-way
  (in-depot (robot)
    (robot:publish-way robot '((10.5 20.5) (14.5 20.5)))
    (let ((lines (map-lines robot :columns 200 :layers '(:plan))))
      (is (char= #\: (shown-at lines 13 20)))
      (is (char= #\Space (shown-at lines 15 20)))
      (is (legend-has-p lines ": planned way of CLERK")))
    (is (char= #\Space (shown-at (map-lines robot :columns 200) 13 20)))))

(test text-map.shows-what-the-robot-believes
  (in-depot (robot)
    (is (null (legend-has-p (map-lines robot :layers '(:belief :way)) "@ believed (10.50,20.50)"))
        "The robot stands there.")
    (command:camera-get-object-designator (robot:robot-camera robot 0) :non-local
                                          '((:color (red))) nil)
    (run:run-ticks 5)
    (let ((lines (map-lines robot :columns 200 :layers '(:belief))))
      (is (legend-has-p lines "0 Designator 0"))
      (is (char= #\0 (shown-at lines 20 20)) "where the crate is"))))

(test text-map.rejects-what-makes-no-sense
  (in-depot (robot)
    (dolist (options '((:rows 2) (:columns 3) (:radius -1) (:region (1 2 3)) (:region (5 5 1 9))
                       (:region (500 500 600 600)) (:region (-9 -9 0 0))
                       (:region (1 2 3 . 4)) (:layers (:frob)) (:layers :way)))
      (signals base:wrong-argument (apply #'display:text-map robot options)))))
