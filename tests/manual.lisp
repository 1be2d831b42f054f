;;;; manual.lisp -- the package, the world and the helpers of suites that follow the manual.

(in-package :ars-user)

;;; These suites are written as users write, in a user's package. They use only the exports of ARS
;;; and NISP.

(define-user-package :ars-test-manual
  (:documentation "Where a user checks the manual's claims, one after another.")
  (:import-from :ars-magna.tests
                #:ars-magna #:def-suite* #:in-suite #:test #:is #:is-true #:is-false #:signals
                #:project-file #:near #:put #:call-times #:call-once #:end-code
                #:frequent-p #:chi-square #:normal-probability #:uniform #:same-distribution-p
                #:expands-badly-p))

(in-package :ars-test-manual)

;;; A field 40 by 30 metres, with a wall in the east that leaves a doorway in the row of the cell
;;; (10,10).
(defmap yard (40 30)
  (rect (0 0) (39 29) bricks 10)
  (wall (30 1) (30 9) slate 30)
  (wall (30 11) (30 28) slate 30))

(defrobot scout (yard (10 10) 0)
  :cameras (((/ pi 2) 5) ((/ pi 4) 3))
  :hands (10 4)
  :bins (20 5))

(defmacro with-scout ((&rest options) &body body)
  "Run BODY in a headless simulation with OPTIONS and a fresh SCOUT, at (10,10) heading east."
  `(with-simulation (scout ,@options) ,@body))

(defparameter *spots* '((10 10) (10.5 10.5) (10.37 10.81) (10.02 10.96))
  "Points of one cell to stand on: whole, half and odd ones.")

(defmacro at-each-spot ((&rest options) &body body)
  "Run BODY, as in WITH-SCOUT, with SCOUT at each of *SPOTS* in turn."
  `(dolist (spot *spots*)
     (with-scout (,@options)
       (place-robot scout (first spot) (second spot) 0)
       ,@body)))

(defparameter *sure* '((miss-thing-prob* 0) (miss-place-prob* 0) (false-thing-prob* 0))
  "Parameters by which searches find what is there, though they read it with noise.")

;;; What is where.

(defun eye (&optional (index 0)) (robot-camera scout index))
(defun hand-of-scout (&optional (index 0)) (robot-hand scout index))
(defun bin-of-scout (&optional (index 0)) (robot-storage-bin scout index))

(defun beside (dx dy)
  "Return the point DX and DY metres from SCOUT, as a list."
  (list (+ (robot-x scout) dx) (+ (robot-y scout) dy)))

(defun put-beside (name dx dy &rest attributes)
  "Return a new thing NAME with ATTRIBUTES, keys and values, DX and DY metres from SCOUT."
  (apply #'put name (beside dx dy) attributes))

(defun turned-to (angle)
  "Let SCOUT head for ANGLE where it is, at once."
  (place-robot scout (robot-x scout) (robot-y scout) angle))

;;; What is answered. PUT, CALL-TIMES, CALL-ONCE and END-CODE are those of the suite looking.

(defun answer (command &rest arguments)
  "Return the results of COMMAND with ARGUMENTS, claiming that there was no error: a list, without
code and resource."
  (destructuring-bind (code resource &rest results) (apply #'call-once command arguments)
    (declare (ignore resource))
    (is (null code) "~S ended with ~S" command code)
    results))

(defun said ()
  "Return what has been reported since last asked, a list of lines."
  (with-input-from-string (in (with-output-to-string (out) (error-display out)))
    (loop for line = (read-line in nil) while line collect line)))

(defmacro recording ((record) &body body)
  "Run BODY where RECORD is a function of a name: it returns a continuation, and (RECORD) the list
of what such continuations were called with since last asked: (name code resource result...)."
  (let ((calls (gensym "CALLS")))
    `(let ((,calls '()))
       (flet ((,record (&optional (name nil asked-p))
                (if asked-p
                    (lambda (&rest call) (push (cons name call) ,calls))
                    (reverse (shiftf ,calls '())))))
         ,@body))))

;;; What is seen.

(defun look (specification &key (type :non-local) (camera (eye)))
  "Return what the one result of a search by SPECIFICATION is, a designator or NIL."
  (third (call-once 'camera-get-object-designator camera type specification)))

(defun look-for-all (specification &key (type :non-local) (camera (eye)))
  "Return the designators that a search for all finds, a list."
  (third (call-once 'camera-get-all-object-designators camera type specification)))

(defun look-for-place (type &optional (camera (eye)))
  (third (call-once 'camera-get-place-designator camera type)))

(defun names-of (designators)
  "Return what the things that DESIGNATORS denote are called, sorted."
  (sort (loop for designator in designators
              collect (thing-name (designator-denotation designator)))
        #'string<))

(defun seen (&rest options)
  "Return the names of the things that a search for anything finds."
  (names-of (apply #'look-for-all '() options)))

(defun look-often (trials function &key (type :non-local) (camera (eye)) (specification '()))
  "Call FUNCTION with what each of TRIALS searches finds, a designator or NIL, and collect the
values. A search takes one tick then; afterwards nobody remembers the designators."
  (let ((camera-desig-delay* 0) (values '()))
    (loop repeat trials
          do (camera-get-object-designator camera type specification
               (continuation (err camera designator)
                 (push (funcall function designator) values)))
             (run-ticks 1))
    values))

(defun find-count (trials specification &rest options)
  "Return how many of TRIALS searches by SPECIFICATION find something."
  (count-if #'identity (apply #'look-often trials #'identity
                              :specification specification options)))

(defun reading-of (key designator)
  "Return what DESIGNATOR says of the attribute KEY, and whether it says anything."
  (let ((entry (assoc key (designator-data designator))))
    (values (second entry) (and entry t))))

;;; What is tracked.

(defmacro tracking ((record designator &key (camera '(eye)) (ticks 5)) &body body)
  "Run BODY where CAMERA has been told to track DESIGNATOR, TICKS ago; RECORD is as in RECORDING,
and has recorded under the name :TRACK."
  `(recording (,record)
     (camera-track ,camera ,designator (,record :track))
     (run-ticks ,ticks)
     ,@body))

(defun codes (calls)
  "Return the codes in CALLS, of a record."
  (mapcar #'second calls))
