;;;; plans-handling.lisp -- plans that grasp, stow and put down.

;;; For any robot with a hand, a camera and a storage bin. Hands miss and bump, cameras lose their
;;; track, and bins jam. So each step is repeated until it succeeds, or fails for a reason that
;;; repeating does not change. Cameras, hands and bins are given by index.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-macro (hand-outcome ?hand ?command)
  "Issue COMMAND, which uses HAND; return its error code or NIL."
  `(outcome ,command (vref hand-moved* ,hand) (vref hand-error* ,hand)))

(def-interp-macro (bin-outcome ?bin ?command)
  "Issue COMMAND, which uses BIN; return its error code or NIL."
  `(outcome ,command (vref storage-bin-moved* ,bin) (vref storage-bin-error* ,bin)))

(def-interp-macro (insistently (?error ?command) . ?clauses)
  "Repeat COMMAND, a form that returns an error code or NIL, until it returns NIL or CLAUSES accept
the code. CLAUSES are as in CASE, with ERROR bound to the code; a true value accepts the code. Fails
with :WILL-NOT-DO and the last code as :ERROR after twelve attempts."
  `(let ((left 12) (done nil) (code nil))
     (loop UNTIL done
       (if (zerop left) (fail :class :will-not-do :error code :command ',command))
       (decf left)
       (let ((,error ,command))
         (setf code ,error)
         (setf done (case ,error ((nil) t) ,@clauses))))))

;;; Bins.

(def-interp-proc open-bin (bin)
  "Open the storage bin with index BIN, unless it is open."
  (insistently (error (bin-outcome bin (rpl-storage-bin-open bin)))
    (:bin-open t)))

(def-interp-proc close-bin (bin)
  "Close the storage bin with index BIN, unless it is closed; repeat if the lid jams. Fails with
:ROBOT-IN-BIN if a part of the robot is inside."
  (insistently (error (bin-outcome bin (rpl-storage-bin-close bin)))
    (:bin-closed t)
    (:robot-in-bin
     (fail :class :robot-in-bin :part (fluent-value (vref storage-bin-jammer* bin))))))

(def-interp-proc reach-into-bin (hand bin)
  "Put HAND into the storage bin with index BIN; open the bin if it is closed. Fails with :BIN-FULL
if the bin has no room for what HAND holds."
  (insistently (error (hand-outcome hand (rpl-hand-insert-bin hand bin)))
    (:insufficient-capacity (fail :class :bin-full :bin bin))
    (:bin-closed (open-bin bin) nil)
    (:different-location (draw-back hand) nil)))

(def-interp-proc draw-back (hand)
  "Take HAND out of the container it is in, if any."
  (insistently (error (hand-outcome hand (rpl-hand-remove hand)))
    (:not-inside t)))

(def-interp-proc let-go (hand)
  "Make HAND drop what it holds, if anything."
  (insistently (error (hand-outcome hand (rpl-hand-ungrasp hand)))
    (:not-grasping t)))

(def-interp-proc holding-p (hand)
  "True if HAND feels that it holds something."
  (eq :grasping (outcome (rpl-hand-grasp-check hand)
                         (vref hand-input* hand) (vref hand-error* hand))))

;;; Grasping.

(def-interp-proc look-closely (camera description)
  "Return a designator of something that fits DESCRIPTION and is local to CAMERA: next to the robot,
or in the same bin as CAMERA. Return NIL if 15 looks find none."
  (let ((found nil))
    (n-times 15 UNTIL found
      (setf found (first (look-for-things camera :local description))))
    found))

(def-interp-proc try-to-grasp (hand camera designator)
  "Track the local DESIGNATOR with CAMERA and grasp it with HAND. Return an error code or NIL."
  (let ((error (or (begin-track camera designator)
                   (hand-outcome hand (rpl-hand-grasp-desig hand camera designator)))))
    (stop-track camera)
    error))

(def-interp-proc grasp-thing (hand camera description &key designator)
  "Grasp DESIGNATOR with HAND, or else something that fits DESCRIPTION. HAND and CAMERA are next to
the robot, or in one bin. Fails with :NOT-FOUND, :TOO-HEAVY or :WILL-NOT-DO."
  (let ((target designator))
    (insistently (error (seq (setf target (or target (look-closely camera description)))
                             (if (null target)
                                 (fail :class :not-found :description description))
                             (try-to-grasp hand camera target)))
      (:hand-grasping t)
      (:insufficient-strength (fail :class :too-heavy :description description))
      (t (setf target nil)))))

(def-interp-proc stow-thing (hand bin)
  "Open BIN, put what HAND holds into it, and close it. Fails with :BIN-FULL (HAND still holds the
thing), or with :LOST-GRIP if HAND holds nothing: a kicked thing can get free."
  (open-bin bin)
  (reach-into-bin hand bin)
  (if (not (holding-p hand))
      (fail :class :lost-grip :hand hand))
  (let-go hand)
  (draw-back hand)
  (close-bin bin))

(def-interp-proc take-thing (hand camera bin description &key designator)
  "Grasp DESIGNATOR, or else something that fits DESCRIPTION, with HAND and stow it in BIN. Fails as
GRASP-THING and STOW-THING do; after :BIN-FULL and :LOST-GRIP, HAND is empty."
  (grasp-thing hand camera description :designator designator)
  (handle-failure ((:bin-full () (let-go hand))
                   (:lost-grip () (draw-back hand)))
    (stow-thing hand bin)))

;;; Beginning. An earlier errand that was interrupted may have left a hand or a bin in any state.

(def-interp-proc free-hand (hand bin)
  "If HAND is in a container, take HAND out. If HAND holds a thing, stow the thing in BIN, or drop
it on the floor if BIN is NIL or has no room. The state of HAND is taken from its fluents."
  (if (vref hand-inside* hand)
      (draw-back hand))
  (if (vref hand-grasping* hand)
      (handle-failure ((:lost-grip () (draw-back hand))
                       (:bin-full () (draw-back hand) (let-go hand)))
        (if bin (stow-thing hand bin) (let-go hand)))))

(def-interp-proc stowed-p (camera bin description)
  "True if CAMERA sees something in BIN that fits DESCRIPTION."
  (let ((found nil))
    (if (< (rpl-storage-bin-real-capacity bin) (rpl-storage-bin-capacity bin))
        (seq (open-bin bin)
             (evap-protect (seq (look-into-bin camera bin)
                                (setf found (confirm-thing camera description)))
                           (withdraw-camera camera))
             (close-bin bin)))
    (if found t nil)))

;;; Putting down.

(def-interp-proc look-into-bin (camera bin)
  "Put CAMERA into the storage bin with index BIN; open the bin if it is closed."
  (insistently (error (outcome (rpl-camera-insert camera bin)
                               (vref camera-moved* camera) (vref camera-movement-error* camera)))
    (:bin-closed (open-bin bin) nil)
    (:local-not-local (withdraw-camera camera) nil)))

(def-interp-proc withdraw-camera (camera)
  "Take CAMERA out of the container it is in, if any."
  (insistently (error (outcome (rpl-camera-remove camera)
                               (vref camera-moved* camera) (vref camera-movement-error* camera)))
    (:not-inside t)))

(def-interp-proc put-thing-down (hand camera bin &key (description '()))
  "Take a thing that fits DESCRIPTION out of BIN with HAND, put it on the floor, and close BIN.
Fails with :NOTHING-INSIDE if CAMERA sees no such thing in BIN."
  (open-bin bin)
  (evap-protect
      (seq (look-into-bin camera bin)
           (reach-into-bin hand bin)
           (handle-failure ((:not-found () (fail :class :nothing-inside :bin bin)))
             (grasp-thing hand camera description)))
    (seq (draw-back hand)
         (withdraw-camera camera)))
  (let-go hand)
  (close-bin bin))
