;;;; picture-lines.lisp -- the world in files and windows: PICTURE, WINDOW, IMPORT, EXPORT.

(in-package :ars-magna.cli)

;;; A picture shows the default layers, and those whose names are typed.

(defun picture-layer-for-word (text line)
  "Return the layer for TEXT, typed after LINE. TEXT begins the name of a layer of MAP or PICTURE,
or BARE, which omits the default layers."
  (picture-layer-name (keyword-for-word text
                           (mapcar #'symbol-name
                                   (append (picture-layers) '(:bare) (text-layers)))
                           line "a file, a scale, and words: ~{~A~^, ~}")))

(defun picture-options (text &optional (line "PICTURE"))
  "Return the options of SAVE-PICTURE for TEXT, the words typed after LINE and the file's name."
  (loop for word in (split-words (or text ""))
        for number = (parse-typed-number word)
        if number collect number into numbers
        else collect (picture-layer-for-word word line) into words
        finally (when (rest numbers)
                  (reject-line "~A takes one number, the scale; not ~{~A~^ ~}." line numbers))
                (return (list :scale (first numbers)
                              :layers (union (remove :bare words)
                                             (unless (member :bare words) *picture-layers*))))))

(defun layers-text (layers)
  "Return the names of LAYERS as text. A title follows each name, unless the title equals the name."
  (format nil "~:{~A~@[ (~A)~]~:^, ~}"
          (loop for layer in layers
                for name = (substitute #\Space #\- (symbol-name layer))
                for title = (layer-title layer)
                collect (list (layer-prompt-text layer)
                              (and (not (string-equal title name)) (string-downcase title))))))

(defun measures-and-others (text)
  "Return a list of those words in TEXT that name measures, and the other words as one text."
  (let ((words (split-words (or text ""))))
    (flet ((named-p (word) (find-measure word nil)))
      (values (remove-if-not #'named-p words)
              (format nil "~{~A~^ ~}" (remove-if #'named-p words))))))

(define-line "PICTURE" (session (file :file "a name that ends in .svg or .png")
                                (what :rest "pixels per cell, names of layers, BARE, and names
of measures" :optional))
    (:seeing
     "PICTURE world.svg is usually enough. PICTURE world.png 30 GRID TRAIL has 30 pixels per cell
and two more layers; PICTURE world.svg BARE NAMES has only the layer NAMES. The values of measures
that you name are written below the title; see MEASURE."
     "Pixels per cell: from 1 to 256. By default graphics-scale*, if set; otherwise from 4 to 40, so
that the map has at most 900 x 700 pixels."
     (format nil "Layers shown by default, except with BARE: ~A." (layers-text *picture-layers*))
     (format nil "Layers shown if you name them: ~A."
             (layers-text (remove-if (lambda (layer) (member layer *picture-layers*))
                                     (picture-layers)))))
    "Save a picture of the world as it is now in FILE, replacing it."
  (multiple-value-bind (measures others) (measures-and-others what)
    (format t "~A~%" (native-name (apply #'save-picture (session-robot) (path-of-name file)
                                         :measures measures (picture-options others))))))

;;;; Windows

;;; Neither this program nor its tests need McCLIM. ASDF finds it, or an installed Quicklisp. The
;;; program's second core, for --window, has it already; the first one, and a Lisp of the user's,
;;; load it when a window is opened.

(defun load-or-reject (function trouble)
  "Call FUNCTION, which compiles and loads libraries, with Lisp's standard syntax and without
output. After an error, signal BAD-LINE with TROUBLE, a format control for the error's text."
  (handler-case
      (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream))
            (*package* (find-package :cl-user))
            (*readtable* (copy-readtable nil))
            (*read-default-float-format* 'single-float))
        (handler-bind ((warning #'muffle-warning)) (funcall function)))
    (error (condition)
      (reject-line trouble (one-line (condition-text condition))))))

(defun call-showing-compiled-files (function system)
  "Call FUNCTION, which loads SYSTEM. At a terminal, show which file is compiled."
  (let ((progress (and *session*
                       (session-terminal-p *session*)
                       (make-progress-line (session-console *session*)))))
    (unwind-protect
         (ars-magna.compiling:call-counting-files
          function system (lambda (text) (note-progress progress "~@(~A~)" text)))
      (when progress (end-progress progress)))))

(defun load-window-system (quicklisp-p)
  "Load the system ars-magna/clim. If QUICKLISP-P, load McCLIM through Quicklisp first."
  (flet ((load-showing-files (function system trouble)
           (load-or-reject (lambda () (call-showing-compiled-files function system)) trouble)))
    (when quicklisp-p
      (load-showing-files #'ars-magna.clx:load-by-quicklisp "mcclim/looks"
                          "No window: Quicklisp could not get McCLIM (~A). Check the network, ~
                           then type WINDOW again."))
    (load-showing-files (lambda () (asdf:load-system "ars-magna/clim")) "ars-magna/clim"
                        "No window: McCLIM was found, but cannot be loaded: ~A")))

;; Read when this file is loaded, so that a saved program has it with it.
(defparameter *mcclim-installation-text*
  (file-text (asdf:system-relative-pathname "ars-magna" "cli/prompt/usage-window.txt")))

(defun ensure-window-system ()
  "Load the code for windows, if needed. Signals BAD-LINE if X server, McCLIM or CLX does not work."
  (unless *display-opener*
    (when (member (environment-value "DISPLAY") '(nil "") :test #'equal)
      (reject-line "No display: the environment variable DISPLAY names no X server. MAP draws the ~
                    world here, PICTURE in a file."))
    ;; In this program, ASDF must find the project and its compiled files.
    (when (find-package :ars-magna.build)
      (uiop:symbol-call :ars-magna.build :configure))
    (let ((found-p (ars-magna.clx:find-library "mcclim/looks")))
      (unless (or found-p (find-package :quicklisp) (ars-magna.clx:quicklisp-file))
        (write-string *mcclim-installation-text*)
        (reject-line "No window: McCLIM is not installed. See above how to install it."))
      (let ((trouble (ars-magna.clx:clx-trouble)))
        (when trouble (reject-line "No window: ~A" trouble)))
      (format t "Loading McCLIM; the first time this takes some minutes.~%")
      (finish-output)
      (load-window-system (not found-p)))))

;;;; WINDOW

(defun find-running-robot (name)
  "Return the robot NAME of this or another live run. Signals BAD-LINE if no such robot is found."
  (let* ((name (resolve-robot-name name))
         (robot (or (find name (and *simulation* (simulation-robots *simulation*))
                          :key #'robot-name)
                    (find-robot name nil)))
         (simulation (and robot (robot-simulation robot))))
    (if (and simulation
             (not (simulation-over simulation))
             (or (eq simulation *simulation*) (live-p simulation)))
        robot
        (reject-robot-elsewhere name))))

(define-line "WINDOW" (session (name :robot-name "the robot; the one commanded if left out"
                                     :optional))
    (:seeing)
    "Open a window that shows the robot NAME in its world and takes commands, or raise its open
window. Windows need McCLIM; if McCLIM is not installed, a message says how to install it. You may
close the window at any time. The window closes by itself when the run is over."
  (let ((robot (if name (find-running-robot name) (session-robot))))
    (ensure-window-system)
    (open-display robot)
    (format t "The window of ~A is open.~%" (robot-label robot))))

(define-line "DISPLAY" (session) (:seeing)
    "Show the robot and its world in a window, as WINDOW does."
  (let ((robot (session-robot)))
    (ensure-window-system)
    (open-display robot)))

;;;; Maps in files

(defun free-point-near-middle (map)
  "Return the point nearest to the middle of MAP where a robot can stand, as a list (x y), or NIL."
  (let ((point (nearest-free-point map (list (/ (map-width map) 2) (/ (map-height map) 2)))))
    (and point (list (pt-x point) (pt-y point)))))

(defun describe-imported-map (map report)
  "Print a description of MAP and how to use MAP. REPORT is the list that IMPORT-MAP returned."
  (destructuring-bind (&key width height cell free occupied unknown walls) report
    (format t "~(~A~): ~D by ~D cells of ~A m~:[~; (a cell is 1 m for the robot)~], ~D free, ~
               ~D occupied, ~D unknown; ~D walls.~%"
            (map-name map) width height (plain-number-text cell) (/= 1 cell)
            free occupied unknown walls)
    (format t "For a robot there: (defrobot NAME (~(~A~) (~:[X Y~;~:*~{~,1F~^ ~}~]) 0)), and then ~
               WORLD ~2:*~(~A~).~%"
            (map-name map) (free-point-near-middle map))))

(define-line "IMPORT" (session (file :file "a YAML file, as ROS's map_server keeps them"))
    (:seeing)
    "Make a map, named like FILE, of the occupancy grid in FILE and the image that FILE names. In
the simulator each cell is one metre wide, whatever its real size: GO 5 m crosses five cells."
  (multiple-value-call #'describe-imported-map (import-map file)))

(define-line "EXPORT" (session (file :file "a name that ends in .yaml"))
    (:seeing)
  "Write the walls of the robot's map to FILE, as an occupancy grid for ROS's map_server, and a PGM
image beside it. Only maps saved under the same names are replaced. IMPORT reads both files."
  (multiple-value-bind (description image)
      (export-map (world-map (robot-world (session-robot))) file)
    (format t "~A~%~A~%" (native-name description) (native-name image))))
