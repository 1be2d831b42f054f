;;;; run-picture.lisp -- one run as a picture: where its robots went, and what happened where.

(in-package :ars-magna.trails)

;;; Moments are numbered where they happened; what the numbers mean stands below the map. Moments
;;; that happened at one spot share a number's circle.

(defconstant +spot+ 14 "How near to each other moments share a circle, in pixels.")

(defstruct (spot (:constructor make-spot (x y)) (:copier nil))
  "Where moments happened, in pixels, and their NUMBERS, the latest first."
  (x 0 :type real :read-only t)
  (y 0 :type real :read-only t)
  (numbers '() :type list))

(defun near-spot (x y spots)
  (find-if (lambda (spot) (and (< (abs (- x (spot-x spot))) +spot+)
                               (< (abs (- y (spot-y spot))) +spot+)))
           spots))

(defun spots-of (moments)
  "Return the spots of those of MOMENTS that have a place; they are numbered from 1."
  (let ((spots '()))
    (loop for moment in moments
          for number from 1
          do (when (moment-x moment)
               (let* ((x (* graphics-scale* (moment-x moment)))
                      (y (* graphics-scale* (moment-y moment)))
                      (spot (or (near-spot x y spots)
                                (first (push (make-spot x y) spots)))))
                 (push number (spot-numbers spot)))))
    (reverse spots)))

(defun numbers-text (numbers)
  "Return NUMBERS, whole ones in order, as text in which those that follow each other are a range."
  (with-output-to-string (out)
    (loop with rest = numbers
          for first = (pop rest)
          for last = (loop with last = first
                           while (eql (first rest) (1+ last)) do (setf last (pop rest))
                           finally (return last))
          do (format out "~D~:[-~D~;~*~]~:[~;,~]" first (= first last) last rest)
          while rest)))

(defun draw-spot (canvas spot)
  (let* ((text (numbers-text (reverse (spot-numbers spot))))
         (half (max 9 (+ 3 (/ (text-width text 11) 2))))
         (x (spot-x spot)) (y (spot-y spot)))
    (with-gcontext (draw-gcontext* :foreground white*)
      (draw-arc canvas draw-gcontext* (- x half) (- y 9) (* 2 half) 18 0 (* 2 pi) t))
    (with-gcontext (draw-gcontext* :foreground black* :line-width 1.2)
      (draw-arc canvas draw-gcontext* (- x half) (- y 9) (* 2 half) 18 0 (* 2 pi) nil)
      (draw-words canvas draw-gcontext* x (+ y 4) text :size 11 :anchor :middle))))

(define-constant +figure-space+ (code-char #x2007)
  :documentation "A space that is as wide as a digit.")

(defun moment-notes (moments)
  "Return what the numbers of MOMENTS mean, a text for each; the texts stand below each other."
  (loop with digits = (length (princ-to-string (length moments)))
        for moment in moments
        for number from 1
        collect (format nil "~V,,,VD   tick ~A: ~A" digits +figure-space+ number
                        (moment-tick moment) (moment-text moment))))

;;; Finding out.

(defun watch-run (journal until)
  "Repeat JOURNAL up to UNTIL. Return a snapshot of its end, the ways of its robots, and moments."
  (let ((trails '()))
    (multiple-value-bind (watch seen) (moments-watcher)
      (call-with-replay
       (lambda ()
         (values (take-snapshot (simulation-world (current-simulation)))
                 (ways-along (note-places (current-simulation) trails) 1 "success")
                 (funcall seen)))
       journal
       :until until
       :observer (lambda (simulation)
                   (setf trails (note-places simulation trails))
                   (funcall watch simulation))))))

(defun draw-run (canvas snapshot ways moments)
  (draw-ways-on-map canvas snapshot ways 0 0)
  (mapc (lambda (spot) (draw-spot canvas spot)) (spots-of moments)))

(defun run-chart (snapshot ways moments title)
  "Return a picture of a run that ended as SNAPSHOT shows, with WAYS and MOMENTS, under TITLE."
  (let* ((map (snapshot-map snapshot))
         (scale (scale-for (map-width map) (map-height map))))
    (drawing-chart (lambda (canvas)
                     (let ((graphics-scale* scale)) (draw-run canvas snapshot ways moments)))
                   (* scale (map-width map)) (* scale (map-height map))
                   :title title
                   :notes (moment-notes moments))))

(addition save-run-picture)
(defun save-run-picture (file &key journal until moments title)
  "Save in FILE, replacing it, a picture of the run that JOURNAL holds (a journal, or a file with
one; by default that of the current simulation) up to the tick UNTIL or its end: its map and things
as they are then, the ways that its robots went, and with numbers where they grasped, let go of or
stowed something, or a command failed. MOMENTS, a list of moments or of lists of a tick and a
string, are told of besides. TITLE stands above. FILE is SVG or, where the program rsvg-convert is
installed, PNG, as its name ends. Return its truename. Signals WRONG-ARGUMENT, what REPLAY does, and
MISUSE without that program, or where no journal is kept."
  (check-argument save-run-picture title (typep title '(or null string)) "a string or NIL")
  (picture-kind 'save-run-picture file)
  (let ((own (checked-moments 'save-run-picture moments)))
    (multiple-value-bind (snapshot ways seen) (watch-run (journal-meant journal) until)
      (save-chart file (run-chart snapshot ways (in-order (append seen own)) title)))))
