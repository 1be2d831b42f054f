;;;; looks.lisp -- the fonts and colours of the window.

(in-package :ars-magna.clim)

;;; Labels have a proportional font. What is typed, its output and columns have a font in which all
;;; characters are equally wide. McCLIM does not adjust letters to pixels. So the sizes are those at
;;; which it draws sharp letters: 11 pixels for labels, where DejaVu's small letters are 6 pixels
;;; high and its capitals 8; and 12 for text in columns, where each letter is 7 pixels wide.

(defconstant +label-size+ 11 "The height of the font of labels, in pixels.")
(defconstant +column-font-size+ 35/3
  "The height of the font of text in columns, in pixels. It is rounded after magnification.")

(defconstant +greatest-magnification+ 6
  "The largest magnification, in screen pixels per window pixel.")

(defvar *text-styles* (make-hash-table :test 'equal :synchronized t)
  "A cache of CLIM's text styles, by family, face and size.")

(defun text-style (family face size magnification)
  "Return CLIM's text style for letters SIZE window pixels high."
  (let ((key (list family face (round (* size magnification)))))
    (or (gethash key *text-styles*)
        (setf (gethash key *text-styles*) (apply #'clim:make-text-style key)))))

(defun label-width (text &optional bold-p)
  "Return the width of TEXT as a label, in pixels. This is at least the drawn width."
  (ceiling (text-width text +label-size+ bold-p)))

(defun cut-label (text width)
  "Return TEXT, cut to end in three dots if it is wider than WIDTH pixels as a label."
  (if (<= (label-width text) width)
      text
      (loop for count downfrom (min (length text) (max 4 (floor width 3)))
            for cut = (cut text (max 4 count))
            when (or (<= count 4) (<= (label-width cut) width)) return cut)))

(defun draw-label (canvas x y text &key (anchor :start) bold-p)
  (draw-words canvas draw-gcontext* x y text :size +label-size+ :anchor anchor :bold-p bold-p))

;;; Colours. White is for what is shown, greys with a tint of blue for what is around it, and blue
;;; for what is on or under the mouse, so that the colours of maps and things stand out.

(defvar *ink-cache* (make-hash-table :synchronized t) "A cache of CLIM's colour objects by colour.")

(defun clim-ink (color)
  (or (gethash color *ink-cache*)
      (setf (gethash color *ink-cache*)
            (flet ((part (position) (/ (ldb (byte 8 position) color) 255)))
              (clim:make-rgb-color (part 16) (part 8) (part 0))))))

(defconstant +menu-bar-color+ #xD3D9E0)
(defconstant +title-color+ #xDDE2E8)
(defconstant +bar-color+ #xE8EBEF)
(defconstant +outside-color+ #xEEF0F3 "The colour around the map.")
(defconstant +splitter-color+ #xC3CAD3)
(defconstant +popup-color+ #xFBFCFD)
(defconstant +button-color+ #xFBFCFD)
(defconstant +border-color+ #x76808C)
(defconstant +secondary-text-color+ #x4A5560 "The colour of the second column of a panel.")
(defconstant +lit-color+ #xB9D6F2 "The colour of a button that is on, and of an open menu.")
(defconstant +pointed-color+ #xD8E8F8 "The colour of the row under the mouse.")
(defconstant +thumb-color+ #x8E98A4)
