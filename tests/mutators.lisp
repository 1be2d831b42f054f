;;;; mutators.lisp -- random damage to forms, texts and bytes.

(in-package :ars-magna.tests)

;;; A copy is damaged, not the original. The same dice do the same damage.

(defun one-of (dice &rest elements) (base:roll-element elements dice))

;;; What nobody expects.

(defvar *sprung* 0 "How often something was executed that should not have been.")

(defun spring (&rest ignore)
  "Say that data have been executed."
  (declare (ignore ignore))
  (incf *sprung*))

(defun circle (&rest elements)
  "Return a list of ELEMENTS without an end."
  (let ((list (copy-list elements)))
    (setf (cdr (last list)) list)
    list))

(defun nest (depth)
  "Return a list in a list, and so on, DEPTH lists deep."
  (let ((list '()))
    (dotimes (i depth list) (setf list (list list)))))

(defun infinity (sign)
  (base:bits-to-double (if (plusp sign) #x7FF0000000000000 #xFFF0000000000000)))

(defun not-a-number ()
  (base:bits-to-double #x7FF8000000000000))

(defun hostile-number (dice)
  (base:roll-element (list 0 -1 -0d0 1/3 -7/2 1.5 (expt 10 40) (- (expt 10 400)) (/ (expt 7 400))
                           1d308 -1d308 1f38 least-positive-double-float 1d-300
                           most-positive-fixnum 40000 4d18 1d9 #c(1 2) #c(1d0 -1d0)
                           (infinity 1) (infinity -1) (not-a-number)
                           sb-ext:single-float-positive-infinity)
                     dice))

(defun hostile-name (dice)
  (base:roll-element (list t :t 'list 'cl:lambda '&rest '&key '|| '|odd name; #.(quit)| '- '*
                           (make-symbol "HOMELESS") 'sb-ext:quit 'world:thing 'pi
                           (make-symbol (string (code-char 0)))
                           :wall :sise :colur :wheight :cashe 'no-such-thing 'quote '?x)
                     dice))

(defun hostile-text (dice)
  (base:roll-element (list "" "x" "~A~D~" (string (code-char 0)) "#.(quit)" "../../etc/passwd"
                           (make-string 10000 :initial-element #\a) (string (code-char #xD800))
                           (format nil "two~%lines") "~/*?[")
                     dice))

(defun hostile-list (dice)
  (one-of dice '(1 . 2) '(:size . 3) (circle 1 2) (list 'wall (circle nil)) (nest 500)
          (make-list 2000 :initial-element 'x) '(nil) '(nil nil) '((1 2) (3)) '(quote x)
          '(spring) '(function spring) '(lambda) '(:the robot) '(&optional) '#1=(a . #1#)))

(defun hostile-object (dice)
  (one-of dice #'spring (make-hash-table) #p"/no-such-directory/*.*" #\x (find-package :cl)
          (vector 1 2) (make-array '(2 2)) #*101 (find-class 'standard-object) *standard-output*
          (first (world:all-maps)) (first (world:all-kickers)) (geo:make-pt 1 2)))

(defun hostile (dice)
  "Return something that makes sense in few places."
  (funcall (one-of dice (constantly nil) #'hostile-number #'hostile-number #'hostile-name
                   #'hostile-text #'hostile-list #'hostile-list #'hostile-object)
           dice))

;;; Forms.

(defun circular-p (tree)
  (not (run::tree-p tree)))

(defun tails-of (tree)
  "Return a list of all conses of TREE."
  (loop for tail on tree
        collect tail
        when (consp (car tail)) append (tails-of (car tail))
        while (consp (cdr tail))))

(defun damage-at (tail tree dice)
  "Do some damage to the list of which TAIL, a cons of TREE, is the rest."
  (ecase (base:roll-index 10 dice)
    ((0 1 2 3) (setf (car tail) (hostile dice)))
    (4 (setf (car tail) (copy-tree (car (base:roll-element (tails-of tree) dice)))))
    (5 (if (consp (cdr tail))
           (setf (car tail) (cadr tail) (cdr tail) (cddr tail))
           (setf (car tail) nil)))
    (6 (push (car tail) (cdr tail)))
    (7 (when (consp (cdr tail)) (rotatef (car tail) (cadr tail))))
    (8 (setf (cdr tail) (one-of dice nil nil (hostile dice) tail)))
    (9 (setf (car tail) (one-of dice (list (car tail)) (list 'quote (car tail))
                                (princ-to-string (car tail)) (slip-of (car tail) dice))))))

(defun slip-of (datum dice)
  "Return DATUM, if it is a name, with a letter of it dropped, doubled or replaced."
  (if (and datum (symbolp datum) (< 1 (length (symbol-name datum))))
      (let* ((name (symbol-name datum)) (i (base:roll-index (length name) dice)))
        (intern (concatenate 'string (subseq name 0 i)
                             (one-of dice "" "X" "E" (make-string 2 :initial-element (char name i)))
                             (subseq name (1+ i)))
                (if (keywordp datum) :keyword :ars-magna.tests)))
      datum))

(defun form-mutant (form dice &key (keep 1))
  "Return FORM, a list, damaged by DICE at one place or two; not in the first KEEP elements."
  (let ((copy (copy-tree form)))
    (dotimes (i (one-of dice 1 1 2) copy)
      (let ((tails (if (circular-p copy) '() (tails-of copy))))
        (setf tails (set-difference tails (loop repeat keep for tail on copy collect tail)))
        (when tails (damage-at (base:roll-element tails dice) copy dice))))))

;;; Texts and bytes.

(defparameter *nasty-characters*
  (concatenate 'string "()'\"|;\\#:.,`@&0-~*?/ " (map 'string #'code-char
                                                      '(0 7 9 10 13 27 127 155 #xFEFF #xD800
                                                        #x10FFFF))))

(defparameter *nasty-pieces*
  '("#.(ars-magna.tests::spring)" "#1=(a . #1#)" "((((((((" "1e999" "1/0" "#+nil" "#|" "|#" "::"
    "no-such-package::x" "9999999999999999999999" "-1" "nil" "(quit" "''''" "#\\" "#<x>" "#p\"/\""
    "#*2" "#2A((1)(2 3))" "abuse-interned-name" ":abuse-interned-key")
  "What stands in texts to do harm.")

(defun cut-in (text start end middle)
  (concatenate 'string (subseq text 0 start) middle (subseq text end)))

(defun text-mutant (text dice)
  "Return TEXT damaged by DICE."
  (let* ((size (length text)) (i (base:roll-index (1+ size) dice))
         (j (base:roll-index (1+ size) dice)) (next (min size (1+ i)))
         (char (string (base:roll-element *nasty-characters* dice))))
    (ecase (base:roll-index 8 dice)
      (0 (subseq text 0 i))
      (1 (cut-in text i next ""))
      (2 (cut-in text i i char))
      (3 (cut-in text i next char))
      (4 (cut-in text (min i j) (max i j) ""))
      (5 (cut-in text i i (base:roll-element *nasty-pieces* dice)))
      (6 (cut-in text i i (subseq text (min i j) (max i j))))
      (7 (cut-in text i i (make-string (one-of dice 10 1000 5000)
                                       :initial-element (char char 0)))))))

(defun octets-mutant (octets dice)
  "Return a copy of OCTETS in which DICE have flipped bits, put in others, or cut."
  (let* ((size (length octets)) (i (base:roll-index (max 1 size) dice))
         (copy (copy-seq octets)))
    (flet ((spliced (start end &rest middle)
             (concatenate '(vector (unsigned-byte 8)) (subseq copy 0 (min size start)) middle
                          (subseq copy (min size end)))))
      (ecase (base:roll-index 5 dice)
        (0 (if (plusp size)
               (spliced i (1+ i) (logxor (aref copy i) (ash 1 (base:roll-index 8 dice))))
               copy))
        (1 (spliced i (1+ i) (base:roll-index 256 dice)))
        (2 (spliced i size))
        (3 (spliced i i #xF7 #xB2 #xBB #x9B))
        (4 (spliced i (+ i 1 (base:roll-index 100 dice))))))))
