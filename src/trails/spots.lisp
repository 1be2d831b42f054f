;;;; spots.lisp -- what happened where: numbered places on a map, and lines that tell of them.

(in-package :ars-magna.trails)

;;; Places are numbered, not moments: so a number is short, however much happened there. Moments at
;;; one place that read the same share a line. If there are too many lines, those that matter least
;;; are left out, and counted.

(defstruct (spot (:constructor make-spot (x y)) (:copier nil))
  "A place where something happened, in metres, and its NUMBER on the map."
  (x 0 :type real :read-only t)
  (y 0 :type real :read-only t)
  (number 0 :type fixnum))

(defstruct (moment-group (:constructor make-moment-group (spot words weight)) (:copier nil))
  "That at SPOT, or nobody knows where, at the ticks of MOMENTS, the latest first, there was what
WORDS say."
  (spot nil :type (or null spot) :read-only t)
  (words "" :type string :read-only t)
  (weight 0 :type fixnum :read-only t)
  (moments '() :type list))

(defun spot-near (moment spots reach)
  (find-if (lambda (spot) (and (< (abs (- (moment-x moment) (spot-x spot))) reach)
                               (< (abs (- (moment-y moment) (spot-y spot))) reach)))
           spots))

(defun group-moments (moments several-p reach)
  "Return MOMENTS as happenings: what is nearer than REACH metres to each other is at one spot.
SEVERAL-P: say of which robot each is."
  (let ((spots '()) (happenings '()))
    (dolist (moment (stable-sort (copy-list moments) #'< :key #'moment-weight)
                    (nreverse happenings))
      (let* ((spot (and (moment-x moment)
                        (or (spot-near moment spots reach)
                            (first (push (make-spot (moment-x moment) (moment-y moment))
                                         spots)))))
             (words (moment-words moment several-p))
             (happening (or (find-if (lambda (other)
                                       (and (eq spot (moment-group-spot other))
                                            (string= words (moment-group-words other))))
                                     happenings)
                            (first (push (make-moment-group spot words (moment-weight moment))
                                         happenings)))))
        (push moment (moment-group-moments happening))))))

(defun more-important-p (one other)
  (if (= (moment-group-weight one) (moment-group-weight other))
      (> (length (moment-group-moments one)) (length (moment-group-moments other)))
      (< (moment-group-weight one) (moment-group-weight other))))

(defun number-spots (happenings)
  "Number the spots of HAPPENINGS, in order. Return them."
  (let ((spots (remove-duplicates (remove nil (mapcar #'moment-group-spot happenings))
                                  :from-end t)))
    (loop for spot in spots for number from 1 do (setf (spot-number spot) number))
    spots))

;;; As text.

(defun ticks-text (ticks most)
  "Return TICKS, in order, as text: no more than MOST of them, or all if it is NIL."
  (let ((more (if most (- (length ticks) most) 0)))
    (format nil "tick~P ~{~D~^, ~}~@[ and ~D more~]" (length ticks)
            (if (plusp more) (subseq ticks 0 most) ticks) (and (plusp more) more))))

(defun group-note (happening most)
  "Return a list of the number of the spot of HAPPENING, if it has one, and a text, with no more
than MOST ticks, or all if it is NIL."
  (list (and (moment-group-spot happening) (spot-number (moment-group-spot happening)))
        (format nil "~A: ~A"
                (ticks-text (sort (mapcar #'moment-tick (moment-group-moments happening)) #'<) most)
                (moment-group-words happening))))

(defparameter *kind-words*
  '((:grasp "grasp" "grasps") (:release "letting go" "times of letting go")
    (:stow "thing stowed" "things stowed") (:failure "failure of a command" "failures of commands")
    (:plan "plan that failed or was ended" "plans that failed or were ended")
    (:part "failure or end within a plan" "failures or ends within plans")
    (:error "error in your code" "errors in your code") (:note "note of yours" "notes of yours"))
  "What one moment of each kind is called, and several.")

(defun not-shown-note (words moments)
  "Return a list of a note that says, after WORDS, what MOMENTS were; or none."
  (when moments
    (list (list nil (format nil "~A: ~{~A~^, ~}."
                            words
                            (loop for (kind one several) in *kind-words*
                                  for count = (count kind moments :key #'moment-kind)
                                  when (plusp count)
                                    collect (format nil "~D ~A" count
                                                    (if (= count 1) one several))))))))

;;; What the journal says of plans has their code in it. A picture has a line for each, and says why
;;; a plan failed where the task in it did that failed first.

(define-constant +reason-mark+ "failed: "
  :test #'cl:equal
  :documentation "What stands before why a plan failed.")
(defconstant +longest-reason+ 40 "How many characters the reason has at most.")

(defun short-reason (reason)
  "Return REASON, why a plan failed, in a few words, without code."
  (let* ((prefix "Plan failure ")
         (own-p (eql 0 (search prefix reason)))
         (words (if own-p (string-downcase (subseq reason (length prefix))) reason))
         (words (subseq words 0 (search " (" words)))
         (second (and own-p (position #\: words :start (min 1 (length words))))))
    (cut (string-trim " :" (subseq words 0 second)) +longest-reason+)))

(defun abridge-failures (moments)
  "Return MOMENTS with what failed in few words, and why only once."
  (let ((told '()))
    (flet ((brief (moment)
             (let* ((text (moment-text moment)) (at (search +reason-mark+ text))
                    (why (and at (list (moment-robot moment) (subseq text at)))))
               (cond ((not (and at (member (moment-kind moment) '(:plan :part)))) moment)
                     ((and (eq :plan (moment-kind moment)) (member why told :test #'equal))
                      (moment-with-text moment (format nil "~Afailed by that" (subseq text 0 at))))
                     (t (push why told)
                        (moment-with-text moment
                          (format nil "~A~A~A" (subseq text 0 at) +reason-mark+
                                  (short-reason (subseq text
                                                        (+ at (length +reason-mark+)))))))))))
      (mapcar #'brief moments))))

(defun moment-with-text (moment text)
  (make-moment (moment-tick moment) (moment-kind moment) text (moment-x moment) (moment-y moment)
               (moment-robot moment) (moment-code moment)))

(defun spots-and-notes (moments limit several-p reach)
  "Return the numbered spots of what happened at MOMENTS, and notes that tell of that, lists of a
number or NIL and a text: of all if LIMIT is NIL, else of LIMIT at most, or of more if so many are a
user's own. See HAPPENINGS-OF."
  (let* ((all (stable-sort (group-moments moments several-p reach) #'more-important-p))
         ;; These are a user's own.
         (own (count 0 all :key #'moment-group-weight))
         (count (if limit (min (max limit own) (length all)) (length all)))
         (told (stable-sort (subseq all 0 count) #'<
                            :key (lambda (happening)
                                   (reduce #'min (moment-group-moments happening)
                                           :key #'moment-tick))))
         (spots (number-spots told)))
    (values spots
            (append (mapcar (lambda (happening) (group-note happening (and limit 3))) told)
                    (not-shown-note "Not shown" (loop for happening in (nthcdr count all)
                                                      append (moment-group-moments happening)))))))

;;; On the map: an open ring where it was, around the thing that lies there, if one does, so that it
;;; can be seen; and beside it, where nothing else is, the number.

(defconstant +number-radius+ 8 "The radius of the circle around a number, in pixels.")
(defconstant +ring-radius+ 4 "The radius of a ring around a spot without a thing, in pixels.")

(defun draw-number (canvas x y text)
  "Draw TEXT, a number, in a circle around X, Y."
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-circle canvas x y +number-radius+ t))
  (with-gcontext (draw-gcontext* :foreground black* :line-width 6/5)
    (draw-circle canvas x y (- +number-radius+ 3/5) nil)
    (draw-words canvas draw-gcontext* x (+ y 4) text :size 11 :anchor :middle)))

(defun ring-radius (snapshot x y)
  "Return the radius of the ring around the spot at X, Y, in pixels, on the map of SNAPSHOT: so
large that what lies right there, as what was let go of does, is within it."
  (flet ((reach (image)
           (let ((off (max (abs (- (to-pixels (thing-image-x image)) x))
                           (abs (- (to-pixels (thing-image-y image)) y))))
                 (half (half-width image)))
             (if (< off (max +ring-radius+ (/ half 3))) (+ half off 3) 0))))
    (reduce #'max (snapshot-things snapshot) :key #'reach :initial-value +ring-radius+)))

(defun boxes-to-avoid (snapshot spots)
  "Return boxes around robots, spots and things: what no number should hide."
  (flet ((box (x y half) (box-around (to-pixels x) (to-pixels y) half)))
    (append (loop for robot in (snapshot-robots snapshot)
                  collect (box (robot-image-x robot) (robot-image-y robot)
                               (max 8 (to-pixels 1))))
            (loop for spot in spots collect (box (spot-x spot) (spot-y spot) +ring-radius+))
            (loop for image across (snapshot-things snapshot)
                  collect (box (thing-image-x image) (thing-image-y image)
                               (max 4 (to-pixels 1/2)))))))

(defun places-around (x y radius)
  "Return points (x y), the nearest first, for the number of a spot at X, Y with a ring of RADIUS."
  (loop for distance in '(12 20 30 42 56)
        append (loop for turn below 12
                     for angle = (+ (/ pi -4) (* turn (/ pi 6)))
                     collect (around x y angle (+ radius distance)))))

(defun free-place-p (place shown taken)
  "True if the number at PLACE, a point (x y), is in the box SHOWN and meets none of the boxes
TAKEN."
  (destructuring-bind (x y) place
    (let ((box (box-around x y (1+ +number-radius+))))
      (and (every #'<= (subseq shown 0 2) box)
           (every #'>= (subseq shown 2) (subseq box 2))
           (notany (lambda (other) (overlap-p box other)) taken)))))

(defun move-inside (shown place)
  "Return PLACE, or what is nearest to it of where a number is wholly in the box SHOWN; the middle
of one that is less wide or high."
  (let ((reach (1+ +number-radius+)))
    (flet ((within (at low high)
             (if (< (- high low) (* 2 reach))
                 (/ (+ low high) 2)
                 (clamp at (+ low reach) (- high reach)))))
      (mapcar #'within place shown (subseq shown 2)))))

(defun place-for-number (shown x y radius taken rather-not)
  "Return the point (x y) for the number of a spot at X, Y with a ring of RADIUS: in the box SHOWN,
and if possible where none of the boxes TAKEN is, nor of RATHER-NOT."
  (let ((places (places-around x y radius)))
    (flet ((free (taken) (find-if (lambda (place) (free-place-p place shown taken)) places)))
      (or (free (append taken rather-not)) (free taken) (free '())
          (move-inside shown (first places))))))

(defun draw-spot (canvas x y radius place text)
  "Draw a ring of RADIUS around X, Y, and TEXT, its number, at PLACE, with a line from there."
  (let* ((angle (arctangent (- (second place) y) (- (first place) x)))
         (edge (around x y angle radius)))
    (with-halo (black*)
      (draw-circle canvas x y radius nil)
      (draw-segments canvas draw-gcontext* (append edge place)))
    (draw-number canvas (first place) (second place) text)))

(defun draw-spots (canvas snapshot spots ways)
  "Draw SPOTS on the map of SNAPSHOT, the numbers rather not on the boxes WAYS. Return the boxes of
the numbers."
  (let ((spared (boxes-to-avoid snapshot spots)) (boxes '()))
    (dolist (spot spots boxes)
      (let* ((x (to-pixels (spot-x spot))) (y (to-pixels (spot-y spot)))
             (radius (ring-radius snapshot x y))
             (place (place-for-number (pixels-of (shown-part snapshot)) x y radius
                                      (append boxes spared) ways)))
        (push (box-around (first place) (second place) +number-radius+) boxes)
        (draw-spot canvas x y radius place (princ-to-string (spot-number spot)))))))
