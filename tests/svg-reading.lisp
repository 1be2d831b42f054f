;;;; svg-reading.lisp -- pictures as data: the elements of an SVG document.

(in-package :ars-magna.tests)

;;; Elements like (:rect (:x . 16) (:fill . "#202020") ...), and texts.

(defun value-of (text)
  "Return TEXT, the value of an SVG attribute, as a number if it is one."
  (if (every (lambda (char) (find char "-.0123456789")) text)
      (let ((*read-default-float-format* 'double-float)) (read-from-string text))
      text))

(defun attributes-in (text)
  "Return the attributes name=\"value\" in TEXT as conses."
  (loop for start = 0 then (1+ close)
        for equals = (search "=\"" text :start2 start)
        while equals
        for close = (position #\" text :start (+ 2 equals))
        collect (cons (intern (string-upcase (string-trim " " (subseq text start equals))) :keyword)
                      (value-of (subseq text (+ 2 equals) close)))))

(defun elements (svg)
  "Return the elements of the picture SVG, in order; a text's own words are under :TEXT."
  (loop for start = (position #\< svg) then (position #\< svg :start end)
        while start
        for end = (position #\> svg :start start)
        for name-end = (position-if (lambda (char) (find char " />")) svg :start (1+ start))
        unless (char= #\/ (char svg (1+ start)))
          collect `(,(intern (string-upcase (subseq svg (1+ start) name-end)) :keyword)
                    ,@(attributes-in (subseq svg name-end end))
                    (:text . ,(subseq svg (1+ end) (position #\< svg :start end))))))

(defun of-element (element key) (rest (assoc key (rest element))))

(defun drawn-with (tag svg &rest attributes)
  "Return the elements of the picture SVG called TAG that have ATTRIBUTES, keys and values."
  (remove-if-not (lambda (element)
                   (and (eq tag (first element))
                        (loop for (key value) on attributes by #'cddr
                              always (equalp value (of-element element key)))))
                 (elements svg)))

(defun web (color)
  "Return COLOR as it is written in pictures."
  (format nil "#~(~6,'0X~)" color))
