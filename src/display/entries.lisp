;;;; entries.lisp -- what legends are made of: a sample each, and what looks so.

(in-package :ars-magna.display)

;;; An entry is a text with a function of a canvas and a place, X and Y in pixels, that draws the
;;; sample around there, no more than 16 pixels high and as wide as the entry says.

(define-constant +sample-width+ 18 :documentation "How wide most samples are, in pixels.")

(defstruct (entry (:constructor make-entry (text sample &key whole (width +sample-width+)))
                  (:copier nil))
  "TEXT stands in the legend beside a sample WIDTH pixels wide; WHOLE is what it is short for, or
NIL."
  (width +sample-width+ :type real :read-only t)
  (text "" :type string :read-only t)
  (sample (constantly nil) :type function :read-only t)
  (whole nil :type (or null string) :read-only t))

(defmacro sample-of ((canvas x y) text &body body)
  "Return an entry with TEXT, the sample of which BODY draws."
  `(make-entry ,text (lambda (,canvas ,x ,y) (declare (ignorable ,canvas ,x ,y)) ,@body)))

(defun named-entry (name sample &optional (more "") (width +sample-width+))
  "Return an entry for NAME, a string, abridged if it is long, and for MORE, with SAMPLE, WIDTH
pixels wide."
  (let ((text (short-name name)))
    (make-entry (concatenate 'string text more) sample
                :whole (and (string/= text name) name) :width width)))

(defmacro sample-of-name ((canvas x y) (name &rest more-and-width) &body body)
  "Return an entry for NAME, the sample of which BODY draws. MORE-AND-WIDTH: a text to stand behind
the name, and how wide the sample is, in pixels."
  `(named-entry ,name (lambda (,canvas ,x ,y) (declare (ignorable ,canvas ,x ,y)) ,@body)
                ,@more-and-width))

(defun grouped (objects key)
  "Return OBJECTS, a list, as lists of those for which KEY returns what is equal, in their order."
  (let ((groups '()))
    (dolist (object objects (mapcar #'reverse (mapcar #'rest (reverse groups))))
      (let* ((value (funcall key object)) (group (assoc value groups :test #'cl:equal)))
        (if group
            (push object (rest group))
            (push (list value object) groups))))))

(define-constant +longest-names+ 32
  :documentation "How many characters several names beside one sample have, about.")

(defun joined (texts)
  "Return TEXTS as one, or as many as there is room for, and how many there are more."
  (loop with joined = (first texts)
        for rest on (rest texts)
        for longer = (format nil "~A, ~A" joined (first rest))
        while (<= (length longer) +longest-names+)
        do (setf joined longer)
        finally (return (format nil "~A~@[ and ~D more~]" joined (and rest (length rest))))))

(defun names-entry (names sample)
  "Return an entry for NAMES, lists (name more) of two strings each, with SAMPLE, which looks as all
that they are the names of."
  (flet ((texts (function)
           (loop for (name more) in names
                 collect (concatenate 'string (funcall function name) more))))
    (let ((text (joined (texts #'short-name))) (whole (format nil "~{~A~^, ~}" (texts #'identity))))
      (make-entry text sample :whole (and (string/= text whole) whole)))))
