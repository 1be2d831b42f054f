;;;; manual-4-handling.lisp -- how often hands, cameras and bins fail (manual 4).

(in-package :ars-magna.tests)

(in-suite manual-4)

(defparameter *steady-eyes* '((ars:prob-lose-track* 0) (ars:miss-thing-prob* 0)
                              (ars:false-thing-prob* 0))
  "Settings without chance in searches and tracks.")

(defun quick-sight (tag index)
  "Return the designator that JOINER's camera INDEX gets on what has TAG, next to it, and tracks."
  (let ((designator (third (quick-answer 4 'ars:camera-get-object-designator (lamp index) :local
                                         `((:tag ,tag))))))
    (quick-answer 4 'ars:camera-track (lamp index) designator)
    designator))

(defun quick-code (ticks command &rest arguments)
  (first (apply #'quick-answer ticks command arguments)))

;;; Hands.

(test manual-4.prob-miss-grasp*-misses
  "4: the chance that an attempted grasp misses its object."
  (with-joiner (:seed 1 :parameters `((ars:prob-grasp-lose-desig* 0) ,@*steady-eyes*))
    (let ((designator (quick-sight 'mallet 0)))
      (is (frequent-p (loop repeat 3000
                            count (eq :missed-grasp
                                      (quick-code 6 'ars:hand-grasp-desig
                                                  (arm 0) (lamp 0) designator))
                            do (quick-answer 1 'ars:hand-ungrasp (arm 0)))
                      3000 .04)))))

(test manual-4.prob-grasp-lose-desig*-loses-each-designator-for-itself
  "4: even if the grasp succeeds; tested independently for each designator on the object."
  (with-joiner (:seed 2 :parameters *steady-eyes*)
    (let ((lost '()))
      (loop repeat 1200
            do (let ((designators (list (quick-sight 'mallet 0) (quick-sight 'mallet 1))))
                 (quick-answer 6 'ars:hand-grasp-desig (arm 0) (lamp 0) (first designators))
                 (push (mapcar (lambda (d) (not (ars:designator-valid-p d))) designators) lost)
                 (quick-answer 1 'ars:hand-ungrasp (arm 0))
                 (dotimes (i 2) (quick-answer 1 'ars:camera-untrack (lamp i)))))
      (is (frequent-p (count t lost :key #'first) 1200 .1))
      (is (frequent-p (count t lost :key #'second) 1200 .1))
      (is (frequent-p (count '(t t) lost :test #'equal) 1200 .01)))))

(test manual-4.hand-insert-miss-prob*-misses-the-destination
  "4, reading 159: of containers and bins alike."
  (with-joiner (:seed 3 :parameters `((ars:hand-insert-lose-desig-prob* 0) ,@*steady-eyes*))
    (dolist (destination (list (quick-sight 'toolbox 0) (drawer 0)))
      (is (frequent-p (loop repeat 2500
                            count (eq :hand-bump
                                      (quick-code 2 'ars:hand-insert (arm 0) destination))
                            do (quick-answer 2 'ars:hand-remove (arm 0)))
                      2500 .05)))))

(test manual-4.hand-insert-lose-desig-prob*-is-of-misses
  "4, reading 157: a missed insertion loses each designator with that chance; one that succeeds
loses none."
  (loop for (miss lost) in '((1 .1) (0 0))
        do (with-joiner (:seed 4 :parameters `((ars:hand-insert-miss-prob* ,miss)
                                               ,@*steady-eyes*))
             (is (frequent-p (loop repeat 500
                                   for designator = (quick-sight 'toolbox 0)
                                   do (quick-answer 2 'ars:hand-insert (arm 0) designator)
                                   count (not (ars:designator-valid-p designator))
                                   do (quick-answer 2 'ars:hand-remove (arm 0))
                                      (quick-answer 1 'ars:camera-untrack (lamp 0)))
                             500 lost)))))

;;; Cameras.

(defun camera-insertions (trials)
  "Let camera 0 go into the toolbox TRIALS times, while camera 1 tracks that too. Return a list of
(code lost), LOST being whether the designator is not valid afterwards."
  (loop repeat trials
        collect (let ((designator (quick-sight 'toolbox 0)))
                  (quick-answer 4 'ars:camera-track (lamp 1) designator)
                  (list (quick-code 2 'ars:camera-insert (lamp 0) designator)
                        (not (ars:designator-valid-p designator))))
        do (quick-answer 2 'ars:camera-remove (lamp 0))
           (dotimes (i 2) (quick-answer 1 'ars:camera-untrack (lamp i)))))

(test manual-4.camera-insert-miss-prob*-misses-and-loses
  "4, reading 157: a camera that misses always loses the designator."
  (with-joiner (:seed 5 :parameters *steady-eyes*)
    (let ((outcomes (camera-insertions 700)))
      (is (frequent-p (count :camera-bump outcomes :key #'first) 700 .05))
      (is (equal '((:camera-bump t))
                 (remove-duplicates (remove nil outcomes :key #'first) :test #'equal))))))

(test manual-4.camera-insert-lose-desig-prob*-loses-it-all-the-same
  "4, reading 158: with that chance an insertion that succeeds loses the designator, though
another camera tracks it."
  (with-joiner (:seed 6 :parameters `((ars:camera-insert-miss-prob* 0) ,@*steady-eyes*))
    (let ((outcomes (camera-insertions 500)))
      (is (every #'null (mapcar #'first outcomes)))
      (is (frequent-p (count t outcomes :key #'second) 500 .1)))))

;;; Bins.

(test manual-4.bin-close-jam-prob*-jams
  "4, reading 166: if there is anything in the bin to jam it, whatever has happened before."
  (with-joiner (:seed 7)
    (flet ((jams (trials)
             (loop repeat trials
                   count (eq :bin-jammed (quick-code 2 'ars:storage-bin-close (drawer 0)))
                   do (quick-answer 2 'ars:storage-bin-open (drawer 0)))))
      (is (= 0 (jams 1500)))
      (send (drawer 0) 'shaving)
      (is (frequent-p (jams 5000) 5000 .01)))))
