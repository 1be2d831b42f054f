;;;; html.lisp -- characters that HTML and JavaScript take for their own, and anchors.

(in-package :ars-magna.manual)

(export '(escaped anchor))

(defun escaped (text)
  "Return TEXT as it is written in HTML, between tags or in an attribute's double quotes."
  (with-output-to-string (out) (write-xml-text text out)))

(defun entity-at (html position)
  "Return the element of *ENTITIES* that HTML has at POSITION, or NIL."
  (find-if (lambda (entity)
             (let ((end (+ position (length (cdr entity)))))
               (and (<= end (length html))
                    (string= (cdr entity) html :start2 position :end2 end))))
           *entities*))

(defun unescaped (html)
  "Return the text that HTML, without tags, stands for."
  (with-output-to-string (out)
    (loop with i = 0
          while (< i (length html))
          do (let ((entity (entity-at html i)))
               (write-char (if entity (car entity) (char html i)) out)
               (incf i (if entity (length (cdr entity)) 1))))))

(defun javascript-string (text)
  "Return TEXT as a string of JavaScript's, in its double quotes."
  (with-output-to-string (out) (write-json-string text out :in-page t)))

;;; Anchors.

(defun plain-char-p (char)
  (or (char<= #\a char #\z) (char<= #\0 char #\9) (char= char #\-)))

(defun anchor (name)
  "Return the id of the entry NAME on its page: in it are only characters that mean nothing in
addresses, and no two names have the same."
  (with-output-to-string (out)
    (loop for char across (string-downcase name)
          do (if (plain-char-p char)
                 (write-char char out)
                 (format out "_~(~2,'0X~)" (char-code char))))))

(defun slug (heading)
  "Return the id of HEADING, a text, on its page, as the sites that show Markdown make it."
  (substitute #\- #\Space
              (remove-if-not (lambda (char)
                               (or (alphanumericp char) (find char " -_")))
                             (string-downcase heading))))
