;;;; saving.lisp -- runs saved in files, and continued from there.

(in-package :ars-magna.tests)

(def-suite* saving :in ars-magna)

(defun saved-and-loaded (simulation)
  "Return the simulation that comes of a file in which SIMULATION is saved."
  (with-temporary-file (file)
    (run:save-simulation file simulation)
    (run:load-simulation file)))

(defun long-future (simulation)
  "Return the digests of SIMULATION in the next 1,000 ticks, in which nobody asks for anything."
  (loop repeat 50
        do (run:run-ticks 20 simulation)
        collect (run:state-digest simulation)))

(defun driven-future (simulation seed)
  "Return the digest of SIMULATION after it was driven at random, by SEED."
  (run::call-in-simulation simulation
                           (lambda ()
                             (let ((*ride* (make-ride (base:make-dice seed "driven"))))
                               (loop repeat 150 do (step-ride) (base:take-messages))
                               (run:run-ticks 100)
                               (run:state-digest)))))

(test saved.goes-on-as-its-original
  "40 moments of random rides, and 1,000 ticks from there."
  (call-at-moments
   (lambda (simulation)
     (let ((twin (saved-and-loaded simulation)))
       (is (= (run:state-digest simulation) (run:state-digest twin)))
       (is (equal (long-future (run:fork-simulation simulation)) (long-future twin)))))
   40 21))

(test saved.does-what-it-is-asked-as-its-original
  (let ((seed 0))
    (call-at-moments
     (lambda (simulation)
       (is (= (driven-future (run:fork-simulation simulation) (incf seed))
              (driven-future (saved-and-loaded simulation) seed))))
     10 22)))

(test saved.again-is-the-same-file
  (call-at-moments
   (lambda (simulation)
     (with-temporary-file (file)
       (with-temporary-file (again)
         (run:save-simulation file simulation)
         (run:save-simulation again (run:load-simulation file))
         (is (equal (journal-lines file) (journal-lines again))))))
   5 23))

(defun kinds-met (simulation)
  "Return the names of the structures that SIMULATION is saved with."
  (loop for batch in (run::batches-in-order
                      (run::take-inventory simulation (run::waiting-requests simulation)))
        when (eq :object (first (run::batch-shape batch)))
          collect (second (run::batch-shape batch))))

(test saved.are-objects-of-every-kind
  (let ((met '()))
    (loop for seed from 31 to 33
          do (call-at-moments (lambda (simulation)
                                (setf met (union met (kinds-met simulation))))
                              30 seed))
    (dolist (kind '(run:simulation time:timeline world:world world:thing world:attachment
                    robot:robot robot:camera robot:hand robot:storage-bin robot:odometer
                    robot:designator robot:track command::operation time:interruption world:place
                    world:cell))
      (is (member kind met) "~A was never met" kind))))

(test saved.are-requests-that-wait
  (with-rover (:seed 2)
    (command:robot-go-forward rover 20)
    (run:run-ticks 8)
    (command:camera-view (robot:robot-camera rover 0))
    (time:grab-resource rover)
    (let ((twin (saved-and-loaded time:*simulation*)))
      (is (equal (long-future (run:fork-simulation time:*simulation*)) (long-future twin))))))

(test saved.loads-in-a-fresh-lisp
  (run:with-simulation (ars-worlds:marvin :seed 7 :journal t)
    (let ((robot ars-worlds:marvin))
      (command:robot-go-forward robot 30)
      (run:run-ticks 12)
      (with-temporary-file (file)
        (run:save-simulation file)
        (run:run-ticks 200)
        (is (= (run:state-digest)
               (parse-integer
                (printed-in-child
                 "ars-magna/worlds"
                 (format nil "(let ((run (ars:load-simulation ~S)))
                                (ars:run-ticks 200 run)
                                (prin1 (ars:state-digest run)))"
                         (uiop:native-namestring file))))))))))

