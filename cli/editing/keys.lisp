;;;; keys.lisp -- from the octets of a terminal to keys.

(in-package :ars-magna.cli)

;;; A key is one of these: the text it types, a string; a keyword like :UP or :CONTROL-A, or :META-F
;;; for one after Escape; a list (:PASTE text); or (:ENTRY text) for a line chosen elsewhere, as in
;;; a menu, which no terminal sends. NEXT, below, is a function that returns the terminal's next
;;; octet, a character, or NIL at the end. Called with an octet, NEXT puts that back.

(defparameter *key-codes*
  '(("A" :up) ("B" :down) ("C" :right) ("D" :left) ("H" :home) ("F" :end)
    ("1~" :home) ("7~" :home) ("4~" :end) ("8~" :end) ("3~" :delete)
    ("1;5C" :meta-f) ("1;5D" :meta-b) ("1;3C" :meta-f) ("1;3D" :meta-b)
    ("200~" :paste) ("202~" :entry))
  "Lists (code key): a terminal sends the code after Escape [ or Escape O when the key is pressed.")

(defun read-escape-code (next)
  "Read a code from NEXT, up to the first letter or tilde, and return it."
  (with-output-to-string (out)
    (loop for char = (funcall next)
          while char
          do (write-char char out)
          until (or (alpha-char-p char) (char= char #\~)))))

(defun read-utf-8-character (lead next)
  "Return the UTF-8 character of the octet LEAD and of octets read from NEXT, as a string."
  (utf-8-decoded (with-output-to-string (out)
             (write-char lead out)
             (loop repeat (let ((code (char-code lead)))
                            (cond ((< code #xC0) 0)
                                  ((< code #xE0) 1)
                                  ((< code #xF0) 2)
                                  ((< code #xF8) 3)
                                  (t 0)))
                   for char = (funcall next)
                   while char
                   ;; An octet that does not continue the character is read next.
                   do (unless (<= #x80 (char-code char) #xBF)
                        (funcall next char)
                        (return))
                      (write-char char out)))))

(defun normalize-newlines (text)
  "Return the pasted TEXT with newlines for all line ends, but without newlines at its end."
  (string-right-trim
   '(#\Newline)
   (with-output-to-string (out)
     (loop for last = nil then char
           for char across text
           unless (and (char= char #\Newline) (eql last #\Return))
             do (write-char (if (char= char #\Return) #\Newline char) out)))))

(defun read-paste (next)
  "Read pasted text from NEXT, up to the code that ends such text, and return the text."
  (loop with end = (paste-end-code)
        with octets = (make-array 100 :element-type 'character :adjustable t :fill-pointer 0)
        for char = (funcall next)
        while char
        do (vector-push-extend char octets)
           (when (and (char= char #\~) (uiop:string-suffix-p octets end))
             (decf (fill-pointer octets) (length end))
             (return (normalize-newlines (utf-8-decoded octets))))
        finally (return (normalize-newlines (utf-8-decoded octets)))))

(defun format-as-keyword (control &rest arguments)
  (make-keyword (string-upcase (apply #'format nil control arguments))))

(defun read-key-after-escape (next)
  (let ((char (funcall next)))
    (case char
      ((nil) nil)
      ((#\[ #\O) (let ((key (second (assoc (read-escape-code next) *key-codes* :test #'string=))))
                   (if (member key '(:paste :entry))
                       (list key (read-paste next))
                       (or key :unknown))))
      (#\Rubout :meta-rubout)
      (t (if (graphic-char-p char) (format-as-keyword "meta-~A" char) :unknown)))))

(defun read-key (next)
  "Read the next key from NEXT and return it; NIL at the end of the input."
  (let ((char (funcall next)))
    (cond ((null char) nil)
          ((find char '(#\Return #\Newline)) :return)
          ((char= char #\Tab) :tab)
          ((find char '(#\Rubout #\Backspace)) :rubout)
          ((char= char +escape+) (read-key-after-escape next))
          ((< (char-code char) 32)
           (format-as-keyword "control-~C" (code-char (+ 64 (char-code char)))))
          (t (read-utf-8-character char next)))))

;;; The reverse, for keys that are pressed elsewhere than at a terminal.

(defun escape-sequence-of-key (key)
  "Return the escape sequence that a terminal sends for KEY, a keyword; NIL if there is none."
  (let ((code (find key *key-codes* :key #'second)) (name (string-downcase key)))
    (cond (code (format-escape-code "~A" (first code)))
          ((eq key :meta-rubout) (format nil "~C~C" +escape+ #\Rubout))
          ((starts-with-subseq "meta-" name) (format nil "~C~A" +escape+ (subseq name 5))))))

(defun octets-of-key (key)
  "Return the octets that a terminal sends for KEY, as a string: one character for each octet. The
string is empty if no terminal has KEY."
  (cond ((stringp key) (utf-8-encoded key))
        ((consp key) (format nil "~A~A~A" (escape-sequence-of-key (first key))
                             (utf-8-encoded (second key)) (paste-end-code)))
        ((eq key :return) (string #\Return))
        ((eq key :tab) (string #\Tab))
        ((eq key :rubout) (string #\Rubout))
        ((escape-sequence-of-key key))
        ((starts-with-subseq "CONTROL-" (string key))
         (string (code-char (logand 31 (char-code (char (string key) 8))))))
        (t "")))

;;;; Octets handed over before their time

;;; Of many lines pasted at once, most wait here while the first ones run. Adding to them, and
;;; looking for Control-C among them, must not take longer with their number.

(defparameter *control-c* (code-char 3))

(defstruct (octet-queue (:copier nil) (:constructor make-octet-queue ()))
  "OCTETS is a list of characters, LAST its last cons, INTERRUPTS the count of Control-C in it."
  (octets '() :type list)
  (last '() :type list)
  (interrupts 0 :type (integer 0)))

(defun empty-queue-p (queue)
  (null (octet-queue-octets queue)))

(defun queue-has-line-p (queue)
  (find-if (lambda (octet) (find octet '(#\Return #\Newline))) (octet-queue-octets queue)))

(defun pop-octet (queue)
  (let ((octet (pop (octet-queue-octets queue))))
    (when (char= octet *control-c*) (decf (octet-queue-interrupts queue)))
    octet))

(defun add-octets (queue octets)
  "Append OCTETS, a fresh list, to QUEUE."
  (when octets
    (if (empty-queue-p queue)
        (setf (octet-queue-octets queue) octets)
        (setf (rest (octet-queue-last queue)) octets))
    (setf (octet-queue-last queue) (last octets))
    (incf (octet-queue-interrupts queue) (count *control-c* octets))))

(defun put-back-octet (queue octet)
  (if (empty-queue-p queue)
      (add-octets queue (list octet))
      (progn (push octet (octet-queue-octets queue))
             (when (char= octet *control-c*) (incf (octet-queue-interrupts queue))))))

(defun remove-all-octets (queue)
  (setf (octet-queue-interrupts queue) 0)
  (shiftf (octet-queue-octets queue) '()))

(defun drop-until-interrupt (queue)
  "Remove all octets up to the last Control-C from QUEUE. Return true if there was a Control-C."
  (when (plusp (octet-queue-interrupts queue))
    (loop until (zerop (octet-queue-interrupts queue)) do (pop-octet queue))
    t))
