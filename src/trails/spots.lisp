;;;; spots.lisp -- the events of a run: numbered spots on a map, and notes about them.

(in-package :ars-magna.trails)

;;; Spots are numbered, not moments: so numbers stay short. Moments at one spot with the same text
;;; are a group and share a note. Of too many notes, the least important are left out and counted.

(defstruct (spot (:constructor make-spot (x y)) (:copier nil))
  "A point of the map, in metres, at which events happened, with its NUMBER in the picture."
  (x 0 :type real :read-only t)
  (y 0 :type real :read-only t)
  (number 0 :type fixnum))

(defstruct (moment-group (:constructor make-moment-group (spot words weight)) (:copier nil))
  "A group of MOMENTS, latest first, with the same text WORDS at the same SPOT (NIL if unknown)."
  (spot nil :type (or null spot) :read-only t)
  (words "" :type string :read-only t)
  (weight 0 :type fixnum :read-only t)
  (moments '() :type list))

(defun spot-near (moment spots reach)
  (find-if (lambda (spot) (and (< (abs (- (moment-x moment) (spot-x spot))) reach)
                               (< (abs (- (moment-y moment) (spot-y spot))) reach)))
           spots))

(defun group-moments (moments robots reach)
  "Return a list of groups of MOMENTS. Moments less than REACH metres apart are at the same spot. If
ROBOTS, the names of the robots of the run, are several, texts name the robots."
  (let ((spots '()) (groups '()))
    (dolist (moment (stable-sort (copy-list moments) #'< :key #'moment-rank)
                    (nreverse groups))
      (let* ((spot (and (moment-x moment)
                        (or (spot-near moment spots reach)
                            (first (push (make-spot (moment-x moment) (moment-y moment))
                                         spots)))))
             (words (moment-description moment robots))
             (group (or (find-if (lambda (other)
                                   (and (eq spot (moment-group-spot other))
                                        (string= words (moment-group-words other))))
                                 groups)
                        (first (push (make-moment-group spot words (moment-rank moment))
                                     groups)))))
        (push moment (moment-group-moments group))))))

(defun more-important-group-p (one other)
  (if (= (moment-group-weight one) (moment-group-weight other))
      (> (length (moment-group-moments one)) (length (moment-group-moments other)))
      (< (moment-group-weight one) (moment-group-weight other))))

(defun assign-spot-numbers (groups)
  (let ((spots (remove-duplicates (remove nil (mapcar #'moment-group-spot groups))
                                  :from-end t)))
    (loop for spot in spots for number from 1 do (setf (spot-number spot) number))
    spots))

(defun ticks-text (ticks most)
  (let ((more (if most (- (length ticks) most) 0)))
    (format nil "tick~P ~{~D~^, ~}~@[ and ~D more~]" (length ticks)
            (if (plusp more) (subseq ticks 0 most) ticks) (and (plusp more) more))))

(defun group-note (group most)
  "Return a note about GROUP. The note lists the number of the spot, or NIL, and a text with at most
MOST ticks, or with all ticks if MOST is NIL."
  (list (and (moment-group-spot group) (spot-number (moment-group-spot group)))
        (format nil "~A: ~A"
                (ticks-text (sort (mapcar #'moment-tick (moment-group-moments group)) #'<) most)
                (moment-group-words group))))

(defparameter *moment-kind-nouns*
  '((:grasp "grasp" "grasps") (:release "letting go" "times of letting go")
    (:stow "thing stowed" "things stowed") (:failure "failure of a command" "failures of commands")
    (:message "message" "messages")
    (:plan "plan that failed or was ended" "plans that failed or were ended")
    (:part "failure or end within a plan" "failures or ends within plans")
    (:error "error in your code" "errors in your code") (:note "note of yours" "notes of yours"))
  "Lists (kind singular plural) of the words for moments of each kind.")

(defun not-shown-note (words moments)
  "Return a list of a single note: WORDS and the counts of MOMENTS by kind. Without MOMENTS: NIL."
  (when moments
    (list (list nil (format nil "~A: ~{~A~^, ~}."
                            words
                            (loop for (kind one several) in *moment-kind-nouns*
                                  for count = (count kind moments :key #'moment-kind)
                                  when (plusp count)
                                    collect (format nil "~D ~A" count
                                                    (if (= count 1) one several))))))))

;;; In a journal, failures of plans are described with code. A note describes each in a few words,
;;; and gives the reason only for the task that failed first.

(define-constant +reason-mark+ "failed: "
  :test #'cl:equal
  :documentation "The text before the reason why a plan failed.")
(defconstant +longest-reason+ 40 "The largest number of characters of the reason why a plan
failed.")

(defun shorten-reason (reason)
  "Return an abridged REASON without code. REASON says why a plan failed."
  (let* ((prefix "Plan failure ")
         (own-p (eql 0 (search prefix reason)))
         (words (if own-p (string-downcase (subseq reason (length prefix))) reason))
         (words (subseq words 0 (search " (" words)))
         (second (and own-p (position #\: words :start (min 1 (length words))))))
    (cut (string-trim " :" (subseq words 0 second)) +longest-reason+)))

(defun abridge-failures (moments)
  "Return copies of MOMENTS with abridged texts about failures. Each reason is given only once."
  (let ((told '()))
    (flet ((brief (moment)
             (let* ((text (moment-text moment)) (at (search +reason-mark+ text))
                    (why (and at (list (moment-robot moment) (subseq text at)))))
               (cond ((not (and at (member (moment-kind moment) '(:plan :part)))) moment)
                     ((and (eq :plan (moment-kind moment)) (member why told :test #'equal))
                      (copy-moment-with-text moment
                        (format nil "~Afailed by that" (subseq text 0 at))))
                     (t (push why told)
                        (copy-moment-with-text moment
                          (format nil "~A~A~A" (subseq text 0 at) +reason-mark+
                                  (shorten-reason (subseq text
                                                        (+ at (length +reason-mark+)))))))))))
      (mapcar #'brief moments))))

(defun copy-moment-with-text (moment text)
  (make-moment (moment-tick moment) (moment-kind moment) text (moment-x moment) (moment-y moment)
               (moment-robot moment) (moment-code moment)))

(defun spots-and-notes (moments limit robots reach)
  "Return two values: a list of the numbered spots of MOMENTS, and a list of at most LIMIT notes. A
note is a list (number text); NUMBER may be NIL. Notes about the user's moments are always included;
if LIMIT is NIL, so are all others. For ROBOTS and REACH see GROUP-MOMENTS."
  (let* ((all (stable-sort (group-moments moments robots reach) #'more-important-group-p))
         (own (count 0 all :key #'moment-group-weight))   ; the user's own have the weight 0
         (count (if limit (min (max limit own) (length all)) (length all)))
         (told (stable-sort (subseq all 0 count) #'<
                            :key (lambda (group)
                                   (reduce #'min (moment-group-moments group)
                                           :key #'moment-tick))))
         (spots (assign-spot-numbers told)))
    (values spots
            (append (mapcar (lambda (group) (group-note group (and limit 3))) told)
                    (not-shown-note "Not shown" (loop for group in (nthcdr count all)
                                                      append (moment-group-moments group)))))))

;;; On the map, an open ring marks a spot, around the thing that lies there, if any, so that it
;;; stays visible. The number is beside it, where nothing else is.

(defconstant +number-radius+ 8 "The radius of the circle around a number, in pixels.")
(defconstant +ring-radius+ 4 "The radius of a ring around a spot without a thing, in pixels.")

(defun draw-number (canvas x y text)
  (with-gcontext (draw-gcontext* :foreground white*)
    (draw-circle canvas x y +number-radius+ t))
  (with-gcontext (draw-gcontext* :foreground black* :line-width 6/5)
    (draw-circle canvas x y (- +number-radius+ 3/5) nil)
    (draw-words canvas draw-gcontext* x (+ y 4) text :size 11 :anchor :middle)))

(defun ring-radius (snapshot x y)
  "Return the radius, in pixels, of the ring around the spot at X, Y on the map of SNAPSHOT. If a
thing lies at the spot, for example because it was released there, the ring is around the thing."
  (flet ((reach (image)
           (let ((off (max (abs (- (to-pixels (thing-image-x image)) x))
                           (abs (- (to-pixels (thing-image-y image)) y))))
                 (half (thing-half-width image)))
             (if (< off (max +ring-radius+ (/ half 3))) (+ half off 3) 0))))
    (reduce #'max (snapshot-things snapshot) :key #'reach :initial-value +ring-radius+)))

(defun boxes-to-avoid (snapshot spots)
  "Return a list of boxes around robots, spots and things that no number should hide."
  (flet ((box (x y half) (box-around (to-pixels x) (to-pixels y) half)))
    (append (loop for robot in (snapshot-robots snapshot)
                  collect (box (robot-image-x robot) (robot-image-y robot)
                               (max 8 (to-pixels 1))))
            (loop for spot in spots collect (box (spot-x spot) (spot-y spot) +ring-radius+))
            (loop for image across (snapshot-things snapshot)
                  collect (box (thing-image-x image) (thing-image-y image)
                               (max 4 (to-pixels 1/2)))))))

(defun number-positions-around (x y radius)
  "A spot at X, Y has a ring of RADIUS. Return a list of points (x y), the nearest first, at which
the number of the spot could be drawn."
  (loop for distance in '(12 20 30 42 56)
        append (loop for turn below 12
                     for angle = (+ (/ pi -4) (* turn (/ pi 6)))
                     collect (point-at-distance x y angle (+ radius distance)))))

(defun free-position-p (place shown taken)
  "True if a number at PLACE (x y) is inside the box SHOWN and does not overlap any box of TAKEN."
  (destructuring-bind (x y) place
    (let ((box (box-around x y (1+ +number-radius+))))
      (and (every #'<= (subseq shown 0 2) box)
           (every #'>= (subseq shown 2) (subseq box 2))
           (notany (lambda (other) (overlap-p box other)) taken)))))

(defun nearest-position-inside (shown place)
  "Return the point nearest to PLACE at which a number is completely inside the box SHOWN. If SHOWN
is too small, return its middle."
  (let ((reach (1+ +number-radius+)))
    (flet ((within (at low high)
             (if (< (- high low) (* 2 reach))
                 (/ (+ low high) 2)
                 (clamp at (+ low reach) (- high reach)))))
      (mapcar #'within place shown (subseq shown 2)))))

(defun number-position (shown x y radius taken rather-not)
  "Return the point (x y) for the number of a spot at X, Y with a ring of RADIUS. The number is
inside the box SHOWN and, if possible, outside the boxes TAKEN and RATHER-NOT; TAKEN have priority."
  (let ((places (number-positions-around x y radius)))
    (flet ((free (taken) (find-if (lambda (place) (free-position-p place shown taken)) places)))
      (or (free (append taken rather-not)) (free taken) (free '())
          (nearest-position-inside shown (first places))))))

(defun draw-spot (canvas x y radius place text)
  "Draw a ring of RADIUS around X, Y, the number TEXT at PLACE, and a line between them."
  (let* ((angle (arctangent (- (second place) y) (- (first place) x)))
         (edge (point-at-distance x y angle radius)))
    (with-halo (black*)
      (draw-circle canvas x y radius nil)
      (draw-segments canvas draw-gcontext* (append edge place)))
    (draw-number canvas (first place) (second place) text)))

(defun draw-spots (canvas snapshot spots ways)
  "Draw SPOTS on the map of SNAPSHOT. If possible, numbers do not overlap the boxes WAYS. Return a
list of the boxes around the numbers."
  (let ((spared (boxes-to-avoid snapshot spots)) (boxes '()))
    (dolist (spot spots boxes)
      (let* ((x (to-pixels (spot-x spot))) (y (to-pixels (spot-y spot)))
             (radius (ring-radius snapshot x y))
             (place (number-position (points-to-pixels (shown-part snapshot)) x y radius
                                     (append boxes spared) ways)))
        (push (box-around (first place) (second place) +number-radius+) boxes)
        (draw-spot canvas x y radius place (princ-to-string (spot-number spot)))))))
