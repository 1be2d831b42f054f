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

(defmacro define-choices (type form)
  "Let the value of FORM be what can be typed for an argument of TYPE, whatever is typed already."
  `(defmethod choices ((type (eql ,type)) session typed)
     (declare (ignore session typed))
     ,form))

(defun designator-numbers ()
  (mapcar #'designator-number (live-designators (session-robot))))

(define-choices :designator (designator-numbers))
(define-choices :destination (designator-numbers))
(define-choices :designator-type '(local non-local))
(define-choices :odometer-part '(:pos :ang))
(define-choices :place-type (mapcar #'place-type-name (all-place-types)))
(define-choices :rate '(free))
(define-choices :parameter (mapcar #'parameter-name (all-parameters)))
(define-choices :switch '(on off))
(define-choices :off '(off))
(define-choices :experiment (append (mapcar #'experiment-name (all-experiments)) '(off)))

;;; Worlds and robots.

(defmethod choices ((type (eql :world)) session typed)
  (append (mapcar #'map-name (all-worlds))
          (remove-if-not (lambda (file)
                           (or (uiop:string-suffix-p file "/") (uiop:string-suffix-p file ".lisp")))
                         (choices :file session typed))))

(define-choices :robot-name (robot-names))
(define-choices :robot-here (robots-here))

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

(defmethod choices ((type (eql :file)) session typed)
  (declare (ignore session))
  (let* ((slash (position #\/ typed :from-end t))
         (directory (subseq typed 0 (if slash (1+ slash) 0)))
         (start (subseq typed (length directory))))
    (loop for name in (entries-of (if slash directory "./"))
          when (and (starts-with-subseq start name)
                    (or (string/= "" start) (char/= #\. (char name 0))))
            collect (uiop:strcat directory name))))

;;; Names of commands.

(defmethod choices ((type (eql :command)) session typed)
  (declare (ignore session))
  (let ((names (if (all-starting (string-upcase typed) (all-lines) #'line-name)
                   (mapcar #'line-name (all-lines))
                   (all-line-names))))
    (mapcar #'string-downcase (append names (mapcar #'first *aliases*)))))
