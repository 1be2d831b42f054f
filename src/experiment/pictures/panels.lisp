;;;; panels.lisp -- which conditions stand in which picture, and which of them as one series.

(in-package :ars-magna.experiment)

;;; The first factor whose values are numbers runs along a picture; the others tell series apart,
;;; and where that makes too many of them, pictures. Factors go by their places in SAMPLE-TEXTS.

(defconstant +most-series+ 6 "How many series there are in a picture at most.")

(defstruct (panel (:constructor make-panel (where title series)) (:copier nil))
  "A picture's worth of conditions. WHERE says what these have in common, or is NIL; SERIES are
lists (name sample...), with NIL as the name of a single one. TITLE is what their names are values
of, if that is one factor."
  (where nil :type (or null string) :read-only t)
  (title nil :type (or null string) :read-only t)
  (series '() :type list :read-only t))

;;; Factors.

(defun factor-across (results)
  "Return the factor that runs along pictures of RESULTS, or NIL if nothing varies."
  (let ((free (free-factors results)))
    (or (find-if (lambda (place) (every #'number-in (levels results place))) free)
        (first free))))

(defun factors-beside (results)
  "Return the factors that tell series apart."
  (remove (factor-across results) (free-factors results)))

;;; Series and panels.

(defun common-name (sample places factors)
  "Return what SAMPLE is called by the factors at PLACES, or NIL if there are none."
  (and places
       (level-names (loop for place in places collect (nth place factors))
                    (loop for place in places collect (text-at place sample)))))

(defun series-title (places factors)
  "Return the name of the one factor at PLACES of FACTORS, or NIL if that is not one."
  (and places (null (rest places)) (nth (first places) factors)))

(defun series-name (sample places factors)
  "Return what the series of SAMPLE is called: below a title its bare value."
  (let ((text (and (series-title places factors) (text-at (first places) sample))))
    (if (and text (string/= "" text))
        text
        (common-name sample places factors))))

(defun series-of (samples places factors)
  (loop for group in (grouped samples (lambda (sample) (series-name sample places factors)))
        collect (cons (series-name (first group) places factors) group)))

(defun in-chunks (list most)
  "Return LIST as lists of about equal length, at most MOST."
  (let* ((count (length list)) (size (ceiling count (max 1 (ceiling count most)))))
    (loop while list
          collect (loop repeat size while list collect (pop list)))))

(defun chunk-panels (series where title)
  (loop with chunks = (in-chunks series +most-series+)
        for chunk in chunks
        for number from 1
        collect (make-panel (format nil "~@[~A, ~]~D of ~D" where number (length chunks))
                            title chunk)))

(defun joined (where more) (format nil "~@[~A ~]~A" where more))

(defun panels (samples places factors &optional where)
  "Return panels for SAMPLES, whose series the factors at PLACES of FACTORS tell apart: as few as
hold all series."
  (let ((series (series-of samples places factors)) (title (series-title places factors)))
    (cond ((<= (length series) +most-series+) (list (make-panel where title series)))
          ((null (rest places)) (chunk-panels series where title))
          (t (let ((last (last places)))
               (loop for group in (grouped samples
                                           (lambda (sample) (common-name sample last factors)))
                     append (panels group (butlast places) factors
                                    (joined where (common-name (first group) last factors)))))))))
