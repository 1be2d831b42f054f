;;;; rays-in-c.lisp -- the scans of rays.lisp compared with the same fans in C.

;;; Compiles peers/rays.c with gcc -O3 and prints rays per second of three functions: C's CAST,
;;; which only walks to the walls; C's SCAN, which finds cells with things, as ours does; and ours.
;;; Each figure is the best of several runs by processor time, because other users only slow it
;;; down.

(in-package :ars-magna.benchmarks)

(load (merge-pathnames "fans.lisp" *load-truename*))

(uiop:with-temporary-file (:pathname library :type "so")
  (uiop:run-program (list "gcc" "-O3" "-shared" "-fPIC" "-o" (namestring library)
                          (namestring (merge-pathnames "peers/rays.c" *load-truename*)) "-lm")
                    :error-output t)
  (sb-alien:load-shared-object library :dont-save t))

(defvar *found* (make-array 1000000 :element-type '(signed-byte 32)))

(defmacro define-fans-in-c (name c-name)
  "Define NAME as SCAN-ABOUT with the C function C-NAME; it returns the sum of what that returns."
  `(defun ,name (world places fans)
     (declare (optimize speed) (sb-ext:muffle-conditions sb-ext:compiler-note)
              (type simple-vector places) (type fixnum fans)
              (type (simple-array (signed-byte 32) (*)) *found*))
     (let ((flags (world:world-flags world)) (width (world:map-width (world:world-map world)))
           (sum 0))
       (declare (type (simple-array (unsigned-byte 8) (*)) flags) (type fixnum sum))
       (sb-sys:with-pinned-objects (flags *found*)
         (dotimes (fan fans sum)
           (destructuring-bind (x y) (svref places (mod fan (length places)))
             (incf sum (the fixnum
                            (sb-alien:alien-funcall
                             (sb-alien:extern-alien
                              ,c-name
                              (function (sb-alien:signed 64)
                                        sb-sys:system-area-pointer (sb-alien:signed 64)
                                        double-float double-float double-float double-float
                                        (sb-alien:signed 64) sb-sys:system-area-pointer))
                             (sb-sys:vector-sap flags) width
                             (the double-float x) (the double-float y)
                             (* 0.7d0 fan) (/ pi 2) 50 (sb-sys:vector-sap *found*))))))))))

(define-fans-in-c cast-about-in-c "cast")
(define-fans-in-c scan-about-in-c "scan")

(defun processor-seconds-for (function)
  (let ((start (get-internal-run-time)))
    (funcall function)
    (/ (- (get-internal-run-time) start) internal-time-units-per-second 1d0)))

(defun measure-beside-c (name map things &key (runs 25) (fans 4000))
  (multiple-value-bind (world places) (world-with-things map things)
    (flet ((call (function) (funcall function world places fans)))
      (assert (= (call 'scan-about) (call 'scan-about-in-c)))
      (let* ((functions '(cast-about-in-c scan-about-in-c scan-about))
             (times (loop repeat runs
                          collect (loop for function in functions
                                        collect (processor-seconds-for
                                                 (lambda () (call function))))))
             (best (reduce (lambda (a b) (mapcar #'min a b)) times)))
        (loop for seconds in best
              for what in '("walks in C" "scans in C" "our scans")
              do (say (format nil "~A, ~A" name what) (/ (* 50 fans) seconds) "rays/s"))
        (format t "  ours, of C's walks / of C's scans ~30T~24,2F / ~,2F~%"
                (/ (first best) (third best)) (/ (second best) (third best)))))))

(measure-beside-c "75 x 75, 10 things" 'benchmark-room 10)
(measure-beside-c "75 x 75, 1,000 things" 'benchmark-room 1000)
(measure-beside-c "rooms, 100,000 things" 'benchmark-rooms 100000)
