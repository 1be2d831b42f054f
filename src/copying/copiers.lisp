;;;; copiers.lisp -- what copies the objects of a run: what it was told, and what it has copied.

(in-package :ars-magna.copying)

(export '(copier with-copier copier-variable copier-option note-copy settled))

(define-record (copier (:constructor make-copier ()))
  "What copies a run."
  (table (make-hash-table :test 'eq :size 500) hash-table "what was copied, and to what" :writable)
  (work (make-array 512) simple-vector
        "the copies that are to be put right, each followed by how" :writable)
  (fill 0 fixnum :writable)
  (tables '() list "the hash tables that are to be filled when all else is done" :writable)
  (holder nil t "what is being put right" :writable)
  (environment '() list
               "a list (variable . value): what the run that is copied has bound" :writable :export)
  (objects nil t "what a layer has put there to find copies by. Can be set" :writable :export)
  (screen nil (or null function) "a function of what is about to be copied, or NIL: it returns what
there is to be instead of a copy, and true; or NIL and false" :writable)
  (options '() list "a plist for those who know what to do about it" :writable))

(defun copier-option (copier key)
  "Return what the one who asked for COPIER said of KEY, or NIL."
  (getf (copier-options copier) key))

(defun copier-variable (copier symbol)
  "Return the value that the run that COPIER copies has bound SYMBOL to."
  (cdr (assoc symbol (copier-environment copier) :test #'eq)))

;;; Noting.

(declaim (inline note-copy))
(defun note-copy (value copy copier)
  "Let COPY be what COPIER has for VALUE. Return COPY."
  (setf (gethash value (copier-table copier)) copy))

(declaim (inline settled))
(defun settled (copy copier)
  "Return COPY, an object that is made for the fork of COPIER, and all right."
  (note-copy copy copy copier))

(defun put-right-later (copy how copier)
  "Let COPIER put right what is in COPY, HOW: see PUT-RIGHT. Return COPY."
  (let ((fill (copier-fill copier)))
    (declare (type (unsigned-byte 40) fill))
    (when (= fill (length (copier-work copier)))
      (setf (copier-work copier) (replace (make-array (* 4 fill)) (copier-work copier))))
    (setf (svref (copier-work copier) fill) copy
          (svref (copier-work copier) (1+ fill)) how
          (copier-fill copier) (+ fill 2))
    copy))

;;; A copier is much larger than what it makes of a small run; so those that have done their work
;;; are used again.

(defvar *idle-copiers* (list '())
  "A list whose element is the list of the copiers that nobody uses.")

(defconstant +largest-idle+ 20000 "How many objects a copier may have copied to be used again.")

(defun take-copier ()
  (loop for copiers = (car *idle-copiers*)
        while copiers
        when (swap-if (car *idle-copiers*) copiers (rest copiers))
          return (first copiers)
        finally (return (make-copier))))

(defun put-copier-back (copier)
  "Let COPIER, which has finished its work, forget that, and be used again."
  (when (<= (hash-table-count (copier-table copier)) +largest-idle+)
    (clrhash (copier-table copier))
    (fill (copier-work copier) 0)
    (setf (copier-holder copier) nil
          (copier-environment copier) '()
          (copier-objects copier) nil
          (copier-screen copier) nil
          (copier-options copier) '())
    (atomic-push copier (car *idle-copiers*))))

(defmacro with-copier ((copier &key environment options screen) &body body)
  "Run BODY with COPIER bound to what copies a run that has bound the variables of ENVIRONMENT, with
OPTIONS and SCREEN. Return the values of BODY."
  `(let ((,copier (take-copier)))
     (setf (copier-environment ,copier) ,environment
           (copier-options ,copier) ,options
           (copier-screen ,copier) ,screen)
     (multiple-value-prog1 (progn ,@body)
       (put-copier-back ,copier))))
