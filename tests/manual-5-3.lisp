;;;; manual-5-3.lisp -- Things (manual 5.3).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-5-3 :in ars-magna)

(defvar crate* (new-thing crate nil ((:capacity 8) (:size 8) (:weight 2))))

(defmap barn (20 14)
  (rect (0 0) (19 13) wood 60)
  (obj cart (7 7) ((:capacity 30) (:size 40) (:weight 9)))
  (obj rake (7.5 3.25) ((:size 5) (:color red))))

(defrobot farmer (barn (7 7) 0)
  :cameras ((6.28 100)) :hands (10) :bins (20))

(defun attributes (thing &rest keys)
  (loop for key in keys collect (get-attribute thing key)))

;;; Making.

(test manual-5-3.new-thing-returns-the-thing
  "5.3, reading 12: the new object is what NEW-THING returns, with its name and descriptor."
  (with-simulation (farmer)
    (let ((hen (new-thing hen (barn 3 4.5) ((:size 1) (:color violet)))))
      (is-true (thing-p hen))
      (is (eq 'hen (thing-name hen)))
      (is (equal '((:size 1) (:color violet)) (thing-attributes hen)))
      (is (eq hen (find-thing 'hen))))))

(test manual-5-3.new-thing-takes-a-position-in-a-map
  "5.3: (map x y) is that position, whole or not; all three are evaluated (reading 167)."
  (with-simulation (farmer)
    (let ((x 3) (map barn))
      (is (equalp '(3 4) (where (new-thing a (barn x (1+ x)) ()))))
      (is (equalp '(3.5 4.25) (where (new-thing b (map 3.5 4.25) ())))))
    (is (eq *world* (thing-world (new-thing c (barn 1 1) ()))) "in the world that runs")
    (signals wrong-argument (new-thing d (barn 20 3) ()))))

(test manual-5-3.new-thing-takes-a-container-hand-or-bin
  "5.3: the thing is inside LOC."
  (with-simulation (farmer)
    (dolist (place (list (find-thing 'cart) (robot-hand farmer 0) (robot-storage-bin farmer 0)))
      (let ((egg (new-thing egg place ((:size .1) (:weight .1)))))
        (is (eq place (thing-location egg)))
        (is-true (in-location egg place))
        (is (equalp '(7 7) (where egg)) "it is where that is")))
    (is (eq 'egg (thing-name (hand-holding (robot-hand farmer 0)))))
    (signals wrong-argument (new-thing egg 'cart ()))))

(test manual-5-3.new-thing-with-another
  "5.3: (:with obj) is the location of OBJ, be it a position or inside something."
  (with-simulation (farmer)
    (is (equalp '(7.5 3.25) (where (new-thing hoe (:with (find-thing 'rake)) ()))))
    (let* ((cart (find-thing 'cart)) (hay (new-thing hay cart ((:size 9))))
           (cat (new-thing cat (:with hay) ((:size 2)))))
      (is (equal (list hay cat) (thing-contents cart))))))

(test manual-5-3.new-thing-nowhere-is-a-prototype
  "5.3: with location nil a thing is in no world; it only packages attributes."
  (is (equal '(nil nil) (list (thing-world crate*) (thing-location crate*))))
  (is-false (find-thing 'crate barn))
  (is (equal '((:capacity 8) (:size 8) (:weight 2)) (thing-attributes crate*))))

(test manual-5-3.prototypes-are-copied-and-modified
  "5.3: the attributes and contents of PROTO are copied into the new thing, and then modified by the
descriptor; the prototype stays as it was."
  (with-simulation (farmer)
    (let* ((shelf (new-thing shelf nil ((:capacity 8) (:size 8) (:weight 2) (:color blue))))
           (jar (new-thing jar shelf ((:size 1))))
           (copy (new-thing chest (barn 3 3) ((:size 6) (:substance wood)) :prototype shelf)))
      (is (equal '(8 6 2 blue wood) (attributes copy :capacity :size :weight :color :substance)))
      (is (equal '(8 nil) (attributes shelf :size :substance)))
      (is (equal '(jar) (mapcar #'thing-name (thing-contents copy))))
      (is-false (eq jar (first (thing-contents copy)))))))

(test manual-5-3.descriptors-without-a-prototype-are-complete
  "5.3: then the thing has just the attributes that the descriptor gives."
  (with-simulation (farmer)
    (is (equal '((:weight 3)) (thing-attributes (new-thing stone (barn 1 1) ((:weight 3))))))
    (is (null (thing-attributes (new-thing stone (barn 1 1) ()))))))

(test manual-5-3.names-need-not-be-unique
  "5.3: names are for convenience; things of one name are told apart by their numbers."
  (with-simulation (farmer)
    (let ((one (new-thing egg (barn 3 3) ())) (other (new-thing egg (barn 3 3) ())))
      (is-false (eq one other))
      (is (equal '("EGG#3" "EGG#4") (names (list one other))))
      (is (equal (list one other) (find-things 'egg))))))

(test manual-5-3.names-and-descriptors-are-not-evaluated
  "5.3, reading 167: NEW-THING takes them as written; MAKE-NEW-THING, a function, computes them."
  (with-simulation (farmer)
    (let ((size 4) (name 'hen))
      (is (eq 'name (thing-name (new-thing name (barn 3 3) ((:size 1))))))
      (let ((hen (make-new-thing name (list barn 3 3) `((:size ,size)))))
        (is (equal '(hen 4) (list (thing-name hen) (get-attribute hen :size))))))))

(defun seen (specification)
  "Return what FARMER's camera finds of SPECIFICATION: code and names."
  (destructuring-bind (code camera designators)
      (call-once 'camera-get-all-object-designators (robot-camera farmer 0)
                 :non-local specification)
    (declare (ignore camera))
    (list code (mapcar (lambda (designator) (thing-name (designator-denotation designator)))
                       designators))))

(test manual-5-3.new-things-are-seen-at-once
  "5.3: a thing made on the fly is in the world like any other."
  (with-simulation (farmer :clean t)
    (is (equal '(:designator-not-found nil) (seen '((:color green)))))
    (new-thing frog (barn 12 9) ((:color green) (:size 1)))
    (is (equal '(nil (frog)) (seen '((:color green)))))))

(test manual-5-3.new-things-last-as-long-as-the-run
  "5.3: another run begins without them."
  (with-simulation (farmer) (new-thing frog (barn 12 9) ()))
  (with-simulation (farmer) (is (null (find-thing 'frog)))))

;;; Attributes.

(test manual-5-3.get-attribute
  "5.3: GET-ATTRIBUTE returns the current value, nil for what is not specified."
  (with-simulation (farmer)
    (is (equal '(5 red nil nil nil) (attributes (find-thing 'rake) :size :color :weight :obsmove
                                                :no-such-attribute)))))

(test manual-5-3.get-attribute-is-settable
  "5.3: (setf (get-attribute thing attribute) value) sets it; so does Nisp's !=."
  (with-simulation (farmer)
    (let ((rake (find-thing 'rake)))
      (is (eql 6 (setf (get-attribute rake :size) 6)))
      (!= (get-attribute rake :color) 'blue)
      (is (equal '(6 blue) (attributes rake :size :color))))))

(test manual-5-3.set-attribute
  "5.3: SET-ATTRIBUTE sets a value, whether there was one or not, and returns it."
  (with-simulation (farmer)
    (let ((rake (find-thing 'rake)))
      (is (eql 7 (set-attribute rake :size 7)))
      (is (eql 3 (set-attribute rake :tines 3)))
      (is (equal '(7 3 red) (attributes rake :size :tines :color)))
      (set-attribute rake :color nil)
      (is (null (get-attribute rake :color))))))

(test manual-5-3.change-attribute-changes-several
  "5.3, reading 173: new values for the attributes in the descriptor; others stay."
  (with-simulation (farmer)
    (let ((rake (find-thing 'rake)))
      (change-attribute rake '((:size 1.5) (:weight 2)))
      (is (equal '(1.5 2 red) (attributes rake :size :weight :color))))))

(test manual-5-3.attributes-change-what-is-seen-and-done
  "5.3: the simulator uses the values that are set, for sight and for obstacles."
  (with-simulation (farmer :clean t)
    (let ((rake (find-thing 'rake)))
      (set-attribute rake :color 'green)
      (is (equal '(nil (rake)) (seen '((:color green)))))
      (move-thing rake '(12 7))
      (is (null (end-code 'robot-goto-wall farmer)))
      (place-robot farmer 7 7 0)
      (set-attribute rake :obsmove #t)
      (is (eq :robot-blocked (end-code 'robot-goto-wall farmer)))
      (is (< 11.9 (robot-x farmer) 12)))))

(test manual-5-3.values-must-be-possible
  "5.3: a value that an attribute cannot have is refused where it is given."
  (with-simulation (farmer)
    (let ((rake (find-thing 'rake)))
      (signals wrong-argument (set-attribute rake :size 'large))
      (signals wrong-argument (set-attribute rake :color 'mauve))
      (signals wrong-argument (change-attribute rake '((:weight 1) (:size "5"))))
      (is (equal '(5 red nil) (attributes rake :size :color :weight)) "nothing was changed"))))

(test manual-5-3.what-is-not-specified-counts-as-none
  "Reading 122: a thing without :obsmove does not block the way, one without :weight or :size weighs
and takes nothing; yet GET-ATTRIBUTE answers nil, and no number matches."
  (with-simulation (farmer :clean t)
    (let ((ghost (new-thing ghost (barn 12 7) ((:color green)))))
      (is (equalp '(0 0 nil nil) (list (thing-weight ghost) (thing-size ghost)
                                       (thing-obsmove-p ghost) (thing-obsview-p ghost))))
      (is (equal '(nil nil) (attributes ghost :weight :obsmove)))
      (is (equal '(nil (ghost)) (seen '((:color green) (:obsmove #f)))))
      (is (equal '(:designator-not-found nil) (seen '((:color green) (:weight (-9 9)))))))))

;;; Where things are, and their end.

(test manual-5-3.things-tell-where-they-are
  "Reading 168: location, position, contents and name of a thing can be asked for."
  (with-simulation (farmer)
    (let* ((cart (find-thing 'cart)) (box (new-thing box cart ((:size 3) (:capacity 2))))
           (pin (new-thing pin box ((:size .1)))))
      (is (equal (list box cart) (list (thing-location pin) (thing-location box))))
      (is (equal (list pin) (thing-contents box)))
      (is (eq cart (thing-outermost pin)))
      (is (equalp '(7 7) (where pin)))
      (is-true (in-location box cart))
      (is-false (in-location pin cart) "its immediate location"))))

(test manual-5-3.things-can-be-moved
  "Reading 168: MOVE-THING puts a thing elsewhere, with all that is in it."
  (with-simulation (farmer)
    (let* ((cart (find-thing 'cart)) (hay (new-thing hay cart ((:size 1)))))
      (move-thing cart '(3 4.5))
      (is (equalp '((3 4.5) (3 4.5)) (list (where cart) (where hay))))
      (move-thing hay (robot-storage-bin farmer 0))
      (is (equal '(nil (7d0 7d0)) (list (thing-contents cart) (where hay)))))))

(test manual-5-3.things-can-be-destroyed
  "Reading 168: a destroyed thing is gone; its contents stay where they were."
  (with-simulation (farmer :clean t)
    (let* ((cart (find-thing 'cart)) (hay (new-thing hay cart ((:size 1)))))
      (destroy-thing cart)
      (is (equal '(nil nil) (list (find-thing 'cart) (thing-alive-p cart))))
      (is (equalp '(t (7 7)) (list (thing-alive-p hay) (where hay))))
      (let* ((bin (robot-storage-bin farmer 0)) (box (new-thing box bin ((:capacity 1))))
             (pin (new-thing pin box ())))
        (destroy-thing box)
        (is (equal (list pin) (storage-bin-contents bin))))
      (destroy-thing (find-thing 'rake))
      (is (equal '(:designator-not-found nil) (seen '((:color red))))))))
