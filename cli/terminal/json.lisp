;;;; json.lisp -- output for other programs: JSON objects, one on each line.

(in-package :ars-magna.cli)

;;; The prompt never reads JSON and writes simple objects only, so forty lines replace a library. A
;;; property list becomes an object, with underscores for hyphens in keys; a vector becomes an
;;; array; T, :FALSE and NIL become true, false and null; other symbols become lower-case strings.

(defun write-json-elements (elements open close stream writer)
  (write-char open stream)
  (loop for (element . more) on elements
        do (funcall writer element)
           (when more (write-char #\, stream)))
  (write-char close stream))

(defun write-json (value stream)
  (flet ((write-pair (pair)
           (destructuring-bind (key value) pair
             (write-json-string (substitute #\_ #\- (string-downcase key)) stream)
             (write-char #\: stream)
             (write-json value stream))))
    (typecase value
      (null (write-string "null" stream))
      ((eql t) (write-string "true" stream))
      ((eql :false) (write-string "false" stream))
      (integer (prin1 value stream))
      (real (let ((*read-default-float-format* 'double-float)) (prin1 (double value) stream)))
      (string (write-json-string value stream))
      (symbol (write-json-string (string-downcase value) stream))
      (vector (write-json-elements (coerce value 'list) #\[ #\] stream
                                   (lambda (element) (write-json element stream))))
      (cons (write-json-elements (loop for (key value) on value by #'cddr
                                       collect (list key value))
                                 #\{ #\} stream #'write-pair))
      (t (write-json-string (princ-to-string value) stream)))))

;;; Text that is written meanwhile becomes objects too, one for each line.

(defclass object-stream (fundamental-character-output-stream)
  ((stream :initarg :stream :reader object-stream-target)
   (words :initform (make-string-output-stream) :reader object-stream-words)
   (column :initform 0 :accessor object-stream-column))
  (:documentation "A stream that writes JSON objects to STREAM. WORDS is a stream that collects the
text of the current line, COLUMN the length of that text."))

(defun write-object (object stream)
  (end-text-line stream)
  (printing-plainly () (write-json object (object-stream-target stream)))
  (terpri (object-stream-target stream))
  (finish-output (object-stream-target stream)))

(defun end-text-line (stream &optional (always nil))
  "Write the collected text of STREAM as a JSON object; an empty text only if ALWAYS is true."
  (when (or always (plusp (object-stream-column stream)))
    (setf (object-stream-column stream) 0)
    (write-object (list :type "output"
                        :text (get-output-stream-string (object-stream-words stream)))
                  stream)))

(defmethod stream-write-char ((stream object-stream) char)
  (cond ((char= char #\Newline) (end-text-line stream t))
        (t (write-char char (object-stream-words stream))
           (incf (object-stream-column stream))))
  char)

(defmethod stream-line-column ((stream object-stream))
  (object-stream-column stream))

(defmethod stream-force-output ((stream object-stream))
  (force-output (object-stream-target stream)))

(defmethod stream-finish-output ((stream object-stream))
  (finish-output (object-stream-target stream)))
