;;;; saving-refused.lisp -- states that could not be loaded again are not saved.

(in-package :ars-magna.tests)
(in-suite saving)

;;; Each of these states could be saved, and no file of it loaded.

(defun text-of-refusal (function)
  "Call FUNCTION, which must signal MISUSE. Return what that says."
  (handler-case (progn (funcall function) (fail "It was saved.") "")
    (base:misuse (trouble) (princ-to-string trouble))))

(defun check-refused (save reason file)
  "Check that SAVE, a function of a file's name, says that it cannot save for REASON, and leaves
FILE as it is."
  (with-open-file (out file :direction :output :if-exists :supersede) (declare (ignorable out)))
  (let ((text (text-of-refusal (lambda () (funcall save file)))))
    (is (search reason text) "~A" text)
    (is (search "(simulator ROBOT) starts" text) "~A" text)
    (with-open-file (in file) (is (zerop (file-length in))))))

(defmacro with-hermits (() &body body)
  "Run BODY where the robot HERMIT is in the map HERMITAGE, and nothing of that is left afterwards."
  `(with-messages
     (base:with-own-definitions ()
       (handler-bind ((warning #'muffle-warning))
         (world:define-map 'hermitage 9 9)
         (robot:define-robot 'hermit 'hermitage '(3 3) 0)
         ,@body))))

(test saving.a-robot-that-is-twice-in-its-world-is-refused
  (with-hermits ()
    (with-temporary-file (file)
      (run:with-simulation (hermit :journal t)
        (robot:add-robot (robot:find-blueprint 'hermit) world:*world*)
        (run:run-ticks 1)
        (check-refused #'run:save-simulation "the head names a robot twice" file)
        (check-refused #'run:save-journal "the head names a robot twice" file)))))

(test saving.a-world-without-its-robot-is-refused
  (with-hermits ()
    (with-temporary-file (file)
      (let ((simulation (run:robot-simulation (symbol-value 'hermit))))
        (base:undefine 'robot 'hermit)
        (check-refused (lambda (file) (run:save-simulation file simulation))
                       "all robots have left" file)))))

(test saving.a-published-way-is-saved-with-its-interruption
  (with-hermits ()
    (with-temporary-file (file)
      (run:with-simulation (hermit)
        (let ((hermit (first (run:simulation-robots))))
          (command:robot-go-forward hermit 5)
          (run:run-ticks 1)
          (command:robot-stop hermit)
          (run:run-ticks 2)
          (robot:publish-way hermit '((1 2) (3 4)))
          (run:save-simulation file)))
      (run:with-loaded-simulation (file)
        (let ((hermit (first (run:simulation-robots))))
          (is (equal '((1d0 2d0) (3d0 4d0)) (robot:robot-planned-way hermit)))
          (setf (robot::robot-published-way hermit) (list nil '(1 2 3)))
          (check-refused #'run:save-simulation "the planned way" file))))))

(test saving.a-thing-that-is-in-itself-is-refused
  "A state that no command leads to, but that a fault of the simulator might."
  (with-hermits ()
    (with-temporary-file (file)
      (run:with-simulation (hermit)
        (let ((box (world:make-new-thing 'box '(hermitage 5 5) '((:size 1) (:capacity 5)))))
          (setf (world::thing-location box) box)
          (check-refused #'run:save-simulation "BOX" file))))))

(test relative-names.begin-at-one-place-when-saved-and-when-loaded
  (with-hermits ()
    (call-in-directory
     (lambda (directory)
       (let ((*default-pathname-defaults* directory))
         (run:with-simulation (hermit :journal t)
           (run:run-ticks 1)
           (dolist (path (list (run:save-simulation "run.sim") (run:save-journal "run.journal")))
             (is (equal (truename directory) (uiop:pathname-directory-pathname path)))))
         (is (= 1 (run:simulation-tick (run:load-simulation "run.sim"))))
         (is-true (run:load-journal "run.journal")))))))

(test saving.says-that-a-program-of-continuations-is-left-out
  (flet ((told-p (then)
           (with-temporary-file (file)
             (run:with-simulation (shrew :clean t)
               (command:robot-turn shrew .1 (lambda (&rest ignore)
                                              (declare (ignore ignore))
                                              (funcall then shrew)))
               (run:run-ticks 5)
               (run:save-simulation file)
               (has-words-p (displayed) "SHREW: the program that issued" "not in the saved run")))))
    (is-true (told-p (lambda (robot) (command:robot-turn robot 3))))
    (is-false (told-p (constantly nil)))))
