;;;; bakery.lisp -- A village bakery, where dough rises by itself and a cat walks about.

;;; MAX is to be a robot.  ROOM, OPEN and STEP stay Common Lisp's symbols, which are called by name.
(ars:define-user-package :bakery (:shadow #:max))
(in-package :bakery)
(in-readtable :nisp)

(defattribute :dough (raw risen baked) :noticed .5 :supported-by (:color))
(defsubstance flour 65)
;; The oven is a dead end: walls on three sides and both shoulders, open to the south.
(def-place-type oven (cell)
  :check-matchers ((((t t t) (t nil t) (t nil t)) (/ pi 2)))
  :directions (values !>cell.type.canonical-dir (+ pi !>cell.type.canonical-dir)))
;; Dough rises, a cupboard springs open, and the cat steps wherever the dice say.
(defkicker rise (dough) (:prob .2) (!= (get-attribute dough :dough) 'risen))
(defkicker open (door) (:prob .5 :test (get-attribute door :closed))
  (set-attribute door :closed #f))
(defkicker step (cat) (:prob .5)
  (kick-thing cat (roll-between -1 1 (world-dice *world* :user)) 0 #f))
(defvar table* (new-thing table nil ((:size 12) (:weight 40) (:color violet) (:substance wood))))
(defvar bun* (new-thing bun nil ((:size 1) (:weight 1) (:color lightred) (:dough raw))))

(defmap room (24 16)
  (rect (0 0) (23 15) plaster 10 20 30 40)
  (wall (8 1) (8 4) bricks 20)                  ; the oven's three walls
  (wall (10 1) (10 4) bricks 20) (wall (9 1) (9 2) bricks 25)
  (obj (table :prototype table*) (5 9) ())
  (obj (dough :prototype bun*) (12 8) ())       ; nothing makes this rise
  (obj (bun :prototype bun* :kickers (rise)) (14 8) ())
  (obj (bun :prototype bun* :kickers (rise)) (13 8.5) ())
  (obj (roll :prototype bun*) (12.5 8.5) ((:dough risen) (:color red)))
  (obj stone-loaf (12.7 8.1) ((:size 2) (:weight 3) (:color green)))
  (obj (cat :kickers (step)) (4.25 4.75) ((:size 4) (:weight 4) (:color lightblue)))
  (obj (cupboard :kickers (open)) (19 11)
       ((:capacity 20) (:size 21) (:weight 50) (:closed #t) (:color blue) (:substance wood))
    ((bun :prototype bun*) ((:dough baked)))
    (jar ((:capacity 3) (:size 3) (:weight 1) (:color lightgreen) (:substance glass))
      (list ((:size .5) (:weight .1) (:color blue) (:substance flour)))))
  (obj bowl (12.2 8.3) ((:capacity 4) (:size 5) (:weight 1) (:color blue)))
  (obj tub (12.9 8.9) ((:capacity 30) (:size 31) (:weight 9) (:color violet)))
  (obj lamp (16.37 12.91) ((:size 2) (:weight 1) (:color green) (:substance metal))))
(defrobot max ('room (12.5 8.5) 0) :cameras (((/ pi 2) 5) (2pi 9)) :hands (10 4) :bins (20 5))
(defrobot baker ('room (9.5 8.5) (- (/ pi 2))) :cameras (((/ pi 2) 7)) :hands (10) :bins (20))
;; Baking: risen dough becomes bread; raw dough is refused with a word of its own.
(defmanipulation bake (bun - ((:dough risen)) :by hand - HAND) (:delay 2)
  (set-attribute bun :dough 'baked) (values nil :bread))
(defmanipulation bake (bun - ((:dough raw)) :by hand - HAND) () (values :still-raw hand))
;; Filling: what is done depends on how much goes in.
(defmanipulation fill (bowl - ((:capacity (1 5))) :by hand) () (values nil :spoon))
(defmanipulation fill (bowl - ((:capacity (6 90))) :by hand) () (values nil :bucket))
(def-interp-proc count-things (camera spec)
  "Look with CAMERA in four directions; return how many things fit SPEC."
  (let ((count 0))
    (n-times 4
      (rpl-camera-get-all-object-designators camera :non-local spec)
      (wait-for (vref camera-input* camera))
      (!= count (+ count (length (fluent-value (vref camera-designators* camera)))))
      (rpl-camera-turn camera (/ pi 2))
      (wait-for (vref camera-moved* camera)))
    count))
(defun answer (command &rest arguments &aux (told '()))
  "Issue COMMAND with ARGUMENTS; return what its continuation got, and how many times."
  (apply command `(,@arguments ,(continuation (&rest all) (push all told))))
  (run-ticks 60) (values (first told) (length told)))
(defun handle (robot name spec &aux (hand (robot-hand robot 0)))
  "Do manipulation NAME to the thing next to ROBOT that fits SPEC; return the answer."
  (let ((found (answer 'camera-get-object-designator (robot-camera robot 1) :local spec)))
    (answer 'run-manipulation name (third found) hand)))
(defmacro claims (&rest claims) "The texts of those (text form) whose form is false."
  `(remove nil (list ,@(mapcar (lambda (claim) `(unless ,(second claim) ,(first claim))) claims))))

(defun check ()
  (append
   (with-simulation (max :seed 5 :clean #t)
     (let ((cat (find-thing 'cat)) (roll (find-thing 'roll)))
       (claims
        ("raw dough is told" (equal (first (handle max 'bake '((:dough raw)))) :still-raw))
        ("risen roll is baked" (equal (handle max 'bake '((:color red))) '(nil :bread)))
        ("its state is EQ to ours" (eq (get-attribute roll :dough) 'baked))
        ("stone does not bake" (equal (first (handle max 'bake '((:color green)))) :failed))
        ("a spoon fills the bowl" (equal (handle max 'fill '((:color blue))) '(nil :spoon)))
        ("a bucket fills the tub" (equal (handle max 'fill '((:color violet))) '(nil :bucket)))
        ("turning answers once" (= 1 (nth-value 1 (answer 'robot-turn max 1))))
        ("the roll is red, our RED" (eq 'red (get-attribute roll :color)))
        ("the buns rise" (notany (\\ (it) (eq 'raw (get-attribute it :dough))) (find-things 'bun)))
        ("the cupboard is open" (not (get-attribute (find-thing 'cupboard) :closed)))
        ("the cat has walked" (/= (thing-x cat) 4.25)))))
   (with-simulation (baker :seed 5 :clean #t)
     (let ((found (third (answer 'camera-get-all-place-designators (robot-camera baker 0) 'oven))))
       (claims
        ("the oven is where it is meant to be"
         (eq 'oven (place-type-name (place-type (cell-type (map-cell (find-map 'room) 9.5 3.5))))))
        ("the baker sees just the oven" (equal (mapcar 'designator-data found) '((oven))))
        ("four large things are blue or green"
         (equal 4 (run-plan 'count-things 0 '((:color (blue green)) (:size (1.5 30)))))))))))

(defun live-check (&aux (told '()))
  (simulator max :rate :free :display #f :seed 3)
  (unwind-protect
       (progn
         (asking ((current-simulation))       ; let nothing happen by itself, to come to rest
           (dolist (it (world-thing-list *world*))
             (put-kicker rise (it it)) (put-kicker open (it it)) (put-kicker step (it it))))
         (robot-turn max 1 (continuation (err &rest r) (push `(:turn ,err) told)
           (camera-turn (robot-camera max 0) 1 (continuation (err &rest r)
                                                 (push `(:look ,err) told)))))
         (claims ("the world comes to rest" (await-idle (current-simulation) 20))
                 ("each command succeeds" (subsetp '((:turn nil) (:look nil)) told :test 'equal))
                 ("once" (= 2 (length told)))))
    (stop-simulator)))
