;;;; built-in-attributes.lisp -- the attributes that the simulator itself knows (manual, table 3.3).

(in-package :ars-magna.world)

;;; The manual gives the sensing parameters of :color and :size and the supporters of :capacity. The
;;; rest are our choice: what blocks the way or the view, or is closed, is plain to see if one
;;; looks for it; weight and capacity are guesses from afar; a substance that is a symbol is read
;;; right in :success of all cases.

;; As reading 121 says.
(defattribute :obsmove (t nil)
  :success .95 :noticed .3 :supported-by (:size :weight))
(defattribute :obsview (t nil)
  :success .95 :noticed .5 :supported-by (:size))
(defattribute :closed (t nil)
  :success .9 :noticed .3 :supported-by (:capacity))
(public red green blue violet lightred lightblue lightgreen lightviolet)
(defattribute :color (red green blue violet lightred lightblue lightgreen lightviolet)
  :success .4 :noticed .4 :supported-by (:substance))
(defattribute :size numeric
  :base .8 :max-mult 4 :noticed .7 :supported-by (:capacity :obsview :weight))
(defattribute :weight numeric
  :base .5 :max-mult 4 :noticed .2 :supported-by (:size :substance))
(defattribute :capacity numeric
  :base .6 :max-mult 4 :noticed .3 :supported-by (:size :weight))
(defattribute :substance numeric
  :success .8 :base 1 :max-mult 3 :noticed .5 :supported-by (:color))

(setf *built-in-attributes* (defined-names *attributes*))
