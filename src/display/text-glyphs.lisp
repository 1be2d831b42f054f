;;;; text-glyphs.lisp -- which character, in which colour, stands for what on a text map.

(in-package :ars-magna.display)

;;; Each kind of thing, that is, all that are called the same, has a letter of its own, which it
;;; keeps wherever and whenever one looks at its world, as long as no kinds come or go.

(defstruct (glyph (:constructor make-glyph (kind char text &optional ink)) (:copier nil))
  "A character, what kind of thing it stands for (:ROBOT for where one believes to be, too) and what
it is called, and in which colour it is shown: a name, or NIL for that of text."
  (kind :thing :type (member :wall :robot :layer :several :place :thing) :read-only t)
  (char #\Space :type character :read-only t)
  (text "" :type string :read-only t)
  (ink nil :type (or symbol string) :read-only t))

(define-constant +several+ #\* :documentation "What stands for things of several kinds.")
(define-constant +other+ #\& :documentation "What stands for things for which there is no letter.")

;;; Letters.

(define-constant +letters+ "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ" :test #'equal
  :documentation "What may stand for kinds of things.")

(defun letters-for (name)
  "Return strings of the characters that may stand for things called NAME, the best first."
  (list (string-downcase (char name 0))
        (string-upcase (char name 0))
        (concatenate 'string (string-downcase name) (string-upcase name))
        +letters+))

(defun kinds-of (world)
  "Return what the things of WORLD are called, strings: the largest first, then by name."
  (let ((sizes (make-hash-table :test #'equal)))
    (do-things (thing world)
      (let ((name (symbol-name (thing-name thing))))
        (setf (gethash name sizes) (max (thing-size thing) (gethash name sizes 0)))))
    (remhash "" sizes)
    (sort (loop for name being the hash-keys of sizes collect name)
          (lambda (a b)
            (let ((size-a (gethash a sizes)) (size-b (gethash b sizes)))
              (if (= size-a size-b) (name-before-p a b) (> size-a size-b)))))))

(defun letters-of (world)
  "Return a hash table from what the things of WORLD are called, strings, to their letters: those of
large things are their initials, as far as can be. There may be more kinds than letters."
  (let ((letters (make-hash-table :test #'equal)) (names (kinds-of world))
        (free (remove #\v (coerce +letters+ 'list))))   ; that is a robot
    (dotimes (rank 4 letters)
      (dolist (name names)
        (let ((letter (and (null (gethash name letters))
                           (find-if (lambda (char) (member char free))
                                    (nth rank (letters-for name))))))
          (when letter
            (setf (gethash name letters) letter
                  free (remove letter free))))))))

(defun thing-glyph (image letters)
  (let ((name (symbol-name (thing-name (thing-image-thing image))))
        (color (second (assoc :color (thing-image-attributes image)))))
    (make-glyph :thing (gethash name letters +other+) name
                (and (typep color '(or symbol string)) color))))

(defun things-glyphs (images letters)
  "Return the glyphs of the kinds of the things: in front the one for all, if they are several."
  (let ((glyphs (remove-duplicates (mapcar (lambda (image) (thing-glyph image letters)) images)
                                   :key #'glyph-text :test #'string= :from-end t)))
    (if (rest glyphs)
        (cons (make-glyph :several +several+ "several things" :bold) glyphs)
        glyphs)))

;;; Walls, by their substance.

(defun wall-glyphs (map indices colored-p)
  "Return a list of the glyph of the first wall of MAP in the cells INDICES, if any; if COLORED-P,
by its substance."
  (let ((index (find-if (lambda (index) (logtest +wall+ (aref (map-flags map) index))) indices)))
    (when index
      (let ((name (and colored-p
                       (svref (map-substance-types map) (aref (map-substances map) index)))))
        (list (make-glyph :wall #\# (if name (string-downcase name) "wall")
                          (and name (substance-ink name))))))))

;;; Places.

(define-constant +place-glyphs+ "=:.;,'~\"|-/\\_" :test #'equal
  :documentation "What place types look like, by their rank; the rest look like the last.")

(defun place-glyphs (map indices)
  "Return a list of the glyph of the first place of MAP in the cells INDICES, if any."
  (let ((index (find-if (lambda (index) (plusp (aref (map-places map) index))) indices)))
    (when index
      (let* ((type (svref (map-place-types map) (aref (map-places map) index)))
             (last (1- (length +place-glyphs+))))
        (list (make-glyph :place (char +place-glyphs+ (min (place-type-rank type) last))
                          (string-downcase (place-type-name type)) :grey))))))

;;; Robots.

(defun arrow-glyph (angle)
  "Return the arrow that points most nearly in the direction ANGLE, in radians."
  (char ">v<^" (mod (round (/ angle (/ pi 2))) 4)))

(defun names-text (images)
  "Return what the things are called, each name once."
  (format nil "~{~A~^, ~}"
          (remove-duplicates (mapcar (lambda (image) (thing-name (thing-image-thing image))) images)
                             :from-end t)))

(defun robot-glyph (robot things)
  "Return the glyph of ROBOT, which stands on THINGS: all are images."
  (make-glyph :robot (arrow-glyph (robot-image-angle robot))
              (format nil "~A (~,2F,~,2F)~:[ with ~A~;~]" (robot-image-name robot)
                      (hundredths (robot-image-x robot)) (hundredths (robot-image-y robot))
                      (null things) (names-text things))
              :reverse))
