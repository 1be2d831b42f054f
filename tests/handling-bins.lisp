;;;; handling-bins.lisp -- storage bins, and what pulls parts and things out of containers.

(in-package :ars-magna.tests)

(in-suite handling)

;;; Bins.

(test bin.opens-and-closes
  (with-cook (:clean t)
    (is (equal (list :bin-open (bin 0)) (reply 'command:storage-bin-open (bin 0))))
    (is (equal (list nil (bin 0) nil) (reply 'command:storage-bin-close (bin 0))))
    (is-true (robot:storage-bin-closed-p (bin 0)))
    (is (equal (list :bin-closed (bin 0) nil) (reply 'command:storage-bin-close (bin 0))))
    (is (equal (list nil (bin 0)) (reply 'command:storage-bin-open (bin 0))))
    (is-false (robot:storage-bin-closed-p (bin 0)))
    (is (string= (format nil "*ERROR* -> Storage-bin 0 is already open~@
                              storage-bin-close: Storage-bin 0 closed~@
                              *ERROR* -> Storage-bin 0 is already closed~@
                              storage-bin-open: Storage-bin 0 opened~%")
                 (texts)))))

(test bin.does-not-close-on-parts
  (with-cook (:clean t)
    (put-into (hand 1) (bin 0))
    (is (equal (list :robot-in-bin (bin 0) (hand 1)) (reply 'command:storage-bin-close (bin 0))))
    (is (string= (format nil "*ERROR* -> Hand 1 still in Storage-bin 0~%") (texts)))
    (put-into (camera 1) (bin 0))
    (is (equal (list :robot-in-bin (bin 0) (camera 1))
               (reply 'command:storage-bin-close (bin 0))))
    (put-into (hand 1) nil)
    (put-into (camera 1) nil)
    (world:move-thing (thing 'tin) (bin 0))
    (put-into (hand 1) (thing 'tin))
    (is (equal (list :robot-in-bin (bin 0) (hand 1)) (reply 'command:storage-bin-close (bin 0)))
        "not even in something in it")))

(test bin.jams-only-with-something-in-it
  (with-cook (:clean t)
    (with-chance ('bin-close-jam-prob* 1)
      (is (null (code-of 'command:storage-bin-close (bin 0))))
      (code-of 'command:storage-bin-open (bin 0))
      (world:move-thing (thing 'apple) (bin 0))
      (is (equal (list :bin-jammed (bin 0) nil) (reply 'command:storage-bin-close (bin 0))))
      (is-false (robot:storage-bin-closed-p (bin 0))))))

(test bin.closed-keeps-things-in
  (with-cook (:clean t)
    (world:move-thing (thing 'apple) (bin 0))
    (code-of 'command:storage-bin-close (bin 0))
    (is-false (world:kick-thing (thing 'apple) 1 0 t))
    (code-of 'command:storage-bin-open (bin 0))
    (is-true (world:kick-thing (thing 'apple) 1 0 t))
    (is (eq :floor (world:thing-location (thing 'apple))))))

(test bin.travels-with-the-robot
  (with-cook (:clean t)
    (world:move-thing (thing 'apple) (bin 0))
    (robot:place-robot cook 9.5 3.5 0)
    (is (equal '(9.5d0 3.5d0) (multiple-value-list (world:thing-position (thing 'apple)))))))

;;; What pulls parts out.

(test part.is-pulled-out-when-the-robot-drives-away
  (with-cook (:clean t)
    (world:set-attribute (thing 'anvil) :obsmove nil)
    (put-into (hand 0) (thing 'hamper))
    (put-into (camera 0) (thing 'hamper))
    (world:move-thing (thing 'pen) (hand 0))
    (let ((designator (track (camera 0) (designate 'chest))))
      (command:robot-go-forward cook 4 nil)
      (run:run-ticks 30)
      (is (null (stand-in (hand 0))))
      (is (null (stand-in (camera 0))))
      (is-false (robot:designator-valid-p designator))
      (is (eq (thing 'pen) (robot:hand-holding (hand 0))) "it takes along what it holds")
      (let ((texts (texts)))
        (is (search "Hand 0 was pulled out of HAMPER#5" texts))
        (is (search "PEN#4 has moved" texts))
        (is (search "Camera 0 was pulled out of HAMPER#5" texts))))))

(test part.stays-in-what-is-carried-along
  (with-cook (:clean t)
    (put-into (camera 0) (thing 'hamper))
    (is (null (code-of 'command:hand-grasp-desig (hand 0) (camera 1)
                       (track (camera 1) (designate 'hamper)))))
    (command:robot-go-forward cook 4 nil)
    (run:run-ticks 30)
    (is (eq 'hamper (stand-in (camera 0))))))

(test part.is-pulled-out-when-the-container-goes-or-vanishes
  (with-cook (:clean t)
    (dolist (go-away (list (lambda (thing) (world:move-thing thing 9.5 9.5))
                           (lambda (thing) (world:move-thing thing (thing 'crate)))
                           (lambda (thing) (world:kick-thing thing 3 3 t))
                           #'world:destroy-thing))
      (world:move-thing (thing 'chest) 5.5 5.5)
      (put-into (hand 0) (thing 'tin))
      (funcall go-away (thing 'chest))
      (if (thing 'chest)
          (is (null (stand-in (hand 0))))
          (is (eq 'tin (stand-in (hand 0))) "the tin has only fallen out of it")))
    (world:destroy-thing (thing 'tin))
    (is (null (stand-in (hand 0))))
    (is (null (world:world-invariant-violations (robot:robot-world cook))))))

(test part.is-pulled-out-of-what-its-own-hand-gets
  "A hand in a hamper cannot hold that; somebody put it there."
  (with-cook (:clean t)
    (put-into (hand 0) (thing 'hamper))
    (world:move-thing (thing 'hamper) (hand 0))
    (is (null (stand-in (hand 0))))
    (is (eq (thing 'hamper) (robot:hand-holding (hand 0))))
    ;; By way of two hands and two things.
    (put-into (hand 1) (thing 'hamper))
    (world:move-thing (thing 'crate) (hand 1))
    (world:move-thing (thing 'hamper) (thing 'crate))
    (is (null (stand-in (hand 1))))
    (is (equal '(5.5d0 5.5d0) (multiple-value-list (world:thing-position (thing 'hamper)))))))

(test hand.holds-one-thing
  (with-cook (:clean t)
    (world:move-thing (thing 'apple) (hand 0))
    (world:move-thing (thing 'melon) (hand 0))
    (run:run-ticks 1)
    (is (equal (list (thing 'apple)) (robot:hand-contents (hand 0))))
    (is (eq :floor (world:thing-location (thing 'melon))))
    (is (equal '(5.5d0 5.5d0) (multiple-value-list (world:thing-position (thing 'melon)))))))

(test new-thing.in-a-full-hand-is-refused
  (with-cook (:clean t)
    (world:make-new-thing 'plum (hand 0) '((:size 1)))
    (is (eq (thing 'plum) (robot:hand-holding (hand 0))))
    (dolist (location (list (hand 0) (list :with (thing 'plum))))
      (signals base:misuse (world:make-new-thing 'fig location '((:size 1)))))
    (is (null (thing 'fig)))))

(test hand.in-something-closed-keeps-what-it-holds
  (with-cook (:clean t)
    (put-into (hand 0) (thing 'chest))
    (world:move-thing (thing 'dot) (hand 0))
    (is-true (world:kick-thing (thing 'dot) 1 0 t))
    (world:move-thing (thing 'dot) (hand 0))
    (world:set-attribute (thing 'hamper) :closed t)
    (is-false (world:kick-thing (thing 'dot) 1 0 t))))
