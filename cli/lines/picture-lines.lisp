;;;; picture-lines.lisp -- the world in files and windows: PICTURE, FILM, WINDOW, IMPORT, EXPORT.

(in-package :ars-magna.cli)

;;; A picture shows the layers that pictures show by default, and those whose names are typed.

(defun picture-word (text line)
  "Return the layer that TEXT means after LINE: a word or its beginning, which names a layer, as MAP
or PICTURE call it, or is BARE, for none of those shown by default."
  (layer-named (word-meant text
                           (mapcar #'symbol-name
                                   (append (picture-layers) '(:bare) (text-layers)))
                           line "a file, a scale, and words: ~{~A~^, ~}")))

(defun picture-options (text &optional (line "PICTURE"))
  "Return as options of SAVE-PICTURE what TEXT, as typed after LINE and the name of the file, asks
for."
  (loop for word in (split-words (or text ""))
        for number = (number-typed word)
        if number collect number into numbers
        else collect (picture-word word line) into words
        finally (when (rest numbers)
                  (reject-line "~A takes one number, the scale; not ~{~A~^ ~}." line numbers))
                (return (list :scale (first numbers)
                              :layers (union (remove :bare words)
                                             (unless (member :bare words) *picture-layers*))))))

(defun layers-text (layers)
  "Return LAYERS by name, each with what it shows where that is not the same in other words."
  (format nil "~:{~A~@[ (~A)~]~:^, ~}"
          (loop for layer in layers
                for name = (substitute #\Space #\- (symbol-name layer))
                for title = (layer-title layer)
                collect (list (layer-words layer)
                              (and (not (string-equal title name)) (string-downcase title))))))

(define-line "PICTURE" (session (file :file "a name that ends in .svg or .png")
                                (what :rest "pixels to a cell, and names of layers; BARE"
                                      :optional))
    (:seeing
     "PICTURE world.svg suits most; PICTURE world.png 30 GRID TRAIL has 30 pixels to a cell and
shows two layers more; PICTURE world.svg BARE NAMES shows that one alone."
     "Pixels to a cell: from 1 to 256. By default what suits the map, from 4 to 40, for a map of
900 x 700 pixels at most; or graphics-scale*, if that was set."
     (format nil "Shown by default, but for BARE: ~A." (layers-text *picture-layers*))
     (format nil "Shown if named: ~A."
             (layers-text (remove-if (lambda (layer) (member layer *picture-layers*))
                                     (picture-layers)))))
    "Save a picture of the world as it is now in FILE, replacing it."
  (let ((path (apply #'save-picture (session-robot) (path-called file) (picture-options what))))
    (format t "~A~%" (native-name path))))

;;; FILM.

(define-line "FILM" (session (file :file "a name that ends in .html or .svg")
                             (what :rest "pixels to a cell, names of layers; BARE; ANYWAY"
                                   :optional))
    (:seeing)
    "Save the run so far in FILE, replacing it, as a film: a page for any browser, in which it can
be played, stopped and gone through, or an animated picture. What robots grasped, let go of and
stowed, which commands and plans failed, and errors in your code are marked. The words after FILE
are those of PICTURE, and ANYWAY: also if what is defined is not what the run began with."
  (check-run)
  (let* ((words (split-words (or what "")))
         (others (remove "ANYWAY" words :test #'string-equal))
         (options (picture-options (format nil "~{~A~^ ~}" others) "FILM")))
    (flet ((save (*frame-hook*)
             (apply #'save-animation nil (path-called file)
                    :anyway (/= (length words) (length others)) options)))
      (format t "~A~%" (native-name (call-telling-ticks
                                     #'save session (simulation-tick (current-simulation))))))))

;;;; Windows

;;; Neither this program nor its tests need McCLIM. It is found by ASDF, or through a Quicklisp that
;;; is installed. The program's own second core, for --window, has it already; the first one, and a
;;; Lisp of the user's, load it when somebody wants a window.

(defun call-or-say (function trouble)
  "Call FUNCTION, which compiles and loads libraries, in Lisp's own syntax. What the compiler says
is of no interest. If that fails, signal BAD-LINE with TROUBLE, the control string of a text that
says why."
  (handler-case
      (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream))
            (*package* (find-package :cl-user))
            (*readtable* (copy-readtable nil))
            (*read-default-float-format* 'single-float))
        (handler-bind ((warning #'muffle-warning)) (funcall function)))
    (error (condition)
      (reject-line trouble (one-line (condition-text condition))))))

(defun load-windows (quicklisp-p)
  "Load the system of windows, and McCLIM through Quicklisp before if QUICKLISP-P."
  (when quicklisp-p
    (call-or-say #'ars-magna.clx:get-by-quicklisp
                 "No window: Quicklisp could not get McCLIM (~A). Is the network there? Then say ~
                  WINDOW again."))
  (call-or-say (lambda () (asdf:load-system "ars-magna/clim"))
               "No window: McCLIM is there, but cannot be loaded: ~A"))

;; Read when this file is loaded, so that a saved program has it with it.
(defparameter *how-to-get-windows*
  (file-text (asdf:system-relative-pathname "ars-magna" "cli/prompt/usage-window.txt"))
  "What is to be done where McCLIM is not installed.")

(defun ensure-windows ()
  "Let there be something that opens windows. Signals BAD-LINE if there is no X server or McCLIM, or
if CLX does not work."
  (unless *display-opener*
    (when (member (environment-value "DISPLAY") '(nil "") :test #'equal)
      (reject-line "No display: the environment variable DISPLAY names no X server. MAP draws the ~
                    world here, PICTURE in a file."))
    ;; In this program, ASDF is to find the project, and what has been compiled of it.
    (when (find-package :ars-magna.build)
      (uiop:symbol-call :ars-magna.build :configure))
    (let ((found-p (ars-magna.clx:find-library "mcclim/looks")))
      (unless (or found-p (find-package :quicklisp) (ars-magna.clx:quicklisp-file))
        (write-string *how-to-get-windows*)
        (reject-line "No window: McCLIM is not installed; what is to be done stands above."))
      (let ((trouble (ars-magna.clx:clx-trouble)))
        (when trouble (reject-line "No window: ~A" trouble)))
      (format t "Loading what windows need; the first time that takes some minutes.~%")
      (finish-output)
      (load-windows (not found-p)))))

;;;; WINDOW

(defun robot-at-work-called (name)
  "Return the robot called NAME, of this run or of another that is live. Signals BAD-LINE if there
is none."
  (let* ((name (robot-called name))
         (robot (or (find name (and *simulation* (simulation-robots *simulation*))
                          :key #'robot-name)
                    (find-robot name nil)))
         (simulation (and robot (robot-simulation robot))))
    (if (and simulation
             (not (simulation-over simulation))
             (or (eq simulation *simulation*) (live-p simulation)))
        robot
        (reject-elsewhere name))))

(define-line "WINDOW" (session (name :robot-name "the robot; the one commanded if left out"
                                     :optional))
    (:seeing)
    "Open a window that shows the robot NAME in its world while it runs, and takes commands to it;
one that is open already comes to the front. McCLIM has to be installed; where it is not, this says
how it is. Closing the window changes nothing here. It closes by itself when the run is over."
  (let ((robot (if name (robot-at-work-called name) (session-robot))))
    (ensure-windows)
    (open-display robot)
    (format t "The window of ~A is open.~%" (robot-name robot))))

(define-line "DISPLAY" (session) (:seeing)
    "Show the robot and its world in a window, as WINDOW does."
  (let ((robot (session-robot)))
    (ensure-windows)
    (open-display robot)))

;;;; Maps in files

(defun free-middle (map)
  "Return the point of MAP nearest its middle that a robot can stand at, a list, or NIL."
  (let ((point (nearest-free-point map (list (/ (map-width map) 2) (/ (map-height map) 2)))))
    (and point (list (pt-x point) (pt-y point)))))

(defun tell-imported (map report)
  "Say what MAP is like, of which REPORT is what IMPORT-MAP reports, and what can be done with it."
  (destructuring-bind (&key width height cell free occupied unknown walls) report
    (format t "~(~A~): ~D by ~D cells of ~A m~:[~;, each a metre here~], ~D free, ~D occupied, ~
               ~D unknown, in ~D walls.~%"
            (map-name map) width height (amount-text cell) (/= 1 cell) free occupied unknown walls)
    (format t "For a robot there: (defrobot NAME (~(~A~) (~:[X Y~;~:*~{~,1F~^ ~}~]) 0)), and then ~
               WORLD ~2:*~(~A~).~%"
            (map-name map) (free-middle map))))

(define-line "IMPORT" (session (file :file "a YAML file, as ROS's map_server keeps them"))
    (:seeing)
    "Make a map of the occupancy grid in FILE, and of the image that it names. The map is called
like FILE. In the simulator a cell is a metre wide, whatever it was on the floor: GO 5 m drives
through five."
  (multiple-value-call #'tell-imported (import-map file)))

(define-line "EXPORT" (session (file :file "a name that ends in .yaml"))
    (:seeing)
  "Write the walls of the map that the robot is in into FILE, an occupancy grid as ROS's map_server
keeps them, and beside it an image in PGM. A pair that is there is replaced, other files are not.
IMPORT reads them."
  (multiple-value-bind (description image)
      (export-map (world-map (robot-world (session-robot))) file)
    (format t "~A~%~A~%" (native-name description) (native-name image))))
