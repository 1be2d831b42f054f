;;;; transcript.lisp -- what was said in the window: lines typed, answers, messages.

(in-package :ars-magna.clim)

;;; Any thread may say something; lines are kept newest first, the last few hundred of them.

(define-constant +transcript-length+ 500 :documentation "How many lines of a transcript are kept.")

(defstruct (transcript (:constructor make-transcript (news)) (:copier nil))
  "Lines of text, newest first. NEWS is called, with no arguments, when there is more."
  (news nil :type function :read-only t)
  (lock (make-lock "transcript") :read-only t)
  (lines (list "") :type list)
  (count 1 :type fixnum)
  ;; How many lines there have ever been, to know whether there are new ones.
  (total 0 :type fixnum))

(defun add-text (transcript text)
  "Add TEXT, which may consist of several lines, to TRANSCRIPT."
  (loop for start = 0 then (1+ end)
        for end = (position #\Newline text :start start)
        do (setf (first (transcript-lines transcript))
                 (concatenate 'string (first (transcript-lines transcript))
                              (subseq text start end)))
        while end
        do (push "" (transcript-lines transcript))
           (incf (transcript-count transcript))))

(defun forget-lines (transcript)
  (when (> (transcript-count transcript) (* 2 +transcript-length+))
    (setf (transcript-lines transcript)
          (subseq (transcript-lines transcript) 0 +transcript-length+)
          (transcript-count transcript) +transcript-length+)))

(defun say (transcript text)
  "Add TEXT to TRANSCRIPT."
  (with-lock ((transcript-lock transcript))
    (add-text transcript text)
    (incf (transcript-total transcript))
    (forget-lines transcript))
  (funcall (transcript-news transcript)))

(defun latest-lines (transcript count &optional (skip 0))
  "Return a list of the last COUNT lines of TRANSCRIPT, oldest first, but for the last SKIP."
  (with-lock ((transcript-lock transcript))
    (let ((lines (nthcdr skip (transcript-lines transcript))))
      (reverse (subseq lines 0 (min count (length lines)))))))

;;; As a stream.

(defclass transcript-stream (fundamental-character-output-stream)
  ((transcript :initarg :transcript :reader stream-transcript))
  (:documentation "An output stream that adds what is written to a transcript."))

(defmethod stream-write-string ((stream transcript-stream) string &optional (start 0) end)
  (say (stream-transcript stream) (subseq string start end))
  string)

(defmethod stream-write-char ((stream transcript-stream) char)
  (say (stream-transcript stream) (string char))
  char)

(defmethod stream-line-column ((stream transcript-stream))
  (length (first (latest-lines (stream-transcript stream) 1))))

;;; Its pane: the bottom of the text is in view, unless the user has scrolled up.

(defclass transcript-pane (display-pane) ())

(defun pane-transcript (pane) (window-transcript (window-of pane)))

(defmethod pane-content ((pane transcript-pane))
  (list (pane-offset pane) (transcript-total (pane-transcript pane))))

(defmethod paint ((pane transcript-pane))
  (let ((canvas (make-instance 'clim-canvas :medium pane)))
    (clear pane)
    (multiple-value-bind (width height) (pane-size pane)
      (let ((rows (floor (- height 4) +line-height+))
            (columns (max 1 (floor width +character-width+))))
        (clim:with-drawing-options (pane :clipping-region (clim:sheet-region pane))
          (with-canvas (canvas)
            (loop for line in (latest-lines (pane-transcript pane) rows (pane-offset pane))
                  for y from 14 by +line-height+
                  do (draw-glyphs canvas draw-gcontext* 4 y
                                  (subseq line 0 (min columns (length line)))))))))))

(defun transcript-rows (pane)
  "Return how many lines fit into PANE."
  (floor (- (nth-value 1 (pane-size pane)) 4) +line-height+))

(defmethod scroll-state ((pane transcript-pane))
  (let ((count (transcript-count (pane-transcript pane))) (rows (transcript-rows pane)))
    (values (max 0 (- count rows (pane-offset pane))) rows count)))

(defmethod limit-offset ((pane transcript-pane)) nil)

(defmethod scroll-to ((pane transcript-pane) position)
  (multiple-value-bind (old rows count) (scroll-state pane)
    (declare (ignore old))
    (setf (pane-offset pane) (clamp (round (- count rows position)) 0 (max 0 (- count rows))))
    (repaint-if-changed pane)))

(defmethod click ((pane transcript-pane) button x y)
  (declare (ignore button x y)))

(defmethod wheel ((pane transcript-pane) steps x y)
  (declare (ignore x y))
  (scroll pane (* 3 steps)))
