;;;; choices.lisp -- what can be typed for an argument, by its type.

(in-package :ars-magna.cli)

(defgeneric choices (type session typed)
  (:documentation "Return what can be typed in SESSION for an argument of TYPE, a keyword, of which
TYPED is typed already: a list of strings, symbols and numbers, among them others. NIL if that
cannot be told. May signal BAD-LINE, as when there is no robot.")
  (:method (type session typed)
    (declare (ignore session typed))
    (when (part-type-p type)
      (loop for index below (length (parts-of-kind (session-robot) type))
            collect index))))

(defun designator-numbers ()
  (mapcar #'designator-number (live-designators (session-robot))))

(defmethod choices ((type (eql :designator)) session typed)
  (declare (ignore session typed))
  (designator-numbers))

(defmethod choices ((type (eql :destination)) session typed)
  (declare (ignore session typed))
  (designator-numbers))

(defmethod choices ((type (eql :designator-type)) session typed)
  (declare (ignore session typed))
  '(local non-local))

(defmethod choices ((type (eql :odometer-part)) session typed)
  (declare (ignore session typed))
  '(:pos :ang))

(defmethod choices ((type (eql :place-type)) session typed)
  (declare (ignore session typed))
  (mapcar #'place-type-name (all-place-types)))

(defmethod choices ((type (eql :rate)) session typed)
  (declare (ignore session typed))
  '(free))

(defmethod choices ((type (eql :parameter)) session typed)
  (declare (ignore session typed))
  (mapcar #'parameter-name (all-parameters)))

(defmethod choices ((type (eql :switch)) session typed)
  (declare (ignore session typed))
  '(on off))

(defmethod choices ((type (eql :off)) session typed)
  (declare (ignore session typed))
  '(off))

(defmethod choices ((type (eql :experiment)) session typed)
  (declare (ignore session typed))
  (append (mapcar #'experiment-name (all-experiments)) '(off)))

;;; Worlds and robots.

(defmethod choices ((type (eql :world)) session typed)
  (append (mapcar #'map-name (all-worlds))
          (remove-if-not (lambda (file) (or (ends-like-p file "/") (ends-like-p file ".lisp")))
                         (choices :file session typed))))

(defmethod choices ((type (eql :robot-name)) session typed)
  (declare (ignore session typed))
  (robot-names))

(defmethod choices ((type (eql :robot-here)) session typed)
  (declare (ignore session typed))
  (robots-here))

;;; Files.

(defun entries-of (directory)
  "Return the names of what is in DIRECTORY, as the system names it; directories end with a slash."
  (let ((path (path-called directory)))
    (flet ((without-directory (entry)
             (let ((name (native-name entry)))
               (subseq name (1+ (or (position #\/ name :from-end t :end (1- (length name)))
                                    -1))))))
      (mapcar #'without-directory
              (ignore-errors (append (uiop:subdirectories path) (uiop:directory-files path)))))))

(defun hidden-p (name)
  (char= #\. (char name 0)))

(defmethod choices ((type (eql :file)) session typed)
  (declare (ignore session))
  (let* ((slash (position #\/ typed :from-end t))
         (directory (subseq typed 0 (if slash (1+ slash) 0)))
         (start (subseq typed (length directory))))
    (loop for name in (entries-of (if slash directory "./"))
          when (and (starts-with-subseq start name)
                    (or (string/= "" start) (not (hidden-p name))))
            collect (uiop:strcat directory name))))

;;; Names of commands.

(defmethod choices ((type (eql :command)) session typed)
  (declare (ignore session))
  (let ((names (if (lines-starting (string-upcase typed) (all-lines) #'line-name)
                   (mapcar #'line-name (all-lines))
                   (all-line-names))))
    (mapcar #'string-downcase (append names (mapcar #'first *aliases*)))))