(test saved.live-between-two-ticks
  (with-messages
    (unwind-protect
         (progn
           (run:simulator 'pony :display nil :rate :free)
           (time:pause)
           (command:robot-turn (robot:find-robot 'pony) 2)
           (with-temporary-file (file)
             (run:save-simulation file)
             (let ((twin (run:load-simulation file)))
               (is (= (run:state-digest) (run:state-digest twin)))
               (is (run:headless-p twin))
               (run:run-ticks 50 twin)
               (is (/= 0 (robot:robot-angle (first (run:simulation-robots twin))))))))
      (run:stop-simulator))))

;;; Robots, parameters and noise are bound.

(test loaded.binds-what-belongs-to-it
  (with-temporary-file (file)
    (let (digest)
      (with-rover (:seed 4 :parameters '((base:braking* 7)))
        (setf base:motion-noise* 0.25d0)
        (base:clean-simulation)
        (command:robot-turn rover 1)
        (run:run-ticks 3)
        (run:save-simulation file)
        (run:run-ticks 20)
        (setf digest (run:state-digest)))
      (run:with-loaded-simulation (file)
        (is (= 7 base:braking*))
        (is (= 0 base:motion-noise*))
        (is (eq rover (first (run:simulation-robots))))
        (run:run-ticks 20)
        (is (= digest (run:state-digest)))
        (base:dirty-simulation)
        (is (= 0.25d0 base:motion-noise*)))
      (is (/= 7 base:braking*)))))

;;; What programs roll.

(defun rolls () (loop repeat 5 collect (random 1000)))

(test loaded.rolls-on-as-a-fork-does
  "Dice that have been rolled, not yet, until all words were read, and seeded anew."
  (with-temporary-file (file)
    (with-rover (:seed 1)
      (dolist (prepare (list (constantly nil) #'rolls
                             (lambda () (loop repeat 700 do (random 1000)))
                             (lambda () (run:set-seed 8))))
        (funcall prepare)
        (let ((next (run:with-fork () (rolls))))
          (run:save-simulation file)
          (is (equal next (run:with-loaded-simulation (file) (rolls))))
          (is (equal next (run:with-loaded-simulation (file) (run:with-fork () (rolls)))))
          (is (equal next (run:call-in-fork (run:fork-simulation (run:load-simulation file))
                                            #'rolls))))))))

(test saving.rolls-nothing
  "Neither do journals, nor all else that is written in a run: it goes on as if it had not been."
  (with-temporary-file (file)
    (let ((plain (with-rover (:seed 1) (rolls) (rolls))))
      (is (equal plain (with-rover (:seed 1 :journal t) (rolls) (run:save-journal file) (rolls))))
      (delete-file file)
      (is (equal plain (with-rover (:seed 1) (rolls) (run:save-simulation file) (rolls))))
      (is (equal plain (run:with-loaded-simulation (file) (rolls))))))
  (with-rover (:seed 1)
    (rolls)
    (with-temporary-file (file)
      (run:save-simulation file)
      (is (equal (run:with-fork () (rolls)) (run:with-loaded-simulation (file) (rolls)))))))

(test loaded.rolls-again-when-rewound
  (with-temporary-file (file)
    (with-rover (:seed 1) (rolls) (run:save-simulation file))
    (run:with-loaded-simulation (file :keep t)
      (run:run-ticks 2)
      (let ((first (rolls)))
        (run:run-ticks 2)
        (rolls)
        (run:rewind 3)
        (is (equal first (rolls)))))))

(test loaded.and-saved-at-once-has-the-same-dice
  (with-temporary-file (file)
    (with-temporary-file (again)
      (with-rover (:seed 1) (rolls) (run:save-simulation file))
      (run:save-simulation again (run:load-simulation file))
      (is (equal (journal-lines file) (journal-lines again)))
      (let ((seeded (run:load-simulation file)))
        (run:set-seed 4 seeded)
        (is (equal (with-rover (:seed 4) (rolls)) (run::call-in-simulation seeded #'rolls)))))))

(test loaded.without-dice-rolls-by-the-seed
  "As files of old, and those of live runs, say none."
  (with-temporary-file (file)
    (with-rover (:seed 1) (run:save-simulation file))
    (let* ((texts (saved-texts file)) (head (first texts)) (place (search " dice (" head)))
      (setf (first texts)
            (concatenate 'string (subseq head 0 place)
                         (subseq head (1+ (position #\) head :start place)))))
      (write-saved-texts texts file)
      (is (equal (with-rover (:seed 1) (rolls))
                 (run:with-loaded-simulation (file) (rolls)))))))

(test loaded.keeps-the-journal
  (with-temporary-file (file)
    (with-rover (:seed 31 :journal t)
      (ride-about)
      (run:save-simulation file))
    (run:with-loaded-simulation (file)
      (command:robot-turn rover 1)
      (run:run-ticks 30)
      (is-true (replays-p time:*simulation*))))
  (with-temporary-file (file)
    (with-rover () (run:save-simulation file))
    (is (null (run:simulation-journal (run:load-simulation file))))))

(test loaded.can-keep-forks
  (with-temporary-file (file)
    (with-rover (:seed 5) (run:run-ticks 3) (run:save-simulation file))
    (run:with-loaded-simulation (file :keep t)
      (run:run-ticks 4)
      (run:rewind 4)
      (is (= 3 (run:simulation-tick))))
    (run:with-loaded-simulation (file)
      (run:run-ticks 1)
      (signals base:misuse (run:rewind 1)))))

(test loaded.is-over-with-its-extent
  (with-temporary-file (file)
    (let (robot)
      (with-rover () (run:save-simulation file))
      (run:with-loaded-simulation (file) (setf robot rover))
      (signals base:misuse (command:robot-turn robot 1)))))

;;; Data of users' own.

(defstruct (ars-user::keepsake (:conc-name keepsake-) (:constructor make-keepsake) (:copier nil))
  (size 1 :type (integer 1))
  inside)

(defun odd-data ()
  "Return a list of data of many kinds, some of them the same."
  (let ((text (copy-seq "a \"text\" | of; \\ mine")) (row (list 1 2))
        (table (make-hash-table :test 'equal))
        (pile (make-array 3 :adjustable t :fill-pointer 2 :initial-contents '(a b c)))
        (deep (loop with list = '() repeat 3000 do (setf list (list list)) finally (return list))))
    (setf (gethash "key" table) row
          (gethash '(1 2) table) text)
    (list text text row row table pile deep (cons 1 2) (list* 1 text row)
          (make-keepsake :size 3 :inside table) #\a #\Nul (make-string 5000 :initial-element #\é)
          (loop for i below 5000 collect i) (make-array '(2 3) :initial-element 1/3)
          (make-array 4 :element-type '(unsigned-byte 8) :initial-element 255)
          sb-ext:double-float-negative-infinity -0d0 5d-324 (expt 3 400) 1.5 :key '|| '(:the 1))))

(defun same-shape-p (a b)
  "True if A and B look the same, with what is the same in them at the same places."
  (let ((pairs (make-hash-table)))
    (labels ((same-p (a b)
               (cond ((or (symbolp a) (numberp a) (characterp a)) (eql a b))
                     ((gethash a pairs) (eq b (gethash a pairs)))
                     (t (setf (gethash a pairs) b)
                        (etypecase a
                          (string (string= a b))
                          (cons (and (consp b) (same-p (car a) (car b)) (same-p (cdr a) (cdr b))))
                          (array (and (if (vectorp a)
                                          (= (length a) (length b))
                                          (equal (array-dimensions a) (array-dimensions b)))
                                      (eq (adjustable-array-p a) (adjustable-array-p b))
                                      (equal (array-element-type a) (array-element-type b))
                                      (loop for i below (if (vectorp a)
                                                            (length a)
                                                            (array-total-size a))
                                            always (same-p (row-major-aref a i)
                                                           (row-major-aref b i)))))
                          (hash-table (and (= (hash-table-count a) (hash-table-count b))
                                           (loop for value being the hash-values of a
                                                 for other being the hash-values of b
                                                 always (same-p value other))))
                          (ars-user::keepsake
                           (and (eql (keepsake-size a) (keepsake-size b))
                                (same-p (keepsake-inside a) (keepsake-inside b)))))))))
      (same-p a b))))

(test saved.are-data-of-users-own
  (with-temporary-file (file)
    (with-rover ()
      (let ((data (odd-data)) (crate (world:find-thing 'crate)))
        (setf (world:thing-attributes crate)
              (append (world:thing-attributes crate) (list (list :odd data))))
        (run:save-simulation file)
        (let* ((world (run:simulation-world (run:load-simulation file)))
               (loaded (world:get-attribute (world:find-thing 'crate world) :odd)))
          (is-true (same-shape-p (subseq data 0 9) (subseq loaded 0 9)))
          (is-true (same-shape-p data loaded)))))))

(defun saving-refusal (file)
  "Return what SAVE-SIMULATION to FILE signals, and check that it is of ours."
  (handler-case (progn (run:save-simulation file) nil)
    (base:ars-magna-error (trouble) trouble)))

(test saved.are-no-functions
  (with-temporary-file (file)
    (let ((before (journal-lines file)))
      (flet ((refused-p (words) (is-true (says-p words (saving-refusal file)))))
        (with-rover ()
          (world:put-kicker mine (thing (world:find-thing 'crate)) () (list thing))
          (refused-p "kicker"))
        (with-rover ()
          (setf (world:thing-attributes (world:find-thing 'crate)) `((:odd ,(lambda ()))))
          (refused-p "the slot attributes"))
        (with-rover ()
          (setf (world:thing-attributes (world:find-thing 'crate))
                `((:odd ,(make-hash-table :test 'geo:equal))))
          (refused-p "a user-defined test"))
        (with-rover ()
          (run:set-seed (expt 10 10000))
          (refused-p "too long")))
      (is (equal before (journal-lines file))))))

;;; What may be left out.

(test unsavable.are-plans-and-scheduled-functions
  (with-temporary-file (file)
    (with-rover (:journal t)
      (rpl:def-interp-proc wait-long () (rpl:wait-time 1000))
      (time:schedule (:bell :timer 9) (error "It happened."))
      (command:robot-go-forward rover 40)
      (run:run-ticks 2)
      (time:schedule (nil) (error "It happened."))
      (ars-magna.rpl-robot:begin-plan 'wait-long)
      (let ((refusal (saving-refusal file)))
        (is (typep refusal 'run:unsavable))
        (is (= 4 (length (run:unsavable-parts refusal))))
        (is-true (says-p "tick 9" refusal))
        (is-true (says-p "wait-long" refusal)))
      (handler-bind ((run:unsavable (lambda (trouble)
                                      (declare (ignore trouble))
                                      (invoke-restart 'run:save-without))))
        (run:save-simulation file))
      (let ((twin (run:load-simulation file)))
        (is (null (run:simulation-journal twin)))
        (run:run-ticks 30 twin)
        (is (null (base:take-messages)))
        (is (< 4 (robot:robot-x (first (run:simulation-robots twin)))))))))

(test unsavable.of-a-live-run-can-be-left-out-where-it-is-saved
  "The thread that has the run is another than the one in which the restart is chosen."
  (rpl:def-interp-proc wait-long () (rpl:wait-time 1000))
  (with-temporary-file (file)
    (with-rover ()
      (run:start-clock (time:current-simulation) :rate :free)
      (unwind-protect
           (progn
             (ars-magna.rpl-robot:begin-plan 'wait-long)
             (handler-bind ((run:unsavable (lambda (trouble)
                                             (is-true (find-restart 'run:save-without trouble))
                                             (invoke-restart 'run:save-without))))
               (is-true (run:save-simulation file))))
        (run:stop-clock (time:current-simulation))))
    (is (typep (run:load-simulation file) 'run:simulation))))
