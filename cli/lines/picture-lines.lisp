;;;; picture-lines.lisp -- PICTURE, and FILM: the run so far, to be played in a browser.

(in-package :ars-magna.cli)

;;; A picture shows the layers that pictures show by default, and those whose names are typed.

(defun picture-words ()
  "Return the words that PICTURE understands: names of layers, and BARE for none of those shown by
default; and what MAP calls the same."
  (mapcar #'symbol-name (append (picture-layers) '(:bare) (text-layers))))

(defun picture-word (text line)
  "Return the layer that TEXT, one of PICTURE-WORDS or its beginning, means after LINE."
  (layer-named (word-meant text (picture-words) line "a file, a scale, and words: ~{~A~^, ~}")))

(defun picture-options (text &optional (line "PICTURE"))
  "Return as options of SAVE-PICTURE what TEXT, as typed after LINE and the name of the file, asks
for."
  (loop for word in (split-words (or text ""))
        for number = (number-typed word)
        if number collect number into numbers
        else collect (picture-word word line) into words
        finally (when (rest numbers)
                  (reject-line "~A takes one number, the scale; not ~{~A~^ ~}." line numbers))
                (return (list :scale (first numbers)
                              :layers (union (remove :bare words)
                                             (unless (member :bare words) *picture-layers*))))))

(defun layers-text (layers)
  "Return LAYERS by name, each with what it shows where that is not the same in other words."
  (format nil "~:{~A~@[ (~A)~]~:^, ~}"
          (loop for layer in layers
                for name = (substitute #\Space #\- (symbol-name layer))
                for title = (layer-title layer)
                collect (list (layer-words layer)
                              (and (not (string-equal title name)) (string-downcase title))))))

(define-line "PICTURE" (session (file :file "a name that ends in .svg or .png")
                                (what :rest "pixels to a cell, and names of layers; BARE"
                                      :optional))
    (:seeing
     "PICTURE world.svg suits most; PICTURE world.png 30 GRID TRAIL has 30 pixels to a cell and
shows two layers more; PICTURE world.svg BARE NAMES shows that one alone."
     "Pixels to a cell: from 1 to 256. By default what suits the map, from 4 to 40, for a map of
900 x 700 pixels at most; or graphics-scale*, if that was set."
     (format nil "Shown by default, but for BARE: ~A." (layers-text *picture-layers*))
     (format nil "Shown if named: ~A."
             (layers-text (remove-if (lambda (layer) (member layer *picture-layers*))
                                     (picture-layers)))))
    "Save a picture of the world as it is now in FILE, replacing it."
  (let ((path (apply #'save-picture (session-robot) (path-called file) (picture-options what))))
    (format t "~A~%" (native-name path))))

;;; FILM.

(define-line "FILM" (session (file :file "a name that ends in .html or .svg")
                             (what :rest "pixels to a cell, names of layers; BARE; ANYWAY"
                                   :optional))
    (:seeing)
    "Save the run so far in FILE, replacing it, as a film: a page for any browser, in which it can
be played, stopped and gone through, or an animated picture. What robots grasped, let go of and
stowed, which commands and plans failed, and errors in your code are marked. The words after FILE
are those of PICTURE, and ANYWAY: also if what is defined is not what the run began with."
  (check-run)
  (let* ((words (split-words (or what "")))
         (others (remove "ANYWAY" words :test #'string-equal))
         (options (picture-options (format nil "~{~A~^ ~}" others) "FILM")))
    (flet ((save (*frame-hook*)
             (apply #'save-animation nil (path-called file)
                    :anyway (/= (length words) (length others)) options)))
      (format t "~A~%" (native-name (call-telling-ticks
                                     #'save session (simulation-tick (current-simulation))))))))
