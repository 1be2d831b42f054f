;;;; commands.lisp -- the table of commands whose results arrive in fluents (manual C).

(in-package :ars-magna.rpl-robot)

;;; A row says how the end of a command changes fluents. All settings of one end are one batch:
;;; values and errors first, then the pulse, so that a task woken by the pulse sees the rest.
;;; Success sets the error fluent to NIL.

;;; The robot.

(define-outcome (robot-set-speed robot-set-turn-angle) ()
  (:error robot-movement-error*))

(define-outcome (robot-turn robot-about-face robot-turn-left robot-turn-right robot-turn-corner
                 robot-align-place)
    (angle)
  (:when angle (:set robot-angle-diff* angle))
  (:error robot-movement-error*)
  (:pulse robot-stopped*))

(define-outcome (robot-go-forward robot-go-distance robot-step robot-push robot-goto-wall
                 robot-follow-wall robot-stop)
    ()
  (:error robot-movement-error*)
  (:pulse robot-stopped*))

(define-outcome (robot-goto-designator) (camera designator)
  (:when (null err) (:set robot-arrived-at* designator))
  (:error robot-movement-error*)
  (:pulse robot-stopped*))

(define-outcome (robot-place) (place-type)
  (:set robot-place* place-type)
  (:pulse robot-place-input*))

;;; Cameras.

(define-outcome (camera-turn camera-align-robot camera-align-place camera-insert camera-remove) ()
  (:error camera-movement-error*)
  (:pulse camera-moved*))

(define-outcome (camera-view) (view)
  (:when (null err) (:set camera-views* view))
  (:error camera-error*)
  (:pulse camera-input*))

(define-fluents rangefinder
  (rangefinder-ranges* "The latest distances, a list of metres." :addition)
  (rangefinder-error* "The error code of the last reading; NIL after success." :addition)
  (rangefinder-input* "Pulsed when the rangefinder has been read." :addition))

(define-outcome (rangefinder-read) (ranges)
  (:when (null err) (:set rangefinder-ranges* ranges))
  (:error rangefinder-error*)
  (:pulse rangefinder-input*))

;; As reading 178 says.
(define-outcome (camera-get-object-designator camera-get-place-designator) (designator)
  (:set camera-designators* (if designator (list designator) '()))
  (:error camera-error*)
  (:pulse camera-input*))

(define-outcome (camera-get-all-object-designators camera-get-all-place-designators) (designators)
  (:set camera-designators* designators)
  (:error camera-error*)
  (:pulse camera-input*))

;; A track is answered twice: when it starts, without an error, and when it ends, with one. A
;; matching track is also answered when it has matched its designator, without an error.
(define-outcome (camera-track camera-track-matching) ()
  (:error camera-tracking-error*)
  (:when (null err) (:pulse camera-tracking*)))

;; The track that it ends reports its own end first, with the error :INTERRUPT.
(define-outcome (camera-untrack) ()
  (:error camera-tracking-error*))

;;; Hands. One inside a box inside a bin is, when it comes out of the box, inside the bin.

(defun hand-container-depth (hand)
  (loop for outer = (part-location hand) then (outer-location outer)
        while outer count t))

(defun record-hand-entry (hand destination)
  (setf (hand-way-in hand)
        (cons destination (last (hand-way-in hand) (1- (hand-container-depth hand)))))
  destination)

(defun record-hand-exit (hand)
  "Record that HAND has left its container. Return the container that HAND is still in, or NIL."
  (first (setf (hand-way-in hand)
               (last (hand-way-in hand) (hand-container-depth hand)))))

(define-outcome (hand-insert hand-insert-bin) (destination)
  (:when (null err) (:set hand-inside* (record-hand-entry resource destination)))
  (:error hand-error*)
  (:pulse hand-moved*))

;; As reading 180 says.
(define-outcome (hand-remove) ()
  (:when (null err) (:set hand-inside* (record-hand-exit resource)))
  (:error hand-error*)
  (:pulse hand-moved*))

(define-outcome (hand-grasp-desig) (designator)
  (:when (null err) (:set hand-grasping* designator))
  (:error hand-error*)
  (:pulse hand-moved*))

(define-outcome (hand-ungrasp) ()
  (:when (member err '(nil :not-grasping)) (:set hand-grasping* nil))
  (:error hand-error*)
  (:pulse hand-moved*))

(define-outcome (hand-give) ()
  (:when (member err '(nil :not-grasping)) (:set hand-grasping* nil))
  (:error hand-error*)
  (:pulse hand-moved*))

(define-outcome (hand-grasp-check) ()
  (:when (eq err :not-grasping) (:set hand-grasping* nil))
  (:error hand-error*)
  (:pulse hand-input*))

;; As reading 23 says.
(define-outcome (hand-track) ()
  (:when (member err '(:grasp-lost :not-grasping)) (:set hand-grasping* nil))
  (:error hand-error*)
  (:when (eq err :grasp-lost) (:pulse hand-lost*)))

;;; Storage bins.

(define-outcome (storage-bin-open) ()
  (:error storage-bin-error*)
  (:pulse storage-bin-moved*))

;; As reading 182 says.
(define-outcome (storage-bin-close) (jammed-part)
  (:set storage-bin-jammer* jammed-part)
  (:error storage-bin-error*)
  (:pulse storage-bin-moved*))

;;; A thought is a construct in plans, and a command elsewhere.

(setf (documentation 'think 'function)
      (format nil "~A~%In plans (think span &key unit alone) means: ~A"
              (documentation 'think 'function)
              (documentation 'ars-magna.rpl:think 'function)))
