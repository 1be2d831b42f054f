;;;; user-drawing.lisp -- calling users' code that draws: :graphics and :draw-function.

(in-package :ars-magna.display)

(export '(telling-what-breaks))

;;; Code that fails, or goes on without an end, is reported once and not called again; whoever asked
;;; for it draws something else. Code that is defined anew is another function, and called.

(define-constant +drawing-seconds+ 2
  :documentation "For how many seconds users' code may draw one thing or cell.")
(define-constant +drawing-calls+ 100000
  :documentation "How many times users' code may draw something for one thing or cell.")

(defvar *broken-graphics* (make-hash-table :test #'eq :weakness :key :synchronized t)
  "The functions that have signalled an error, and the names that mean no function.")

(defmacro telling-what-breaks (&body body)
  "Run BODY, which draws a file: of what is broken it tells once, though it was told before."
  `(let ((*broken-graphics* (make-hash-table :test #'eq))) ,@body))

(defun give-up-drawing ()
  "Signal that users' code has drawn for too long, unless it waits in a debugger."
  (unless (user-calls-waiting-p *user-calls*)
    (reject-use "It had not come to its end after ~D seconds. Mend what goes on without an end."
                +drawing-seconds+)))

(defun call-drawing (function)
  "Call FUNCTION, which is users' code, within limits. Return true if it comes to its end."
  (let ((*calls-left* +drawing-calls+) (draw-gcontext* (create-gcontext)))
    (call-with-limit function +drawing-seconds+ #'give-up-drawing)
    t))

(defun draw-by-user (canvas function origin x y width height &rest arguments)
  "Have FUNCTION draw in a box of CANVAS, called with CANVAS and ARGUMENTS. ORIGIN, an item or list
of items, says whose it is (reading 214). Return true if it can; if not, it has been said why, and
what it has drawn is to be drawn over."
  (flet ((draw () (apply function canvas arguments)))
    (unless (gethash function *broken-graphics*)
      (with-clipping (canvas x y width height)
        (let ((*user-calls* (or *user-calls* (make-user-calls))))
          (unless (call-user-code #'call-drawing origin #'draw)
            (setf (gethash function *broken-graphics*) t)))))
    (not (gethash function *broken-graphics*))))

(defun draw-mark (canvas x y width height)
  "Draw what stands for graphics that cannot be drawn: a crossed box."
  (with-color (svref red* 9)
    (with-clipping (canvas x y width height)
      (draw-rectangle canvas draw-gcontext* x y (1- width) (1- height))
      (draw-segments canvas draw-gcontext*
                     (list x y (+ x width -1) (+ y height -1)
                           x (+ y height -1) (+ x width -1) y)))))
