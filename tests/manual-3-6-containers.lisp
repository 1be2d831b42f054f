;;;; manual-3-6-containers.lisp -- hands in containers and bins, and the bins' lids (manual 3.6).

(in-package :ars-magna.tests)

(in-suite manual-3-6)

(defun inside-of (index)
  "Return the name of the thing that hand INDEX is inside of, or its storage bin, or NIL."
  (let ((location (ars:hand-location (arm index))))
    (if (ars:thing-p location) (ars:thing-name location) location)))

;;; What interrupts watching a grip.

(test manual-3-6.any-command-to-the-hand-interrupts-hand-track
  "3.6, reading 239: each of them, and a grab; the grip itself is no matter."
  (dolist (command (list #'ars:hand-grasp-check #'ars:hand-ungrasp #'ars:hand-track
                         #'ars:hand-remove #'ars:grab-resource
                         (lambda (hand) (ars:hand-insert-bin hand (drawer 0)))
                         (lambda (hand) (ars:hand-insert hand (sight-tag 'toolbox)))
                         (lambda (hand)
                           (ars:hand-grasp-desig hand (lamp 0) (sight-tag 'anvil)))))
    (with-joiner (:clean t)
      (let ((*answers* '()))
        (send (arm 0) 'mallet)
        (ars:hand-track (arm 0) (recorder :grip))
        (ars:run-ticks 5)
        (funcall command (arm 0))
        (ars:run-ticks 1)
        (is (equal (list (list :interrupt (arm 0))) (answers-to :grip)))))))

(test manual-3-6.other-resources-do-not-interrupt-hand-track
  "3.6, 3.1.2: the other hand, cameras, bins and the robot itself go about their business."
  (with-joiner (:clean t)
    (let ((*answers* '()))
      (send (arm 0) 'mallet)
      (ars:hand-track (arm 0) (recorder :grip))
      (take-tag 1 'plank)
      (reply 'ars:storage-bin-close (drawer 0))
      (reply 'ars:robot-go-forward joiner 3)
      (is (null (answers-to :grip))))))

;;; Hands in and out.

(test manual-3-6.insert-goes-into-containers-and-bins
  "3.6: hand and designator, or hand and bin, are returned; HAND-INSERT takes bins too."
  (with-joiner (:clean t)
    (let ((toolbox (sight-tag 'toolbox)))
      (loop for (command destination place) in `((ars:hand-insert ,toolbox toolbox)
                                                 (ars:hand-insert ,(drawer 1) ,(drawer 1))
                                                 (ars:hand-insert-bin ,(drawer 0) ,(drawer 0)))
            do (is (equal (list nil (arm 0) destination) (reply command (arm 0) destination)))
               (is (eq place (inside-of 0)))
               (is (equal (list nil (arm 0)) (reply 'ars:hand-remove (arm 0))))
               (is (null (inside-of 0)))))))

(test manual-3-6.insert-needs-no-camera
  "3.6, reading 156: the designator must be valid and local, and need not be tracked."
  (with-joiner (:clean t)
    (is (null (ars:camera-tracks (lamp 0))))
    (is (null (code-of 'ars:hand-insert (arm 0) (sight-tag 'toolbox))))))

(defun insertion-errors ()
  "Return a list of (code situation), where a situation is a function that returns the destination
that hand 0 is to go into."
  `((:bin-closed ,(lambda () (reply 'ars:storage-bin-close (drawer 0)) (drawer 0)))
    (:bin-closed ,(lambda () (sight-tag 'jar)))
    (:insufficient-capacity ,(lambda () (send (arm 0) 'plank) (drawer 0)))
    (:insufficient-capacity ,(lambda () (sight-tag 'mallet)))
    (:insufficient-capacity ,(lambda ()
                               (send (arm 0) 'mallet)
                               (send (thing 'toolbox) 'shaving)
                               (sight-tag 'toolbox)))
    (:holding-thing ,(lambda ()
                       (ars:set-attribute (thing 'toolbox) :capacity 40)
                       (send (arm 0) 'toolbox)
                       (sight-tag 'toolbox)))
    (:hand-bump ,(lambda () (setf ars:hand-insert-miss-prob* 1) (sight-tag 'toolbox)))
    (:hand-bump ,(lambda () (setf ars:hand-insert-miss-prob* 1) (drawer 1)))
    (:bad-designator ,(lambda ()
                        (prog1 (sight-tag 'shaving) (ars:destroy-thing (thing 'shaving)))))
    (:non-local-designator ,(lambda () (sight-tag 'crate :type :non-local)))
    (:different-location ,(lambda ()
                            (reply 'ars:hand-insert (arm 0) (drawer 0))
                            (sight-tag 'toolbox)))))

(test manual-3-6.insert-signals-what-is-wrong
  "3.6, readings 153, 155, 156, 230: each error in a situation of its own; things can be closed
like bins, and what has no capacity has no room. The hand stays where it is."
  (loop for (code situation) in (insertion-errors)
        do (with-joiner (:clean t)
             (let ((destination (funcall situation)) (place (inside-of 0)))
               (is (equal (list code (arm 0) destination)
                          (reply 'ars:hand-insert (arm 0) destination)))
               (is (eq place (inside-of 0)) "~A" code)))))

(test manual-3-6.insert-bin-signals-the-same
  "3.6: the special case for bins."
  (with-joiner (:clean t)
    (flet ((try (index) (reply 'ars:hand-insert-bin (arm 0) (drawer index))))
      (send (arm 0) 'plank)
      (is (equal (list :insufficient-capacity (arm 0) (drawer 0)) (try 0)))
      (reply 'ars:storage-bin-close (drawer 1))
      (is (eq :bin-closed (first (try 1))) "before its room matters")
      (send '(10.5 10.5) 'plank)
      (setf ars:hand-insert-miss-prob* 1)
      (is (eq :hand-bump (first (try 0)))))))

(test manual-3-6.hands-are-as-large-as-what-they-hold
  "3.6, readings 153, 154: an empty hand has no size, so it fits even into a full container; a thing
in the hand needs the room that the direct contents leave."
  (with-joiner (:clean t)
    (is (= 2 (ars:remaining-capacity (thing 'toolbox))) "6, less 3 and 1")
    (send (arm 0) 'mallet)
    (is (null (code-of 'ars:hand-insert (arm 0) (sight-tag 'toolbox))) "the mallet's size is 2")
    (reply 'ars:hand-ungrasp (arm 0))
    (is (= 0 (ars:remaining-capacity (thing 'toolbox))))
    (reply 'ars:hand-remove (arm 0))
    (is (null (code-of 'ars:hand-insert (arm 0) (sight-tag 'toolbox))))))

(test manual-3-6.room-is-taken-up-only-by-letting-go
  "3.6, readings 154, 237: two full hands may go into a bin that has room for one of them, and
letting go never fails; then there is none left."
  (with-joiner (:clean t)
    (dolist (name '(mallet anvil)) (ars:set-attribute (thing name) :size 4))
    (send (arm 0) 'mallet)
    (send (arm 1) 'anvil)
    (is (null (code-of 'ars:hand-insert-bin (arm 0) (drawer 1))))
    (is (= 5 (ars:remaining-capacity (drawer 1))))
    (is (null (code-of 'ars:hand-insert-bin (arm 1) (drawer 1))))
    (is (null (code-of 'ars:hand-ungrasp (arm 0))))
    (is (= 1 (ars:remaining-capacity (drawer 1))))
    (is (null (code-of 'ars:hand-ungrasp (arm 1))))
    (is (= 0 (ars:remaining-capacity (drawer 1))))))

(test manual-3-6.hands-go-one-level-at-a-time
  "3.6, reading 160: in by what can be seen from inside, out again by levels."
  (with-joiner (:clean t)
    (let ((toolbox (point-out 'toolbox)))
      (is (null (code-of 'ars:camera-insert (lamp 0) toolbox)))
      (is (null (code-of 'ars:hand-insert (arm 0) (sight-tag 'toolbox :camera (lamp 1)))))
      (let ((casket (point-out 'casket)))
        (is (eq :different-location (code-of 'ars:hand-insert (arm 1) casket)) "from outside")
        (is (null (code-of 'ars:hand-insert (arm 0) casket))))
      (is (equal '(casket toolbox nil)
                 (loop repeat 3 collect (inside-of 0) do (reply 'ars:hand-remove (arm 0)))))
      (is (equal (list :not-inside (arm 0)) (reply 'ars:hand-remove (arm 0)))))))

(test manual-3-6.hands-get-at-what-is-inside
  "3.6: a hand in a container grasps what a camera in there tracks, as both are in the same
location, and takes it out; then there is more room in the container."
  (with-joiner (:clean t)
    (let ((toolbox (point-out 'toolbox)))
      (reply 'ars:hand-insert (arm 0) toolbox)
      (reply 'ars:camera-insert (lamp 0) toolbox))
    (is (null (take-tag 0 'chisel)))
    (is (eq :different-location (take-tag 1 'casket)) "from outside")
    (is (null (code-of 'ars:hand-remove (arm 0))))
    (is (eq 'chisel (held 0)))
    (is (= 3 (ars:remaining-capacity (thing 'toolbox))))))

(test manual-3-6.what-the-held-thing-contains-is-held-too
  "3.6, reading 160: a hand cannot go into a container that is inside the thing it holds."
  (with-joiner (:clean t)
    (let ((toolbox (point-out 'toolbox)))
      (ars:set-attribute (thing 'casket) :capacity 40)
      (is (null (code-of 'ars:camera-insert (lamp 0) toolbox)))
      (let ((casket (point-out 'casket)))
        (send (arm 0) 'toolbox)
        (ars:run-ticks 1)
        (is (eq :holding-thing (code-of 'ars:hand-insert (arm 0) casket)))))))

(test manual-3-6.a-bump-may-lose-designators
  "3.6, reading 157: of a hand that misses, each designator on the destination is tested; trackers
are told, and warnings say so. A bin has none to lose."
  (with-joiner (:clean t)
    (setf ars:hand-insert-miss-prob* 1)
    (let* ((*answers* '())
           (other (sight-tag 'toolbox :camera (lamp 1)))
           (designator (point-out 'toolbox)))
      (is (eq :hand-bump (code-of 'ars:hand-insert (arm 0) designator)))
      (is-true (ars:designator-valid-p designator) "the chance is 0 in a clean world")
      (setf ars:hand-insert-lose-desig-prob* 1)
      (texts)
      (is (eq :hand-bump (code-of 'ars:hand-insert (arm 0) designator)))
      (is (= 2 (count-if-not #'ars:designator-valid-p (list designator other))))
      (is-true (search "Removing" (texts)))
      (is (equal (list (list nil (lamp 0) designator) (list :lost-track (lamp 0) designator))
                 (answers-to :track))))))

(test manual-3-6.what-is-not-there-is-bumped-into
  "3.6, reading 137: inserting a hand by a false designator."
  (with-joiner (:seed 2 :parameters '((ars:false-thing-prob* 1)
                                      (ars:hand-insert-lose-desig-prob* 0)))
    (is (eq :hand-bump (code-of 'ars:hand-insert (arm 0) (sight-tag 'nothing))))))

(test manual-3-6.driving-away-pulls-hands-out
  "3.6, reading 113: a hand inside of what stays behind comes out, with a warning, and keeps what
it holds; one in a bin stays in there."
  (with-joiner (:clean t)
    (reply 'ars:hand-insert (arm 0) (sight-tag 'toolbox))
    (send (arm 0) 'nail)
    (reply 'ars:hand-insert-bin (arm 1) (drawer 0))
    (texts)
    (reply 'ars:robot-go-forward joiner 5)
    (is (null (inside-of 0)))
    (is (eq 'nail (held 0)))
    (is (eq (drawer 0) (inside-of 1)))
    (is-true (search "*WARNING* -> Hand 0 was pulled out of" (texts)))))

;;; Storage bins.

(test manual-3-6.bins-open-and-close
  "3.6, reading 163: opening what is open and closing what is closed are errors; no part is
jammed."
  (with-joiner (:clean t)
    (loop for (command closed . answer) in `((ars:storage-bin-open nil :bin-open ,(drawer 1))
                                             (ars:storage-bin-close t nil ,(drawer 1) nil)
                                             (ars:storage-bin-close t :bin-closed ,(drawer 1) nil)
                                             (ars:storage-bin-open nil nil ,(drawer 1)))
          do (is (equal answer (reply command (drawer 1))) "~A" command)
             (is (eq closed (ars:storage-bin-closed-p (drawer 1)))))
    (is (string= (format nil "*ERROR* -> Storage-bin 1 is already open~@
                              storage-bin-close: Storage-bin 1 closed~@
                              *ERROR* -> Storage-bin 1 is already closed~@
                              storage-bin-open: Storage-bin 1 opened~%")
                 (texts)))))

(test manual-3-6.bins-do-not-close-on-hands-and-cameras
  "3.6: :ROBOT-IN-BIN, and the part that jams it is returned."
  (with-joiner (:clean t)
    (loop for (command part) in `((ars:hand-insert-bin ,(arm 1)) (ars:camera-insert ,(lamp 1)))
          do (reply command part (drawer 0))
             (is (equal (list :robot-in-bin (drawer 0) part)
                        (reply 'ars:storage-bin-close (drawer 0))))
             (is-false (ars:storage-bin-closed-p (drawer 0)))
             (is (null (code-of 'ars:storage-bin-close (drawer 1))) "the other one does")
             (reply 'ars:storage-bin-open (drawer 1))
             (reply (if (eq part (arm 1)) 'ars:hand-remove 'ars:camera-remove) part))
    (is (null (code-of 'ars:storage-bin-close (drawer 0))))))

(test manual-3-6.bins-jam-by-what-is-in-them
  "3.6, readings 163, 166: :BIN-JAMMED, only where there is something to jam it; no part is to
blame, and the bin stays open."
  (with-joiner (:clean t)
    (setf ars:bin-close-jam-prob* 1)
    (is (null (code-of 'ars:storage-bin-close (drawer 0))))
    (send (drawer 1) 'shaving)
    (is (equal (list :bin-jammed (drawer 1) nil) (reply 'ars:storage-bin-close (drawer 1))))
    (is-false (ars:storage-bin-closed-p (drawer 1)))))

(test manual-3-6.a-jam-is-momentary
  "Chapter 4: that a bin is jammed now says nothing about the next tick."
  (with-joiner (:seed 3 :parameters '((ars:bin-close-jam-prob* 1/2)))
    (send (drawer 0) 'shaving)
    (let ((codes (loop repeat 60
                       collect (code-of 'ars:storage-bin-close (drawer 0))
                       do (reply 'ars:storage-bin-open (drawer 0)))))
      (is (frequent-p (count :bin-jammed codes) 60 1/2))
      (is (frequent-p (count t (mapcar #'eq codes (rest codes))) 59 1/2)))))

(test manual-3-6.closed-bins-keep-things-in
  "3.6: nothing kicks itself out of a closed bin; out of an open one it does."
  (with-joiner (:clean t)
    (send (drawer 0) 'mallet)
    (reply 'ars:storage-bin-close (drawer 0))
    (ars:put-kicker jump (mallet (thing 'mallet)) () (ars:kick-thing mallet 1 0 t))
    (ars:run-ticks 50)
    (is-true (ars:in-location (thing 'mallet) (drawer 0)))
    (reply 'ars:storage-bin-open (drawer 0))
    (is (eq :floor (ars:thing-location (thing 'mallet))))))

(test manual-3-6.hands-are-told-as-many-arguments-as-ever
  "3.6, reading 85: an interrupted command has NIL for each of its results."
  (with-joiner (:clean t)
    (loop for (command resource . arguments)
            in `((ars:hand-grasp-desig ,(arm 0) ,(lamp 0) ,(sight-tag 'mallet))
                 (ars:hand-ungrasp ,(arm 0)) (ars:hand-insert ,(arm 0) ,(drawer 0))
                 (ars:hand-insert-bin ,(arm 0) ,(drawer 0)) (ars:hand-remove ,(arm 0))
                 (ars:storage-bin-open ,(drawer 0)) (ars:storage-bin-close ,(drawer 0)))
          do (let ((*answers* '()))
               (apply command resource (append arguments (list (recorder :it))))
               (ars:grab-resource resource)
               (ars:run-ticks 10)
               (is (equal (list (list* :interrupt resource
                                       (make-list (length (ars:command-results
                                                           (ars:find-command command))))))
                          (answers-to :it))
                   "~A" command)))))
