;;;; bins.lisp -- opening and closing storage bins (manual 3.6).

(in-package :ars-magna.command)

;;; A closed bin keeps its contents from kicking themselves out, and parts from reaching in.

(define-command storage-bin-open (operation (storage-bin storage-bin))
    ()
    ((:family :handling) (:section "3.6") (:delay bin-delay*)
     (:errors (:bin-open (text-of "~A is already open"))))
    "Open STORAGE-BIN."
  (cond ((storage-bin-closed-p storage-bin)
         (setf (storage-bin-closed-p storage-bin) nil)
         (succeed-saying operation (format nil "~A opened" storage-bin)))
        (t (fail-with operation :bin-open))))

(defun bin-jams-p (bin)
  "True if something in BIN happens to be in the way of its door (reading 166)."
  (and (storage-bin-contents bin)
       (chance bin-close-jam-prob* (handling-dice bin))))

;; As reading 163 says.
(define-command storage-bin-close (operation (storage-bin storage-bin))
    ((jammed-part "the camera or hand that keeps the bin from closing, or NIL"))
    ((:family :handling) (:section "3.6") (:delay bin-delay*)
     (:expected :bin-closed :bin-jammed)
     (:errors (:bin-closed (text-of "~A is already closed"))
              (:robot-in-bin (lambda (operation)
                               (let ((bin (operation-resource operation)))
                                 (format nil "~A still in ~A" (part-inside bin) bin))))
              (:bin-jammed (text-of "~A is jammed"))))
    "Close STORAGE-BIN, so that nothing can kick itself out of it."
  (cond ((storage-bin-closed-p storage-bin) (fail-with operation :bin-closed))
        ((part-inside storage-bin)
         (fail-with operation :robot-in-bin (part-inside storage-bin)))
        ((bin-jams-p storage-bin) (fail-with operation :bin-jammed))
        (t (setf (storage-bin-closed-p storage-bin) t)
           (succeed-saying operation (format nil "~A closed" storage-bin)))))
