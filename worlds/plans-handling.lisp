;;;; plans-handling.lisp -- plans that grasp, stow and put down.

;;; Good for any robot with a hand, a camera and a storage bin. Hands miss and bump, and lose the
;;; camera's track; bins jam. Each step is repeated until it has succeeded, or fails for a reason
;;; that repeating does not change. Cameras, hands and bins are given by index.

(in-package :ars-worlds)
(in-readtable :nisp)

(def-interp-macro (hand-outcome ?hand ?command)
  "Give COMMAND to HAND; return its error code or NIL."
  `(outcome ,command (vref hand-moved* ,hand) (vref hand-error* ,hand)))

(def-interp-macro (bin-outcome ?bin ?command)
  "Give COMMAND to BIN; return its error code or NIL."
  `(outcome ,command (vref storage-bin-moved* ,bin) (vref storage-bin-error* ,bin)))

(def-interp-macro (insistently (?error ?command) . ?clauses)
  "Give COMMAND, a form that returns an error code or NIL, until that is NIL or one that CLAUSES, as
of CASE with ERROR bound to it, take for the end by returning true; fail after a dozen times."
  `(let ((left 12) (done nil))
     (loop UNTIL done
       (if (zerop left) (fail :class :will-not-do :command ',command))
       (decf left)
       (let ((,error ,command))
         (setf done (case ,error ((nil) t) ,@clauses))))))

;;; Bins.

(def-interp-proc open-bin (bin)
  "Open the storage bin with index BIN, unless it is open."
  (insistently (error (bin-outcome bin (rpl-storage-bin-open bin)))
    (:bin-open t)))

(def-interp-proc close-bin (bin)
  "Close the storage bin with index BIN, unless it is closed; what jams it is tried again."
  (insistently (error (bin-outcome bin (rpl-storage-bin-close bin)))
    (:bin-closed t)
    (:robot-in-bin
     (fail :class :robot-in-bin :part (fluent-value (vref storage-bin-jammer* bin))))))

(def-interp-proc reach-into-bin (hand bin)
  "Put HAND into the open storage BIN. Fails with :BIN-FULL if what it holds has no room there."
  (insistently (error (hand-outcome hand (rpl-hand-insert-bin hand bin)))
    (:insufficient-capacity (fail :class :bin-full :bin bin))
    (:bin-closed (open-bin bin) nil)
    (:different-location (draw-back hand) nil)))

(def-interp-proc draw-back (hand)
  "Take HAND out of whatever it is inside of."
  (insistently (error (hand-outcome hand (rpl-hand-remove hand)))
    (:not-inside t)))

(def-interp-proc let-go (hand)
  "Let HAND drop what it holds, if anything."
  (insistently (error (hand-outcome hand (rpl-hand-ungrasp hand)))
    (:not-grasping t)))

(def-interp-proc holding-p (hand)
  "True if HAND feels that it holds something."
  (eq :grasping (outcome (rpl-hand-grasp-check hand)
                         (vref hand-input* hand) (vref hand-error* hand))))

;;; Grasping.

(def-interp-proc look-closely (camera description)
  "Return a designator of something that fits DESCRIPTION where CAMERA is, in the open next to the
robot or in a bin; NIL if it sees none in many looks."
  (let ((found nil))
    (n-times 15 UNTIL found
      (setf found (first (look-for-things camera :local description))))
    found))

(def-interp-proc try-to-grasp (hand camera designator)
  "Let CAMERA track the local DESIGNATOR and HAND grasp it. Return an error code or NIL."
  (let ((error (or (begin-track camera designator)
                   (hand-outcome hand (rpl-hand-grasp-desig hand camera designator)))))
    (stop-track camera)
    error))

(def-interp-proc grasp-thing (hand camera description &key designator)
  "Let HAND grasp DESIGNATOR, or else something that fits DESCRIPTION, where it and CAMERA are: next
to the robot or in a bin. Fails with :NOT-FOUND, :TOO-HEAVY or :WILL-NOT-DO."
  (let ((target designator))
    (insistently (error (seq (setf target (or target (look-closely camera description)))
                             (if (null target)
                                 (fail :class :not-found :description description))
                             (try-to-grasp hand camera target)))
      (:hand-grasping t)
      (:insufficient-strength (fail :class :too-heavy :description description))
      (t (setf target nil)))))

(def-interp-proc stow-thing (hand bin)
  "Let HAND put what it holds into the storage BIN, which is closed then. Fails with :BIN-FULL, the
hand still holding it, or with :LOST-GRIP if it does not: what is kicked about can get free."
  (open-bin bin)
  (reach-into-bin hand bin)
  (if (not (holding-p hand))
      (fail :class :lost-grip :hand hand))
  (let-go hand)
  (draw-back hand)
  (close-bin bin))

(def-interp-proc take-thing (hand camera bin description &key designator)
  "Grasp DESIGNATOR, which fits DESCRIPTION, with HAND, and stow it in BIN."
  (grasp-thing hand camera description :designator designator)
  (handle-failure ((:bin-full () (let-go hand))
                   (:lost-grip () (draw-back hand)))
    (stow-thing hand bin)))

;;; Beginning. An errand that was ended before may have left things as they happened to be.

(def-interp-proc free-hand (hand bin)
  "Take HAND out of whatever it is inside of, and let it stow what it holds in BIN, or drop it there
if BIN is NIL or has no room. It knows what its fluents know."
  (if (vref hand-inside* hand)
      (draw-back hand))
  (if (vref hand-grasping* hand)
      (handle-failure ((:lost-grip () (draw-back hand))
                       (:bin-full () (draw-back hand) (let-go hand)))
        (if bin (stow-thing hand bin) (let-go hand)))))

(def-interp-proc stowed-p (camera bin description)
  "True if CAMERA sees in BIN, which may be empty, something that fits DESCRIPTION."
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
  "Put CAMERA into the open storage BIN."
  (insistently (error (outcome (rpl-camera-insert camera bin)
                               (vref camera-moved* camera) (vref camera-movement-error* camera)))
    (:bin-closed (open-bin bin) nil)
    (:local-not-local (withdraw-camera camera) nil)))

(def-interp-proc withdraw-camera (camera)
  "Take CAMERA out of whatever it is inside of."
  (insistently (error (outcome (rpl-camera-remove camera)
                               (vref camera-moved* camera) (vref camera-movement-error* camera)))
    (:not-inside t)))

(def-interp-proc put-thing-down (hand camera bin &key (description '()))
  "Take a thing that fits DESCRIPTION out of the storage BIN with HAND, and put it on the floor.
Fails with :NOTHING-INSIDE if CAMERA sees none in there. The bin is closed then."
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
