;;;; map-lines.lisp -- MAP: the world as characters.

(in-package :ars-magna.cli)

;;; On a terminal a map is made to fit, and has colours; elsewhere it is as long as the world.

(defun terminal-size (session)
  "Return how many columns the terminal of SESSION has, as far as can be found out, and how many
lines; NIL if there is none."
  (flet ((size-said (variable)
           (ignore-errors (parse-integer (environment-value variable)))))
    (multiple-value-bind (columns lines)
        (if (session-terminal-p session) (size-of-window session) (values 80 nil))
      (values (or (size-said "COLUMNS") columns)
              (and lines (or (size-said "LINES") lines))))))

;;; What of it.

(defun words-of-map ()
  "Return the words that MAP understands: its own, and what PICTURE calls the same."
  (mapcar #'symbol-name (append (text-layers) '(:legend) (mapcar #'layer-named (text-layers)))))

(defun word-meant (text words line takes)
  "Return the keyword of the one of WORDS that begins with TEXT, which was typed after LINE. Signals
BAD-LINE if there is none; TAKES is a control string that says what LINE takes besides WORDS."
  (let ((word (find-if (lambda (word) (starts-with-subseq (string-upcase text) word)) words)))
    (unless word
      (reject-line "~A does not know ~A.~@[ Did you mean ~A?~] It takes ~?." line text
                   (nearest-name text words) takes (list words)))
    (make-keyword word)))

(defun map-word (text)
  "Return the keyword of one of WORDS-OF-MAP, the one that begins with TEXT, as TEXT-MAP calls it."
  (text-layer-named (word-meant text (words-of-map) "MAP"
                                "a radius, or LEFT TOP RIGHT BOTTOM, and ~{~A~#[~; or ~:;, ~]~}")))

(defun number-typed (text)
  (let ((datum (ignore-errors (values (read-data-from-string text 0)))))
    (and (realp datum) (whole-if-whole datum))))

(defun map-part (numbers)
  "Return what NUMBERS, as typed, say of the part that is to be shown, as options of TEXT-MAP."
  (case (length numbers)
    (0 '())
    (1 (unless (whole-p (first numbers))
         (reject-line "The radius cannot be ~A. Give a whole number of cells, from 0 to 1e9."
                      (first numbers)))
     (list :radius (first numbers)))
    (4 (destructuring-bind (left top right bottom) numbers
         (unless (and (< left right) (< top bottom) (every #'finite-p numbers))
           (reject-line "~{~A~^ ~} is no region. Give LEFT TOP RIGHT BOTTOM in metres, such as ~
                         MAP 0 0 40 20."
                        numbers)))
     (list :region numbers))
    (t (reject-line "MAP takes one number, a radius, or four, LEFT TOP RIGHT BOTTOM; not ~
                     ~{~A~^ ~}."
                    numbers))))

(defun map-options (text)
  (loop for word in (split-words (or text ""))
        for number = (number-typed word)
        if number collect number into numbers
        else collect (map-word word) into words
        finally (return (append (map-part numbers)
                                (list :layers (remove :legend words)
                                      :only-legend (and (member :legend words) t))))))

(defun map-text (session options &optional (lines-below 1))
  "Return the map that OPTIONS of TEXT-MAP ask for, as it fits into the terminal of SESSION above
LINES-BELOW lines."
  (let ((robot (session-robot))
        (console (session-console session)))
    (multiple-value-bind (columns lines) (terminal-size session)
      (with-output-to-string (*standard-output*)
        (still (write-string (apply #'text-map robot
                                    :columns (max 20 (1- columns))
                                    :rows (and lines (max 5 (- lines lines-below)))
                                    :paint (and (console-colored-p console) #'paint)
                                    options)))))))

(define-choices :map-words (mapcar #'string-downcase (words-of-map)))

(define-line "MAP" (session (what :map-words
                                  "a radius or LEFT TOP RIGHT BOTTOM; names of layers; LEGEND"
                                  :optional))
    (:seeing
     (format nil "Shown if named: ~:{~A (~(~A~))~:^, ~}."
             (loop for name in (text-layers)
                   collect (list name (layer-title (layer-named name))))))
    "Show the world as characters: all of it, what is within a radius of the robot, or a region.
CONES shows what the robot's cameras have in view, WAY where it went, PLAN which way it is about to
go, BELIEF where it believes itself and what its designators denote to be, LEGEND only what the
characters mean. What PICTURE calls WEDGES, TRAIL, PLANNED-WAY and DESIGNATORS, those words mean
here, too."
  (write-string (map-text session (map-options what))))
