;;;; picture-lines.lisp -- the world in files and windows: PICTURE, FILM, WINDOW, IMPORT, EXPORT.

(in-package :ars-magna.cli)

;;; A picture shows the default layers, and those whose names are typed.

(defun picture-word (text line)
  "Return the layer that TEXT means after LINE: a word or its beginning that names a layer for MAP
or PICTURE, or BARE, for no default layers."
  (layer-named (word-meant text
                           (mapcar #'symbol-name
                                   (append (picture-layers) '(:bare) (text-layers)))
                           line "a file, a scale, and words: ~{~A~^, ~}")))

(defun picture-options (text &optional (line "PICTURE"))
  "Return options of SAVE-PICTURE for TEXT, as typed after LINE and the name of the file."
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
  "Return LAYERS by name, each with its title unless that says the same."
  (format nil "~:{~A~@[ (~A)~]~:^, ~}"
          (loop for layer in layers
                for name = (substitute #\Space #\- (symbol-name layer))
                for title = (layer-title layer)
                collect (list (layer-words layer)
                              (and (not (string-equal title name)) (string-downcase title))))))

(define-line "PICTURE" (session (file :file "a name that ends in .svg or .png")
                                (what :rest "pixels per cell, and names of layers; BARE"
                                      :optional))
    (:seeing
     "PICTURE world.svg is usually enough. PICTURE world.png 30 GRID TRAIL has 30 pixels per cell
and two more layers; PICTURE world.svg BARE NAMES has only the layer NAMES."
     "Pixels per cell: from 1 to 256. By default graphics-scale* if that was set, else from 4 to 40,
so that the map has at most 900 x 700 pixels."
     (format nil "Shown by default, except with BARE: ~A." (layers-text *picture-layers*))
     (format nil "Shown if named: ~A."
             (layers-text (remove-if (lambda (layer) (member layer *picture-layers*))
                                     (picture-layers)))))
    "Save a picture of the world as it is now in FILE, replacing it."
  (let ((path (apply #'save-picture (session-robot) (path-called file) (picture-options what))))
    (format t "~A~%" (native-name path))))

;;; FILM.

(define-line "FILM" (session (file :file "a name that ends in .html or .svg")
                             (what :rest "pixels per cell, names of layers; BARE; ANYWAY"
                                   :optional))
    (:seeing)
    "Save the run so far in FILE, replacing it, as a film: an HTML page for any browser, to play,
stop and step through, or an animated SVG. It marks what robots grasped, released and stowed, failed
commands and plans, and errors in your code. The words after FILE are as for PICTURE. ANYWAY saves
it even if definitions have changed since the run began."
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

;;; Neither this program nor its tests need McCLIM. ASDF finds it, or an installed Quicklisp. The
;;; program's second core, for --window, has it already; the first one, and a Lisp of the user's,
;;; load it when a window is opened.

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
  "How to install McCLIM.")

(defun ensure-windows ()
  "Load what opens windows, if needed. Signals BAD-LINE without X server, McCLIM or a working CLX."
  (unless *display-opener*
    (when (member (environment-value "DISPLAY") '(nil "") :test #'equal)
      (reject-line "No display: the environment variable DISPLAY names no X server. MAP draws the ~
                    world here, PICTURE in a file."))
    ;; In this program, ASDF must find the project and its compiled files.
    (when (find-package :ars-magna.build)
      (uiop:symbol-call :ars-magna.build :configure))
    (let ((found-p (ars-magna.clx:find-library "mcclim/looks")))
      (unless (or found-p (find-package :quicklisp) (ars-magna.clx:quicklisp-file))
        (write-string *how-to-get-windows*)
        (reject-line "No window: McCLIM is not installed. See above how to install it."))
      (let ((trouble (ars-magna.clx:clx-trouble)))
        (when trouble (reject-line "No window: ~A" trouble)))
      (format t "Loading McCLIM; the first time this takes some minutes.~%")
      (finish-output)
      (load-windows (not found-p)))))

;;;; WINDOW

(defun robot-at-work-called (name)
  "Return the robot called NAME of this run or of another live one. Signals BAD-LINE if none."
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
    "Open a window that shows the robot NAME in its world and takes commands, or raise the one that
is open. This needs McCLIM; if it is not installed, a message says how to install it. You may close
the window at any time. It closes by itself when the run is over."
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
  "Return the point of MAP nearest its middle at which a robot can stand, a list, or NIL."
  (let ((point (nearest-free-point map (list (/ (map-width map) 2) (/ (map-height map) 2)))))
    (and point (list (pt-x point) (pt-y point)))))

(defun tell-imported (map report)
  "Describe MAP by REPORT, the report of IMPORT-MAP, and say how to use it."
  (destructuring-bind (&key width height cell free occupied unknown walls) report
    (format t "~(~A~): ~D by ~D cells of ~A m~:[~; (a cell is 1 m for the robot)~], ~D free, ~
               ~D occupied, ~D unknown; ~D walls.~%"
            (map-name map) width height (amount-text cell) (/= 1 cell) free occupied unknown walls)
    (format t "For a robot there: (defrobot NAME (~(~A~) (~:[X Y~;~:*~{~,1F~^ ~}~]) 0)), and then ~
               WORLD ~2:*~(~A~).~%"
            (map-name map) (free-middle map))))

(define-line "IMPORT" (session (file :file "a YAML file, as ROS's map_server keeps them"))
    (:seeing)
    "Make a map, named like FILE, of the occupancy grid in FILE and the image that it names. In the
simulator each cell is one metre wide, whatever its real size: GO 5 m drives through five cells."
  (multiple-value-call #'tell-imported (import-map file)))

(define-line "EXPORT" (session (file :file "a name that ends in .yaml"))
    (:seeing)
  "Write the walls of the robot's map to FILE, as an occupancy grid for ROS's map_server, and an
image in PGM beside it. Replaces such a pair of files, but no other files. IMPORT reads them."
  (multiple-value-bind (description image)
      (export-map (world-map (robot-world (session-robot))) file)
    (format t "~A~%~A~%" (native-name description) (native-name image))))
