;;;; floors.lisp -- how long it takes to import a floor of 400 x 400 pixels.

;;; Prints milliseconds for two floors. The first is like a scanner's: rooms of 40 x 40 pixels with
;;; walls of two pixels, one pixel in a hundred wrongly occupied, and one in five unknown. The
;;; second is the worst case: every other pixel, at random, is occupied.

(in-package :ars-magna.benchmarks)

(defun say-import (name chance)
  "Say how long the 400 x 400 pixels, as CHANCE, a function of x and y, says, take to be imported."
  (uiop:with-temporary-file (:pathname yaml :type "yaml")
    (let ((image (make-pathname :type "pgm" :defaults yaml)))
      (with-open-file (out yaml :direction :output :if-exists :supersede)
        (format out "image: ~A~%resolution: 0.05~%origin: [0, 0, 0]~%negate: 0~%~
                     occupied_thresh: 0.65~%free_thresh: 0.196~%" (file-namestring image)))
      (with-open-file (out image :direction :output :external-format :latin-1)
        (format out "P5 400 400 255~%")
        (dotimes (y 400)
          (dotimes (x 400) (write-char (code-char (funcall chance x y)) out))))
      (unwind-protect
           (let ((report nil))
             (say (format nil "import ~A" name)
                  (* 1000 (median (loop repeat 5
                                        collect (seconds-for
                                                 (lambda ()
                                                   (setf report
                                                         (nth-value 1 (ars:import-map
                                                                       yaml :name 'imported
                                                                            :unknown nil))))))))
                  "ms")
             (say "cells that are occupied" (getf report :occupied) "")
             (say "walls" (getf report :walls) ""))
        (delete-file image)))))

(let ((dice (base:make-dice 1)))
  (say-import "rooms"
              (lambda (x y)
                (cond ((or (< (mod x 40) 2) (< (mod y 40) 2)) 0)
                      ((< (+ x y) 250) 205)
                      ((base:chance 1/100 dice) 0)
                      (t 254))))
  (say-import "noise" (lambda (x y) (declare (ignore x y)) (if (base:chance 1/2 dice) 0 254))))
