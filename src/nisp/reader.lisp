;;;; reader.lisp -- what !, ?, #t and #f read as, and loading files (manual 3.1, 5.5.1, A).

(in-package :ars-magna.nisp)

;;; ! and ? start special syntax only at a token's start: add! and interval-subset? stay symbols. A
;;; user's own symbols are interned where the standard reader would; Nisp's operators are symbols of
;;; this package and slot accessors of ARS-MAGNA.SLOTS, so what is read works in any package.

(defun delimiter-p (char)
  (or (blank-character-p char)
      (multiple-value-bind (function non-terminating) (get-macro-character char)
        (and function (not non-terminating)))))

(defun read-escape (char stream token)
  "CHAR is a backslash or bar just read from STREAM. Add the characters that it escapes to TOKEN."
  (if (char= char #\\)
      (vector-push-extend (read-char stream t nil t) token)
      (loop for next = (read-char stream t nil t)
            do (vector-push-extend next token)
            until (char= next #\|))))

(defun read-token (stream)
  "Return the rest of the token in STREAM, a string, including escape characters."
  (loop with token = (make-array 16 :element-type 'character :fill-pointer 0 :adjustable t)
        for char = (peek-char nil stream nil nil t)
        until (or (null char) (delimiter-p char))
        do (vector-push-extend (read-char stream t nil t) token)
           (when (find char "\\|") (read-escape char stream token))
        finally (return (coerce token 'simple-string))))

(defun reject-syntax (text expected)
  (reject-clause "Nisp's reader" text expected))

(defun token-object (token)
  "Return TOKEN read by the standard reader. Signals MALFORMED-DEFINITION if TOKEN is incomplete."
  (let ((*readtable* (find-readtable :standard)))
    (handler-case (values (read-from-string token))
      ;; The text around TOKEN is complete, so that is no END-OF-FILE there.
      (end-of-file () (reject-syntax token "a name or number after ! or ?")))))

(defun token-name (token)
  (string-upcase (remove #\| token)))

;;; ! and its forms.

(defun path-form (token)
  "Return the form for !>TOKEN, a path of slots: the first part is a variable, and each further part
is a slot of the value before it."
  (let ((parts (uiop:split-string token :separator ".")))
    (when (or (null parts) (member "" parts :test #'string=))
      (reject-syntax (concatenate 'string "!>" token)
                     "a variable and slots, as in !>robot.cameras"))
    (reduce (lambda (object slot)
              (list (ensure-slot-accessor (token-name slot)) object))
            (rest parts)
            :initial-value (token-object (first parts)))))

(defun read-typed-accessor (stream)
  "Read (TYPE slot) from STREAM; return the name of the reader function of that slot (reading 33)."
  (let ((form (read stream t nil t)))
    (unless *read-suppress*
      (unless (typep form '(cons symbol (cons symbol null)))
        (reject-syntax form "(TYPE slot) after !, as in !(PT x)"))
      (slot-reader-for-type (first form) (second form)))))

(defun next-char-is (char stream)
  (eql char (peek-char nil stream nil nil t)))

(defun read-bang (stream char)
  "Read the form that follows a ! from STREAM; the ! itself is already read (reading 32)."
  (declare (ignore char))
  (let* ((token (read-token stream))
         (head (and (plusp (length token)) (char token 0)))
         (tail (and head (subseq token 1))))
    (cond ((and (member token '("" "_") :test #'string=) (next-char-is #\( stream))
           (read-typed-accessor stream))
          (*read-suppress* nil)
          ((string= token "=") '!=)
          ((and (eql head #\_) (string/= tail "")) (ensure-slot-accessor (token-name tail)))
          ((eql head #\>) (path-form tail))
          (t (token-object (concatenate 'string "!" token))))))

;;; ? and what follows it.

(defun read-anonymous-matchvar (stream)
  (let ((form (read stream t nil t)))
    (when (and form (not *read-suppress*))
      (reject-syntax form "nothing between the parentheses of ?()"))
    (make-matchvar nil)))

(defun read-query (stream char)
  "Read the name of a matchvar, or (), that follows a ? from STREAM; the ? itself is already read."
  (declare (ignore char))
  (let ((token (read-token stream)))
    (cond ((and (string= token "") (next-char-is #\( stream))
           (read-anonymous-matchvar stream))
          (*read-suppress* nil)
          ((string= token "") (token-object "?"))
          (t (let ((name (token-object token)))
               (unless (symbolp name)
                 (reject-syntax name "a symbol after ?"))
               (make-matchvar name))))))

;;; The named readtable :NISP; (in-readtable :nisp) puts it to use.

(defun ensure-nisp-readtable ()
  "Return the readtable :NISP: standard syntax plus #t, #f, ! and ? (reading 31)."
  (let ((readtable (or (find-readtable :nisp)
                       (make-readtable :nisp :merge '(:standard)))))
    (set-macro-character #\! 'read-bang t readtable)
    (set-macro-character #\? 'read-query t readtable)
    (set-dispatch-macro-character #\# #\t (constantly t) readtable)
    (set-dispatch-macro-character #\# #\f (constantly nil) readtable)
    ;; Some editors begin a file with a byte order mark.
    (set-syntax-from-char (code-char #xFEFF) #\Space readtable)
    readtable))

(dolist (character '(#\t #\f))
  (note-dispatch-character character
                           "Before #t and #f, evaluate (named-readtables:in-readtable :nisp)."))

(addition (in-readtable :nisp))
(ensure-nisp-readtable)

;;;; Loading

(public dsklap)
(defun dsklap (path)
  "Load the Lisp file at PATH, or the ASDF system named by the last component of PATH, as in (dsklap
\"ars-dir/ars-magna\"). Return true. It is an error if neither exists (manual A; reading 41)."
  (check-argument dsklap path (typep path '(or string pathname symbol)) "a path or a system's name")
  (let* ((path (if (pathnamep path) (namestring path) (string path)))
         (file (probe-file (merge-pathnames path (make-pathname :type "lisp"))))
         (slash (position #\/ path :from-end t))
         (system (string-downcase (subseq path (if slash (1+ slash) 0)))))
    (cond ((and file (pathname-name file)) (load file))
          ((asdf:find-system system nil) (asdf:load-system system) t)
          (t (reject-name "Lisp file or system" path '())))))

;; ARS: is the installation directory in logical pathnames (manual A).
(let ((system (asdf:find-system "ars-magna" nil)))
  (when system
    (setf (logical-pathname-translations "ARS")
          `(("**;*.*.*" ,(merge-pathnames "**/*.*" (asdf:system-source-directory system)))))))

;;; ASDF keeps compiled files for all Lisps of the user. Files are read in the current syntax and
;;; package unless they say otherwise. So a library loaded after (in-readtable :nisp) would be
;;; compiled in Nisp's syntax, and kept like that.

(defvar *library-readtable* (copy-readtable nil)
  "A modifiable readtable, in which systems are loaded while Nisp's readtable is current.")

(defmethod asdf:perform :around ((operation asdf:operation) (component asdf:cl-source-file))
  (if (eq (get-macro-character #\! (find-readtable :nisp)) (get-macro-character #\!))
      (let ((*readtable* *library-readtable*)
            (*package* (find-package :cl-user)))
        (call-next-method))
      (call-next-method)))
