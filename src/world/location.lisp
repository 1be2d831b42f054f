;;;; location.lisp -- where things can be.

(in-package :ars-magna.world)

(export '(location-contents location-position location-world location-closed-p location-full-p
          location-name location-words))

;;; The location of a thing is :FLOOR (then it has a position of its own), something that
;;; holds it -- a thing or, in the layer above, a hand or storage bin -- or NIL: nowhere, as
;;; for prototypes and what has been destroyed. What holds things answers these questions.

(defgeneric location-contents (location)
  (:documentation "Return the list of things directly in LOCATION, a thing, hand or storage bin,
in order of arrival. Can be set; the setter does not touch the things."))

(defgeneric (setf location-contents) (things location))

(defgeneric location-position (location)
  (:documentation "Return, as two values, the coordinates x and y of LOCATION, in metres."))

(defgeneric location-world (location)
  (:documentation "Return the world that LOCATION is in, or NIL."))

(defgeneric location-closed-p (location)
  (:documentation "True if nothing can be kicked, put or taken out of LOCATION: a closed thing or
storage bin."))

(defgeneric location-full-p (location)
  (:documentation "True if nothing can be made in LOCATION because it holds as many things as it
can, whatever their size.")
  (:method (location)
    (declare (ignore location))
    nil))

(defgeneric location-name (location)
  (:documentation "Return the symbol or string that LOCATION is called, for messages."))

(defgeneric location-words (location)
  (:documentation "Return what LOCATION is called in the middle of a sentence, and whose it is.")
  (:method (location) (location-name location)))

(addition remaining-capacity)
(defgeneric remaining-capacity (location)
  (:documentation "Return, in units of size, how much can still be put into LOCATION: its capacity
less the sizes of what is directly in it (a double-float, at least 0). Signals WRONG-ARGUMENT.")
  (:method (location)
    (check-argument remaining-capacity location nil "a thing, hand or storage bin")))
