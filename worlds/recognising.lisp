;;;; recognising.lisp -- places recognised by what cameras see there, without odometry.

;;; A SIGNATURE has what cameras saw at a place, as plain data (manual 2.2, 3.4.3):
;;;
;;;   (:round STRIP...)  each strip has the pixels of a camera that was turned all round, clockwise
;;;                      and equally spaced; heading does not matter
;;;   (:fixed VIEW...)   each view is of a camera that was not turned; heading matters
;;;
;;; A place is a list (name signature...). A set of places is a list of places. The match of two
;;; signatures is the mean match of their pixels, from 0 to 1. Round signatures have the match of
;;; the best rotation. The match of a signature and a place is that of the place's best signature.

(in-package :ars-worlds)
(in-readtable :nisp)

(defvar pixel-tolerance* 5
  "By how much two pixels differ that do not match at all, in units of substance. Pixels that differ
by less match in part: equal pixels by 1, pixels that differ by half as much by 1/2.")

(defvar recognition-threshold* .55
  "The least match at which RECOGNISE-PLACE recognises a place, from 0 to 1.")

(define-run-variable *known-places* '()
  "The places that LEARN-PLACE has learned in this run: lists (name signature...).")

;;; Arguments.

(defun views-p (value)
  (and (consp value) (ars-magna.base:proper-list-p value)
       (every (lambda (view)
                (and (consp view) (ars-magna.base:proper-list-p view) (every #'realp view)))
              value)))

(defun signature-p (value)
  (and (consp value) (member (first value) '(:round :fixed)) (views-p (rest value))))

(defun place-name-p (value)
  (and value (typep value '(or symbol string integer))))

(defun known-place-p (value)
  (and (consp value) (ars-magna.base:proper-list-p value)
       (place-name-p (first value)) (rest value) (every #'signature-p (rest value))))

(defun check-signature (operator signature)
  (check-arguments operator
                   (list (signature-p signature) "signature" signature
                         "a list (:round view...) or (:fixed view...) of lists of numbers")))

(defun check-places (operator places)
  (check-arguments operator
                   (list (and (ars-magna.base:proper-list-p places) (every #'known-place-p places))
                         ":places" places "a list of places (name signature...)")))

(defun check-same-shape (operator signature other)
  "Signal WRONG-ARGUMENT unless SIGNATURE and OTHER were taken by cameras of the same kind."
  (check-arguments operator
                   (list (and (eq (first signature) (first other))
                              (equal (mapcar #'length (rest signature))
                                     (mapcar #'length (rest other))))
                         "signature" signature
                         (format nil "a signature of the same cameras as the other one, ~(~S~) ~
                                      with ~{~D~^, ~} pixels"
                                 (first other) (mapcar #'length (rest other))))))

;;; Matches.

(defun pixel-match (pixel other)
  (max 0d0 (- 1d0 (/ (abs (- pixel other)) (float pixel-tolerance* 1d0)))))

(defun views-match (views others turn turns)
  "Return the mean match of the pixels of VIEWS and OTHERS, lists of vectors. Pixels of VIEWS are
compared with those TURN of TURNS of a circle further on in OTHERS."
  (let ((sum 0d0) (count 0))
    (loop for view in views
          for other in others
          for size = (length view)
          for shift = (round (* turn size) turns)
          do (incf count size)
             (dotimes (i size)
               (incf sum (pixel-match (svref view i) (svref other (mod (+ i shift) size))))))
    (/ sum count)))

(defun turns-to-try (signature)
  "Return the numbers of pixels by which SIGNATURE is to be turned, the smallest turns first, and
how many pixels make a circle."
  (let ((turns (reduce #'max (mapcar #'length (rest signature)))))
    (values (if (eq :round (first signature))
                (cons 0 (loop for turn from 1 to (floor turns 2) collect turn collect (- turn)))
                '(0))
            turns)))

(defun vectors (lists)
  (mapcar (lambda (list) (coerce list 'simple-vector)) lists))

(defun signature-match (signature other)
  "Return how well SIGNATURE matches the signature OTHER, from 0 to 1, and how far the robot had
turned from OTHER to SIGNATURE, in radians from -pi to pi, positive to the right. The match is the
mean match of the pixels, see PIXEL-TOLERANCE*. For round signatures it is that of the best
rotation, to the nearest pixel; for others the turn is 0. It is the same if the two are exchanged,
but for the sign of the turn. Signals WRONG-ARGUMENT if the two are not of the same cameras."
  (check-signature 'signature-match signature)
  (check-signature 'signature-match other)
  (check-same-shape 'signature-match signature other)
  (let ((views (vectors (rest signature))) (others (vectors (rest other))) (best -1) (turned 0))
    (multiple-value-bind (candidates turns) (turns-to-try signature)
      (dolist (turn candidates)
        (let ((match (views-match views others turn turns)))
          (when (> match best) (setf best match turned turn))))
      (values best (/ (* 2pi turned) turns)))))

;;; Places.

(defun place-match (signature place)
  "Return the best match of SIGNATURE and a signature of PLACE, and the turn."
  (let ((best -1) (turn 0))
    (dolist (other (rest place))
      (multiple-value-bind (match turned) (signature-match signature other)
        (when (> match best) (setf best match turn turned))))
    (values best turn)))

(defun add-place (name signature places)
  "Return PLACES with SIGNATURE added to the place NAME, or with a new place NAME at the end."
  (check-signature 'add-place signature)
  (check-places 'add-place places)
  (check-arguments 'add-place (list (place-name-p name) "name" name
                                    "a symbol other than NIL, a string or an integer"))
  (when places (check-same-shape 'add-place signature (second (first places))))
  (if (assoc name places :test #'equal)
      (mapcar (lambda (place)
                (if (equal name (first place)) (append place (list signature)) place))
              places)
      (append places (list (list name signature)))))

(defun learn-place (name signature)
  "Add SIGNATURE to the place NAME of *KNOWN-PLACES*, or add a new place NAME. Return NAME. A place
that looks different from its parts, or at different times, should have several signatures."
  (setf *known-places* (add-place name signature *known-places*))
  name)

(defun recognise-place (signature &key (places *known-places*) (threshold recognition-threshold*))
  "Return five values: the name of the one of PLACES that SIGNATURE matches best, or NIL if the
match is below THRESHOLD; the match, from 0 to 1; how far the robot has turned since the signature
of that place was taken, in radians; the name of the place that comes second, or NIL; and the match
of that place, or 0. A match of the second that is almost as high tells that the answer is doubtful.
Without places, return NIL, 0, 0, NIL and 0. Uses no odometry."
  (check-signature 'recognise-place signature)
  (check-places 'recognise-place places)
  (check-arguments 'recognise-place (list (and (realp threshold) (<= 0 threshold 1)) ":threshold"
                                          threshold "a number from 0 to 1"))
  (let ((best '(nil 0 0)) (second '(nil 0 0)))
    (dolist (place places)
      (let ((entry (cons (first place) (multiple-value-list (place-match signature place)))))
        (cond ((or (null (first best)) (> (second entry) (second best)))
               (setf second best best entry))
              ((or (null (first second)) (> (second entry) (second second)))
               (setf second entry)))))
    (destructuring-bind (name match turn) best
      (values (and (>= match threshold) name) match turn (first second) (second second)))))
