;;;; slots.lisp -- what Nisp's MAKE and slot access know of the simulator's types (manual 3.1).

(in-package :ars-magna.nisp)

;;; Named odometers of a robot (manual 3.2.2).
(define-nisp-type odometer (robot name) #'ars-magna.robot:make-odometer)

;;; Cells and places, for the expressions of DEF-PLACE-TYPE (manual 5.1.1).
(define-nisp-slot ars-magna.world:cell filled? ars-magna.world:cell-filled?)
(define-nisp-slot ars-magna.world:cell type ars-magna.world:cell-type)
(define-nisp-slot ars-magna.world:cell x ars-magna.world:cell-x)
(define-nisp-slot ars-magna.world:cell y ars-magna.world:cell-y)
(define-nisp-slot ars-magna.world:place canonical-dir ars-magna.world:place-canonical-dir)

;;; The manual's programs reach these, although it says that robots have no accessible slots.
;; As reading 216 says.
(define-nisp-slot ars-magna.robot:robot cameras ars-magna.robot:robot-cameras)
(define-nisp-slot ars-magna.robot:robot designators ars-magna.robot:live-designators)
(define-nisp-slot ars-magna.robot:camera field-of-view ars-magna.robot:camera-field-of-view)
(define-nisp-slot ars-magna.robot:camera resolution ars-magna.robot:camera-resolution)
(define-nisp-slot ars-magna.robot:camera angle ars-magna.robot:camera-angle)

;;; The three documented slots of designators (manual 3.4.1).
(define-nisp-slot ars-magna.robot:designator type ars-magna.robot:designator-type)
(define-nisp-slot ars-magna.robot:designator angle ars-magna.robot:designator-angle)
(define-nisp-slot ars-magna.robot:designator data ars-magna.robot:designator-data)
