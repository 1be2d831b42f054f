;;;; animation.lisp -- a run, replayed from its journal, as a moving picture or a series.

(in-package :ars-magna.display)

;;; An animated SVG draws the terrain once, and then the movers of each frame in a group that is
;;; visible in its turn. Programs that do not animate show the first frame. A page for browsers can
;;; besides be stopped and gone through: see film.lisp.

(define-constant +frame-limit+ 600
  :documentation "How many frames a run is shown in at most, unless the user asks for more.")

(defun call-with-frames (function journal every until &optional (watch #'identity))
  "Replay JOURNAL up to the tick UNTIL (NIL: its end); call FUNCTION with a snapshot every EVERY
ticks and at the end, and WATCH with the simulation after each."
  (let ((last nil))
    (flet ((show (world)
             (setf last (take-snapshot world last))
             (funcall function last)))
      (flet ((look (simulation)
               (keep-history simulation)
               (funcall watch simulation)
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

(defun draw-tick-label (canvas tick)
  "Write in the corner of CANVAS that it is TICK, on a light strip, as there may be a wall."
  (let ((text (format nil "tick ~D" tick)))
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-rectangle canvas draw-gcontext* 0 0 (+ 7 (* +character-width+ (length text)))
                      +line-height+ t))
    (draw-text canvas 3 12 text)))

(defun write-frames-of (canvas snapshots rate layers)
  (loop with count = (length snapshots)
        for snapshot in snapshots
        for index from 0
        do (write-frame canvas index count (/ count rate)
                        (lambda ()
                          (draw-movers canvas snapshot layers)
                          (draw-tick-label canvas (snapshot-tick snapshot))))))

(defun write-animation (stream snapshots rate &key layers in-color scale)
  (let ((first (first snapshots)))
    (with-svg (canvas stream :color-p in-color)
      (with-canvas (canvas :scale (suitable-scale scale first layers))
        (draw-framed canvas first layers
                     (lambda ()
                       (draw-terrain canvas (snapshot-map first) :layers layers)
                       (write-frames-of canvas snapshots rate layers)))))))

;;; A page.

(defun movers-text (snapshot layers in-color scale)
  "Return what moves in SNAPSHOT as lines of SVG."
  (with-output-to-string (out)
    (let ((canvas (make-instance 'svg-canvas :stream out :color-p in-color)))
      (with-canvas (canvas :scale scale) (draw-movers canvas snapshot layers)))))

(defun still-text (snapshot movers layers in-color scale)
  "Return an SVG document of the map of SNAPSHOT and LAYERS, with a group called movers over it, of
the lines of SVG MOVERS."
  (with-output-to-string (out)
    (with-svg (canvas out :color-p in-color)
      (with-canvas (canvas :scale scale)
        (draw-framed canvas snapshot layers
                     (lambda ()
                       (draw-terrain canvas (snapshot-map snapshot) :layers layers)
                       (write-svg canvas "<g id=\"movers\">
" movers "</g>
")))))))

(defun film-title (journal ticks)
  (format nil "~{~(~A~)~^ and ~}, tick~P ~D~@[ to ~D~]"
          (mapcar (lambda (robot) (blueprint-name (find-blueprint robot)))
                  (getf (journal-header journal) :robots))
          (length ticks) (first ticks)
          (and (rest ticks) (first (last ticks)))))

(defun film-text (journal moments &key every until rate layers in-color scale)
  "Return the page of a film of JOURNAL, with MOMENTS besides those that are seen in it."
  (let ((reel (make-reel)) (ticks '()) (opening nil) (first nil) (last nil))
    (multiple-value-bind (watch seen) (moments-watcher)
      (call-with-frames (lambda (snapshot)
                          (unless opening
                            (setf opening snapshot
                                  scale (suitable-scale scale snapshot layers)))
                          (setf last (movers-text snapshot layers in-color scale)
                                first (or first last))
                          (push (snapshot-tick snapshot) ticks)
                          (add-frame last reel))
                        journal (frame-step journal every until) until watch)
      (setf ticks (reverse ticks))
      (flet ((still (movers) (still-text opening movers layers in-color scale)))
        (with-output-to-string (out)
          (write-film out (film-title journal ticks) (still first) (still last)
                      reel ticks rate (in-order (append (funcall seen) moments))))))))

(defun film-file-p (file)
  "True if FILE, the name of one, is a page for browsers, as it ends."
  (and (typep file '(or string pathname))
       (string-equal "html" (or (pathname-type file) ""))))

(defun animation-kind (file series)
  "Return :HTML, :SVG or :PNG, as the name of FILE ends. Signals WRONG-ARGUMENT for other names, and
says what is for a film, or for a SERIES."
  (if (film-file-p file)
      (let ((missing (missing-directory file)))
        (when missing
          (reject-argument 'save-animation 'file file
                           (format nil "a name in a directory that there is; make ~A first"
                                   missing)))
        :html)
      (picture-kind 'save-animation file (if series ".svg or .png" ".html or .svg"))))

;;; A series.

(defun numbered-file (file number)
  "Return FILE with NUMBER in its name: run.png is the first of run-0001.png, run-0002.png ...."
  (merge-pathnames (make-pathname :name (format nil "~A-~4,'0D" (pathname-name file) number))
                   (merge-pathnames file)))

(addition save-animation)
(defun save-animation (journal file &key every until (rate 10) series (display :world) moments
                                      (layers *picture-layers*) (in-color t) scale)
  "Replay JOURNAL (a journal, a file that holds one, or NIL for that of the current simulation so
far) up to the tick UNTIL or its end and save what it looks like every EVERY ticks (by default as
few that there are no more than 600 frames), RATE frames a second, to FILE. If its name ends in
.html it is a page for any browser, without a network, in which the run can be played, stopped, and
gone through: what a robot grasped, let go of and stowed, and which commands failed, are marked
there, and what the list MOMENTS has besides, each a moment or a list of a tick and a string. If it
ends in .svg, it is an animated picture of the world. With SERIES, pictures of DISPLAY go to a
series of files, as FILE ends: for run.png, run-0001.png and so on. The other arguments are those of
SVG-PICTURE. Return the truename, or a list of them. Signals WRONG-ARGUMENT, MISUSE, and what REPLAY
does."
  (let ((kind (animation-kind file series))
        (moments (checked-moments 'save-animation moments))
        (journal (journal-meant journal))
        ;; The tick, which the title has, is told of by frames.
        (look (list :layers (if series layers (remove :title layers))
                    :in-color in-color :scale scale)))
    (check-animation kind series every rate display layers scale)
    (cond (series
           (apply #'save-series journal file :every every :until until :display display look))
          ((eq kind :html)
           (save-text (apply #'film-text journal moments :every every :until until :rate rate look)
                      file))
          (t (save-text (apply #'animation-text journal :every every :until until :rate rate look)
                        file)))))

(defun animation-text (journal &key every until rate layers in-color scale)
  "Return the animated SVG document of JOURNAL."
  (let ((snapshots '()))
    (call-with-frames (lambda (snapshot) (push snapshot snapshots))
                      journal (frame-step journal every until) until)
    (with-output-to-string (stream)
      (write-animation stream (reverse snapshots) rate
                       :layers layers :in-color in-color :scale scale))))

(addition journal-moments)
(defun journal-moments (journal &key until)
  "Replay JOURNAL (a journal, a file that holds one, or NIL for that of the current simulation so
far) up to the tick UNTIL or its end; return a list of what happened there that people look for, in
order: moments at which a robot grasped, let go of or stowed something, or a command failed. Signals
what REPLAY does."
  (multiple-value-bind (watch seen) (moments-watcher)
    (call-with-replay seen (journal-meant journal) :until until :observer watch)))

(defun check-animation (kind series every rate display layers scale)
  (flet ((reject (name value expected)
           (error 'wrong-argument :operator 'save-animation :name name :value value
                                  :expected expected)))
    (when (if series (eq kind :html) (eq kind :png))
      (reject "file" kind "a name that ends in .html or .svg; with :series t in .svg or .png"))
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
