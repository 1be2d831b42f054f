;;;; keys.lisp -- from the octets of a terminal to keys.

(in-package :ars-magna.cli)

;;; A key is one of these: the text that it types, a string; a keyword such as :UP or :CONTROL-A, or
;;; :META-F for one after Escape; a list (:PASTE text); or (:ENTRY text) for a line that was chosen
;;; elsewhere, as from a menu, which no terminal sends. NEXT, in what follows, is a function that
;;; returns the terminal's next octet, as a character, or NIL at the end. Called with an octet, it
;;; puts that back.

(defparameter *keys-of-codes*
  '(("A" :up) ("B" :down) ("C" :right) ("D" :left) ("H" :home) ("F" :end)
    ("1~" :home) ("7~" :home) ("4~" :end) ("8~" :end) ("3~" :delete)
    ("1;5C" :meta-f) ("1;5D" :meta-b) ("1;3C" :meta-f) ("1;3D" :meta-b)
    ("200~" :paste) ("202~" :entry))
  "Lists (code key): what terminals send after Escape and [, or Escape and O.")

(defun read-code (next)
  "Return the code that NEXT returns: everything up to the first letter or ~."
  (with-output-to-string (out)
    (loop for char = (funcall next)
          while char
          do (write-char char out)
          until (or (alpha-char-p char) (char= char #\~)))))

(defun read-text (lead next)
  "Return the character in UTF-8 that begins with the octet LEAD, as a string."
  (decoded (with-output-to-string (out)
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

(defun with-newlines (text)
  "Return TEXT, as pasted, with newlines between its lines, but none at its end."
  (string-right-trim
   '(#\Newline)
   (with-output-to-string (out)
     (loop for last = nil then char
           for char across text
           unless (and (char= char #\Newline) (eql last #\Return))
             do (write-char (if (char= char #\Return) #\Newline char) out)))))

(defun read-paste (next)
  "Return the text from NEXT up to the code that ends pasted text."
  (loop with end = (paste-ended)
        with octets = (make-array 100 :element-type 'character :adjustable t :fill-pointer 0)
        for char = (funcall next)
        while char
        do (vector-push-extend char octets)
           (when (and (char= char #\~) (uiop:string-suffix-p octets end))
             (decf (fill-pointer octets) (length end))
             (return (with-newlines (decoded octets))))
        finally (return (with-newlines (decoded octets)))))

(defun key-called (control &rest arguments)
  (make-keyword (string-upcase (apply #'format nil control arguments))))

(defun read-key-after-escape (next)
  (let ((char (funcall next)))
    (case char
      ((nil) nil)
      ((#\[ #\O) (let ((key (second (assoc (read-code next) *keys-of-codes* :test #'string=))))
                   (if (member key '(:paste :entry))
                       (list key (read-paste next))
                       (or key :unknown))))
      (#\Rubout :meta-rubout)
      (t (if (graphic-char-p char) (key-called "meta-~A" char) :unknown)))))

(defun read-key (next)
  "Return the next key, or NIL at the end."
  (let ((char (funcall next)))
    (cond ((null char) nil)
          ((find char '(#\Return #\Newline)) :return)
          ((char= char #\Tab) :tab)
          ((find char '(#\Rubout #\Backspace)) :rubout)
          ((char= char +escape+) (read-key-after-escape next))
          ((< (char-code char) 32) (key-called "control-~C" (code-char (+ 64 (char-code char)))))
          (t (read-text char next)))))

;;; The reverse, for keys that are pressed elsewhere than at a terminal.

(defun escaped-key (key)
  "Return what a terminal hands over for KEY, a keyword, if that begins with escape; else NIL."
  (let ((code (find key *keys-of-codes* :key #'second)) (name (string-downcase key)))
    (cond (code (escape "~A" (first code)))
          ((eq key :meta-rubout) (format nil "~C~C" +escape+ #\Rubout))
          ((starts-with-subseq "meta-" name) (format nil "~C~A" +escape+ (subseq name 5))))))

(defun octets-of-key (key)
  "Return what a terminal sends for KEY, one character for each octet; \"\" if it has no such key."
  (cond ((stringp key) (encoded key))
        ((consp key) (format nil "~A~A~A" (escaped-key (first key)) (encoded (second key))
                             (paste-ended)))
        ((eq key :return) (string #\Return))
        ((eq key :tab) (string #\Tab))
        ((eq key :rubout) (string #\Rubout))
        ((escaped-key key))
        ((starts-with-subseq "CONTROL-" (string key))
         (string (code-char (logand 31 (char-code (char (string key) 8))))))
        (t "")))

;;;; Octets handed over before their time

;;; Of many lines pasted at once, most wait here while the first ones run. Adding to them, and
;;; looking for Control-C among them, must not take longer with their number.

(defparameter *control-c* (code-char 3))

(defstruct (octet-queue (:copier nil) (:constructor make-octet-queue ()))
  "OCTETS, a list of characters, whose last cons is LAST. INTERRUPTS is the number of Control-C
among them."
  (octets '() :type list)
  (last '() :type list)
  (interrupts 0 :type (integer 0)))

(defun empty-queue-p (queue)
  (null (octet-queue-octets queue)))

(defun whole-line-p (queue)
  (find-if (lambda (octet) (find octet '(#\Return #\Newline))) (octet-queue-octets queue)))

(defun take-octet (queue)
  (let ((octet (pop (octet-queue-octets queue))))
    (when (char= octet *control-c*) (decf (octet-queue-interrupts queue)))
    octet))

(defun add-octets (queue octets)
  "Append OCTETS, a fresh list, to those of QUEUE."
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

(defun take-all-octets (queue)
  (setf (octet-queue-interrupts queue) 0)
  (shiftf (octet-queue-octets queue) '()))

(defun forget-until-interrupt (queue)
  "Take all up to the last control C out of QUEUE. True if there is one."
  (when (plusp (octet-queue-interrupts queue))
    (loop until (zerop (octet-queue-interrupts queue)) do (take-octet queue))
    t))
