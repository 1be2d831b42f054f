;;;; listings-sensing.lisp -- the manual's descriptors, attributes, manipulation (manual 3, 5.4-5).

(in-package :ars-magna.tests)

(in-suite listings)

;;; 3.1.3: looking for a place.

(defun output-of-example (robot ticks)
  "Return what the example of 3.1.3 prints for ROBOT within TICKS."
  (let ((example (listing-function "3-1-3-documentation-example" 'robot)))
    (with-output-to-string (*standard-output*)
      (funcall example robot)
      (run:run-ticks ticks))))

(test documentation-example.tells-the-error
  "There is no place type DOOR, the manual says DOORWAY; with such a type it says nothing."
  (with-listings ()
    (with-watcher (:clean t)
      (let ((text (output-of-example watcher 20)))
        (is (eql 0 (search "Get designator failed on " text)))
        (is-true (has-words-p text "camera 1" "due to INVALID-PLACE-TYPE"))
        (is (= 1 (length (lines-of text))))))
    (eval '(world:def-place-type door (cell) :check-matchers ((((- * -) (- - -) (- * -)) 0))
            :before doorway))
    (world:rebuild-map 'gallery)
    (with-watcher (:clean t)
      (is (string= "" (output-of-example watcher 20)))
      (is (equal (list (list (own 'door)))
                 (mapcar #'robot:designator-data (robot:live-designators watcher)))))
    (with-watcher (:clean t)
      (robot:set-robot-angle watcher pi)
      (is (search "DESIGNATOR-NOT-FOUND" (output-of-example watcher 20))))))

;;; 3.3: things by descriptors.

(defun descriptor (name) (first (listing-forms name)))

(defun put-described (listing where)
  "Make a thing where WHERE says, (x y), by the descriptor in LISTING."
  (world:make-new-thing 'described (cons world:*world* where) (descriptor listing)))

(test descriptors.are-what-the-things-are
  (with-listings ()
    (with-watcher (:clean t)
      (loop for (listing y key value) in '(("3-3-descriptor-red-box" 9.5 :color red)
                                           ("3-3-descriptor-blue-column" 11.5 :shape cylinder))
            for thing = (put-described listing (list 9.5 y))
            do (loop for (attribute value) in (descriptor listing)
                     do (is (equal value (world:get-attribute thing attribute))))
               (is (eq thing (robot:designator-denotation
                              (find-object (list (list key value)))))))
      (let ((data (robot:designator-data (find-object (descriptor "3-3-descriptor-red-box")))))
        (is (base:value-equal 4.2 (second (assoc :substance data))))
        (is (base:value-equal 13 (second (assoc :capacity data))))))))

(test descriptors.have-their-physics
  "The column is in the way and in the view, the box in neither."
  (with-listings ()
    (flet ((hidden-and-blocking (listing)
             (with-watcher (:clean t)
               (let ((ball (put 'ball '(12.5 10.5))))
                 (put-described listing '(7.5 10.5))
                 (list (not (member ball (mapcar #'robot::sighting-denotation
                                                 (robot:look-for-things (eye) :non-local '()
                                                                        :all t))))
                       (end-code 'command:robot-go-forward watcher 5))))))
      (is (equal '(t :robot-blocked) (hidden-and-blocking "3-3-descriptor-blue-column")))
      (is (equal '(nil nil) (hidden-and-blocking "3-3-descriptor-red-box"))))))

(test descriptors.views-show-their-substance
  "That of the column, which is in the view; that of the box corrupts the wall's, which is 30."
  (with-listings ()
    (flet ((middle-pixel (listing)
             (with-watcher (:clean t)
               (robot:set-robot-pose watcher 5.5 5.5 0)
               (put-described listing '(8.5 5.5))
               (second (robot:take-view (eye 1))))))
      (is (near 7.3 (middle-pixel "3-3-descriptor-blue-column") 1d-6))
      (is (near (/ (+ 30 4.2) 2) (middle-pixel "3-3-descriptor-red-box") 1d-6)))))

;;; 3.4.2: specifications.

(defun found-sizes (specification)
  "Return the sizes of the things that a clean search finds, in order."
  (sort (loop for designator in (third (call-once 'command:camera-get-all-object-designators
                                                  (eye) :non-local (list specification)))
              collect (world:get-attribute (robot:designator-denotation designator) :size))
        #'<))

(defun found-colors (specification)
  (sort (loop for designator in (third (call-once 'command:camera-get-all-object-designators
                                                  (eye) :non-local (list specification)))
              collect (world:get-attribute (robot:designator-denotation designator) :color))
        #'string<))

(test specifications.match-what-the-text-says
  "Of things of each colour and of sizes from 0.8 to 7.4, a third apart. The threshold of .5
also widens the range that has none of its own."
  (with-listings ()
    (with-watcher (:clean t)
      (loop for tenths from 8 to 74 by 3
            do (put 'ball '(9.5 10.5) :size (/ tenths 10)))
      (dolist (color '(red green blue violet)) (put 'flag '(9.5 10.5) :color color))
      (destructuring-bind (red green-or-blue &rest sizes)
          (listing-forms "3-4-2-attribute-specifications")
        (is (equal '(red) (found-colors red)))
        (is (equal '(blue green) (found-colors green-or-blue)))
        (loop for specification in sizes
              for (low high) in '((3.5 4.5) (2.5 5.5) (2 6) (1 7))
              do (is (equalp (loop for tenths from 8 to 74 by 3
                                   when (<= low (/ tenths 10) high) collect (/ tenths 10))
                             (found-sizes specification))
                     "~S" specification))))))

(defun normal-between (low high mean deviation)
  "Return the probability that a normal number is between LOW and HIGH."
  (- (normal-probability (/ (- high mean) deviation))
     (normal-probability (/ (- low mean) deviation))))

(defparameter *no-others* '((false-thing-prob* 0) (miss-thing-prob* 0))
  "Parameters without missed and false things.")

(test specifications.match-with-noise
  "A colour is read right with .4, and else as any of eight; a size with its deviation, at 4 m."
  (with-listings ()
    (destructuring-bind (red green-or-blue &rest sizes)
        (listing-forms "3-4-2-attribute-specifications")
      (loop for (color in-red in-two) in '((red 0.475 .15) (blue .075 .55) (violet .075 .15))
            do (with-watcher (:seed 21 :parameters *no-others*)
                 (put 'ball '(9.5 10.5) :color color)
                 (is (frequent-p (find-count 3000 (list red)) 3000 in-red))
                 (is (frequent-p (find-count 3000 (list green-or-blue)) 3000 in-two))))
      (with-watcher (:seed 22 :parameters *no-others*)
        (put 'ball '(9.5 10.5) :size 4)
        (loop with deviation = (* .8 4 (/ 4 (+ 4 .05)))
              for specification in sizes
              for (low high) in '((3.5 4.5) (2.5 5.5) (2 6) (1 7))
              do (is (frequent-p (find-count 3000 (list specification)) 3000
                                 (normal-between low high 4 deviation))))))))

;;; 5.4: attributes.

(defmacro with-attributes-of-5.4 (() &body body)
  "Run BODY with :color and :size as the listings define them, and as nothing else did before."
  `(with-listings ()
     (world:define-attribute :color '(black white))
     (world:define-attribute :size 'world:numeric)
     (load-quietly "5-4-color")
     (load-quietly "5-4-size")
     ,@body))

(defun reading-count (trials key specification)
  "Return how many of TRIALS searches by SPECIFICATION also read the attribute KEY."
  (loop repeat trials
        count (assoc key (robot::sighting-data
                          (first (robot:look-for-things (eye) :non-local specification))))))

(test attributes-of-5.4.are-noticed-by-what-supports-them
  "1-(1-p)^(n+1): .4 and .7, more when their supporters are asked for."
  (with-attributes-of-5.4 ()
    (with-watcher (:seed 23 :parameters *no-others*)
      (put 'ball '(9.5 10.5) :color 'red :size 3 :weight 2 :capacity 2 :substance 4)
      (flet ((as-frequent-p (key specification probability)
               (frequent-p (reading-count 3000 key specification) 3000 probability)))
        (is (as-frequent-p :color '() .4))
        (is (as-frequent-p :color '((:substance 4 999)) .64))
        (is (as-frequent-p :color '((:weight 2 999)) .4))
        (is (as-frequent-p :size '() .7))
        (is (as-frequent-p :size '((:capacity 2 999)) .91))
        (is (as-frequent-p :size '((:capacity 2 999) (:weight 2 999)) .973))
        (is (as-frequent-p :size '((:capacity 2 999) (:weight 2 999) (:obsview (t nil)))
                           .9919))
        (is (as-frequent-p :size '((:substance 4 999)) .7))))))

(defun readings (trials key)
  "Return the values of KEY that TRIALS searches for anything with KEY read of the thing in view."
  (loop repeat trials
        collect (second (assoc key (robot::sighting-data
                                    (first (robot:look-for-things
                                            (eye) :non-local
                                            (if (eq key :size)
                                                '((:size 3 9999))
                                                '((:color (red green blue violet lightred
                                                           lightblue lightgreen
                                                           lightviolet)))))))))))

(test attributes-of-5.4.are-read-with-their-noise
  "A colour is right with .4 + .6/8, each other one as likely as the next; a size has the deviation
.8 times 4 but for a little, at 4 m."
  (with-attributes-of-5.4 ()
    (with-watcher (:seed 24 :parameters *no-others*)
      (put 'ball '(9.5 10.5) :color 'red :size 3)
      (let ((colors (readings 4000 :color)) (sizes (readings 4000 :size))
            (deviation (* .8 4 (/ 4 (+ 4 .05)))))
        (is (frequent-p (count 'red colors :test #'base:same-name-p) 4000 .475))
        (is (frequent-p (count 'lightgreen colors :test #'base:same-name-p) 4000 .075))
        (is (same-distribution-p sizes (lambda (x) (normal-probability
                                                    (/ (- x 3) deviation)))))))))

;;; 5.5: a manipulation.

(defmacro with-lock ((&rest options) &body body)
  "Run BODY where COOK stands by a BOX with its KEY, another's LATCHKEY, and an apple with a lock."
  `(with-listings ("5-5-lock")
     (with-cook (,@options)
       (put-there 'box '((:capacity 3) (:size 4) (:lock-id 7)))
       (put-there 'key '((:type :key) (:lock-id 7) (:size .1)))
       (put-there 'latchkey '((:type :key) (:lock-id 8) (:size .1)))
       (put-there 'block '((:capacity 0) (:size 4) (:lock-id 7)))
       ,@body)))

(defun ways-to-lock ()
  "Return the two fragments of 5.5.2 as functions: by MANIPULATE and by RUN-MANIPULATION."
  (loop for name in '("5-5-2-manipulate" "5-5-2-run-manipulation")
        collect (listing-function name 'box-desig 'key-desig 'hand 'cont)))

(defun lock-outcomes (trials way box key)
  "Have hand 0 lock BOX by KEY, both designators, TRIALS times; return the (code value) of each."
  (let ((outcomes '()))
    (loop repeat trials
          do (funcall way box key (hand 0) (lambda (&rest outcome) (push outcome outcomes)))
             (run:run-ticks 1))
    outcomes))

(test lock.locks-nine-times-in-ten
  "With the key in the hand, although shipped LOCKs, of lids and of doors, fit these things too."
  (with-lock (:seed 25)
    (is (= 3 (length (command::manipulation-methods (command:find-manipulation 'lock)))))
    (world:move-thing (thing 'key) (hand 0))
    (dolist (way (ways-to-lock))
      (world:set-attribute (thing 'box) :locked nil)
      (let* ((outcomes (lock-outcomes 3000 way (designate 'box) (designate 'key)))
             (locked (count (list nil (hand 0)) outcomes :test #'equal)))
        (is (= 3000 (length outcomes)) "each was answered once, after a tick")
        (is (<= 2550 locked 2850))
        (is (frequent-p locked 3000 .9))
        (is (= (- 3000 locked) (count '(:failed nil) outcomes :test #'equal)))
        (is (eq t (declared-attribute 'box :locked)))))))

(test lock.wants-the-key-in-the-hand
  (with-lock (:seed 26)
    (dolist (way (ways-to-lock))
      (let ((outcomes (lock-outcomes 1000 way (designate 'box) (designate 'key))))
        (is (frequent-p (count (list :not-holding-key (hand 0)) outcomes :test #'equal)
                        1000 .9))
        (is (frequent-p (count '(:failed nil) outcomes :test #'equal) 1000 .1))
        (is (null (declared-attribute 'box :locked)))))
    (world:move-thing (thing 'key) (hand 1))
    (is (find :not-holding-key (lock-outcomes 20 (first (ways-to-lock))
                                              (designate 'box) (designate 'key))
              :key #'first)
        "the other hand does not do")))

(test lock.is-for-a-container-and-its-key
  "No other key, no thing without room in it (its capacity is exactly 0), nothing but a key."
  (with-lock (:seed 27)
    (flet ((always-fails-p (way box key)
             (world:move-thing (thing key) (hand 0))
             (every (lambda (outcome) (equal '(:failed nil) outcome))
                    (lock-outcomes 200 way (designate box) (designate key)))))
      (dolist (way (ways-to-lock))
        (is (always-fails-p way 'box 'latchkey))
        (is (always-fails-p way 'block 'key))
        (is (always-fails-p way 'apple 'key))
        (is (always-fails-p way 'box 'apple))
        (is (always-fails-p way 'hamper 'key) "a container without a lock"))
      (is (null (declared-attribute 'box :locked))))))
