;;;; inserting.lisp -- hands and cameras into containers and bins, and out (3.4.3, 3.6).

(in-package :ars-magna.command)

;;; Insertion goes one level in, removal one level out. Only from the open can parts reach the
;;; robot's bins, and what stands in the open.

(defun insertion-message (operation destination)
  (format nil "~A inserted into ~A" (operation-resource operation)
          (destination-name destination)))

(defun insertion-error-formatter (control)
  "Return a function that formats CONTROL with an operation's part and its destination's name."
  (lambda (operation)
    (format nil control (operation-resource operation)
            (destination-name (first (operation-arguments operation))))))

;;; Hands.

(defun inside-held-thing-p (hand container)
  (loop for outer = container then (thing-location outer)
        while (thing-p outer)
        thereis (eq outer (hand-holding hand))))

(defun try-hand-insertion (hand container)
  "Move HAND into CONTAINER (NIL: a false designator). Return an error code or NIL (reading 155)."
  (cond ((null container) :hand-bump)
        ((location-closed-p container) :bin-closed)
        ((not (has-room-p container (if (hand-holding hand) (thing-size (hand-holding hand)) 0d0)))
         :insufficient-capacity)
        ((inside-held-thing-p hand container) :holding-thing)
        ((not (reaches-container-p hand container)) :different-location)
        ((chance hand-insert-miss-prob* (handling-dice hand)) :hand-bump)
        (t (move-part hand container)
           nil)))

(defun insert-hand (operation hand destination)
  "Insert HAND into DESTINATION, a valid local designator or a storage bin (reading 157)."
  (let ((code (try-hand-insertion hand (destination-container destination))))
    (when (and (eq code :hand-bump) (designator-p destination))
      (drop-designators-by-chance destination hand-insert-lose-desig-prob* (handling-dice hand)))
    (end-operation operation code destination)))

;; See reading 156.
(define-command hand-insert (operation (hand hand)
                             (destination destination
                              "a local designator of a container, or a storage bin"))
    ((destination "the designator or bin"))
    ((:family :handling) (:section "3.6") (:prompt "HAND-INSERT-DESIG")
     (:delay hand-move-delay*)
     (:errors (:bin-closed (insertion-error-formatter "~*~A is closed"))
              (:insufficient-capacity (insertion-error-formatter "No room for ~A in ~A"))
              (:holding-thing (insertion-error-formatter "~A is holding ~A"))
              (:hand-bump (insertion-error-formatter "~A bumped ~A"))
              (:bad-designator "Designator is not valid")
              (:non-local-designator "Designator is not local")
              (:different-location (insertion-error-formatter "~A not in same location as ~A")))
     (:report (destination) (insertion-message operation destination)))
    "Insert HAND, with what it holds, into a container."
  (cond ((storage-bin-p destination) (insert-hand operation hand destination))
        ((not (own-designator-p hand destination))
         (fail-with operation :bad-designator destination))
        ((eq (designator-type destination) :non-local)
         (fail-with operation :non-local-designator destination))
        (t (insert-hand operation hand destination))))

(define-command hand-insert-bin (operation (hand hand)
                                 (storage-bin storage-bin "a storage bin of the same robot"))
    ((storage-bin "the storage bin"))
    ((:family :handling) (:section "3.6") (:prefix "hand-insert") (:delay hand-move-delay*)
     (:errors (:bin-closed (insertion-error-formatter "~*~A is closed"))
              (:insufficient-capacity (insertion-error-formatter "No room for ~A in ~A"))
              (:holding-thing (insertion-error-formatter "~A is holding ~A"))
              (:hand-bump (insertion-error-formatter "~A bumped ~A"))
              (:different-location (insertion-error-formatter "~A not in same location as ~A")))
     (:report (storage-bin) (insertion-message operation storage-bin)))
    "Insert HAND, with what it holds, into a storage bin."
  (insert-hand operation hand storage-bin))

;;; Out again.

(defun take-part-out (operation part)
  "Take PART one level out of its container and end OPERATION (reading 160)."
  (let ((location (part-location part)))
    (cond (location
           (move-part part (location-after-removal part))
           (succeed-with-message
            operation (format nil "~A removed from ~A" part (location-name location))))
          (t (fail-with operation :not-inside)))))

(define-command hand-remove (operation (hand hand))
    ()
    ((:family :handling) (:section "3.6") (:delay hand-move-delay*)
     (:errors (:not-inside (operation-formatter "~A is not inside anything"))))
    "Take HAND, with what it holds, one level out of its container."
  (take-part-out operation hand))

