;;;; tiny.lisp -- a single small room, for tests and first steps.

;;; For trying a command on a few things, all of them near. Nothing moves by itself. The only places
;;; are the four corners of the room and those round one post. North is up, y grows downwards. Each
;;; character is a square metre: # wall, > DOT at its start.
;;;
;;;   ############
;;;   #..........#     (8.5 3.5)  a ball
;;;   #..........#
;;;   #..........#     (3.5 8.5)  a table with a cup on it
;;;   #..........#
;;;   #..........#     (9.5 9.5)  a box, in it a tin, in it a key
;;;   #..>.......#
;;;   #..........#
;;;   #......##..#
;;;   #......##..#
;;;   #..........#
;;;   ############

(in-package :ars-worlds)
(in-readtable :nisp)

(defmap tiny (12 12)
  (rect (0 0) (12 12) plaster 10 20 30 20)
  (wall (7 8) (8 8) slate 25)
  (wall (7 9) (8 9) slate 25)

  (obj (ball :prototype ball*) (8.5 3.5) ())
  (obj (table :prototype table*) (3.5 8.5) ())
  (obj (cup :prototype cup*) (3.5 8.5) ())
  (obj (box :prototype box*) (9.5 9.5) ((:color lightblue) (:substance wood))
    ((tin :prototype tin*) ()
      ((key :prototype key*) ()))))

(defrobot dot (tiny (3.5 6.5) 0)
  :cameras (((/ pi 2) 5))
  :hands (5)
  :bins (10))

(document-variables
 tiny "The map of a single small room in which nothing moves by itself, 12 x 12."
 dot "The robot in TINY: a camera, a hand, a bin.")
