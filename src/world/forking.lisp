;;;; forking.lisp -- the things of a world, copied for a fork of its run.

(in-package :ars-magna.world)

;;; A world may have a hundred thousand things, each with kickers. So its things are copied first of
;;; all, one after the other; what a thing was copied to is then known by its rank, and what an
;;; attachment was copied to by its thing. What has been destroyed or taken off has no rank: it is
;;; copied like anything else, if somebody still has it.

(declaim (inline twin-by-rank))
(defun twin-by-rank (thing old new)
  "Return what THING was copied to, if it is one of the vector OLD, that were copied to NEW."
  (declare (type thing thing) (type simple-vector old new))
  (let ((rank (thing-rank thing)))
    (and (< rank (length old))
         (eq thing (svref old rank))
         (svref new rank))))

(defmethod copy-plan-value ((thing thing) fork)
  (let ((world (thing-world thing)))
    (cond ((and world (not (eq world (copier-option fork :world)))) thing)
          ((destructuring-bind (&optional (old #()) &rest new) (copier-objects fork)
             (and new (twin-by-rank thing old new))))
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

(defun begin-group (group copier)
  "Return the copy of GROUP, with members yet to be seated."
  (let ((copy (copy-slots group copier)))
    (setf (group-row copy) (settled (copy-seq (group-row group)) copier))
    copy))

(defun copy-attachment (attachment twin copier)
  "Return a copy of ATTACHMENT for TWIN, a copy of its thing, seated in the copy of its group."
  (let ((copy (copy-structure attachment))
        (group (attachment-group attachment)))
    (setf (attachment-kicker copy) (forked (attachment-kicker attachment) copier)
          (attachment-thing copy) twin)
    (when group
      (setf (attachment-group copy) (forked group copier))
      (seat-member (attachment-group copy) (attachment-index copy) copy))
    copy))

(defun seat-others (group copy copier)
  "Seat in COPY those members of GROUP that are on no thing any more, until they are taken out."
  (when (group-dead group)
    (let ((row (group-row copy)))
      (loop for place from 0 below (* 3 (group-count group)) by 3
            do (when (eq (svref row place) (svref (group-row group) place))
                 (loop for index from place repeat 3
                       do (setf (svref row index) (forked (svref row index) copier))))))))

;;; Things.

(defun complete-thing (thing twin copy old new copier)
  "Let what TWIN, the copy of THING for the world COPY, refers to be copies too."
  (declare #.*hot* (type thing thing twin))
  (flet ((twin (inside) (or (twin-by-rank inside old new) (forked inside copier))))
    (setf (thing-world twin) copy)
    (unless (symbolp (thing-location thing))
      (setf (thing-location twin) (forked (thing-location thing) copier)))
    (when (thing-contents thing)
      (setf (thing-contents twin) (mapcar #'twin (thing-contents thing))))
    (when (thing-kickers thing)
      (setf (thing-kickers twin)
            (mapcar (lambda (attachment) (copy-attachment attachment twin copier))
                    (thing-kickers thing))))))

(defun copy-stock (stock things copier)
  "Return a copy of STOCK that has THINGS, copies of its own."
  (let ((copy (make-stock)))
    (setf (stock-things copy) (settled things copier)
          (stock-count copy) (stock-count stock)
          (stock-firsts copy) (settled (copy-seq (stock-firsts stock)) copier)
          (stock-nexts copy) (settled (copy-seq (stock-nexts stock)) copier)
          (stock-marks copy) (settled (copy-seq (stock-marks stock)) copier))
    (settled copy copier)))

(defun copy-things (world copy copier)
  "Let COPY, a copy of WORLD, have copies of its things and kickers."
  (declare #.*hot*)
  (let* ((stock (world-stock world)) (count (stock-count stock))
         (old (stock-things stock))
         (new (make-array (length old) :initial-element nil)))
    (declare (type simple-vector old new))
    (dotimes (rank count)
      (when (svref old rank)
        (setf (svref new rank) (copy-structure (the thing (svref old rank))))))
    (setf (copier-objects copier) (cons old new))
    (dotimes (rank count)
      (when (svref old rank)
        (complete-thing (svref old rank) (svref new rank) copy old new copier)))
    (loop for group in (world-kicker-groups world)
          do (seat-others group (forked group copier) copier))
    (setf (world-stock copy) (copy-stock stock new copier))))

;; One of another run stays what it is.
(defmethod copy-plan-value ((world world) fork)
  (if (not (eq world (copier-option fork :world)))
      world
      (let ((copy (copy-slots world fork)))
        (dolist (group (world-kicker-groups world)) (begin-group group fork))
        (copy-things world copy fork)
        copy)))
