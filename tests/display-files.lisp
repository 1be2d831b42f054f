;;;; display-files.lisp -- snapshots, pictures in files, animations, and robots without a display.

(in-package :ars-magna.tests)

(in-suite display)

(test snapshot.does-not-change-with-the-world
  (in-studio (robot)
    (let* ((world (robot:robot-world robot))
           (before (display:take-snapshot world)))
      (robot:place-robot robot 2.5 2.5 1)
      (world:move-thing (world:find-thing 'box) 12 4)
      (world:destroy-thing (world:find-thing 'pen))
      (is (= 2 (length (display:snapshot-things before))))
      (is (= 3.5d0 (display::thing-image-x (aref (display:snapshot-things before) 0))))
      (is (= 6.5d0 (display:robot-image-x (first (display:snapshot-robots before))))))))

(defun shown-of (robot display)
  "Return what DISPLAY shows of ROBOT now, as a window sees it."
  (display:display-content display (first (display:snapshot-robots
                                           (display:take-snapshot (robot:robot-world robot))))))

(test snapshot.tells-which-displays-look-otherwise
  "What each change is to be seen in, and nowhere else."
  (in-studio (robot)
    (loop with box = (world:find-thing 'box)
          with all = '(:state :designators :cameras :hands :bins)
          for (change . displays)
            in `((,(lambda () (robot:place-robot robot 5 5 0)) :state)
                 (,(lambda () (robot:place-robot robot 5 5 1)) :state :cameras)
                 (,(lambda () (robot:add-designator robot :x 8 :y 6)) :designators)
                 (,(lambda () (world:move-thing box (robot:robot-hand robot 0))) :hands)
                 (,(lambda () (world:move-thing box (robot:robot-storage-bin robot 0)))
                  :hands :bins))
          for before = (mapcar (lambda (display) (shown-of robot display)) all)
          do (funcall change)
             (is (equal displays (loop for display in all
                                       for old in before
                                       unless (equal old (shown-of robot display))
                                         collect display))))))

(test snapshot.shares-what-has-not-changed-with-the-one-before
  (in-studio (robot)
    (let* ((world (robot:robot-world robot))
           (before (display:take-snapshot world))
           (box (world:find-thing 'box)))
      (world:set-attribute (world:find-thing 'pen) :color 'blue)
      (world:make-new-thing 'cup (list world 8 8) '())
      (let* ((after (display:take-snapshot world before))
             (old (display:snapshot-things before))
             (new (display:snapshot-things after)))
        (is (= 3 (length new)))
        (is (eq (aref old 0) (aref new 0)))
        (is (not (eq (aref old 1) (aref new 1))))
        (world:destroy-thing box)
        (is (equal '(pen cup)
                   (loop for image across (display:snapshot-things
                                           (display:take-snapshot world after))
                         for thing = (display::thing-image-thing image)
                         collect (intern (string (world:thing-name thing)) :ars-magna.tests))))))))

(test snapshot.changes-nothing-in-the-run
  (in-studio (robot)
    (let ((digest (run:state-digest)))
      (display:svg-picture robot :display :all :layers (display:picture-layers))
      (is (= digest (run:state-digest))))))

;;; Files.

(defmacro with-scratch-file ((file type) &body body)
  "Run BODY with FILE bound to the name of a file of TYPE that is deleted afterwards."
  `(uiop:with-temporary-file (:pathname ,file :type ,type) ,@body))

(test picture.svg-files-hold-the-picture
  (in-studio (robot)
    (with-scratch-file (file "svg")
      (is (equal (truename file) (display:save-picture robot file)))
      (is (string= (display:svg-picture robot) (uiop:read-file-string file))))))

(test picture.other-kinds-of-files-are-refused
  (in-studio (robot)
    (signals base:wrong-argument (display:save-picture robot "world.gif"))
    (signals base:wrong-argument (display:save-picture robot "world"))
    (handler-case (progn (display:save-picture robot "/tmp/[1]*?.svg") (fail "It was saved."))
      (base:wrong-argument (trouble)
        (is-true (mentions-p (princ-to-string trouble) "before each *, ? and ["))
        (is (not (mentions-p (princ-to-string trouble) "PATTERN")))))
    (signals base:wrong-argument (display:save-picture :nobody "world.svg"))
    (signals base:wrong-argument (display:save-picture robot "world.svg" :display :kitchen))))

(defun png-p (file)
  (with-open-file (stream file :element-type '(unsigned-byte 8))
    (= #x89504E47 (loop with sum = 0 repeat 4
                        do (setf sum (+ (* 256 sum) (read-byte stream)))
                        finally (return sum)))))

(test picture.png-files-need-a-program-that-the-error-names
  (in-studio (robot)
    (with-scratch-file (file "png")
      (handler-case (progn (display:save-picture robot file)
                           (is (png-p file)))
        (base:misuse (condition)
          (is (mentions-p (princ-to-string condition) "librsvg2-bin")))))))

(test picture.user-graphics-of-a-live-robot-see-a-world-that-stands-still
  (in-studio (robot)
    (let ((simulation (time:current-simulation)))
      (run:start-clock simulation :rate :free)
      (unwind-protect
           (dotimes (count 5)
             (is (mentions-p (display:svg-picture robot) "STUDIO-ROBOT")))
        (run:stop-clock simulation)))))

;;; Animations.

(defun journal-of-a-drive (robot)
  "Return the journal of a run in which ROBOT jumps about for 20 ticks."
  (dotimes (jump 4)
    (robot:place-robot robot (+ 2 jump) 6.5 0)
    (run:run-ticks 5))
  (run:journal-up-to-now (time:current-simulation)))

(test animation.shows-each-frame-in-its-turn
  (in-studio (robot)
    (with-scratch-file (file "svg")
      (display:save-animation (journal-of-a-drive robot) file :every 5 :layers '(:trail)
                                                                 :scale 8)
      (let ((text (uiop:read-file-string file)))
        (dolist (part '("tick 0<" "tick 5<" "tick 10<" "tick 15<" "tick 20<"
                        "values=\"visible;hidden\" keyTimes=\"0;0.200000\""
                        "values=\"hidden;visible;hidden\" keyTimes=\"0;0.200000;0.400000\""
                        "values=\"hidden;visible\" keyTimes=\"0;0.800000\""
                        "dur=\"0.5s\""
                        "<ellipse cx=\"40\" cy=\"52\" rx=\"7\""))
          (is (mentions-p text part)))
        (is (not (mentions-p text "tick 25<")))))))

(test animation.can-be-a-series-of-pictures
  (in-studio (robot)
    (let ((journal (journal-of-a-drive robot)))
      (with-scratch-file (file "svg")
        (let ((files (display:save-animation journal file :every 10 :series t :until 15
                                                          :display :state)))
          (is (= 3 (length files)))
          (is (mentions-p (uiop:read-file-string (first files)) "Position: 2.00, 6.50"))
          (is (mentions-p (uiop:read-file-string (second files)) "Position: 3.00, 6.50"))
          (is (mentions-p (uiop:read-file-string (third files)) "Position: 4.00, 6.50"))
          (is (mentions-p (pathname-name (second files)) "-0002"))
          (mapc #'delete-file files)))
      (signals base:wrong-argument (display:save-animation journal "run.png"))
      (signals base:wrong-argument (display:save-animation journal "run.svg" :every 0)))))

(test animation.series-says-what-an-older-longer-one-has-left
  "These files stay: nobody said that they may go."
  (in-studio (robot)
    (let ((journal (journal-of-a-drive robot)))
      (with-scratch-file (file "svg")
        (flet ((save (until)
                 (display:save-animation journal file :every 5 :series t :until until)))
          (let ((older (save 20)) (base:*message-queue* (base:make-message-queue)))
            (save 5)
            (let ((said (format nil "~{~A~}" (mapcar #'base:message-text (base:take-messages)))))
              (is (mentions-p said "-0003.svg to "))
              (is (mentions-p said "-0005.svg are left from an older and longer series")))
            (is (every #'probe-file older))
            (save 20)
            (is (null (base:take-messages)))
            (mapc #'delete-file older)))))))

;;; What all pictures know.

(test files.unknown-keywords-are-warned-of-while-compiling
  (flet ((warned (form)
           (handler-case (progn (compile nil `(lambda (robot) ,form)) nil)
             (warning (condition) (princ-to-string condition)))))
    (is (search "save-picture has no keyword :colour; it knows"
                (or (warned '(ars:save-picture robot "x.svg" :colour t)) "")))
    (is (null (warned '(ars:save-picture robot "x.svg" :title "Yard"))))))

(test pictures.list-their-keywords-when-given-another
  (in-studio (robot)
    (flet ((said (function &rest arguments)
             (handler-case (apply function arguments)
               (base:unknown-name (condition) (text-of condition)))))
      (dolist (words (list (said 'ars:save-picture robot "x.svg" :layer '())
                           (said 'ars:svg-picture robot :layer '())
                           (said 'ars:save-run-picture "x.svg" :layer '())
                           (said 'ars:save-animation nil "x.svg" :layer '())
                           (said 'ars:save-way-picture 'studio '() "x.svg" :layer '())))
        (is-true (has-words-p words "keyword of" "layer" "layers" "title")))
      (is-true (has-words-p (said 'ars-magna.rpl-pictures:save-plan-timeline "x.svg" :scales 2)
                            "keyword of save-plan-timeline" "scales" "most")))))

(test pictures.of-runs-and-films-have-parts-and-titles
  (in-studio (robot)
    (journal-of-a-drive robot)
    (with-scratch-file (page "html")
      (with-scratch-file (film "svg")
        (flet ((texts (&rest options)
                 (list (run-picture* options)
                       (apply #'display:svg-picture robot options)
                       (progn (apply #'ars:save-animation nil page options)
                              (uiop:read-file-string page))
                       (progn (apply #'ars:save-animation nil film options)
                              (uiop:read-file-string film)))))
          (loop for whole in (texts) for part in (texts :part '(0 0 9 10) :title "Left half")
                do (is (mentions-p whole "bricks 10"))
                   (is (mentions-p part "Left half"))
                   (is (not (mentions-p whole "Left half")))
                   (is (< (length part) (length whole))))
          (dolist (part '((0 0 99 99) (1 2 3) 7))
            (signals base:wrong-argument (run-picture* (list :part part)))
            (signals base:wrong-argument (display:svg-picture robot :part part))
            (signals base:wrong-argument (ars:save-animation nil film :part part))))))))

(defun run-picture* (options) (apply #'run-picture options))

(test pictures.of-runs-have-no-numbers-beside-their-part
  (in-studio (robot)
    (run:run-ticks 5)
    (flet ((notes (&rest options)
             (notes-in (apply #'run-picture :layers '() :moments
                              (list (display:make-moment 2 :note "here" 3 3)
                                    (display:make-moment 3 :note "there" 15 3))
                              options))))
      (is (= 2 (length (notes))))
      (is (equal '("tick 2: here" "Not shown, outside of this part: 1 note of yours.")
                 (notes :part '(0 0 9 10)))))))

(test pictures.that-end-too-late-name-themselves
  (in-studio (robot)
    (journal-of-a-drive robot)
    (flet ((said (function &rest arguments)
             (handler-case (apply function arguments)
               (base:wrong-argument (condition) (text-of condition)))))
      (is-true (has-words-p (said 'ars:save-animation nil "x.svg" :until 99)
                            "save-animation: until is 99"))
      (is-true (has-words-p (said 'ars:save-run-picture "x.svg" :until 99)
                            "save-run-picture: until is 99"))
      (is-true (has-words-p (said 'ars:journal-moments nil :until 99)
                            "journal-moments: until is 99")))))

;;; Without a window.

(test display.a-robot-without-a-window-says-so-in-one-line
  (in-studio (robot)
    (let* ((display:*display-opener* nil) (display::*reported-messages* '())
           (said (with-output-to-string (*standard-output*)
                   (display:open-display-or-report robot '()))))
      (is (mentions-p said "No display"))
      (is (mentions-p said "ars-magna/clim"))
      (is (= 1 (count #\Newline said)))
      (is (string= "" (with-output-to-string (*standard-output*)
                        (display:open-display-or-report robot '())
                        (display:open-display-or-report robot '(:display nil))))
          "once in a Lisp, or not at all")
      (signals base:misuse (display:open-display robot)))))

(test display.an-opener-opens-instead
  (in-studio (robot)
    (let* ((opened '())
           (display:*display-opener* (lambda (robot) (push robot opened))))
      (is (string= "" (with-output-to-string (*standard-output*)
                        (display:open-display-or-report robot '()))))
      (is (equal (list robot) opened)))))
