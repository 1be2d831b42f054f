;;;; bundles.lisp -- pictures of many ways at once, and of one run: order of layers, legends.

(in-package :ars-magna.tests)

(in-suite display)

(defun way-of-outcome (trial outcome)
  "Return a way through the middle of the studio of TRIAL, which had OUTCOME."
  (trails::make-way trial outcome (list (list '(3 . 5) '(8 . 5) '(8 . 9)))))

(defun bundle (robot outcomes &rest options)
  "Return a picture of ways with OUTCOMES in the world of ROBOT."
  (with-scratch-file (file "svg")
    (apply #'trails:save-picture-of-ways 'bundle "trial" file (display:snapshot-of robot)
           (lambda ()
             (loop for outcome in outcomes for trial from 1
                   collect (way-of-outcome trial outcome)))
           "A title" "A subtitle" options)
    (uiop:read-file-string file)))

(defparameter *mixed-outcomes* '("failure" "success" "error" "limit" "success" "failure" "limit"))

(defun looks-in (texts)
  "Return the outcomes that the colours TEXTS, written as in SVG, mean."
  (loop for text in texts
        for look = (find text trails::*outcome-looks*
                         :test #'equal :key (lambda (look) (format nil "#~(~6,'0X~)" (third look))))
        collect (first look)))

(test bundle.has-ways-that-failed-above-others
  (in-studio (robot)
    (let ((picture (bundle robot *mixed-outcomes* :layers '())))
      (is (equal '("success" "success" "limit" "limit" "failure" "failure" "error")
                 (looks-in (mapcar (lambda (line) (of-element line :stroke))
                                   (drawn-with :polyline picture))))))))

(test bundle.legend-stands-in-the-order-in-which-ways-lie
  (in-studio (robot)
    (let ((words (mapcar (lambda (text) (of-element text :text))
                         (drawn-with :text (bundle robot *mixed-outcomes*)))))
      (is (equal '("succeeded: 2 trials" "came to the limit: 2 trials" "failed: 2 trials"
                   "broke off with an error: 1 trial")
                 (remove-if-not (lambda (word) (search " trial" word)) words)))
      (dolist (word '("A title" "A subtitle" "bricks 10" "20"))
        (is (member word words :test #'string=) "~A" word))
      (is (some (lambda (word) (search " m" word)) words) "the scale bar"))))

(test bundle.needs-no-colours
  "Outcomes differ in their markers and dashes."
  (in-studio (robot)
    (let* ((picture (bundle robot *mixed-outcomes* :in-color nil :layers '()))
           (lines (drawn-with :polyline picture)))
      (is (subsetp (colors-in picture) '("000000" "ffffff") :test #'string=))
      (is (= 4 (length (remove-duplicates
                        (mapcar (lambda (line)
                                  (list (of-element line :stroke-width)
                                        (of-element line :stroke-dasharray)))
                                lines)
                        :test #'equal)))))))

(test bundle.of-a-part-tells-of-what-is-there
  "Numbers of metres are those of the map; what is elsewhere is not in the legend."
  (in-studio (robot)
    (flet ((words (&rest options)
             (mapcar (lambda (text) (of-element text :text))
                     (drawn-with :text (apply #'bundle robot '("success") options)))))
      (is-true (member "pen" (words) :test #'string=))
      (let ((words (words :part '(12 5 16 9) :scale 40)))
        (is (equal '("12" "13" "14" "15" "16" "5" "6" "7" "8" "9")
                   (remove-if-not (lambda (word) (every #'digit-char-p word)) words)))
        (is (null (intersection '("bricks 10" "doorway" "pen") words :test #'string=)))))
    (dolist (options '((:part (1 2 3)) (:part (0 0 99 99)) (:title 7) (:layers (:frob)) (:scale 0)))
      (signals base:wrong-argument (apply #'bundle robot '("success") options)))))

;;; Trials that broke off.

(test bundles.count-trials-that-broke-off-before-robots-were-seen
  (is (equal '("broke off with an error: 2 trials")
             (mapcar #'display::entry-text
                     (trails::outcome-legend-entries (append (trails:trails-to-ways '() 1 "error")
                                                             (trails:trails-to-ways '() 2 "error"))
                                                     "trial")))))

;;; Robots that are put elsewhere.

(defun drive-and-be-put-elsewhere (robot)
  "Let ROBOT drive a little, be put on the other side of the wall of the studio, and drive on."
  (dolist (x '(3.5 14.5))
    (robot:place-robot robot x 6.5 0)
    (command:robot-go-forward robot 2)
    (run:run-ticks 12)))

(defun longest-line (svg)
  "Return how far to the right the longest line of several points in SVG goes, in pixels."
  (loop for line in (drawn-with :polyline svg)
        for xs = (loop for (x) on (coordinates-in (of-element line :points)) by #'cddr collect x)
        maximize (- (reduce #'max xs) (reduce #'min xs))))

(defun coordinates-in (text)
  (mapcar #'read-from-string
          (remove "" (uiop:split-string text :separator ", ") :test #'string=)))

(test ways.break-where-a-robot-was-put-elsewhere
  "It went no way through the wall: the picture of the run, its trail and its film say so."
  (in-studio (robot)
    (display:keep-history)
    (drive-and-be-put-elsewhere robot)
    (dolist (picture (list (run-picture :scale 10 :layers '(:legend))
                           (display:svg-picture robot :scale 10 :layers '(:trail :legend))
                           (with-scratch-file (file "html")
                             (display:save-animation nil file :scale 10
                                                              :layers '(:trail :legend))
                             (uiop:read-file-string file))))
      (is (mentions-p picture "put elsewhere")))
    (is (< 5 (longest-line (run-picture :scale 10 :layers '())) 40))
    (is (< 5 (longest-line (display:svg-picture robot :scale 10 :layers '(:trail))) 40))))

(test ways.of-forks-and-replays-break-where-that-of-the-run-does
  (in-studio (robot)
    (drive-and-be-put-elsewhere robot)
    (flet ((pieces (simulation)
             (robot:robot-placements (first (run:simulation-robots simulation)))))
      (let ((count (pieces (time:current-simulation))))
        (is (= count (pieces (run:fork-simulation))))
        (run:call-with-replay (lambda () (is (= count (pieces (time:current-simulation)))))
                              (run:journal-up-to-now (time:current-simulation)))))))

(test ways.without-jumps-do-not-mention-any
  (in-studio (robot)
    (command:robot-go-forward robot 5)
    (run:run-ticks 6)
    (is (mentions-p (run-picture) "studio-robot and its way"))
    (is (not (mentions-p (run-picture) "put elsewhere")))))

(test bundle.samples-in-the-legend-are-as-pale-as-the-ways
  (in-studio (robot)
    (let ((picture (bundle robot (loop repeat 40 collect "success") :layers '(:legend))))
      (is (= 41 (loop with group = "<g opacity=\"0.2\">"
                      for start = (search group picture) then (search group picture
                                                                      :start2 (1+ start))
                      while start count t))))))

(test ways.go-on-from-where-a-robot-was-put
  "Not from where it had come to a tick later: in the picture of the run and in its trail."
  (in-studio (robot)
    (display:keep-history)
    (drive-and-be-put-elsewhere robot)
    (flet ((from-there-p (svg)
             (loop for line in (drawn-with :polyline svg)
                   thereis (find-if (lambda (x) (<= 145 x 145.5))
                                    (coordinates-in (of-element line :points))))))
      (is-true (from-there-p (run-picture :scale 10 :layers '())))
      (is-true (from-there-p (display:svg-picture robot :scale 10 :layers '(:trail)))))))

(test run-picture.has-one-entry-for-a-robot-and-its-way
  (in-studio (robot)
    (command:robot-go-forward robot 5)
    (run:run-ticks 6)
    (is (= 1 (count-if (lambda (text) (search "studio-robot" (of-element text :text)))
                       (drawn-with :text (run-picture :layers '(:legend))))))))

(test bundle.swatches-in-the-legend-are-as-pale-as-the-map
  (in-studio (robot)
    (flet ((pale (layers)
             (times-written "<g opacity=\"0.5\">" (bundle robot '("success") :layers layers))))
      (is (= 1 (pale '())))
      (is (= 3 (pale '(:legend))) "bricks and wood"))))
