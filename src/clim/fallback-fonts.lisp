;;;; fallback-fonts.lisp -- characters that McCLIM's font lacks, drawn in other installed fonts.

(in-package :ars-magna.clim)

;;; McCLIM draws all fixed-width text in one font, DejaVu Sans Mono, and draws a box for each
;;; character that this font lacks. It can draw other fonts with TrueType outlines, but not the
;;; outlines of OpenType fonts such as Noto Sans CJK, and no bitmaps. Fontconfig's program fc-list
;;; knows which installed fonts have a character.

(defun standard-font-file ()
  (cdr (assoc '(:fix :roman) mcclim-truetype:*families/faces* :test #'equal)))

(defun advance-in-font (file character)
  "Return the advance width of CHARACTER in the font FILE, in ems; NIL if FILE lacks CHARACTER or
McCLIM cannot draw FILE."
  (ignore-errors
   (zpb-ttf:with-font-loader (loader (native-name file))
     (and (zpb-ttf:glyph-exists-p character loader)
          (/ (zpb-ttf:advance-width (zpb-ttf:find-glyph character loader))
             (zpb-ttf:units/em loader))))))

(defun upright-p (path)
  (notany (lambda (word) (search word path :test #'char-equal)) '("bold" "italic" "oblique")))

(defun installed-font-files (character)
  "Return the native paths of installed fonts that have CHARACTER, upright fonts first."
  (let ((paths (ignore-errors
                (uiop:run-program (list "fc-list" (format nil ":charset=~(~X~)"
                                                          (char-code character))
                                        "file")
                                  :output :lines :error-output nil))))
    (stable-sort (loop for line in paths collect (string-right-trim ": " line))
                 (lambda (one other) (and (upright-p one) (not (upright-p other)))))))

(defvar *fonts-of-characters* (make-hash-table :synchronized t)
  "Table from characters to lists (file advance) of the font to draw them in, or NIL if there is
none. FILE is NIL for McCLIM's own font; ADVANCE is in ems.")

(defun known-fallback-files ()
  "Return the files of the fonts that other characters are drawn in."
  (remove-duplicates (loop for font being the hash-values of *fonts-of-characters*
                           when (first font) collect (first font))
                     :test #'equal))

(defconstant +greatest-drawable-code+ #xFFFF)

(define-constant +box-in-place-of-character+ (string (code-char #x25A1)) :test #'equal)

(defun find-font-for (character)
  "Return a list (file advance) of a font to draw CHARACTER in, or NIL; see *FONTS-OF-CHARACTERS*."
  ;; McCLIM reads no glyphs of higher codes, but does not say so.
  (when (< +greatest-drawable-code+ (char-code character))
    (return-from find-font-for nil))
  (flet ((font-in (files)
           (loop for file in files
                 for advance = (advance-in-font file character)
                 when advance return (list file advance))))
    (or (and (advance-in-font (standard-font-file) character) (list nil 0))
        (font-in (known-fallback-files))
        (font-in (installed-font-files character)))))

(defun font-for (character)
  (multiple-value-bind (font known-p) (gethash character *fonts-of-characters*)
    (if known-p
        font
        (setf (gethash character *fonts-of-characters*) (find-font-for character)))))

(defconstant +first-doubtful-code+ #x180
  "The code from which on characters may be missing in McCLIM's font.")

(defun plain-text-p (string)
  "True if McCLIM's font certainly has all characters of STRING."
  (every (lambda (character) (< (char-code character) +first-doubtful-code+)) string))

;;; Text styles.

(defgeneric text-style-in-file (port file size)
  (:documentation "Return a CLIM text style for the font FILE with SIZE in pixels, or NIL.")
  (:method (port file size) (declare (ignore port file size)) nil)
  (:method ((port mcclim-truetype:ttf-port-mixin) file size)
    (let* ((size (climb:normalize-font-size size))
           (face (clime:font-face (clim-sys:with-lock-held (mcclim-truetype:*zpb-font-lock*)
                                    (uiop:symbol-call :mcclim-truetype :ensure-truetype-font
                                                      port file file size)))))
      (clim:make-text-style (clime:font-family-name (clime:font-face-family face))
                            (clime:font-face-name face) size))))

(defun fallback-text-style (port character size width)
  "Return a CLIM text style to draw CHARACTER on PORT with SIZE in pixels, or smaller so that it is
at most WIDTH pixels wide. Return NIL to draw it in McCLIM's own font."
  (destructuring-bind (&optional file advance) (font-for character)
    (and file
         (ignore-errors
          (text-style-in-file port file (if (> (* size advance) width) (/ width advance) size))))))

;;; What no font has.

(defparameter *font-packages*
  '((#x2E80 #xA4CF "fonts-droid-fallback") (#xAC00 #xD7FF "fonts-droid-fallback")
    (#xF900 #xFAFF "fonts-droid-fallback") (#xFF00 #xFFEF "fonts-droid-fallback")
    (#x2000 #x2BFF "fonts-symbola") (0 #xFFFF "fonts-noto-core"))
  "Lists (from to package): the Debian package with a TrueType font for the character codes from
FROM to TO. The first list that fits is valid; no package helps beyond U+FFFF.")

(defun font-package-for (character)
  (third (find-if (lambda (range) (<= (first range) (char-code character) (second range)))
                  *font-packages*)))

(defun fc-list-there-p ()
  (zerop (nth-value 2 (uiop:run-program "command -v fc-list" :ignore-error-status t))))

(defun missing-character-text (character)
  "Return a text that says that CHARACTER cannot be drawn, and which Debian packages to install."
  (unless (font-package-for character)
    (return-from missing-character-text
      (format nil "The character U+~4,'0X is shown as a box, because the window can draw only ~
                   characters up to U+FFFF." (char-code character))))
  (format nil "The character U+~4,'0X is shown as a box, because the window can draw no installed ~
               font that has it. Install the Debian package~:[s fontconfig and~;~] ~A, then start ~
               this program again."
          (char-code character) (fc-list-there-p) (font-package-for character)))

(defvar *packages-named* '() "The packages that a window has told the user to install.")
(defvar *packages-named-lock* (make-lock "packages named"))

(defun report-missing-character (window character)
  "Say in WINDOW which package has CHARACTER, once for each package."
  (let ((package (font-package-for character)))
    (when (with-lock (*packages-named-lock*)
            (unless (member package *packages-named* :test #'equal)
              (push package *packages-named*)))
      (write-in-window window "~A~%" (missing-character-text character)))))
