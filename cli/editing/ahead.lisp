;;;; ahead.lisp -- what is typed in a window before it is read, while a line is under way.

(in-package :ars-magna.cli)

;;; Nobody reads the keys then. So they are kept as what they come to: lines that wait, each as a
;;; line that was chosen elsewhere, and after those what is being typed, as if it had been pasted.
;;; Whoever reads next finds keys like others. The arrow up goes to what was entered before, as at a
;;; prompt. What needs the prompt, such as Tab, does nothing.

(defstruct (ahead (:copier nil))
  "What was typed ahead. LINES wait, the oldest first; TEXT is being typed, the cursor at POINT."
  (lines '() :type list)
  (text "" :type string)
  (point 0 :type (integer 0)))

(defun change-ahead (ahead text point &optional killed)
  (declare (ignore killed))
  (setf (ahead-text ahead) text
        (ahead-point ahead) point))

(defun insert-ahead (ahead text)
  (multiple-value-call #'change-ahead ahead
    (inserted text (ahead-text ahead) (ahead-point ahead))))

(defun enter-ahead (ahead lines)
  "Let LINES wait after those of AHEAD."
  (setf (ahead-lines ahead) (append (ahead-lines ahead) lines)))

(defun type-last-again (ahead)
  (let ((line (first (last (ahead-lines ahead)))))
    (when line
      (setf (ahead-lines ahead) (butlast (ahead-lines ahead)))
      (change-ahead ahead line (length line)))))

(defun show-neighbour (ahead entries step)
  "Let what is STEP further in ENTRIES than what is being typed in AHEAD be typed instead. The empty
line is before the first."
  (let* ((entries (cons "" (append (reverse (ahead-lines ahead)) entries)))
         (place (position (ahead-text ahead) entries :test #'string=))
         (next (and place (+ place step))))
    (when (and next (< -1 next (length entries)))
      (change-ahead ahead (nth next entries) (length (nth next entries))))))

(defun press-given-ahead (ahead kind text)
  (ecase kind
    (:paste (insert-ahead ahead (without-answers text)))
    (:entry (enter-ahead ahead (list text)))))

(defun press-ahead (ahead key entries)
  "Do to AHEAD what KEY does. ENTRIES, the newest first, were entered before its lines."
  (cond ((stringp key) (insert-ahead ahead key))
        ((consp key) (press-given-ahead ahead (first key) (second key)))
        ((and (eq key :rubout) (string= "" (ahead-text ahead))) (type-last-again ahead))
        ((change-of key) (multiple-value-call #'change-ahead ahead
                           (funcall (change-of key) (ahead-text ahead) (ahead-point ahead))))
        (t (case key
             (:return (enter-ahead ahead (lines-in (ahead-text ahead)))
              (change-ahead ahead "" 0))
             ((:up :control-p) (show-neighbour ahead entries 1))
             ((:down :control-n) (show-neighbour ahead entries -1))
             (:control-c (change-ahead ahead "" 0))))))

;;; From octets, and to octets.

(defun text-reader (text)
  "Return a function that returns the next character of TEXT, or NIL, or is given one to return
first."
  (let ((position 0))
    (lambda (&optional again)
      (cond (again (decf position) nil)
            ((< position (length text)) (prog1 (char text position) (incf position)))))))

(defun ahead-in (octets entries)
  "Return what OCTETS, a string that has not been read yet, come to after ENTRIES."
  (loop with ahead = (make-ahead)
        with next = (text-reader octets)
        for key = (read-key next)
        while key do (press-ahead ahead key entries)
        finally (return ahead)))

(defun octets-of-ahead (ahead)
  (let ((text (ahead-text ahead)))
    (format nil "~{~A~}~A~V@{~A~:*~}"
            (loop for line in (ahead-lines ahead) collect (octets-of-key (list :entry line)))
            (if (string= "" text) "" (octets-of-key (list :paste text)))
            (- (length text) (ahead-point ahead)) (octets-of-key :left))))
