;;;; export-line.lisp -- EXPORT: this map for others, as robots read them that drive about.

(in-package :ars-magna.cli)

(define-line "EXPORT" (session (file :file "a name that ends in .yaml"))
    (:seeing)
  "Write the walls of the map that the robot is in into FILE, an occupancy grid as ROS's map_server
keeps them, and beside it an image in PGM. A pair that is there is replaced, other files are not.
IMPORT reads them."
  (multiple-value-bind (description image)
      (export-map (world-map (robot-world (session-robot))) file)
    (format t "~A~%~A~%" (native-name description) (native-name image))))
