;;;; manual-3-1.lisp -- section 3.1 of the manual: Nisp, and where its names are.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-3-1 :in ars-magna)

;;; 3.1: Nisp. What follows is compiled as it stands, in this file.

(defun nisp-read (text)
  "Return the form that TEXT is, read here."
  (let ((*package* (find-package :ars-test-manual))
        (*readtable* (copy-readtable nil)))
    (in-readtable :nisp)
    (read-from-string text)))

(test manual-3-1.variables-may-have-types
  "3.1: a hyphen and a type designator may follow a variable where it is bound."
  (is (= 7 (let ((a 3) - INTEGER (b 4) - (Lst INTEGER)) (+ a b))))
  (is (= 7 (funcall (\\ (a - INTEGER b - (~ FIXNUM)) (+ a b)) 3 4)))
  (is (= 7 (funcall (continuation (a - INTEGER &optional (b 4) - VOID) (+ a b)) 3))))

(test manual-3-1.type-designators-are-types
  "3.1: VOID is the type of no values, (Lst t) of lists, (~ t) of #F and what is of type t."
  (is (typep '(1 2) '(Lst INTEGER)))
  (is (not (typep 1 '(Lst INTEGER))))
  (loop for (value fits) in '((1 t) (nil t) ("one" nil))
        do (is (eq fits (typep value '(~ INTEGER)))))
  (is (not (typep nil 'VOID))))

(test manual-3-1.slots-have-three-syntaxes
  "3.1, readings 32 and 33: (!_slot x), (!(t slot) x), also (!_(t slot) x), and !>x.slot."
  (let ((p (make PT 1 2)))
    (is (= 1 (!_x p) (!(PT x) p) (!_(PT x) p) !>p.x))
    (!= (!_x p) 3 (!(PT y) p) 4)
    (is (equal (make PT 3 4) p))
    (!= !>p.y 5)
    (is (= 5 (!_y p)))))

(test manual-3-1.slots-can-be-chained
  "3.1, reading 32: !>a.b.c is the slot c of the slot b of a."
  (let ((box (make PT-INTERVAL (make PT 1 2) (make PT 4 8))))
    (is (= 8 !>box.y.max))
    (!= !>box.y.max 9)
    (is (= 7 !>box.dy))))

(test manual-3-1.marks-count-at-the-start-of-a-token-only
  "3.1, reading 32: add! is a plain symbol, != another, !_x an accessor."
  (is (eq 'add! (nisp-read "add!")))
  (is (eq '!= (nisp-read "!=")))
  (is (equal (nisp-read "(!_c (!_b a))") (nisp-read "!>a.b.c"))))

(defproc countdown - INTEGER (n - INTEGER)
  (if (plusp n) (countdown (- n 1)) n))
(deffunc twice - (Lst INTEGER) (x - INTEGER &optional (y x) - INTEGER) (list x y))

(test manual-3-1.procedures-have-result-types
  "3.1: defproc and deffunc take a hyphen and the result's type after the name."
  (is (= 0 (countdown 3)))
  (is (equal '(2 2) (twice 2)))
  (is (equal '(2 5) (twice 2 5))))

(test manual-3-1.make-makes-objects-of-a-type
  "3.1: (make t args...)."
  (with-scout ()
    (loop for (object type) in (list (list (make PT 1 2) 'pt)
                                     (list (make INTERVAL 1 2) 'interval)
                                     (list (make PT-INTERVAL 1 2) 'pt-interval)
                                     (list (make ODOMETER scout 'trip) 'odometer))
          do (is (typep object type))))
  (signals unknown-name (eval '(make TEAPOT 1))))

(test manual-3-1.!=-sets
  "3.1, reading 14: != is setf, of any place and of several."
  (let ((list (list 1 2)) a)
    (!= a 5 (second list) 6)
    (is (equal '(5 1 6) (cons a list)))))

(test manual-3-1.backslash-makes-functions
  "3.1, reading 4: an operator whose name is one backslash is lambda with types."
  (is (string= "\\" (symbol-name '\\)))
  (is (= 9 (funcall (\\ (x - REAL y) (* x y)) 3 3)))
  (let ((n 0))
    (funcall (\\ () (incf n)))
    (is (= 1 n))))

(test manual-3-1.booleans-are-written-with-a-sharp-sign
  "3.1, reading 31: #T, #F, #t and #f."
  (is (equal '(t nil t nil) '(#T #F #t #f))))

(defparameter *manual-names*
  '("PT" "INTERVAL" "PT-INTERVAL" "ADD" "SUBTRACT!" "NOMINAL" "LIFT-LBI" "EQUAL" "COPY-OBJ"
    "ROBOT-MAIN-ODOMETER" "ROBOT-ODOMETER" "ROBOT-ODOMETERS" "RESET-ODOMETER" "GET-ODOMETER-POS"
    "GET-ODOMETER-ANG" "ROBOT-CAMERA" "DESIGNATOR" "CAMERA-VIEW" "CAMERA-GET-PLACE-DESIGNATOR"
    "CAMERA-GET-ALL-PLACE-DESIGNATORS" "CAMERA-GET-OBJECT-DESIGNATOR"
    "CAMERA-GET-ALL-OBJECT-DESIGNATORS" "CAMERA-TRACK" "CAMERA-UNTRACK" "CAMERA-TURN"
    "CAMERA-ALIGN-ROBOT" "CAMERA-ALIGN-PLACE" "CAMERA-INSERT" "CAMERA-REMOVE" "ROBOT-SET-SPEED"
    "ROBOT-SET-TURN-ANGLE" "ROBOT-TURN" "ROBOT-ABOUT-FACE" "ROBOT-TURN-LEFT" "ROBOT-TURN-RIGHT"
    "ROBOT-ALIGN-PLACE" "ROBOT-TURN-CORNER" "ROBOT-GO-FORWARD" "ROBOT-GOTO-WALL"
    "ROBOT-GOTO-DESIGNATOR" "ROBOT-STOP" "ROBOT-HAND" "ROBOT-STORAGE-BIN" "HAND-GRASP-DESIG"
    "HAND-UNGRASP" "HAND-GRASP-CHECK" "HAND-TRACK" "HAND-INSERT" "HAND-INSERT-BIN" "HAND-REMOVE"
    "STORAGE-BIN-OPEN" "STORAGE-BIN-CLOSE" "ERROR-SET" "WARNING-SET" "MESSAGE-SET"
    "ERROR-DISPLAY" "SCHEDULE" "CLEAN-SIMULATION" "DIRTY-SIMULATION" "DEFMAP" "DEF-PLACE-TYPE"
    "DEFROBOT" "NEW-THING" "DEFKICKER" "DEFATTRIBUTE" "DEFMANIPULATION" "MANIPULATE" "SIMULATOR"
    "CLI" "GRAPHICS-SCALE*")
  "What the manual takes from the package ARS.")

(test manual-3-1.simulator-symbols-are-external-in-ars
  "3.1, reading 29: the simulator's are, and Nisp's are external in NISP, which does not use ARS."
  (flet ((external-p (name package) (eq :external (nth-value 1 (find-symbol name package)))))
    (dolist (name *manual-names*) (is (external-p name :ars) "~A" name))
    (dolist (name '("!=" "MAKE" "DEFPROC" "CONTINUATION" "VREF" "OUT" "\\" "MATCHQ" "LET"))
      (is (external-p name :nisp) "~A" name)))
  (is (not (member (find-package :ars) (package-use-list :nisp)))))

(test manual-3-1.names-of-common-lisp-still-work
  "3.1, reading 30: ARS extends equal and map, NISP let, if and loop."
  (is (equal '(1 "a") (list 1 "a")))
  (is (equal (make PT 1 2) (make PT 1.0 2)))
  (is (equal '(2 3) (map 'list #'1+ '(1 2))))
  (is (equal '(1 2) (loop for i from 1 to 2 collect i)))
  (is (equal '(1 . 2) (let ((x 1) (y 2)) (if (< x y) (cons x y))))))

(test manual-3-1.loop-until-and-while
  "Figure D.3: (loop UNTIL test body...), and likewise WHILE."
  (let ((n 0))
    (loop UNTIL (= n 3) (incf n))
    (loop WHILE (< n 9) (incf n) (incf n))
    (is (= 9 n))))

(test manual-3-1.if-takes-several-forms-else
  "Figure D.5, reading 40: all forms after the first are for the case that the test is false."
  (let ((n 0))
    (is (= 2 (if #F 9 (incf n) (incf n))))
    (is (= 1 (if #T 1 (incf n) (incf n))))))

(test manual-3-1.matchvars-match
  "Reading 34: ?x gives the variable x what it matches, the same each time; ?() matches all."
  (let ((x nil))
    (is-true (matchq (box ?x ?() ?x) '(box 7 8 7)))
    (is (= 7 x))
    (is-false (matchq (box ?x ?() ?x) '(box 1 8 2)))
    (is (= 7 x))))

(test manual-3-1.what-the-listings-use-is-there
  "Reading 37: nop, atan2 with y first, origin*, vref, which can be set, and in-location."
  (is (null (multiple-value-list (nop))))
  (is (near (/ pi 2) (atan2 1 0)))
  (is (equal (make PT 0 0) origin*))
  (let ((vector (vector 1 2)))
    (!= (vref vector 0) 5)
    (is (equal '(5 2) (list (vref vector 0) (vref '(1 2) 1)))))
  (with-scout ()
    (let* ((box (put-beside 'box 0 0 :capacity 5)) (pen (put 'pen box)))
      (is-true (in-location pen box))
      (is (not (in-location pen (hand-of-scout)))))))

(test manual-3-1.values-are-compared-by-name
  "Reading 38: red is the same in all packages."
  (at-each-spot (:clean t)
    (put-beside 'ball 4 0 :color 'common-lisp-user::red)
    (is-true (look '((:color red))))
    (is-true (look '((:color :red))))
    (is-true (look-for-place 'common-lisp-user::doorway))
    (is (null (look '((:color blue)))))))
