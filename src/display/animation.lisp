;;;; animation.lisp -- a run, replayed from its journal, as a moving picture or a series.

(in-package :ars-magna.display)

;;; An animated SVG draws the terrain once, and then the movers of each frame in a group that is
;;; visible in its turn. Programs that do not animate show the first frame.

(define-constant +frame-limit+ 600
  :documentation "How many frames a run is shown in at most, unless the user asks for more.")

(defun call-with-frames (function journal every until)
  "Replay JOURNAL up to the tick UNTIL (NIL: its end); call FUNCTION with a snapshot every EVERY
ticks and at the end."
  (let ((last nil))
    (flet ((show (world)
             (setf last (take-snapshot world last))
             (funcall function last)))
      (flet ((look (simulation)
               (keep-history simulation)
               (when (zerop (mod (simulation-tick simulation) every))
                 (show (simulation-world simulation)))))
        (call-with-replay (lambda ()
                            (let ((simulation (current-simulation)))
                              (unless (and last (= (snapshot-tick last)
                                                   (simulation-tick simulation)))
                                (show (simulation-world simulation)))))
                          journal :until until :observer #'look)))))

(defun frame-step (journal every until)
  "Return every how many ticks to draw a frame."
  (or every
      (max 1 (ceiling (if until (min until (journal-end journal)) (journal-end journal))
                      +frame-limit+))))

;;; One animated picture.

(defun write-frame (canvas index count seconds function)
  "Write a group, drawn by FUNCTION, that is visible as number INDEX of COUNT in SECONDS."
  (write-svg canvas "<g" (if (zerop index) "" " visibility=\"hidden\"") ">
<animate attributeName=\"visibility\" calcMode=\"discrete\" dur=\"" seconds
             "s\" repeatCount=\"indefinite\" values=\"")
  (write-string (cond ((= count 1) "visible")
                      ((zerop index) "visible;hidden")
                      ((= index (1- count)) "hidden;visible")
                      (t "hidden;visible;hidden"))
                (svg-stream canvas))
  (format (svg-stream canvas) "\" keyTimes=\"0~:[;~,6F~;~*~]~:[;~,6F~;~*~]\"/>~%"
          (zerop index) (/ index count)
          (= index (1- count)) (/ (1+ index) count))
  (funcall function)
  (write-svg canvas "</g>
"))

(defun write-animation (stream snapshots rate &key layers in-color scale)
  (let ((count (length snapshots)) (map (snapshot-map (first snapshots))))
    (with-svg (canvas stream :color-p in-color)
      (with-canvas (canvas :scale scale)
        (draw-terrain canvas map)
        (loop for snapshot in snapshots
              for index from 0
              do (write-frame canvas index count (/ count rate)
                              (lambda ()
                                (draw-movers canvas snapshot layers)
                                (draw-text canvas 3 12
                                           (format nil "tick ~D" (snapshot-tick snapshot))))))
        (values (to-pixels (map-width map)) (to-pixels (map-height map)))))))

;;; A series.

(defun numbered-file (file number)
  "Return FILE with NUMBER in its name: run.png is the first of run-0001.png, run-0002.png ...."
  (merge-pathnames (make-pathname :name (format nil "~A-~4,'0D" (pathname-name file) number))
                   (merge-pathnames file)))

(addition save-animation)
(defun save-animation (journal file &key every until (rate 10) series (display :world)
                                      (layers *picture-layers*) (in-color t)
                                      (scale graphics-scale*))
  "Replay JOURNAL (a journal or a file that holds one) up to the tick UNTIL or its end and save what
it looks like every EVERY ticks (by default as few that there are no more than 600 frames). An
animated SVG of the world, RATE frames a second, goes to FILE, a name that ends in .svg; with
SERIES, pictures of DISPLAY to a series of files, as FILE ends: for run.png, run-0001.png and so
on. The other arguments are those of SVG-PICTURE. Return the truename, or a list of them. Signals
WRONG-ARGUMENT, MISUSE, and what REPLAY does."
  (let ((kind (picture-kind 'save-animation file))
        (journal (if (journal-p journal) journal (read-journal journal))))
    (check-animation kind series every rate display layers scale)
    (if series
        (save-series journal file :every every :until until :display display
                                  :layers layers :in-color in-color :scale scale)
        (let ((snapshots '()))
          (call-with-frames (lambda (snapshot) (push snapshot snapshots))
                            journal (frame-step journal every until) until)
          (save-text (with-output-to-string (stream)
                       (write-animation stream (reverse snapshots) rate
                                        :layers layers :in-color in-color :scale scale))
                     file)))))

(defun check-animation (kind series every rate display layers scale)
  (flet ((reject (name value expected)
           (error 'wrong-argument :operator 'save-animation :name name :value value
                                  :expected expected)))
    (unless (or series (eq kind :svg))
      (reject "file" kind "a name that ends in .svg, or :series t for numbered pictures"))
    (unless (or series (eq display :world))
      (reject "display" display ":world, or :series t for numbered pictures"))
    (unless (or (null every) (whole-p every 1))
      (reject "every" every "a whole number of ticks, from 1 to 1e9"))
    (unless (and (finite-p rate) (<= 1/1000 rate 1000))
      (reject "rate" rate "a number of frames a second, from 0.001 to 1000"))
    (check-display 'save-animation display)
    (check-layers 'save-animation layers)
    (check-scale 'save-animation scale)))

(defun save-series (journal file &key every until display layers in-color scale)
  (let ((robot (first (getf (journal-header journal) :robots))) (files '()))
    (call-with-frames (lambda (snapshot)
                        (push (save-snapshot snapshot (snapshot-robot snapshot robot)
                                             (numbered-file file (1+ (length files)))
                                             :display display :layers layers
                                             :in-color in-color :scale scale)
                              files))
                      journal (frame-step journal every until) until)
    (reverse files)))
