;;;; map-file-lines.lisp -- IMPORT and EXPORT: maps as robots make and read them that drive about.

(in-package :ars-magna.cli)

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
