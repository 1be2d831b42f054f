;;;; soundness.lisp -- a world that was put together from a file is one, or it is said why not.

(in-package :ars-magna.world)

(export '(check-world world-invariant-violations))

(defun check-cell (index stock met)
  "Signal CONTRADICTION unless what lies in the cell INDEX of STOCK are things that none of the tags
in MET, which they are added to, stand for."
  (loop for tag = (aref (stock-firsts stock) index) then (aref (stock-nexts stock) (1- tag))
        until (zerop tag)
        do (must-hold (and (<= tag (stock-count stock))
                           (thing-p (svref (stock-things stock) (1- tag)))
                           (zerop (bit met tag)))
                      "what lies in a cell are no things")
           (setf (bit met tag) 1)))

(defun check-cells (world)
  "Signal CONTRADICTION unless WORLD has as many cells as its map, with things in them."
  (let* ((stock (world-stock world)) (size (length (stock-firsts stock)))
         (met (make-array (1+ (stock-count stock)) :element-type 'bit :initial-element 0)))
    (must-hold (= size (* (map-width (world-map world)) (map-height (world-map world)))
                  (length (world-flags world)))
               "its world has not the size of ~A" (world-map world))
    (dotimes (index size) (check-cell index stock met))))

(defun check-stock (stock)
  "Signal CONTRADICTION unless STOCK has room for as many things as it says."
  (must-hold (and (<= 0 (stock-count stock) (length (stock-things stock)))
                  (<= +least-stock+ (length (stock-things stock)))
                  (= (length (stock-things stock)) (length (stock-nexts stock))
                     (length (stock-marks stock)))
                  (every #'null (subseq (stock-things stock) (stock-count stock))))
             "its vector of things cannot grow"))

(defun check-thing (thing rank world)
  "Signal CONTRADICTION unless THING makes sense as the one with RANK in WORLD."
  (must-hold (and (thing-p thing)
                  (eq world (thing-world thing))
                  (thing-alive-p thing)
                  (= rank (thing-rank thing))
                  (< 0 (thing-serial thing) (world-next-serial world)))
             "what is number ~D of its things is none of them" rank)
  (must-hold (proper-list-of-p (lambda (entry) (typep entry '(cons keyword (cons t null))))
                               (thing-attributes thing))
             "the attributes of ~A make no sense" thing)
  (must-hold (proper-list-of-p (lambda (inside)
                                 (and (thing-p inside) (eq thing (thing-location inside))))
                               (thing-contents thing))
             "what is in ~A are no things, or are elsewhere" thing)
  (must-hold (proper-list-of-p (lambda (attachment)
                                 (and (attachment-p attachment)
                                      (eq thing (attachment-thing attachment))))
                               (thing-kickers thing))
             "the kickers of ~A are not its own" thing))

(defun check-things (world)
  (let ((serials (make-hash-table)))
    (loop for rank below (world-rank-count world)
          for thing = (thing-of-rank rank world)
          do (when thing
               (check-thing thing rank world)
               (must-hold (null (gethash (thing-serial thing) serials))
                          "two things have the number ~D" (thing-serial thing))
               (setf (gethash (thing-serial thing) serials) t)))
    (must-hold (= (world-live-count world) (hash-table-count serials))
               "it has not as many things as it says")))

;;; Places. Each thing is met once: in the cell where it lies, or in what holds it.

(defun count-met (things location met)
  "Count in the table MET each of THINGS, which are in LOCATION."
  (dolist (thing things)
    (must-hold (eq location (thing-location thing)) "~A is not where it is listed" thing)
    (incf (gethash thing met 0))))

(defun check-lying (thing index world)
  "Signal CONTRADICTION unless THING can lie in the cell INDEX of WORLD."
  (must-hold (and (map-index (world-map world) (thing-x thing) (thing-y thing))
                  (= index (thing-index thing)))
             "~A does not lie in its cell" thing)
  (must-hold (= (thing-flags thing) (aref (stock-marks (world-stock world)) (thing-rank thing)))
             "~A is not marked as what it is" thing))

(defun check-floor (world met)
  "Count in MET what lies in the cells of WORLD, and check that and the cells' flags."
  (loop for index below (length (world-flags world))
        for flags = (aref (map-flags (world-map world)) index)
        do (do-cell (thing index world)
             (count-met (list thing) :floor met)
             (check-lying thing index world)
             (setf flags (logior flags (thing-flags thing))))
           (must-hold (= flags (aref (world-flags world) index))
                      "cell ~D is not as the map and the things in it make it" index)))

(defun holders-in (world)
  "Return a list of all that holds things of WORLD, each once."
  (let ((holders (make-hash-table :test 'eq)))
    (do-things (thing world)
      (let ((location (thing-location thing)))
        (unless (eq :floor location)
          (must-hold (and location (holder-p location)) "~A is nowhere" thing)
          (setf (gethash location holders) t))))
    (loop for holder being the hash-keys of holders collect holder)))

(defun check-no-circle (world)
  "Signal CONTRADICTION if a thing of WORLD is in itself."
  (let ((grounded (make-hash-table :test 'eq)))
    (do-things (thing world)
      (loop for outer = thing then (thing-location outer)
            for passed from 0
            while (and (thing-p outer) (not (gethash outer grounded)))
            do (must-hold (< passed (world-live-count world)) "~A is in itself" thing))
      (loop for outer = thing then (thing-location outer)
            while (and (thing-p outer) (not (gethash outer grounded)))
            do (setf (gethash outer grounded) t)))))

(defun check-places (world)
  (let ((met (make-hash-table :test 'eq)))
    (check-floor world met)
    (dolist (holder (holders-in world))
      (must-hold (proper-list-of-p #'thing-p (location-contents holder))
                 "what ~A holds are no things" (location-name holder))
      (count-met (location-contents holder) holder met))
    (do-things (thing world)
      (must-hold (eql 1 (gethash thing met)) "~A is not in one place" thing)
      (must-hold (= (hash-table-count met) (world-live-count world))
                 "something that is no more lies about"))
    (check-no-circle world)))

;;; Kickers.

(defun check-seat (group index)
  "Signal CONTRADICTION unless the member of GROUP with INDEX makes sense."
  (let* ((row (group-row group))
         (attachment (svref row (* 3 index)))
         (thing (svref row (+ 1 (* 3 index)))))
    (must-hold (and (attachment-p attachment)
                    (eq group (attachment-group attachment))
                    (= index (attachment-index attachment))
                    (eq thing (and (attachment-alive-p attachment) (attachment-thing attachment)))
                    (eq (svref row (+ 2 (* 3 index))) (attachment-kicker attachment)))
               "number ~D of the kickers with the chance ~A is none of them"
               index (group-probability group))))

(defun check-group (group)
  (must-hold (and (typep group 'group)
                  (<= 0 (group-skip group))
                  (<= 0 (* 3 (group-count group)) (length (group-row group)))
                  (plusp (length (group-row group)))
                  (zerop (mod (length (group-row group)) 6))
                  (probability-p (group-probability group))
                  (<= 0 (group-quantum group)))
             "its groups of kickers make no sense")
  (dotimes (index (group-count group)) (check-seat group index))
  (must-hold (every #'null (subseq (group-row group) (* 3 (group-count group))))
             "there are more kickers with the chance ~A than it says" (group-probability group))
  (must-hold (and (proper-list-of-p (lambda (attachment)
                                      (and (attachment-p attachment)
                                           (eq group (attachment-group attachment))
                                           (not (attachment-alive-p attachment))))
                                    (group-dead group))
                  (= (length (group-dead group))
                     (length (remove-duplicates (group-dead group)))
                     (loop for index below (group-count group)
                           count (null (svref (group-row group) (+ 1 (* 3 index)))))))
             "the kickers with the chance ~A that were taken off do not add up"
             (group-probability group)))

(defun check-kickers (world)
  (must-hold (proper-list-p (world-kicker-groups world)) "its groups of kickers go round")
  (mapc #'check-group (world-kicker-groups world))
  (must-hold (proper-list-of-p (lambda (attachment)
                                 (and (attachment-p attachment)
                                      (eq world (thing-world (attachment-thing attachment)))))
                               (world-due-kickers world))
             "the kickers that are due are none"))

(defun check-world (world)
  "Signal an error, CONTRADICTION as far as we know, unless WORLD, which was put together from a
file, could have come about by itself."
  (must-hold (and (= (length (world-dice-set world)) (length +dice-purposes+))
                  (every (lambda (dice) (typep dice 'dice)) (world-dice-set world)))
             "its dice are none")
  (check-stock (world-stock world))
  (check-cells world)
  (check-things world)
  (check-places world)
  (check-kickers world))

(defun world-invariant-violations (world)
  "Return in a list what CHECK-WORLD says is wrong with WORLD, a string; NIL if nothing is."
  (handler-case (progn (check-world world) '())
    (error (condition) (list (princ-to-string condition)))))
