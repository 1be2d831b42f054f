;;;; animation.lisp -- a run, replayed from its journal, as an animated picture or a series.

(in-package :ars-magna.display)

(export '(*frame-hook* checked-end-tick))

;;; An animated SVG has the terrain once, and a group for the movers of each frame, which is visible
;;; in its turn. Programs that do not animate show the first frame. A page for browsers can also be
;;; stopped and searched: see film.lisp.

(defconstant +most-frames+ 600
  "The largest number of frames of a film, unless the user sets :EVERY.")

(defvar *frame-hook* (constantly nil)
  "A function that is called with ticks during the replay for a film, to report progress.")

(defun call-with-frames (function journal every until &key (from 0) part (watch #'identity))
  "Replay JOURNAL up to the tick UNTIL, by default its end. Call FUNCTION with a snapshot at the
tick FROM, every EVERY ticks after it, and at the end. The snapshots show PART of the map, or the
whole map if PART is NIL. Call WATCH with the simulation at the beginning and after each tick.
Errors of FUNCTION are signalled after the replay."
  (let ((last nil) (queue *message-queue*) (trouble nil))
    (labels ((draw ()
               ;; Errors in drawing are signalled here; an observer's would be messages.
               (let ((*message-queue* queue))
                 (handler-case (funcall function (snapshot-of-part last part 'save-animation))
                   (error (condition) (setf trouble condition)))))
             (show (simulation)
               (setf last (take-snapshot (simulation-world simulation) last))
               (unless trouble (draw)))
             (look (simulation &aux (tick (simulation-tick simulation)))
               (keep-history simulation)
               (funcall watch simulation)
               (when (zerop (mod (- tick from) every))
                 (when (>= tick from) (show simulation))
                 (funcall *frame-hook* tick)))
             (end ()
               (let ((simulation (current-simulation)))
                 (unless (= (snapshot-tick last) (simulation-tick simulation))
                   (show simulation))
                 (when trouble (error trouble)))))
      (call-with-replay #'end journal :until until :observer #'look :beginning #'look))))

(defun frame-step (journal every until from)
  (or every
      (max 1 (ceiling (- (if until (min until (journal-end journal)) (journal-end journal)) from)
                      +most-frames+))))

(defun write-frame (canvas index count seconds function)
  "Write an SVG group that FUNCTION draws: frame INDEX of COUNT, in an animation of SECONDS."
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
  "Write TICK in the corner of CANVAS, on a white background, because a wall may be there."
  (let ((text (format nil "tick ~D" tick)))
    (fill-with-white canvas 0 0 (+ 7 (monospaced-width text)) +line-height+)
    (draw-text canvas 3 12 text)))

(defun write-animation-frames (canvas snapshots rate layers)
  (loop with count = (length snapshots)
        for snapshot in snapshots
        for index from 0
        do (write-frame canvas index count (/ count rate)
                        (lambda ()
                          (draw-movers canvas snapshot layers)
                          (draw-tick-label canvas (snapshot-tick snapshot))))))

(defun title-of-journal (journal)
  (let ((names (journal-robot-names journal)))
    (robots-and-map-title (mapcar (lambda (name) (drawn-name (name-label name names))) names)
                          (map-name (find-map (getf (journal-header journal) :map))))))

(defun title-with-remark (title journal anyway)
  "Return TITLE, a string or NIL. If ANYWAY is true and definitions have changed since JOURNAL was
made, add a remark that says so."
  (let ((words (and anyway (typep title '(or null string)) (changed-definitions-sentence journal))))
    (if words
        (format nil "~A~%~A" (or title (title-of-journal journal)) words)
        title)))

(defun checked-end-tick (operator journal until)
  "Return the last tick of JOURNAL to show: UNTIL, or the end of JOURNAL if UNTIL is NIL. Signals
WRONG-ARGUMENT for OPERATOR if UNTIL is not a tick of JOURNAL."
  (let ((end (journal-end journal)))
    (unless (typep until `(or null (integer 0 ,end)))
      (reject-argument operator :until until
                       (format nil "a tick of the journal, from 0 to ~D, or NIL" end)))
    (or until end)))

(defun check-start-tick (from end)
  "Signal WRONG-ARGUMENT for SAVE-ANIMATION unless FROM is a tick of a film that ends at END."
  (check-argument save-animation from (whole-p from 0 end)
                  (format nil "a tick from 0 to ~D, the end of the film" end)))

(defun numbered-file (file number)
  "Return the pathname FILE with NUMBER added to its name: run-0001.png for run.png and 1."
  (merge-pathnames (make-pathname :name (format nil "~A-~4,'0D" (pathname-name file) number))
                   (merge-pathnames file)))

(addition save-animation)
(define-with-keywords save-animation
    (journal file &key every (from 0) until (rate 10) series (display :world) moments (kinds t)
                       (layers *picture-layers*) (in-color t) scale title part anyway)
  "Replay a run and save it in FILE as a film. Return the truename of FILE, or with SERIES a list of
truenames. JOURNAL is a journal, the name of a journal file, or NIL for the journal of the current
simulation. The film has a frame for the tick FROM, by default 0, and one after every EVERY ticks,
up to the tick UNTIL, by default the end. By default EVERY is chosen so that the film has at most
600 frames. RATE is the number of frames per second.

The name of FILE chooses the kind of film:
- .html: a page that plays, stops and searches the run in any browser, without a network. The page
  lists what robots grasped, released and stowed; commands that failed; plans and parts of plans
  that failed or were ended; errors in your code; and your own MOMENTS, a list of moments or of
  lists (tick string). KINDS chooses the kinds of listed events: see SAVE-RUN-PICTURE. The page fits
  its window, so a SCALE larger than the map needs has no effect.
- .svg: an animated picture of the world. The file is about ten times as large as an .html file.
- .svg or .png with SERIES: numbered pictures of DISPLAY. If FILE is run.png, the first picture is
  run-0001.png.

With ANYWAY, replay the run even if definitions have changed since it was recorded. The other
arguments are those of SVG-PICTURE. Signals WRONG-ARGUMENT, MISUSE, and the errors of REPLAY."
  (let* ((kind (if series
                   (picture-kind 'save-animation file)
                   (picture-kind 'save-animation file '(:html :svg)
                                 ".html or .svg; with :series t, in .svg or .png")))
         (journal (resolve-journal journal 'save-animation))
         (end (checked-end-tick 'save-animation journal until))
         (moments (checked-moments 'save-animation moments end))
         (title (title-with-remark title journal anyway))
         ;; A default title has a tick, which frames show themselves.
         (look (list :every every :from from :until until
                     :layers (if (or series title) layers (remove :title layers))
                     :in-color in-color :scale scale :title title :part part)))
    (check-animation series every rate display layers scale title)
    (check-start-tick from end)
    (check-moment-kinds 'save-animation kinds)
    (with-broken-graphics-reported
      (replaying (anyway)
        (if series
            (apply #'save-series journal file :display display look)
            (write-picture-file (if (eq kind :html)
                                    (apply #'film-text journal moments :rate rate :kinds kinds look)
                                    (apply #'animation-text journal :rate rate look))
                                file))))))

(defun animation-text (journal &key every from until rate layers in-color scale title part)
  (let ((snapshots '()))
    (call-with-frames (lambda (snapshot) (push snapshot snapshots))
                      journal (frame-step journal every until from) until :from from :part part)
    (let* ((snapshots (reverse snapshots)) (first (first snapshots)))
      (framed-picture-svg first
                          (lambda (canvas)
                            (draw-terrain canvas (snapshot-map first) :layers layers)
                            (write-animation-frames canvas snapshots rate layers))
                          :layers layers :in-color in-color :scale scale :title title))))

(addition journal-moments)
(define-with-keywords journal-moments
    (journal &key until anyway)
  "Replay a run and return a list of its notable events, which are MOMENT objects, in order. Notable
events are: a robot grasped, released or stowed something; a command failed; a plan or a part of a
plan failed or was ended; an error occurred in your code. JOURNAL is a journal, the name of a
journal file, or NIL for the journal of the current simulation. UNTIL is the last tick to replay, by
default the end of JOURNAL. With ANYWAY, replay the run even if definitions have changed since it
was recorded. Signals the errors of REPLAY."
  (let ((journal (resolve-journal journal 'journal-moments)))
    (checked-end-tick 'journal-moments journal until)
    (multiple-value-bind (watch seen) (make-moments-watcher)
      (sort-moments (append (call-with-replay seen journal :until until :anyway anyway
                                                           :observer watch :beginning watch)
                            (moments-in-remarks journal until))))))

(defun check-animation (series every rate display layers scale title)
  (check-display 'save-animation display)
  (check-argument save-animation display (or series (eq display :world))
                  ":world, or :series t for numbered pictures")
  (check-argument save-animation every (or (null every) (whole-p every 1))
                  "a whole number of ticks, from 1 to 1e9")
  (check-argument save-animation rate (and (finite-p rate) (<= 1/1000 rate 1000))
                  "a number of frames a second, from 0.001 to 1000")
  (check-map-options 'save-animation :title title :layers layers :scale scale))

(defun file-names-text (files)
  "FILES is a list of files, the last one first. Return a text with the first and the last name."
  (format nil "~A~@[ to ~A~]" (file-name-text (first (last files)))
          (and (rest files) (file-base-name (first files)))))

(defun warn-of-older-frames (file count)
  "Warn if files of an older and longer series FILE remain after the new series of COUNT files. The
older files are not deleted, because the user did not request that."
  (let ((older (loop for number from (1+ count)
                     for frame = (numbered-file file number)
                     while (probe-file frame) collect frame)))
    (when older
      (warning-set (format nil "~A are left from an older and longer series; the new series has ~D ~
                                files. Delete the older files before you make a film of the series."
                           (file-names-text (reverse older)) count)))))

(defun call-naming-files-in-errors (function files)
  "Call FUNCTION, which writes the next file of a series. If FUNCTION signals MISUSE, add the names
of FILES, the files already written, to the message."
  (handler-case (funcall function)
    (misuse (trouble)
      (if files
          (reject-use "~A. Written so far: ~A." (one-line-text trouble) (file-names-text files))
          (error trouble)))))

(defun save-series (journal file &key every from until display layers in-color scale title part)
  (let ((robot (first (getf (journal-header journal) :robots))) (files '()))
    (flet ((save (snapshot)
             (save-snapshot snapshot (snapshot-robot snapshot robot)
                            (numbered-file file (1+ (length files)))
                            :display display :layers layers
                            :in-color in-color :scale scale :title title)))
      (call-with-frames (lambda (snapshot)
                          (push (call-naming-files-in-errors (lambda () (save snapshot)) files)
                                files))
                        journal (frame-step journal every until from) until
                        :from from :part part))
    (warn-of-older-frames file (length files))
    (reverse files)))