(define-command camera-remove (operation (camera camera))
    ()
    ((:family :handling) (:section "3.4.3") (:delay camera-move-delay*)
     (:errors (:not-inside (operation-formatter "~A is not inside anything"))))
    "Take CAMERA out of its innermost container. The camera loses its track."
  (take-part-out operation camera))

;;; Cameras.

(defun camera-misses-p (camera destination container)
  "True if DESTINATION is false and local, or if CAMERA by chance bumps CONTAINER in its reach."
  (cond ((null container) (eq (designator-type destination) :local))
        ((reaches-container-p camera container)
         (chance camera-insert-miss-prob* (handling-dice camera)))))

(defun try-camera-insertion (camera destination container)
  "Move CAMERA into the CONTAINER of DESTINATION. Return an error code or NIL (reading 159)."
  (cond ((and container (location-closed-p container)) :bin-closed)
        ((and (designator-p destination) (null (camera-tracks camera))) :not-tracking)
        ((and (designator-p destination) (not (tracking-p camera destination)))
         :not-tracking-destination)
        ((camera-misses-p camera destination container) :camera-bump)
        ((and container (not (has-room-p container 0d0))) :insufficient-capacity)
        ((and (designator-p destination) (eq (designator-type destination) :non-local))
         :non-local-designator)
        ((not (reaches-container-p camera container)) :local-not-local)
        (t (move-part camera container)
           nil)))

;; See reading 158.
(define-command camera-insert (operation (camera camera)
                               (destination destination
                                "a local designator that the camera tracks, or a storage bin"))
    ((destination "the designator or bin"))
    ((:family :handling) (:section "3.4.3") (:prompt "CAM-INSERT-DESIG")
     (:delay camera-move-delay*)
     (:errors (:bin-closed (insertion-error-formatter "~*~A is closed"))
              (:not-tracking (operation-formatter "~A is not tracking anything"))
              (:not-tracking-destination (operation-formatter "~A is not tracking ~A"))
              (:camera-bump (insertion-error-formatter "~A bumped ~A"))
              (:insufficient-capacity (insertion-error-formatter "No room for ~A in ~A"))
              (:non-local-designator "Designator is not local")
              (:local-not-local (insertion-error-formatter "~A not in same location as ~A")))
     (:report (destination) (insertion-message operation destination)))
    "Insert CAMERA into a container, to look inside. The camera loses its track."
  (let ((code (try-camera-insertion camera destination (destination-container destination))))
    (when (and (designator-p destination)
               (or (eq code :camera-bump)
                   (and (null code)
                        (chance camera-insert-lose-desig-prob* (handling-dice camera)))))
      (drop-designator destination))
    (end-operation operation code destination)))

;;; A closed bin keeps its contents from kicking themselves out, and parts from reaching in.

(define-command storage-bin-open (operation (storage-bin storage-bin))
    ()
    ((:family :handling) (:section "3.6") (:delay bin-delay*)
     (:errors (:bin-open (operation-formatter "~A is already open"))))
    "Open STORAGE-BIN."
  (cond ((storage-bin-closed-p storage-bin)
         (setf (storage-bin-closed-p storage-bin) nil)
         (succeed-with-message operation (format nil "~A opened" storage-bin)))
        (t (fail-with operation :bin-open))))

;; See readings 163 and 166.
(define-command storage-bin-close (operation (storage-bin storage-bin))
    ((jammed-part "the camera or hand that keeps the bin from closing, or NIL"))
    ((:family :handling) (:section "3.6") (:delay bin-delay*)
     (:expected :bin-closed :bin-jammed)
     (:errors (:bin-closed (operation-formatter "~A is already closed"))
              (:robot-in-bin (lambda (operation)
                               (let ((bin (operation-resource operation)))
                                 (format nil "~A still in ~A" (part-in-bin bin) bin))))
              (:bin-jammed (operation-formatter "~A is jammed"))))
    "Close STORAGE-BIN, so that kickers cannot move things out of the bin."
  (cond ((storage-bin-closed-p storage-bin) (fail-with operation :bin-closed))
        ((part-in-bin storage-bin)
         (fail-with operation :robot-in-bin (part-in-bin storage-bin)))
        ((and (storage-bin-contents storage-bin)
              (chance bin-close-jam-prob* (handling-dice storage-bin)))
         (fail-with operation :bin-jammed))
        (t (setf (storage-bin-closed-p storage-bin) t)
           (succeed-with-message operation (format nil "~A closed" storage-bin)))))
