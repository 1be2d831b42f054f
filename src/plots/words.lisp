;;;; words.lisp -- text that is broken into lines, never cut.

(in-package :ars-magna.plots)

(defun name-text (name)
  "Return NAME, a string, symbol, character or number, as text; NIL is none."
  (check-argument chart name (typep name '(or string symbol character real))
                  "a string, symbol, character or number")
  (typecase name
    (null "")
    (symbol (string-downcase name))
    (real (figure-text name))
    (t (string name))))

(defun split (text separator-p)
  "Return the pieces of TEXT between characters for which SEPARATOR-P is true, but empty ones."
  (loop with start = 0
        for end = (position-if separator-p text :start start)
        unless (eql start (or end (length text)))
          collect (subseq text start end)
        while end
        do (setf start (1+ end))))

(defun fitting (word width size bold-p)
  "Return how many of the first characters of WORD fit in WIDTH pixels; at least one does."
  (loop for count from 1 to (length word)
        while (<= (text-width (subseq word 0 count) size bold-p) width)
        finally (return (max 1 (1- count)))))

(defun place-to-break (word count)
  "Return where WORD, the first COUNT characters of which fit in a line, is broken: behind the last
dash, slash or the like among these, but not one it begins with; or where the line is full."
  (let ((place (position-if (lambda (char) (find char "-/_,;:)"))
                            word :end count :from-end t)))
    (if (and place (plusp place)) (1+ place) count)))

(defun broken (word width size bold-p)
  (loop for fitting = (fitting word width size bold-p)
        while (< fitting (length word))
        for count = (place-to-break word fitting)
        collect (subseq word 0 count) into pieces
        do (setf word (subseq word count))
        finally (return (append pieces (list word)))))

(defun wrapped-words (words width size bold-p)
  "Return lines of WORDS, each as long as fits in WIDTH pixels."
  (let ((lines '()) (line nil))
    (dolist (word words)
      (dolist (piece (broken word width size bold-p))
        (let ((longer (if line (concatenate 'string line " " piece) piece)))
          (cond ((or (null line) (<= (text-width longer size bold-p) width))
                 (setf line longer))
                (t (push line lines)
                   (setf line piece))))))
    (nreverse (if line (cons line lines) lines))))

(defun space-p (character) (not (and (graphic-char-p character) (char/= #\Space character))))

(defun wrapped (text width &key (size +text-size+) bold-p)
  "Return TEXT, a string or NIL, as a list of lines that fit in WIDTH pixels, broken where it is
broken, else between words; within a word longer than a line behind a dash, else anywhere."
  (check-argument chart text (typep text '(or null string)) "a string, or NIL for none")
  (and text
       (loop for paragraph in (split text (lambda (character) (char= #\Newline character)))
             append (wrapped-words (split paragraph #'space-p) width size bold-p))))

(defun lines-width (lines &optional (size +text-size+) bold-p)
  "Return how wide LINES are at most, in pixels."
  (reduce #'max lines :key (lambda (line) (text-width line size bold-p)) :initial-value 0))

(defun lines-height (lines) (* +text-step+ (length lines)))

(defun write-lines (canvas x y lines &key (anchor :start) (color +ink+) (size +text-size+) bold-p
                                       (step +text-step+))
  "Write LINES below each other, the first with its base line at Y. Return where the next would be."
  (with-ink (color)
    (dolist (line lines y)
      (draw-words canvas draw-gcontext* x y line :anchor anchor :size size :bold-p bold-p)
      (incf y step))))

(defun write-lines-upward (canvas x y lines)
  "Write LINES upward, beside each other around X, with their ends at Y."
  (with-ink (+ink+)
    (loop for line in lines
          for shift from (- (/ (1- (length lines)) 2))
          do (draw-words canvas draw-gcontext* (+ x 4 (* shift +text-step+)) y line
                        :anchor :end :size +text-size+ :upward-p t))))
