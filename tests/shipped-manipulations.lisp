;;;; shipped-manipulations.lisp -- the manipulations of the shipped worlds.

(in-package :ars-magna.tests)

(in-suite manipulations)

(defun put-there (name descriptor)
  "Make a thing NAME where COOK stands; return a designator of it."
  (world:make-new-thing name (list 'kitchen 5.5 5.5) descriptor)
  (designate name))

(defun do-till-done (name &rest arguments)
  "Run the manipulation NAME until it does not fail by chance; return its error code."
  (loop repeat 10
        for code = (first (apply #'outcome-of name arguments))
        until (not (eq code :failed))
        finally (return code)))

(defun declared-attribute (name attribute)
  (world:get-attribute (thing name) attribute))

(test shipped.open-and-close
  (with-cook (:clean t :seed 3)
    (let ((box (put-there 'strongbox '((:capacity 3) (:size 4)))))
      (is (eq :already-open (do-till-done 'open box (hand 0))))
      (is (null (do-till-done 'close box (hand 0))))
      (is (eq t (declared-attribute 'strongbox :closed)))
      (is (eq :bin-closed (code-of 'command:hand-insert (hand 0) box)))
      (is (eq :already-closed (do-till-done 'close box (hand 0))))
      (is (null (do-till-done 'open box (hand 0))))
      (is (null (declared-attribute 'strongbox :closed)))
      (do-till-done 'close box (hand 0))
      (grasp 0 'apple)
      (is (eq :hand-full (do-till-done 'open box (hand 0))))
      (put-into (hand 1) (bin 0))
      (is (eq :out-of-reach (do-till-done 'open box (hand 1))))
      (put-into (hand 1) nil)
      (world:set-attribute (thing 'strongbox) :locked t)
      (is (eq :locked (do-till-done 'open box (hand 1))))
      (is (eq :failed (do-till-done 'open (designate 'apple) (hand 1))) "no container"))))

(test shipped.lock-and-unlock
  (with-cook (:clean t :seed 3)
    (let ((box (put-there 'strongbox '((:capacity 3) (:closed t) (:lock-id 7))))
          (key (put-there 'key '((:type :key) (:lock-id 7) (:size .1))))
          (other (put-there 'latchkey '((:type :key) (:lock-id 8) (:size .1)))))
      (is (eq :key-not-in-hand (do-till-done 'lock box key (hand 0))))
      (is (null (code-of 'command:hand-grasp-desig (hand 0) (camera 0) (track (camera 0) key))))
      (is (eq :failed (do-till-done 'lock box other (hand 0))) "not its key")
      (is (null (do-till-done 'lock box key (hand 0))))
      (is (eq t (declared-attribute 'strongbox :locked)))
      (is (eq :locked (do-till-done 'open box (hand 1))))
      (is (null (do-till-done 'unlock box key (hand 0))))
      (is (null (do-till-done 'open box (hand 1))))
      (is (eq :lid-open (do-till-done 'lock box key (hand 0)))))))

(test shipped.lamps
  (with-cook (:clean t :seed 3)
    (let ((lamp (put-there 'lamp '((:type :lamp)))))
      (is (null (do-till-done 'switch-on lamp (hand 0))))
      (is (eq t (declared-attribute 'lamp :lit)))
      (is (null (do-till-done 'switch-off lamp (hand 1))))
      (is (null (declared-attribute 'lamp :lit)))
      (is (eq :failed (do-till-done 'switch-on (designate 'apple) (hand 0)))))))
