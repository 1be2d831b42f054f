;;;; animation.lisp -- a run, replayed from its journal, as a moving picture or a series.

(in-package :ars-magna.display)

(export '(*frame-hook* shown-end))

;;; An animated SVG draws the terrain once, and then the movers of each frame in a group that is
;;; visible in its turn. Programs that do not animate show the first frame. A page for browsers can
;;; besides be stopped and gone through: see film.lisp.

(defconstant +frame-limit+ 600 "The most frames of a film, unless the user asks for more.")

(defvar *frame-hook* (constantly nil)
  "A function that is called with the tick of each frame of a run that is drawn, for those who say
how far that has come.")

(defun call-with-frames (function journal every until &key part (watch #'identity))
  "Replay JOURNAL up to the tick UNTIL (NIL: its end); call FUNCTION with a snapshot of its
beginning, of every EVERY ticks and of its end, of PART of its map or, if that is NIL, of all; and
WATCH with the simulation at the beginning and after each tick. Signals what FUNCTION does."
  (let ((last nil) (queue *message-queue*) (trouble nil))
    (labels ((draw ()
               ;; What is wrong with drawing is to be told here, not in the run repeated, in which
               ;; an observer's errors are messages.
               (let ((*message-queue* queue))
                 (handler-case (funcall function (in-part last part 'save-animation))
                   (error (condition) (setf trouble condition)))))
             (show (simulation)
               (setf last (take-snapshot (simulation-world simulation) last))
               (unless trouble (draw))
               (funcall *frame-hook* (snapshot-tick last)))
             (look (simulation)
               (keep-history simulation)
               (funcall watch simulation)
               (when (zerop (mod (simulation-tick simulation) every)) (show simulation)))
             (end ()
               (let ((simulation (current-simulation)))
                 (unless (= (snapshot-tick last) (simulation-tick simulation))
                   (show simulation))
                 (when trouble (error trouble)))))
      (call-with-replay #'end journal :until until :observer #'look :beginning #'look))))

(defun frame-step (journal every until)
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
    (wipe canvas 0 0 (+ 7 (words-width text)) +line-height+)
    (draw-text canvas 3 12 text)))

(defun write-frames-of (canvas snapshots rate layers)
  (loop with count = (length snapshots)
        for snapshot in snapshots
        for index from 0
        do (write-frame canvas index count (/ count rate)
                        (lambda ()
                          (draw-movers canvas snapshot layers)
                          (draw-tick-label canvas (snapshot-tick snapshot))))))

(defun title-of-journal (journal)
  (let ((header (journal-header journal)))
    (title-of (mapcar (lambda (robot) (drawn-name (blueprint-name (find-blueprint robot))))
                      (getf header :robots))
              (map-name (find-map (getf header :map))))))

(defun titled-anyway (title journal anyway)
  "Return TITLE, or NIL; one that says so if JOURNAL is shown ANYWAY, with other definitions."
  (let ((words (and anyway (typep title '(or null string)) (repeated-words journal))))
    (if words
        (format nil "~A~%~A" (or title (title-of-journal journal)) words)
        title)))

(defun shown-end (operator journal until)
  "Return the tick at which what is shown of JOURNAL, up to UNTIL, an argument of OPERATOR, ends.
Signals WRONG-ARGUMENT if UNTIL is no tick of it, nor NIL."
  (let ((end (journal-end journal)))
    (unless (typep until `(or null (integer 0 ,end)))
      (reject-argument operator :until until
                       (format nil "a tick of the journal, from 0 to ~D, or NIL" end)))
    (or until end)))

;;; A series.

(defun numbered-file (file number)
  "Return FILE with NUMBER in its name: run.png is the first of run-0001.png, run-0002.png ...."
  (merge-pathnames (make-pathname :name (format nil "~A-~4,'0D" (pathname-name file) number))
                   (merge-pathnames file)))

(addition save-animation)
(define-with-keywords save-animation
    (journal file &key every until (rate 10) series (display :world) moments (kinds t)
                       (layers *picture-layers*) (in-color t) scale title part anyway)
  "Replay JOURNAL (a journal, a file that holds one, or NIL for that of the current simulation so
far) up to the tick UNTIL or its end and save what it looks like every EVERY ticks (by default as
few that there are no more than 600 frames), RATE frames a second, to FILE. If its name ends in
.html it is a page for any browser, without a network, in which the run can be played, stopped, and
gone through: what a robot grasped, let go of and stowed, and which commands failed, are marked
there, also plans and parts of plans that failed or were ended, errors in your code, and what the
list MOMENTS has besides, each a moment or a list of a tick and a string; KINDS chooses, see
SAVE-RUN-PICTURE. If it ends in .svg, it is an animated picture of the world, in a file about ten
times as large. With SERIES, pictures of DISPLAY go to a series of files, as FILE ends: for run.png,
run-0001.png and so on. A page is as large as its window: a SCALE of more than suits the map changes
nothing there. The first frame shows how the run began. With ANYWAY the run is replayed also if its
definitions are not those at hand. The other arguments are those of
SVG-PICTURE. Return the truename, or a list of them. Signals WRONG-ARGUMENT, MISUSE, and what REPLAY
does."
  (let* ((kind (if series
                   (picture-kind 'save-animation file)
                   (picture-kind 'save-animation file '(:html :svg)
                                 ".html or .svg; with :series t in .svg or .png")))
         (journal (journal-meant journal 'save-animation))
         (moments (checked-moments 'save-animation moments
                                   (shown-end 'save-animation journal until)))
         (title (titled-anyway title journal anyway))
         ;; The tick, which a title has that nobody gave, is told of by frames.
         (look (list :every every :until until
                     :layers (if (or series title) layers (remove :title layers))
                     :in-color in-color :scale scale :title title :part part)))
    (check-animation series every rate display layers scale title)
    (check-kinds 'save-animation kinds)
    (telling-what-breaks
      (replaying (anyway)
        (if series
            (apply #'save-series journal file :display display look)
            (save-text (if (eq kind :html)
                           (apply #'film-text journal moments :rate rate :kinds kinds look)
                           (apply #'animation-text journal :rate rate look))
                       file))))))

(defun animation-text (journal &key every until rate layers in-color scale title part)
  (let ((snapshots '()))
    (call-with-frames (lambda (snapshot) (push snapshot snapshots))
                      journal (frame-step journal every until) until :part part)
    (let* ((snapshots (reverse snapshots)) (first (first snapshots)))
      (framed-text first
                   (lambda (canvas)
                     (draw-terrain canvas (snapshot-map first) :layers layers)
                     (write-frames-of canvas snapshots rate layers))
                   :layers layers :in-color in-color :scale scale :title title))))

(addition journal-moments)
(define-with-keywords journal-moments
    (journal &key until anyway)
  "Replay JOURNAL (a journal, a file that holds one, or NIL for that of the current simulation so
far) up to the tick UNTIL or its end; return a list of what happened there that people look for, in
order: moments at which a robot grasped, let go of or stowed something, a command failed, a plan or
a part of one failed or was ended, or an error came up in users' code. With ANYWAY it is replayed
also if its definitions are not those at hand. Signals what REPLAY does."
  (let ((journal (journal-meant journal 'journal-moments)))
    (shown-end 'journal-moments journal until)
    (multiple-value-bind (watch seen) (moments-watcher)
      (in-order (append (call-with-replay seen journal :until until :anyway anyway
                                                       :observer watch :beginning watch)
                        (remarked-moments journal until))))))

(defun check-animation (series every rate display layers scale title)
  (check-display 'save-animation display)
  (check-argument save-animation display (or series (eq display :world))
                  ":world, or :series t for numbered pictures")
  (check-argument save-animation every (or (null every) (whole-p every 1))
                  "a whole number of ticks, from 1 to 1e9")
  (check-argument save-animation rate (and (finite-p rate) (<= 1/1000 rate 1000))
                  "a number of frames a second, from 0.001 to 1000")
  (check-map-options 'save-animation :title title :layers layers :scale scale))

(defun files-in-words (files)
  "Return what FILES, one or more of a series, the last first, are called."
  (format nil "~A~@[ to ~A~]" (shown-name (first (last files)))
          (and (rest files) (name-in-directory (first files)))))

(defun warn-of-older-frames (file count)
  "Say so if an older series called FILE, of which COUNT files were written anew, had more. They are
left alone: nobody said that they may go."
  (let ((older (loop for number from (1+ count)
                     for frame = (numbered-file file number)
                     while (probe-file frame) collect frame)))
    (when older
      (warning-set (format nil "~A are of an older series, which was longer than this one of ~D. ~
                                Delete them before you make a film of the files."
                           (files-in-words (reverse older)) count)))))

(defun call-for-series (function files)
  "Call FUNCTION, which writes the next file of a series of which FILES, the last first, are there.
Signals MISUSE, which says so, if it cannot."
  (handler-case (funcall function)
    (misuse (trouble)
      (if files
          (reject-use "~A. Of the series there ~:[is~;are~] so far ~A."
                      (one-line-text trouble) (rest files) (files-in-words files))
          (error trouble)))))

(defun save-series (journal file &key every until display layers in-color scale title part)
  (let ((robot (first (getf (journal-header journal) :robots))) (files '()))
    (flet ((save (snapshot)
             (save-snapshot snapshot (snapshot-robot snapshot robot)
                            (numbered-file file (1+ (length files)))
                            :display display :layers layers
                            :in-color in-color :scale scale :title title)))
      (call-with-frames (lambda (snapshot)
                          (push (call-for-series (lambda () (save snapshot)) files) files))
                        journal (frame-step journal every until) until :part part))
    (warn-of-older-frames file (length files))
    (reverse files)))
