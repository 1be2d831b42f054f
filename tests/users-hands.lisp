;;;; users-hands.lisp -- users change a run only by what its journal records.

(in-package :ars-magna.tests)

(def-suite* users-hands :in ars-magna)

(world:defmap larder (10 10)
  (obj jar (5 5) ((:size 1) (:color world:red))))
(robot:defrobot potter (larder (2 2) 0) :cameras ((6 5)))

(defmacro with-larder ((&rest options) &body body)
  `(run:with-simulation (potter :seed 5 :clean t ,@options) ,@body))

(defun jar () (world:find-thing 'jar))

(defun evaluated-by-user (text)
  "Return the value of the form in TEXT, as a user writes it, or the error that comes of it."
  (let ((*package* (find-package :ars-user)))
    (handler-case (handler-bind ((warning #'muffle-warning)) (eval (read-from-string text)))
      (error (condition) condition))))

;;; Readers.

(test readers.cannot-be-set-by-users
  (with-larder ()
    (dolist (text '("(setf (robot-x *potter*) 7)" "(setf (thing-size *jar*) 7)"
                    "(incf (thing-x *jar*))" "(push 1 (thing-contents *jar*))"
                    "(setf (world-seed (robot-world *potter*)) 9)"
                    "(funcall #'(setf robot-angle) 1 *potter*)"))
      (progv (list (intern "*POTTER*" :ars-user) (intern "*JAR*" :ars-user)) (list potter (jar))
        (let ((digest (run:state-digest)) (answer (evaluated-by-user text)))
          (is (typep answer 'base:misuse) "~A: ~A" text answer)
          (is (search "SET-ATTRIBUTE" (princ-to-string answer)))
          (is (= digest (run:state-digest))))))
    (progv (list (intern "*POTTER*" :ars-user)) (list potter)
      (is (= 2 (evaluated-by-user "(robot-x *potter*)")))
      (is (search "x coordinate" (evaluated-by-user "(documentation 'robot-x 'function)"))))))

(test readers.of-nisp-cannot-set-either
  (with-larder ()
    (let ((camera (robot:robot-camera potter 0)) (*readtable* *readtable*))
      (nisp:in-readtable :nisp)
      (progv (list (intern "*CAMERA*" :ars-user)) (list camera)
        (is (zerop (evaluated-by-user "!>*camera*.angle")))
        (dolist (text '("(!= !>*camera*.angle 2)" "(!= (!(camera angle) *camera*) 2)"))
          (is (typep (evaluated-by-user text) 'error) "~A" text)
          (is (zerop (robot:camera-angle camera))))))))

(test readers.that-users-may-set-can-be
  (is (eql 5d0 (evaluated-by-user "(let ((p (make-pt 1 2))) (setf (pt-x p) 5) (pt-x p))")))
  (is (equal '(1 9) (evaluated-by-user "(let ((v (list 1 2))) (setf (vref v 1) 9) v)"))))

;;; What is given is copied.

(test given.values-of-attributes-are-the-things-own
  (with-larder (:journal t)
    (let ((list (list 1 2 (list 3))) (text (copy-seq "note")))
      (world:set-attribute (jar) :numbers list)
      (world:change-attribute (jar) (list (list :label text)))
      (let ((digest (run:state-digest)))
        (setf (first list) 9 (first (third list)) 9 (char text 0) #\v)
        (is (equal '(1 2 (3)) (world:get-attribute (jar) :numbers)))
        (is (equal "note" (world:get-attribute (jar) :label)))
        (is (= digest (run:state-digest)))
        (run:run-ticks 2)
        (is-true (replays-p time:*simulation*))))))

(test given.descriptors-of-new-things-are-copied
  (with-larder ()
    (let* ((values (list 1 2)) (descriptor (list (list :numbers values)))
           (thing (world:make-new-thing 'tin '(larder 3 3) descriptor)))
      (setf (first values) 9 (second (first descriptor)) 8)
      (is (equal '(1 2) (world:get-attribute thing :numbers))))))

(test given.arguments-of-commands-are-copied
  "What is looked for is what was asked for, though it was altered before the command began."
  (with-larder ()
    (let* ((specification (list (list :color 'world:red))) (found nil))
      (command:camera-get-object-designator (robot:robot-camera potter 0) :non-local specification
                                            (lambda (err camera designator)
                                              (declare (ignore camera designator))
                                              (setf found (or err :found))))
      (setf (second (first specification)) 'world:blue)
      (run:run-ticks 10)
      (is (eq :found found)))))

(test given.resources-are-copied
  (with-larder ()
    (let ((resource (list 'stove 1)) (done '()))
      (time:schedule (resource :timer 3 :interrupt (push :lost done)) (push :kept done))
      (run:run-ticks 1)
      (setf (second resource) 2)
      (time:grab-resource (list 'stove 1))
      (run:run-ticks 5)
      (is (equal '(:lost) done)))))

(test given.what-never-ends-is-refused
  (with-larder ()
    (let ((circle (list 1 2)) (deep nil))
      (setf (cddr circle) circle)
      (dotimes (i 300) (setf deep (list deep)))
      (dolist (value (list circle deep (make-list 200000)))
        (signals base:wrong-argument (world:set-attribute (jar) :luck value))
        (signals base:wrong-argument (time:schedule (value) 1))))))

;;; Hash tables.

(test equal.is-the-test-of-a-hash-table
  (is (eql 3 (evaluated-by-user "(let ((h (make-hash-table :test 'equal)))
                                   (setf (gethash (list 1 \"x\") h) 1)
                                   (incf (gethash (list 1 \"x\") h) 2))")))
  (is (eql 7 (evaluated-by-user "(let ((h (make-hash-table :test #'equal)))
                                   (setf (gethash (make-pt 0 2) h) 7)
                                   (gethash (make-pt -0.0 2) h))")))
  (let ((table (make-hash-table :test 'geo:equal)))
    (flet ((key (a b) (geo:make-pt-interval (geo:make-interval a b) (geo:make-interval b 9))))
      (dotimes (i 5) (setf (gethash (geo:make-interval i 9) table) i
                           (gethash (key i 6) table) (- i)))
      (is (= 10 (hash-table-count table)))
      (is (= 3 (gethash (geo:make-interval 3 9) table)))
      (is (= -3 (gethash (key 3 6) table))))))

;;; Journals in which nothing happens.

(test journals.of-ages-of-silence-are-not-repeated-unasked
  (let ((journal (with-larder (:journal t)
                   (command:robot-turn potter 1)
                   (run:run-ticks 50)
                   (run:simulation-journal time:*simulation*))))
    (setf (run:journal-end journal) 1000000000)
    (let ((trouble (handler-case (run:replay journal) (base:misuse (condition) condition))))
      (is (search ":until 0" (princ-to-string trouble)))
      (is (search "1000000000" (princ-to-string trouble))))
    (is (= 100 (run:simulation-tick (run:replay journal :until 100))))))
