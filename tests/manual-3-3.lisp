;;;; manual-3-3.lisp -- section 3.3 of the manual: objects and their attributes.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-3-3 :in ars-magna)

;;; Table 3.3.

(test manual-3-3.built-in-attributes
  "Table 3.3: which there are, and what values they take."
  (loop for (name kind . domain)
          in '((:obsmove :discrete t nil) (:obsview :discrete t nil) (:closed :discrete t nil)
               (:color :discrete red green blue violet lightred lightblue lightgreen lightviolet)
               (:size :numeric) (:weight :numeric) (:capacity :numeric) (:substance :numeric))
        for attribute = (find-attribute name)
        do (is (eq kind (attribute-kind attribute)) "~A" name)
           (is (null (set-exclusive-or domain (attribute-domain attribute))) "~A" name)))

(test manual-3-3.attributes-are-called-by-keywords
  "3.3: attribute names are Lisp keywords."
  (is (every #'keywordp (mapcar #'attribute-name (all-attributes)))))

(test manual-3-3.obsmove-blocks-movement
  "Table 3.3: an object blocks the robot's way if it is :obsmove, else not."
  (loop for (obsmove code) in '((#t :robot-blocked) (#f nil))
        do (at-each-spot (:clean t)
             (put-beside 'crate 3 0 :obsmove obsmove)
             (is (eq code (end-code 'robot-go-forward scout 8))))))

(test manual-3-3.obsview-obstructs-vision
  "Table 3.3: nothing behind an :obsview object is seen; other objects hide nothing."
  (loop for (obsview names) in '((#t (crate)) (#f (ball crate)))
        do (at-each-spot (:clean t)
             (put-beside 'crate 3 0 :obsview obsview)
             (put-beside 'ball 8 0)
             (is (equal names (seen))))))

(test manual-3-3.closed-containers-cannot-be-entered
  "Table 3.3, reading 155: a hand gets :BIN-CLOSED, and a camera as well."
  (loop for (closed code) in '((#t :bin-closed) (#f nil))
        do (at-each-spot (:clean t)
             (put-beside 'box .2 .1 :capacity 5 :closed closed)
             (let ((box (look '() :type :local)))
               (answer 'camera-track (eye) box)
               (is (eq code (end-code 'hand-insert (hand-of-scout) box)))
               (is (eq code (end-code 'camera-insert (eye) box)))))))

(test manual-3-3.nothing-kicks-itself-out-of-closed-containers
  "Table 3.3: the contents of a closed object stay inside."
  (with-scout (:clean t)
    (let* ((box (put-beside 'box 3 0 :capacity 5 :closed #t)) (frog (put 'frog box :size 1)))
      (is (null (kick-thing frog 1 0 #t)))
      (set-attribute box :closed #f)
      (is-true (kick-thing frog 1 0 #t)))))

(test manual-3-3.size-decides-what-fits
  "Table 3.3: a hand with an object enters a container only if it has room for the object."
  (loop for (size code) in '((5 nil) (5.1 :insufficient-capacity))
        do (at-each-spot (:clean t)
             (put 'ball (hand-of-scout) :size size)
             (is (eq code (end-code 'hand-insert-bin (hand-of-scout) (bin-of-scout 1)))))))

(test manual-3-3.weight-decides-what-can-be-picked-up
  "Table 3.3: a hand lifts what weighs no more than it is strong."
  (loop for (weight code) in '((4 nil) (4.25 :insufficient-strength))
        do (at-each-spot (:clean t)
             (put-beside 'ball .3 0 :weight weight :size 50)
             (tracking (record (look '() :type :local))
               (is (eq code (end-code 'hand-grasp-desig (hand-of-scout 1) (eye)
                                      (camera-tracks (eye)))))))))

(test manual-3-3.a-capacity-of-0-is-no-container
  "Table 3.3, reading 122: nor is a thing that says nothing of its capacity."
  (loop for (attributes code) in '(((:capacity 0) :insufficient-capacity)
                                   (() :insufficient-capacity)
                                   ((:capacity 1/4) nil))
        do (at-each-spot (:clean t)
             (apply #'put-beside 'box .2 0 attributes)
             (tracking (record (look '() :type :local))
               (is (eq code (end-code 'hand-insert (hand-of-scout) (camera-tracks (eye)))))))))

(test manual-3-3.capacity-is-what-fits-inside
  "Table 3.3: the sizes of the contents are subtracted."
  (with-scout (:clean t)
    (let ((box (put-beside 'box 3 0 :capacity 5)))
      (is (= 5 (remaining-capacity box)))
      (put 'pen box :size .5)
      (put 'cup box :size 2)
      (is (= 2.5 (remaining-capacity box))))))

(defun middle-pixel () (second (first (answer 'camera-view (eye 1)))))

(test manual-3-3.substance-is-seen-of-what-obstructs-vision
  "Table 3.3: directly."
  (at-each-spot (:clean t)
    (put-beside 'screen 4 0 :obsview #t :substance 70)
    (is (= 70 (middle-pixel)))))

(test manual-3-3.substance-is-seen-from-inside
  "Table 3.3: each pixel of a camera in a container is the container's parameter."
  (at-each-spot (:clean t)
    (put-beside 'box .2 0 :capacity 5 :substance 33)
    (tracking (record (look '() :type :local))
      (answer 'camera-insert (eye) (camera-tracks (eye)))
      (is (equal '(33d0 33d0 33d0 33d0 33d0) (first (answer 'camera-view (eye))))))))

(test manual-3-3.substance-corrupts-what-is-behind
  "Table 3.3, reading 65: the pixel is the mean of the wall, here 10, and the thing before it."
  (at-each-spot (:clean t)
    (is (= 10 (middle-pixel)))
    (put-beside 'pane 4 0 :substance 40)
    (is (= 25 (middle-pixel)))
    (put-beside 'mist 9 0 :substance 100)
    (is (= 50 (middle-pixel)))
    (put-beside 'air 12 0)
    (is (= 50 (middle-pixel)))))

(test manual-3-3.substances-have-three-forms
  "Reading 64: a number is the parameter, a symbol a type with one of its own, a list has both."
  (at-each-spot (:clean t)
    (loop for (substance parameter) in '((42 42) (wood 120) ((wood 7) 7))
          for screen = (put-beside 'screen 4 0 :obsview #t :substance substance)
          do (is (= parameter (thing-substance-parameter screen) (middle-pixel)))
             (destroy-thing screen))))

;;; Descriptors.

(defparameter *red-box*
  '((:obsmove #f) (:obsview #f) (:color red) (:substance 4.2)
    (:size 14) (:capacity 13) (:weight 1)))

(defparameter *blue-column*
  '((:obsmove #t) (:obsview #t) (:color blue) (:substance 7.3)
    (:size 10) (:capacity 0) (:shape cylinder)))

(defun put-described (descriptor dx dy)
  (make-new-thing 'thing (cons *world* (beside dx dy)) descriptor))

(test manual-3-3.descriptors-are-association-lists
  "3.3: the value is the cadr of the attribute's element; the examples make objects so."
  (with-scout ()
    (dolist (descriptor (list *red-box* *blue-column*))
      (let ((thing (put-described descriptor 4 0)))
        (loop for (key value) in descriptor
              do (is (equal value (get-attribute thing key)) "~A" key))))))

(test manual-3-3.the-box-can-be-passed-and-holds-things
  "3.3: the large red box does not block robots, and has room for 13."
  (at-each-spot (:clean t)
    (let ((box (put-described *red-box* 2 0)))
      (put 'ball box :size 13)
      (is (= 0 (remaining-capacity box)))
      (is (null (end-code 'robot-go-forward scout 6))))))

(test manual-3-3.the-column-blocks-way-and-view
  "3.3: the blue column does, and contains nothing."
  (at-each-spot (:clean t)
    (put-described *blue-column* 3 0)
    (put-beside 'ball 9 0)
    (is (equal '(thing) (seen)))
    (is (near 7.3 (middle-pixel) 1d-6))
    (is (eq :robot-blocked (end-code 'robot-go-forward scout 8)))))

(test manual-3-3.objects-that-match-can-be-looked-for
  "3.3: by any of their attributes, a user's too (reading 124)."
  (at-each-spot (:clean t)
    (let ((box (put-described *red-box* 4 1)) (column (put-described *blue-column* 4 -2)))
      (loop for (thing . specification) in `((,box (:color red)) (,column (:shape cylinder))
                                             (,box (:size 14) (:capacity (10 20)))
                                             (,column (:obsmove #t)))
            do (is (eq thing (designator-denotation (look specification))))))))

(test manual-3-3.sensors-estimate-attributes
  "3.3: the attributes that a search asks for are reported of each finding, with noise."
  (with-scout (:seed 9 :parameters *sure*)
    (put-beside 'box 5 0 :size 14)
    (let ((sizes (look-often 200 (lambda (found) (reading-of :size found))
                             :specification '((:size (0 99))))))
      (is (every #'realp sizes))
      (is (< 190 (length (remove-duplicates sizes))))
      (is (near 14 (/ (reduce #'+ sizes) 200) 1)))))

(test manual-3-3.sameness-is-not-given
  "3.3: a thing found twice gives two designators; only their data can show that they are the same."
  (at-each-spot (:clean t)
    (put-beside 'ball 4 0)
    (let ((first (look '())) (second (look '())))
      (is (not (eq first second)))
      (is (/= (designator-number first) (designator-number second)))
      (is (eq (designator-denotation first) (designator-denotation second))))))

(test manual-3-3.symbolic-attributes-have-set-values
  "3.3: a value outside of the predetermined set cannot be asked for."
  (with-scout ()
    (signals wrong-argument
      (camera-get-object-designator (eye) :non-local '((:color purple))))
    (signals wrong-argument
      (camera-get-object-designator (eye) :non-local '((:obsmove 3))))))

(test manual-3-3.world-designers-can-add-attributes
  "3.3, reading 20: a new attribute is looked for, read and reported like the built-in ones."
  (with-own-definitions ()
    (defattribute :ripeness (green ripe rotten) :noticed 1)
    (defattribute :price NUMERIC :noticed 1)
    (at-each-spot (:clean t)
      (put-beside 'plum 4 1 :ripeness 'ripe :price 3)
      (put-beside 'pear 4 -2 :ripeness 'rotten :price 9)
      (let ((found (look '((:ripeness (green ripe))))))
        (is (eq 'plum (thing-name (designator-denotation found))))
        (is (= 3 (reading-of :price found)))))))

(test manual-3-3.missing-attributes
  "Reading 122: get-attribute answers NIL; booleans count as false, and numbers as no value."
  (at-each-spot (:clean t)
    (let ((ball (put-beside 'ball 4 0)))
      (dolist (key '(:obsmove :obsview :size :weight :capacity :color :substance))
        (is (null (get-attribute ball key))))
      (is (= 0 (thing-size ball) (thing-weight ball) (thing-capacity ball)))
      (is-true (look '((:obsmove #f) (:obsview #f) (:closed #f))))
      (dolist (key '(:size :weight :capacity :substance))
        (is (null (look `((,key (-999 999))))) "~A" key)))))
