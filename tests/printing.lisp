;;;; printing.lisp -- files and data for other programs do not depend on the printer's settings.

(in-package :ars-magna.tests)

(def-suite* printing :in ars-magna)

(defun call-printing-strangely (function)
  "Call FUNCTION with the printer's variables as somebody may have set them for his own eyes."
  (let ((*print-base* 16) (*print-radix* t) (*print-case* :capitalize) (*print-length* 1)
        (*print-level* 1) (*print-pretty* t) (*print-right-margin* 20) (*print-circle* t)
        (*read-default-float-format* 'double-float))
    (funcall function)))

(defun writes-the-same-p (function)
  "True if FUNCTION returns the same texts, and some, however the printer is set."
  (let ((texts (funcall function)))
    (is-true texts)
    (is (equal texts (call-printing-strangely function)))))

(defun file-written-by (function type)
  "Return the text of a file of TYPE whose name FUNCTION was called with."
  (uiop:with-temporary-file (:pathname path :type type)
    (funcall function path)
    (uiop:read-file-string path)))

(test printing.trajectories-and-pictures-are-the-same
  (with-skater (:journal t)
    (command:robot-go-forward skater 4)
    (run:run-ticks 12)
    (writes-the-same-p (lambda () (saved-trajectory)))
    (dolist (display '(:world :all))
      (writes-the-same-p (lambda () (display:svg-picture skater :display display))))))

(test printing.pictures-name-things-alike
  (run:with-simulation (ars-worlds:robbie :seed 1)
    (writes-the-same-p (lambda () (display:svg-picture ars-worlds:robbie :display :all)))))

(test printing.charts-are-the-same
  (writes-the-same-p
   (lambda ()
     (list (plots:line-chart '((soon (1 1/3) (20 12 10 17)) ("late" (1 2))) :title "A title")
           (plots:survival-chart '((walk :steps ((12 1/2 0 1)) :times (12 13)))))))
  (writes-the-same-p
   (lambda ()
     (file-written-by (lambda (path)
                        (display:save-way-picture 'ars-worlds:watson '(((3 4) (14 17))) path))
                      "svg"))))

(defun lines-but-times (file)
  "Return the lines of FILE, but those that have the time, or a check sum that follows from it."
  (remove-if (lambda (line)
               (or (eql 0 (search "Written " line)) (eql 0 (search "Check sum" line))))
             (file-lines file)))

(test printing.experiments-are-the-same
  (define-for-test (:robots ars-worlds:dot)
    (:vary (metres 10 17))
    (:run (list metres "and so on" 1/3 '(a (b (c)))))
    (:measure (number 12) (what (list 'a 12 2.5))))
  (writes-the-same-p
   (lambda ()
     (experiment::call-with-temporary-directory
      (lambda (directory)
        (experiment:run-experiment 'question :trials 2 :directory directory :stream nil)
        (loop for name in '("rows.csv" "experiment.txt")
              collect (lines-but-times (uiop:subpathname directory name))))))))

(test printing.maps-are-the-same
  (writes-the-same-p
   (lambda ()
     (experiment::call-with-temporary-directory
      (lambda (directory)
        (let ((description (uiop:subpathname directory "room.yaml")))
          (floors:export-map 'ars-worlds:watson description)
          (uiop:read-file-string description)))))))

(test printing.objects-for-programs-are-the-same
  (run:with-simulation (ars-worlds:robbie :seed 1)
    (writes-the-same-p
     (lambda ()
       (with-output-to-string (out)
         (cli::write-object (list :tick 12 :name 'robbie :position #(1/3 20)
                                  :thing (first (world:world-thing-list
                                                 (robot:robot-world ars-worlds:robbie))))
                            (make-instance 'cli::object-stream :stream out)))))))

(test printing.what-is-said-is-the-same
  (flet ((text-of (control &rest arguments)
           (basics::text-of-condition (apply #'make-condition 'simple-error
                                           (list :format-control control
                                                 :format-arguments arguments)))))
    (writes-the-same-p
     (lambda ()
       (list (text-of "~A ~S of ~A" 17 'red '(1 2 3))
             (base:message-text (definitions::make-message :message
                                                    (list (base:phrase "at ~A ~A" 17 'red))))
             (base:safe-text 17)
             (tasks:lambda-list-text '(a &optional b))
             (tasks::form-text '(17 18))
             (handler-case (base:reject-use "not ~S ~A" 17 'red)
               (base:misuse (condition) (princ-to-string condition)))))))
  (run:with-simulation (ars-worlds:robbie :seed 1)
    (writes-the-same-p
     (lambda ()
       (command:robot-place ars-worlds:robbie)
       (run:run-ticks 3)
       (mapcar #'base:message-text (base:take-messages))))))
