;;;; built-in-places.lisp -- doorway, convex, concave and beak.

(in-package :ars-magna.world)

;;; Manual 2.1, 5.1.1 and B. Two things differ from its listings: the diagonal doorways face
;;; through the opening (as printed they face a wall), and concave and beak, which it only
;;; names, are ours. Angles grow clockwise from the right, y points down.

(public doorway)
;; As reading 66 says.
(def-place-type doorway (cell)
  :confusion 0.05
  :check-matchers ((((- - -)
                     (* - *)
                     (- - -)) (/ pi 2))
                   (((- * -)
                     (- - -)
                     (- * -)) 0)
                   (((* - -)
                     (- - -)
                     (- - *)) (* pi 3/4))
                   (((- - *)
                     (- - -)
                     (* - -)) (/ pi 4))))

;;; The empty cell diagonally outside a corner of a wall, facing away from either arm.
(public convex)
(def-place-type convex (cell)
  :confusion 0.03
  :check-matchers ((((- - -)
                     (* * -)
                     (x * -)) 0 1 -1)
                   (((x * -)
                     (* * -)
                     (- - -)) (/ pi 2) 1 1)
                   (((- - -)
                     (- * *)
                     (- * x)) (* 3/2 pi) -1 -1)
                   (((- * x)
                     (- * *)
                     (- - -)) pi -1 1))
  :directions (let ((basic (place-canonical-dir (cell-type cell))))
                (values basic (- basic (/ pi 2)))))

;;; The empty cell where two walls meet, facing away from either. The corner itself must be
;;; filled, or every cell along an oblique wall would count.
(public concave)
;; As reading 67 says.
(def-place-type concave (cell)
  :confusion 0.03
  :check-matchers ((((* * x)
                     (* - -)
                     (x - x)) 0)
                   (((x * *)
                     (- - *)
                     (x - x)) (/ pi 2))
                   (((x - x)
                     (- - *)
                     (x * *)) pi)
                   (((x - x)
                     (* - -)
                     (* * x)) (* 3/2 pi)))
  :directions (let ((basic (place-canonical-dir (cell-type cell))))
                (values basic (+ basic (/ pi 2)))))

;;; The empty cell in front of the end of a thin wall, facing away from it.
(public beak)
(def-place-type beak (cell)
  :confusion 0.02
  :check-matchers ((((- - -)
                     (* * -)
                     (- - -)) 0 1 0)
                   (((- * -)
                     (- * -)
                     (- - -)) (/ pi 2) 0 1)
                   (((- - -)
                     (- * *)
                     (- - -)) pi -1 0)
                   (((- - -)
                     (- * -)
                     (- * -)) (* 3/2 pi) 0 -1)
                   (((* - -)
                     (- * -)
                     (- - -)) (/ pi 4) 1 1)
                   (((- - *)
                     (- * -)
                     (- - -)) (* pi 3/4) -1 1)
                   (((- - -)
                     (- * -)
                     (* - -)) (* pi 7/4) 1 -1)
                   (((- - -)
                     (- * -)
                     (- - *)) (* pi 5/4) -1 -1)))
