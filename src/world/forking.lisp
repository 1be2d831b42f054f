;;;; forking.lisp -- the things of a world, copied for a fork of its run.

(in-package :ars-magna.world)

(export '(octets-of-copy))

;;; A world may have a hundred thousand things, each with kickers. So its things are copied first,
;;; in order. Afterwards a thing's copy is found by its rank, and an attachment's copy by its thing.
;;; Destroyed things and removed attachments have no rank: they are copied like other objects, if
;;; something still refers to them.

(declaim (inline find-copy-by-rank))
(defun find-copy-by-rank (thing old new)
  "NEW has the copies of the things in the vector OLD. Return the copy of THING; NIL if not in OLD."
  (declare (type thing thing) (type simple-vector old new))
  (let ((rank (thing-rank thing)))
    (and (< rank (length old))
         (eq thing (svref old rank))
         (svref new rank))))

(defmethod copy-plan-value ((thing thing) fork)
  (let ((world (thing-world thing)))
    (cond ((and world (not (eq world (copier-option fork :world)))) thing)
          ((destructuring-bind (&optional (old #()) &rest new) (copier-objects fork)
             (and new (find-copy-by-rank thing old new))))
          (t (copy-slots thing fork)))))

(defmethod copy-plan-value ((attachment attachment) fork)
  (let* ((thing (attachment-thing attachment))
         (place (position attachment (thing-kickers thing))))
    (if place
        (let ((twin (forked thing fork)))
          (if (eq twin thing)
              attachment                ; of another run
              (nth place (thing-kickers twin))))
        (copy-slots attachment fork))))

;;; Kickers.

(defun attachment-copier (copier)
  "Return a function with two arguments, an attachment and a copied thing. The function copies the
attachment for this thing, and puts the copy into the copied group."
  (let ((kicker nil) (new-kicker nil) (group nil) (new-group nil))
    ;; Most have the kicker and the group of the one before.
    (flet ((kicker-for (old)
             (unless (eq old kicker) (setf new-kicker (forked old copier) kicker old))
             new-kicker)
           (group-for (old)
             (unless (eq old group) (setf new-group (forked old copier) group old))
             new-group))
      (lambda (attachment twin)
        (declare #.*hot* (type attachment attachment))
        (let ((copy (copy-structure attachment)))
          (setf (attachment-kicker copy) (kicker-for (attachment-kicker attachment))
                (attachment-thing copy) twin)
          (when (attachment-group attachment)
            (setf (attachment-group copy) (group-for (attachment-group attachment)))
            (put-member (attachment-group copy) (attachment-index copy) copy))
          copy)))))

(defun put-other-members (group copy copier)
  "Copy the members that were removed from their things and are still in the row of GROUP. Put these
copies into COPY, the copy of GROUP."
  (when (group-dead group)
    (let ((row (group-row copy)))
      (loop for place from 0 below (* 3 (group-count group)) by 3
            do (when (eq (svref row place) (svref (group-row group) place))
                 (loop for index from place repeat 3
                       do (setf (svref row index) (forked (svref row index) copier))))))))

;;; Things.

(defun copy-thing (thing world copied)
  "Return a copy of THING for WORLD that still has the original location and contents. COPIED is a
function that copies attachments."
  (declare #.*hot* (type thing thing) (type function copied))
  (let ((twin (copy-structure thing)))
    (setf (thing-world twin) world)
    (when (thing-kickers thing)
      (setf (thing-kickers twin)
            (loop for attachment in (thing-kickers thing)
                  collect (funcall copied attachment twin))))
    twin))

(declaim (inline uncontained-empty-thing-p))
(defun uncontained-empty-thing-p (thing)
  (declare (type thing thing))
  (and (symbolp (thing-location thing))
       (null (thing-contents thing))))

(defun complete-thing-copy (thing old new copier)
  "Replace location and contents of the copy of THING by their copies. See FIND-COPY-BY-RANK."
  (declare (type thing thing))
  (flet ((twin (other) (or (find-copy-by-rank other old new) (forked other copier))))
    (let ((twin (twin thing)))
      (unless (symbolp (thing-location thing))
        (setf (thing-location twin) (forked (thing-location thing) copier)))
      (setf (thing-contents twin) (mapcar #'twin (thing-contents thing)))
      (when (robot-body-p thing)
        (setf (body-robot twin) (forked (body-robot thing) copier))))))

(defun copy-stock (stock things copier)
  (let ((copy (make-stock)))
    (setf (stock-things copy) (record-finished-copy things copier)
          (stock-count copy) (stock-count stock)
          (stock-bodies copy) (stock-bodies stock)
          (stock-firsts copy) (record-finished-copy (copy-seq (stock-firsts stock)) copier)
          (stock-nexts copy) (record-finished-copy (copy-seq (stock-nexts stock)) copier)
          (stock-marks copy) (record-finished-copy (copy-seq (stock-marks stock)) copier))
    (record-finished-copy copy copier)))

(defun copy-each-thing (old new count world copier)
  (declare #.*hot* (type simple-vector old new) (type cell-index count))
  (let ((copied (attachment-copier copier)) (others '()))
    (dotimes (rank count)
      (let ((thing (svref old rank)))
        (when thing
          (setf (svref new rank) (copy-thing thing world copied))
          (unless (and (uncontained-empty-thing-p thing) (not (robot-body-p thing)))
            (push thing others)))))
    (setf (copier-objects copier) (cons old new))
    (dolist (thing others) (complete-thing-copy thing old new copier))))

(defun copy-things (world copy copier)
  (let* ((stock (world-stock world)) (things (stock-things stock))
         (new (make-array (length things) :initial-element nil)))
    (copy-each-thing things new (stock-count stock) copy copier)
    (loop for group in (world-kicker-groups world)
          do (put-other-members group (forked group copier) copier))
    (setf (world-stock copy) (copy-stock stock new copier))))

(defun octets-of-copy (world)
  "Return roughly how many octets a copy of WORLD takes."
  (let ((map (world-map world)))
    (+ (* 5 (map-width map) (map-height map))
       (* 300 (world-rank-count world)))))

;; A thing of another run is not copied.
(defmethod copy-plan-value ((world world) fork)
  (if (not (eq world (copier-option fork :world)))
      world
      (let ((copy (copy-slots world fork)))
        ;; Their members are put into the rows later.
        (dolist (group (world-kicker-groups world))
          (setf (group-row (copy-slots group fork))
                (record-finished-copy (copy-seq (group-row group)) fork)))
        (copy-things world copy fork)
        copy)))
