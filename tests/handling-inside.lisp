;;;; handling-inside.lisp -- hands and cameras going into containers and bins, and out.

(in-package :ars-magna.tests)

(in-suite handling)

(defun stand-in (part)
  "Return what the thing that PART is inside of is called, or its bin, or NIL."
  (let ((location (robot:part-location part)))
    (if (world:thing-p location) (world:thing-name location) location)))

;;; Hands going in and out.

(test hand-insert.goes-in-and-out
  (with-cook (:clean t)
    (let ((designator (designate 'hamper)))
      (is (equal (list nil (hand 0) designator)
                 (reply 'command:hand-insert (hand 0) designator)))
      (is (eq 'hamper (stand-in (hand 0))))
      (is (string= (format nil "hand-insert: Hand 0 inserted into HAMPER#5~%") (texts)))
      (is (equal (list nil (hand 0)) (reply 'command:hand-remove (hand 0))))
      (is (null (stand-in (hand 0))))
      (is (string= (format nil "hand-remove: Hand 0 removed from HAMPER#5~%") (texts)))
      (is (eq :not-inside (code-of 'command:hand-remove (hand 0)))))))

(test hand-insert.bins
  (with-cook (:clean t)
    (is (equal (list nil (hand 0) (bin 1)) (reply 'command:hand-insert-bin (hand 0) (bin 1))))
    (is (eq (bin 1) (stand-in (hand 0))))
    (is (equal (list nil (hand 1) (bin 1)) (reply 'command:hand-insert (hand 1) (bin 1))))
    (is (eq (bin 1) (stand-in (hand 1))))
    (is (string= (format nil "~@{hand-insert: Hand ~D inserted into Storage-bin 1~%~}" 0 1)
                 (texts)))))

(test hand-insert.error-codes-in-the-printed-order
  (with-cook (:clean t)
    (flet ((try (designator) (code-of 'command:hand-insert (hand 0) designator)))
      (is (eq :hand-bump (try (hallucinate))))
      (is (eq :non-local-designator (try (hallucinate :type :non-local))))
      (is (eq :non-local-designator (try (designate 'crate :type :non-local))))
      (is (eq :bin-closed (try (designate 'jar))))
      (is (eq :insufficient-capacity (try (designate 'anvil))))
      (is (eq :different-location (try (designate 'chest))))
      (let ((designator (designate 'hamper)))
        (robot:drop-designator designator)
        (is (eq :bad-designator (try designator))))
      ;; Holding the hamper: it has room for itself, but not while the chest is in it.
      (world:set-attribute (thing 'hamper) :capacity 30)
      (is (null (grasp 0 'hamper)))
      (is (eq :holding-thing (try (designate 'hamper))))
      (is (eq :insufficient-capacity (try (designate 'chest))))
      (world:set-attribute (thing 'chest) :capacity 30)
      (is (eq :holding-thing (try (designate 'chest))) "what is in what it holds")
      (world:set-attribute (thing 'hamper) :capacity 10)
      (is (eq :insufficient-capacity (try (designate 'hamper))))
      (world:set-attribute (thing 'hamper) :closed t)
      (is (eq :bin-closed (try (designate 'hamper)))))))

(test hand-insert-bin.error-codes
  (with-cook (:clean t)
    (flet ((try () (code-of 'command:hand-insert-bin (hand 0) (bin 1))))
      (put-into (hand 0) (thing 'hamper))
      (is (eq :different-location (try)) "bins are reached from the open only")
      (put-into (hand 0) nil)
      (with-chance ('hand-insert-miss-prob* 1) (is (eq :hand-bump (try))))
      (grasp 0 'melon)
      (is (eq :insufficient-capacity (try)))
      (code-of 'command:storage-bin-close (bin 1))
      (is (eq :bin-closed (try))))))

(test hand-insert.does-not-fit-by-rounding
  "0.1 + 0.2 is more than 0.3 to a computer, not to a bin."
  (with-cook (:clean t)
    (let ((box (world:make-new-thing 'case (list 'kitchen 5.5 5.5) '((:capacity .3) (:size 1)))))
      (world:make-new-thing 'coin box '((:size .1)))
      (world:make-new-thing 'coin box '((:size .1)))
      (world:make-new-thing 'ring (hand 0) '((:size .1)))
      (is (null (code-of 'command:hand-insert (hand 0) (designate 'case)))))))

(test hand-insert.one-level-at-a-time
  (with-cook (:clean t)
    (is (eq :different-location (code-of 'command:hand-insert (hand 0) (designate 'tin))))
    (dolist (name '(hamper chest tin))
      (is (null (code-of 'command:hand-insert (hand 0) (designate name))))
      (is (eq name (stand-in (hand 0)))))
    (is (eq :different-location (code-of 'command:hand-insert (hand 0) (designate 'hamper))))
    (put-into (camera 0) (thing 'tin))
    (is (null (grasp 0 'dot)))
    (dolist (name '(chest hamper nil))
      (is (null (code-of 'command:hand-remove (hand 0))))
      (is (eq name (stand-in (hand 0)))))
    (is (eq (thing 'dot) (robot:hand-holding (hand 0))))
    (is (= 4 (world:remaining-capacity (thing 'chest))))
    (is (= .8 (coerce (world:remaining-capacity (thing 'tin)) 'single-float)))))

(test hand-insert.a-bump-loses-designators-by-chance
  (with-cook (:clean t)
    (with-chance ('hand-insert-miss-prob* 1)
      (let ((designators (list (designate 'hamper) (designate 'hamper))))
        (is (eq :hand-bump (code-of 'command:hand-insert (hand 0) (first designators))))
        (is (every #'robot:designator-valid-p designators))
        (with-chance ('hand-insert-lose-desig-prob* 1)
          (texts)
          (is (eq :hand-bump (code-of 'command:hand-insert (hand 0) (first designators))))
          (is (notany #'robot:designator-valid-p designators))
          (is (string= (format nil "~@{*WARNING* -> Removing Designator ~D~%~}~
                                    *ERROR* -> Hand 0 bumped HAMPER#5~%" 0 1)
                       (texts))))))))

(test hand-insert.a-stranger's-designator-or-bin
  (run:with-simulation ((cook rover-in-kitchen) :clean t :ghosts t)
    (let ((hand (robot:robot-hand (robot:find-robot 'rover-in-kitchen) 0)))
      (signals base:misuse (command:hand-insert hand (designate 'hamper)))
      (signals base:misuse (command:hand-insert-bin hand (bin 0)))
      (signals base:misuse
        (command:hand-grasp-desig hand (camera 0) (track (camera 0) (designate 'apple)))))))

(robot:defrobot rover-in-kitchen (kitchen (5.5 5.5) 0)
  :cameras (((/ pi 4) 3))
  :hands (10)
  :bins (20))

(test moving-hand.moves-what-it-holds
  "Messages as in the session of appendix E."
  (with-cook (:clean t)
    (put-into (camera 0) (thing 'hamper))
    (put-into (hand 0) (thing 'hamper))
    (let ((designator (track (camera 0) (designate 'pen))))
      (is (null (code-of 'command:hand-grasp-desig (hand 0) (camera 0) designator)))
      (texts)
      (is (null (code-of 'command:hand-remove (hand 0))))
      (is (string= (format nil "*WARNING* -> PEN#4 has moved~@
                                *WARNING* -> Removing Designator 0~@
                                *WARNING* -> Designator 0 no longer valid. Camera 0 lost track~@
                                hand-remove: Hand 0 removed from HAMPER#5~%")
                   (texts)))
      (is (null (code-of 'command:hand-insert-bin (hand 0) (bin 1))))
      (is (string= (format nil "*WARNING* -> PEN#4 has moved~@
                                hand-insert: Hand 0 inserted into Storage-bin 1~%")
                   (texts))))))

(test moving-hand.tells-of-itself-before-the-track-it-ends
  (with-cook (:clean t)
    (let ((*answers* '()) (designator (designate 'apple)))
      (command:camera-track (camera 0) designator (recorder 'track))
      (command:hand-grasp-desig (hand 0) (camera 0) designator (recorder 'grasp))
      (run:run-ticks 10)
      (is (equal '((track nil) (grasp nil))
                 (mapcar (lambda (answer) (subseq answer 0 2)) (reverse *answers*))))
      (setf *answers* '())
      (command:hand-insert-bin (hand 0) (bin 0) (recorder 'insert))
      (run:run-ticks 5)
      (is (equal '((insert nil) (track :lost-track))
                 (mapcar (lambda (answer) (subseq answer 0 2)) (reverse *answers*)))))))

;;; Cameras.

(test camera-insert.goes-in-and-out
  (with-cook (:clean t)
    (let ((designator (designate 'hamper)))
      (track (camera 0) designator)
      (track (camera 1) designator)
      (is (equal (list nil (camera 0) designator)
                 (reply 'command:camera-insert (camera 0) designator)))
      (is (eq 'hamper (stand-in (camera 0))))
      (is (string= (format nil "*WARNING* -> Camera 0 moved. No longer tracking Designator 0~@
                                camera-insert: Camera 0 inserted into HAMPER#5~%")
                   (texts)))
      (is-true (robot:designator-valid-p designator) "camera 1 tracks it")
      (is (equal (list nil (camera 0)) (reply 'command:camera-remove (camera 0))))
      (is (string= (format nil "camera-remove: Camera 0 removed from HAMPER#5~%") (texts)))
      (is (eq :not-inside (code-of 'command:camera-remove (camera 0)))))))

(test camera-insert.bins-need-no-track
  (with-cook (:clean t)
    (is (equal (list nil (camera 0) (bin 0)) (reply 'command:camera-insert (camera 0) (bin 0))))
    (is (eq (bin 0) (stand-in (camera 0))))))

(test camera-insert.error-codes-in-the-printed-order
  (with-cook (:clean t)
    (flet ((try (designator &optional (tracked designator))
             (when tracked (track (camera 0) tracked))
             (prog1 (code-of 'command:camera-insert (camera 0) designator)
               (robot:end-track (camera 0) :interrupt))))
      (is (eq :bin-closed (try (designate 'jar) nil)))
      (is (eq :not-tracking (try (designate 'hamper) nil)))
      (is (eq :not-tracking-destination (try (designate 'hamper) (designate 'apple))))
      (is (eq :camera-bump (try (hallucinate))))
      (with-chance ('camera-insert-miss-prob* 1)
        (is (eq :camera-bump (try (designate 'anvil)))))
      (is (eq :insufficient-capacity (try (designate 'anvil))))
      (is (eq :non-local-designator (try (designate 'crate :type :non-local))))
      (let ((designator (designate 'hamper)))
        (robot:drop-designator designator)
        (is (eq :not-tracking (try designator nil))))
      (put-into (camera 0) (bin 0))
      (is (eq :local-not-local (code-of 'command:camera-insert (camera 0) (bin 1))))
      (code-of 'command:storage-bin-close (bin 1))
      (is (eq :bin-closed (code-of 'command:camera-insert (camera 0) (bin 1)))))))

(test camera-insert.a-miss-always-loses-the-designator
  (with-cook (:clean t)
    (with-chance ('camera-insert-miss-prob* 1)
      (let ((designator (track (camera 0) (designate 'hamper))) (*answers* '()))
        (track (camera 1) designator)
        (is (eq :camera-bump (code-of 'command:camera-insert (camera 0) designator)))
        (is-false (robot:designator-valid-p designator))
        (is (null (robot:camera-tracks (camera 1))))
        (is (null (stand-in (camera 0))))
        (is (search "Camera 0 bumped HAMPER#5" (texts))))
      (is (eq :camera-bump (code-of 'command:camera-insert (camera 0) (bin 0)))))))

(test camera-insert.success-may-lose-the-designator
  (with-cook (:clean t)
    (with-chance ('camera-insert-lose-desig-prob* 1)
      (let ((designator (track (camera 0) (designate 'hamper))))
        (track (camera 1) designator)
        (is (null (code-of 'command:camera-insert (camera 0) designator)))
        (is (eq 'hamper (stand-in (camera 0))))
        (is-false (robot:designator-valid-p designator))))))

(test camera-insert.one-level-at-a-time
  (with-cook (:clean t)
    (dolist (name '(hamper chest tin))
      (is (null (code-of 'command:camera-insert (camera 0)
                         (track (camera 0) (designate name)))))
      (is (eq name (stand-in (camera 0)))))
    (dolist (name '(chest hamper nil))
      (is (null (code-of 'command:camera-remove (camera 0))))
      (is (eq name (stand-in (camera 0)))))))

;;; Interruption, and wrong arguments.

(defun answers-to-two (first &optional second)
  "Issue the command and arguments FIRST, and then SECOND or grab what FIRST is for. Return what
the continuation of FIRST got; claims that it was called exactly once."
  (let ((*answers* '()))
    (apply (first first) (append (rest first) (list (recorder 'first))))
    (if second
        (apply (first second) (rest second))
        (time:grab-resource (second first)))
    (run:run-ticks 20)
    (is (= 1 (length (answers-to 'first))) "~S" (first first))
    (first (answers-to 'first))))

(test handling.is-interrupted-on-its-resource
  "By a grab all commands, by themselves those that take time."
  (with-cook (:clean t)
    (loop for (name . arguments)
            in `((command:hand-grasp-desig ,(hand 0) ,(camera 0) ,(designate 'apple))
                 (command:hand-ungrasp ,(hand 0))
                 (command:hand-grasp-check ,(hand 0))
                 (command:hand-track ,(hand 0))
                 (command:hand-insert ,(hand 0) ,(designate 'hamper))
                 (command:hand-insert-bin ,(hand 0) ,(bin 0))
                 (command:hand-remove ,(hand 0))
                 (command:storage-bin-open ,(bin 0))
                 (command:storage-bin-close ,(bin 0))
                 (command:camera-insert ,(camera 0) ,(bin 0))
                 (command:camera-remove ,(camera 0)))
          for command = (command:find-command name)
          for results = (make-list (length (command:command-results command)))
          for interruption = (list* :interrupt (first arguments) results)
          do (is (equal interruption (answers-to-two (cons name arguments))) "~S" name)
             (if (command::command-instant-p command)
                 (is (not (eq :interrupt (first (answers-to-two (cons name arguments)
                                                                (cons name arguments)))))
                     "~S" name)
                 (is (equal interruption (answers-to-two (cons name arguments)
                                                         (cons name arguments)))
                     "~S" name)))))

(test handling.rejects-wrong-arguments-at-once
  (with-cook ()
    (loop for (command . arguments)
            in `((command:hand-ungrasp cook) (command:hand-ungrasp ,(camera 0))
                 (command:hand-insert ,(hand 0) ,(thing 'hamper))
                 (command:hand-insert-bin ,(hand 0) ,(hand 1))
                 (command:hand-grasp-desig ,(hand 0) 0 ,(designate 'apple))
                 (command:hand-grasp-desig ,(hand 0) ,(camera 0) nil)
                 (command:storage-bin-open nil) (command:camera-insert ,(camera 0) 3)
                 (command:camera-remove ,(camera 0) 7))
          do (signals base:wrong-argument (apply command arguments)))
    (signals base:wrong-argument (robot:in-location 'pen (hand 0)))))

;;; What a tick settles.

(test settling.is-left-out-while-there-is-nothing-to-settle
  "It is back with each thing that a tick settles, until that is over."
  (with-cook (:clean t)
    (flet ((settled-p () (run:run-ticks 1) (world:world-settled-p world:*world*)))
      (loop for (begin end)
              in (list (list (lambda () (designate 'pen) (designate 'apple))
                             (lambda () (map nil #'robot:drop-designator
                                             (robot:live-designators cook))))
                       (list (lambda () (put-into (hand 1) (thing 'hamper)))
                             (lambda () (put-into (hand 1) nil)))
                       (list (lambda () (put-into (camera 0) (bin 0)))
                             (lambda () (put-into (camera 0) nil)))
                       (list (lambda () (world:move-thing (thing 'apple) (hand 0))
                               (command:hand-track (hand 0))
                               (run:run-ticks 1))
                             (lambda () (world:move-thing (thing 'apple) 5.5 5.5))))
            do (is-true (settled-p))
               (funcall begin)
               (is-false (settled-p))
               (funcall end))
      (is-true (settled-p)))))

(test settling.is-not-forgotten
  "What there is to settle comes up when nothing has been for a while."
  (with-cook (:clean t)
    (let ((*answers* '()))
      (run:run-ticks 5)
      (command:camera-track (camera 0) (designate 'apple) (recorder 'track))
      (run:run-ticks 5)
      (robot:drop-designator (robot:camera-tracks (camera 0)))
      (run:run-ticks 1)
      (is (equal '(nil :lost-track) (mapcar #'first (answers-to 'track))))
      (run:run-ticks 5)
      (world:move-thing (thing 'apple) (hand 0))
      (world:move-thing (thing 'pen) (hand 0))
      (run:run-ticks 1)
      (is (= 1 (length (robot:hand-contents (hand 0)))))
      (run:run-ticks 5)
      (put-into (hand 1) (thing 'hamper))
      (world:move-thing (thing 'hamper) 2.5 2.5)
      (run:run-ticks 1)
      (is (null (stand-in (hand 1)))))))
