;;;; display-drawing.lisp -- things that draw themselves: :draw-function, and its failures.

(in-package :ars-magna.tests)

(in-suite display)

(defun draw-word (window thing x y width height)
  "Write a word where THING is to be drawn."
  (declare (ignore thing width))
  (canvas:draw-glyphs window canvas:draw-gcontext* x (+ y height) "self-made"))

(defun self-made-p (robot)
  "True if what the hand of ROBOT holds draws itself."
  (and (mentions-p (detail robot :hands) "self-made") t))

(defun held-thing (robot name)
  (let ((thing (world:find-thing name)))
    (world:move-thing thing (robot:robot-hand robot 0))
    thing))

(defmacro with-hand-that-holds ((thing robot value) &body body)
  "Run BODY; the hand of ROBOT holds THING, whose :draw-function a map gives as VALUE."
  `(with-own-definitions
     (eval '(world:defmap drawing-room (9 9)
             (obj pin (3.5 3.5) ((:size 2) (:draw-function ,value)))))
     (eval '(robot:defrobot drawer (drawing-room (5.5 5.5) 0) :hands (9)))
     (run::call-with-simulation
      (lambda ()
        (let* ((,robot (robot:find-robot 'drawer)) (,thing (held-thing ,robot 'pin)))
          (declare (ignorable ,robot ,thing))
          ,@body))
      (list 'drawer) :journal t)))

(test draw-functions.a-map-says-them-as-code
  "Manual B, reading 211: a lambda, a name or both with #' stand in a descriptor."
  (macrolet ((drawn-p (value)
               `(with-hand-that-holds (thing robot ,value) (is (self-made-p robot) "~S" ',value))))
    (drawn-p draw-word)
    (drawn-p #'draw-word)
    (drawn-p (lambda (window thing x y width height)
               (canvas:draw-glyphs window canvas:draw-gcontext* x y "self-made")))
    (drawn-p #'(lambda (window &rest more)
                 (canvas:draw-glyphs window canvas:draw-gcontext* (second more) 20 "self-made")))))

(test draw-functions.things-made-on-the-fly-and-prototypes-say-them-too
  (with-hand-that-holds (thing robot draw-word)
    (let* ((text "self-made")
           (prototype (eval '(world:new-thing pin nil ((:size 1) (:draw-function draw-word)))))
           (closed (world:new-thing pin nil
                                    ((:draw-function
                                      (lambda (window thing x y width height)
                                        (canvas:draw-glyphs window canvas:draw-gcontext* x y
                                                            text)))))))
      (dolist (model (list prototype closed))
        (world:destroy-thing (first (world:location-contents (robot:robot-hand robot 0))))
        (world:make-new-thing 'copy (robot:robot-hand robot 0) '() :prototype model)
        (is (self-made-p robot) "~A" model)))))

(test draw-functions.what-cannot-draw-is-refused-where-it-enters
  (with-hand-that-holds (thing robot draw-word)
    (loop for value in '((lambda (window) window) no-such-function :draw-word "draw-word" 7)
          do (handler-case (progn (world:set-attribute thing :draw-function value)
                                  (fail "~S is taken" value))
               (base:wrong-argument (trouble)
                 (is (mentions-p (princ-to-string trouble)
                                 "(defun ")
                     "~S: ~A" value trouble))))
    (signals base:wrong-argument (world:set-attribute thing :draw-function (lambda (x) x)))
    (signals base:wrong-argument (world:set-attribute thing :draw-function 'when))
    (dolist (value '('draw-word no-such-function (lambda (x) x)))
      (signals base:malformed-definition
        (eval `(world:defmap refused (9 9) (obj pin (3 3) ((:draw-function ,value)))))))
    (signals base:malformed-definition (eval '(world:defattribute :draw-function world:numeric)))))

(test draw-functions.a-slip-of-the-name-is-remarked-on
  (with-own-definitions
    (signals base:definition-warning
      (eval '(world:defmap slips (9 9) (obj pin (3 3) ((:draw-functon draw-word))))))))

(test draw-functions.go-by-the-newest-definition
  (with-hand-that-holds (thing robot draw-word)
    (flet ((draws (text)
             (setf (fdefinition 'draw-it-anew)
                   (lambda (window thing x y width height)
                     (declare (ignore thing width height))
                     (if text
                         (canvas:draw-glyphs window canvas:draw-gcontext* x y text)
                         (error "no pen"))))))
      (draws "first")
      (world:set-attribute thing :draw-function 'draw-it-anew)
      (is (mentions-p (detail robot :hands) ">first<"))
      (draws nil)
      (detail robot :hands)
      (draws "mended")
      (is (mentions-p (detail robot :hands) ">mended<"))
      (fmakunbound 'draw-it-anew)
      (base:take-messages)
      (detail robot :hands)
      (is (not (mentions-p (detail robot :hands) ">mended<")))
      (is (= 1 (length (base:take-messages)))))))

(test draw-functions.a-function-that-has-a-name-is-kept-by-it
  (with-hand-that-holds (thing robot nil)
    (world:set-attribute thing :draw-function #'draw-word)
    (is (eq 'draw-word (world:get-attribute thing :draw-function)))))

(test draw-functions.what-fails-is-told-once-and-drawn-plainly
  (with-hand-that-holds (thing robot draw-word)
    (flet ((trouble-of (function)
             (base:take-messages)
             (world:set-attribute thing :draw-function function)
             (detail robot :hands)
             (is (drawn-with :rect (detail robot :hands) :width 15 :fill "none")
                 "it is drawn plainly")
             (mapcar #'base:message-text (base:take-messages))))
      (macrolet ((told (text &body body)
                   `(let ((texts (trouble-of (lambda (window thing x y width height)
                                               (declare (ignorable window thing x y width height))
                                               ,@body))))
                      (is (= 1 (length texts)))
                      (is (mentions-p (first texts) ,text) "~A" texts))))
        (told "no pen" (error "no pen"))
        (told "coordinates" (canvas:draw-line window canvas:draw-gcontext* x y 1d30 0))
        (told "tag that does not exist" (throw 'no-such-tag 1))
        (told "aborted" (abort))
        (told "too many calls" (loop (canvas:draw-point window canvas:draw-gcontext* x y)))))))

(test draw-functions.what-does-not-end-is-left
  (with-hand-that-holds (thing robot draw-word)
    (base:take-messages)
    (world:set-attribute thing :draw-function (lambda (&rest arguments)
                                                (declare (ignore arguments))
                                                (base:call-with-time-limit
                                                 (lambda () (loop)) 1/100
                                                 #'display::signal-drawing-timeout)))
    (detail robot :hands)
    (is (mentions-p (base:message-text (first (base:take-messages))) "had not ended"))))

(test draw-functions.stay-within-their-box
  (with-hand-that-holds (thing robot (lambda (window thing x y width height)
                                       (canvas:draw-rectangle window canvas:draw-gcontext*
                                                              (- x 1e8) (- y 1e8) 1e9 1e9 t)))
    (is (mentions-p (detail robot :hands) "overflow=\"hidden\""))))

(test draw-functions.no-name-from-data-is-called
  "A journal that says :draw-function has nothing called by it; what code has said before, it may."
  (with-hand-that-holds (thing robot draw-word)
    (setf (fdefinition 'never-said) (lambda (&rest arguments) (error "called: ~S" arguments)))
    (let ((symbol 'never-said))
      (world::set-attribute-in-replay thing :draw-function symbol)
      (is (eq symbol (world:get-attribute thing :draw-function)))
      (base:take-messages)
      (detail robot :hands)
      (let ((texts (mapcar #'base:message-text (base:take-messages))))
        (is (= 1 (length texts)))
        (is (mentions-p (first texts) "from a data file")))
      (world::set-attribute-in-replay thing :draw-function 'draw-word)
      (is (self-made-p robot)))))

(test draw-functions.worlds-that-have-them-can-be-saved
  (with-hand-that-holds (thing robot (lambda (window thing x y width height)
                                       (canvas:draw-glyphs window canvas:draw-gcontext* x y
                                                           "self-made")))
    (world:set-attribute thing :draw-function #'draw-word)
    (uiop:with-temporary-file (:pathname file)
      (finishes (ars:save-simulation file)))
    (uiop:with-temporary-file (:pathname file)
      (finishes (ars:save-journal file)))))

(test draw-functions.a-name-that-is-defined-anew-is-drawn-anew
  "What shows a thing drawn by it differs then, though nothing has moved."
  (let ((name 'draw-anew))
    (setf (fdefinition name) #'draw-word)
    (unwind-protect
         (with-hand-that-holds (thing robot draw-anew)
           (flet ((content ()
                    (display:display-content
                     :hands
                     (first (display:snapshot-robots (display:snapshot-of robot))))))
             (let ((before (content)))
               (is (equal before (content)))
               (setf (fdefinition name)
                     (lambda (window thing x y width height)
                       (declare (ignore window thing x y width height))))
               (is (not (equal before (content)))))))
      (fmakunbound name))))
