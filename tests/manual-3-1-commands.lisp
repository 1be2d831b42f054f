;;;; manual-3-1-commands.lisp -- sections 3.1.1 to 3.1.3: continuations and resources.

(in-package :ars-test-manual)
(in-readtable :nisp)

(in-suite manual-3-1)

;;; 3.1.1: continuations.

(test manual-3-1-1.tell-of-success
  "3.1.1: NIL as the first argument means that there was no error."
  (at-each-spot (:clean t)
    (is (equal (list nil scout) (call-once 'robot-go-forward scout 3)))))

(test manual-3-1-1.tell-of-an-error-long-after
  "3.1.1: the path may turn out obstructed when the program has long gone on."
  (at-each-spot (:clean t)
    (put-beside 'crate 9 0 :obsmove #t)
    (destructuring-bind ((tick code resource)) (call-times 40 'robot-go-forward scout 30)
      (is (< 14 tick 18))
      (is (eq :robot-blocked code))
      (is (eq scout resource)))))

(test manual-3-1-1.are-called-once-whatever-happens
  "3.1.1: when the command terminates for any reason, and not before."
  (at-each-spot (:clean t)
    (recording (record)
      (robot-go-forward scout 3 (record 'success))
      (run-ticks 6)
      (is (null (record)))
      (run-ticks 20)
      (robot-turn-corner scout (record 'failure))
      (run-ticks 20)
      (robot-turn scout 3 (record 'broken-off))
      (run-ticks 4)
      (robot-turn scout 0)
      (run-ticks 20)
      (is (equal '((success nil) (failure :no-corner) (broken-off :interrupt))
                 (loop for (name code) in (record) collect (list name code)))))))

(test manual-3-1-1.codes-are-keywords
  "3.1.1: all codes that the commands of the manual can end with."
  (dolist (command (all-commands))
    (dolist (code (command-errors command))
      (is (keywordp (error-code-keyword code))))))

(defparameter *headings*
  '((camera-view camera view) (camera-get-place-designator camera desig)
    (camera-get-all-place-designators camera desig-lst)
    (camera-get-object-designator camera desig)
    (camera-get-all-object-designators camera desig-lst) (camera-track camera desig)
    (camera-untrack camera) (camera-turn camera angle) (camera-align-robot camera angle)
    (camera-align-place camera angle place-type) (camera-insert camera desig)
    (camera-remove camera) (robot-set-speed robot speed) (robot-set-turn-angle robot turn-angle)
    (robot-turn robot angle) (robot-about-face robot angle) (robot-turn-left robot angle)
    (robot-turn-right robot angle) (robot-align-place robot angle)
    (robot-turn-corner robot angle) (robot-go-forward robot) (robot-goto-wall robot)
    (robot-goto-designator robot camera desig) (robot-stop robot) (hand-grasp-desig hand desig)
    (hand-ungrasp hand) (hand-grasp-check hand) (hand-track hand) (hand-insert hand desig)
    (hand-insert-bin hand storage-bin) (hand-remove hand) (storage-bin-open storage-bin)
    (storage-bin-close storage-bin jammed-part))
  "The commands of chapter 3 and what their headings say their continuations get.")

(defun some-argument (spec designator)
  "Return something that a command's argument SPEC can be; if it must be one, DESIGNATOR."
  (case (intern (symbol-name (spec-type spec)) :ars-test-manual)
    (designator-type :non-local) (specification '()) (place-type 'doorway)
    ((designator destination) designator) (storage-bin (bin-of-scout)) (camera (eye))
    (t 1)))

(defun resource-for (command)
  (case (command-family command)
    (:moving scout)
    (:looking (eye))
    (t (let ((type (symbol-name (spec-type (command-resource command)))))
         (cond ((string= type "CAMERA") (eye))
               ((string= type "HAND") (hand-of-scout))
               (t (bin-of-scout)))))))

(test manual-3-1-1.get-what-the-headings-say
  "3.1.1, reading 85: as many arguments after the code, however a command ends."
  (loop for (name . results) in *headings*
        do (with-scout (:clean t)
             (put-beside 'ball 5 0)
             (let* ((command (find-command name)) (resource (resource-for command))
                    (arguments (loop with designator = (look '())
                                     for spec in (command-parameters command)
                                     collect (some-argument spec designator))))
               (recording (record)
                 (apply name resource (append arguments (list (record name))))
                 (grab-resource resource)
                 (apply name resource (append arguments (list (record name))))
                 (run-ticks 80)
                 (let ((calls (record)))
                   (is (<= 2 (length calls)) "~A" name)
                   (dolist (call calls)
                     (is (= (length results) (length (cddr call))) "~A" call)
                     (is (eq resource (third call))))))))))

(test manual-3-1-1.may-be-left-out
  "Reading 39: a command needs no continuation, and NIL is none."
  (at-each-spot (:clean t)
    (robot-turn scout 1)
    (run-ticks 10)
    (robot-turn scout 1 nil)
    (run-ticks 10)
    (is (near 2 (robot-angle scout)))))

(test manual-3-1-1.continuation-makes-functions
  "3.1.1: it is used as lambda is; unused parameters are no mistake."
  (let ((seen '()))
    (at-each-spot (:clean t)
      (robot-turn scout .3 (continuation (err - SYMBOL robot - ROBOT &rest more)
                             (push err seen)))
      (run-ticks 10))
    (is (equal (list nil nil nil nil) seen))))

(test manual-3-1-1.errors-inside-are-messages
  "Reading 86: an error in a continuation is reported, and the simulation goes on."
  (with-scout (:clean t)
    (recording (record)
      (robot-turn scout .3 (continuation (err robot angle) (error "Oh dear.")))
      (camera-turn (eye) 1 (record :camera))
      (run-ticks 10)
      (is (equal '(nil) (codes (record)))))
    (is (find-if (lambda (line) (search "Oh dear." line)) (said)))))

(test manual-3-1-1.commands-inside-run-from-the-next-tick
  "Reading 86: a command issued in a continuation begins in the next tick."
  (at-each-spot (:clean t)
    (let ((ticks '()))
      (camera-view (eye) (continuation (err camera view)
                           (push (simulation-tick) ticks)
                           (camera-view (eye) (continuation (err camera view)
                                                (push (simulation-tick) ticks)))))
      (run-ticks 5)
      (is (equal '(2 1) ticks)))))

;;; 3.1.2: resources.

(test manual-3-1-2.a-new-command-interrupts
  "3.1.2: the command in progress gets :INTERRUPT, and the new one runs."
  (at-each-spot (:clean t)
    (recording (record)
      (robot-turn scout 3 (record 'turn))
      (run-ticks 5)
      (robot-go-forward scout 2 (record 'go))
      (run-ticks 30)
      (is (equal (list (list 'turn :interrupt scout nil) (list 'go nil scout)) (record))))
    (is (< 0 (robot-angle scout) 3))))

(test manual-3-1-2.so-does-one-that-has-not-begun
  "3.1.2: also if the interrupted command was still waiting for its delay to pass."
  (at-each-spot (:clean t)
    (recording (record)
      (robot-turn scout 3 (record 'turn))
      (robot-turn scout -1 (record 'back))
      (run-ticks 30)
      (is (equal '((turn :interrupt) (back nil))
                 (loop for (name code) in (record) collect (list name code)))))
    (is (near -1 (robot-angle scout)))))

(test manual-3-1-2.one-that-is-over-is-not-interrupted
  "3.1.2: only a command that had no chance to complete is."
  (at-each-spot (:clean t)
    (recording (record)
      (robot-turn scout .3 (record 'turn))
      (run-ticks 10)
      (robot-turn scout .3 (record 'again))
      (run-ticks 10)
      (is (equal '(nil nil) (codes (record)))))))

(test manual-3-1-2.parts-work-side-by-side
  "3.1.2: robot, both cameras, a hand and a bin are resources of their own."
  (at-each-spot (:clean t)
    (recording (record)
      (robot-turn scout 1 (record 'robot))
      (camera-turn (eye 0) 1 (record 'camera-0))
      (camera-view (eye 1) (record 'camera-1))
      (hand-insert-bin (hand-of-scout) (bin-of-scout 1) (record 'hand))
      (storage-bin-close (bin-of-scout) (record 'bin))
      (run-ticks 20)
      (is (equal '(nil nil nil nil nil) (codes (record)))))))

(test manual-3-1-2.the-resource-is-the-first-argument
  "3.1.2: each continuation gets it after the code, and its type is the command's own."
  (dolist (heading *headings*)
    (is (string= (second heading)
                 (spec-type (command-resource (find-command (first heading)))))
        "~A" heading)))

(test manual-3-1-2.driving-may-cost-a-track
  "3.1.2: commands on different resources affect each other through the world only."
  (with-scout (:clean t)
    (place-robot scout 26.5 12.5 (/ pi -2))
    (camera-turn (eye) 1)
    (put 'ball '(33.5 8.3))
    (run-ticks 2)
    (let ((ball (look '())))
      (is-true ball)
      (tracking (record ball)
        (robot-go-forward scout 5)
        (run-ticks 20)
        (is (equal '(nil :lost-track) (codes (record))))))))

(test manual-3-1-2.setting-the-speed-interrupts-a-motion
  "Reading 94: it is a command on the robot like any."
  (dolist (setting '(robot-set-speed robot-set-turn-angle))
    (at-each-spot (:clean t)
      (recording (record)
        (robot-go-forward scout 20 (record 'go))
        (run-ticks 8)
        (funcall setting scout .25)
        (run-ticks 9)
        (is (equal '(:interrupt) (codes (record))))))))

(test manual-3-1-2.tracking-goes-on-behind-other-commands
  "Reading 82: views and searches leave a track alone, turning the camera interrupts it."
  (loop for (code track . command) in '((nil (nil) camera-view)
                                        (:already-tracking (nil)
                                         camera-get-place-designator doorway)
                                        (nil (nil :interrupt) camera-turn .1)
                                        (nil (nil :interrupt) camera-align-robot)
                                        (nil (nil :interrupt) camera-untrack))
        do (at-each-spot (:clean t)
             (put-beside 'ball 5 0)
             (tracking (record (look '()))
               (is (eq code (apply #'end-code (first command) (eye) (rest command))))
               (is (equal track (codes (record))) "~A" command)))))

(test manual-3-1-2.grab-resource-interrupts-all
  "Readings 37 and 82: the pending command of a part, and its track."
  (at-each-spot (:clean t)
    (put-beside 'ball 5 0)
    (tracking (record (look '()))
      (camera-turn (eye 1) 2 (record :turn))
      (grab-resource (eye))
      (grab-resource (eye 1))
      (run-ticks 5)
      (is (equal '((:track nil) (:track :interrupt) (:turn :interrupt))
                 (loop for (name code) in (record) collect (list name code)))))))

;;; 3.1.3: the example.

(test manual-3-1-3.the-example-says-what-fails
  "3.1.3, readings 36 and 69: door is no place type; OUT prints without quotes and ends the line."
  (with-scout (:clean t)
    (let ((robot scout))
      (is (string= (format nil "Get designator failed on Camera 1 due to INVALID-PLACE-TYPE~%")
                   (with-output-to-string (*standard-output*)
                     (camera-get-place-designator (vref !>robot.cameras 1) 'door
                       (continuation (err cam desig)
                         (when err
                           (out "Get designator failed on " cam " due to " err T))))
                     (run-ticks 10)))))))

(test manual-3-1-3.cameras-are-a-slot-of-the-robot
  "3.1.3, reading 216: !>robot.cameras, counted from 0 by vref."
  (with-scout ()
    (let ((robot scout))
      (is (eq (robot-camera scout 1) (vref !>robot.cameras 1)))
      (is (= 2 (length !>robot.cameras))))))
