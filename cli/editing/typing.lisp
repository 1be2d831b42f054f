;;;; typing.lisp -- keys typed at the terminal or in a window, also ahead of time.

(in-package :ars-magna.cli)

(export '(take-waiting-lines make-window-input send-key type-ahead-state))

;;; Keys typed while no line is read are kept by their effect: finished lines wait, each like a line
;;; chosen from a menu, and after them the text being typed, as if it had been pasted. The next
;;; reader gets them as keys. Arrow up goes through earlier lines, as at a prompt. Keys that need
;;; the prompt, such as Tab, do nothing.

(defstruct (type-ahead (:conc-name ahead-) (:constructor make-ahead) (:copier nil))
  "Input typed before it is read. LINES are finished lines, the oldest first. TEXT is the line being
typed, POINT the cursor's position in TEXT."
  (lines '() :type list)
  (text "" :type string)
  (point 0 :type (integer 0)))

(defun set-type-ahead-text (ahead text point &optional killed)
  (declare (ignore killed))
  (setf (ahead-text ahead) text
        (ahead-point ahead) point))

(defun insert-in-type-ahead (ahead text)
  (multiple-value-call #'set-type-ahead-text ahead
    (insert-in-text text (ahead-text ahead) (ahead-point ahead))))

(defun add-type-ahead-lines (ahead lines)
  (setf (ahead-lines ahead) (append (ahead-lines ahead) lines)))

(defun reopen-last-line (ahead)
  (let ((line (first (last (ahead-lines ahead)))))
    (when line
      (setf (ahead-lines ahead) (butlast (ahead-lines ahead)))
      (set-type-ahead-text ahead line (length line)))))

(defun show-history-neighbour (ahead entries step)
  "Replace the text of AHEAD by an older line of the history if STEP is 1, a newer one if STEP is
-1. ENTRIES are the lines before AHEAD, the newest first."
  (let* ((entries (cons "" (append (reverse (ahead-lines ahead)) entries)))
         (place (position (ahead-text ahead) entries :test #'string=))
         (next (and place (+ place step))))
    (when (and next (< -1 next (length entries)))
      (set-type-ahead-text ahead (nth next entries) (length (nth next entries))))))

(defun apply-key-to-type-ahead (ahead key entries)
  "Apply KEY to AHEAD. ENTRIES are the lines of the history before AHEAD, the newest first."
  (cond ((stringp key) (insert-in-type-ahead ahead key))
        ((consp key) (destructuring-bind (kind text) key
                       (ecase kind
                         (:paste (insert-in-type-ahead ahead (without-pasted-output text)))
                         (:entry (add-type-ahead-lines ahead (list text))))))
        ((and (eq key :rubout) (string= "" (ahead-text ahead))) (reopen-last-line ahead))
        ((gethash key *editing-keys*)
         (multiple-value-call #'set-type-ahead-text ahead
           (funcall (gethash key *editing-keys*) (ahead-text ahead) (ahead-point ahead))))
        (t (case key
             (:return (add-type-ahead-lines ahead (lines-in (ahead-text ahead)))
              (set-type-ahead-text ahead "" 0))
             ((:up :control-p) (show-history-neighbour ahead entries 1))
             ((:down :control-n) (show-history-neighbour ahead entries -1))
             (:control-c (set-type-ahead-text ahead "" 0))))))

;;; From octets, and to octets.

(defun make-text-reader (text)
  "Return a function that returns the next character of TEXT, or NIL at the end. Called with an
argument, the function steps back by a character."
  (let ((position 0))
    (lambda (&optional again)
      (cond (again (decf position) nil)
            ((< position (length text)) (prog1 (char text position) (incf position)))))))

(defun parse-type-ahead (octets entries)
  "Parse OCTETS, a string of unread input, as type-ahead. ENTRIES: see APPLY-KEY-TO-TYPE-AHEAD."
  (loop with ahead = (make-ahead)
        with next = (make-text-reader octets)
        for key = (read-key next)
        while key do (apply-key-to-type-ahead ahead key entries)
        finally (return ahead)))

(defun type-ahead-octets (ahead)
  (let ((text (ahead-text ahead)))
    (format nil "~{~A~}~A~V@{~A~:*~}"
            (loop for line in (ahead-lines ahead) collect (octets-of-key (list :entry line)))
            (if (string= "" text) "" (octets-of-key (list :paste text)))
            (- (length text) (ahead-point ahead)) (octets-of-key :left))))

;;;; The terminal

;;; A terminal without escape codes, such as a buffer of Emacs, edits lines itself.

(defun accepts-escapes-p (stream)
  (and (interactive-stream-p stream)
       (not (member (environment-value "TERM") '(nil "" "dumb" "unknown") :test #'equal))))

(defun make-standard-console ()
  (let ((stream (text-output-stream 1)))
    (make-console stream (and (accepts-escapes-p stream) #'window-size))))

(defun history-pathname ()
  "Return the pathname of the history file named in the environment, or NIL."
  (let ((name (environment-value "ARS_MAGNA_HISTORY")))
    (and name (string/= name "") (native-path name))))

(defun make-standard-input (console plain)
  "Return a stream of standard input, edited on CONSOLE if the terminal allows it and PLAIN is NIL."
  (let ((octets (octet-input-stream 0)))
    (if (and (not plain) (console-window console) (accepts-escapes-p octets))
        (make-instance 'edited-text :octets octets :by-hand-p t :console console
                                    :history (make-history (history-pathname)))
        (make-instance 'typed-text :octets octets :by-hand-p (interactive-stream-p octets)))))

(defgeneric call-with-typed-input (function input)
  (:documentation "Call FUNCTION, which reads lines from INPUT, with the terminal set up.")
  (:method (function input)
    (declare (ignore input))
    (funcall function))
  (:method (function (input edited-text))
    (let ((console (edited-console input)))
      (unwind-protect (progn (set-paste-marking console t)
                             (call-in-key-mode function))
        (save-newest-entry (edited-history input))
        (note-answered console)
        (set-paste-marking console nil)))))

(defgeneric save-history (input)
  (:documentation "Save the history of INPUT now, before this process may end.")
  (:method (input))
  (:method ((input edited-text)) (save-newest-entry (edited-history input))))

(defgeneric add-to-history (input line before)
  (:documentation "Add LINE to the history of INPUT. If BEFORE is not NIL, LINE continues the text
BEFORE and is appended to that entry.")
  (:method (input line before)
    (declare (ignore input line before)))
  (:method ((input edited-text) line before)
    (if before
        (extend-newest-entry (edited-history input) line before)
        (add-entry (edited-history input) line))))

;;; Some terminals do not mark pasted text, such as those that edit lines themselves. More than one
;;; line at once counts as pasted, too: no user types that fast, except ahead.

(defgeneric pasted-lines-waiting-p (input)
  (:documentation "True if INPUT has unread lines that were pasted with the line read last.")
  (:method (input)
    (declare (ignore input))
    nil)
  (:method ((input typed-text))
    (and (typed-by-hand-p input)
         (typed-followed-p input)
         (input-available-p (typed-octets input))))
  (:method ((input edited-text))
    (and (or (edited-lines input) (queue-has-line-p (edited-ahead input))) t)))

(defgeneric take-waiting-lines (input)
  (:documentation "Remove the waiting lines from INPUT and return them.")
  (:method (input)
    (declare (ignore input))
    '())
  (:method ((input edited-text))
    (setf (typed-position input) (length (typed-line input)))
    (append (shiftf (edited-lines input) '()) (take-type-ahead-lines input))))

(defun take-type-ahead-lines (input)
  "Remove the finished lines of type-ahead from INPUT and return them. An unfinished last line
becomes the line being typed."
  (when (queue-has-line-p (edited-ahead input))
    (let ((ahead (parse-type-ahead (coerce (remove-all-octets (edited-ahead input)) 'string) '())))
      (unless (string= "" (ahead-text ahead))
        (setf (edited-put-off input) (list (ahead-text ahead) (ahead-point ahead))))
      (ahead-lines ahead))))

(defgeneric discard-next-key (input)
  (:documentation "Discard the next key of INPUT, unless more input follows that key at once.")
  (:method (input) (clear-input input))
  (:method ((input edited-text))
    (let* ((octets (read-available-octets input)) (next (make-text-reader (coerce octets 'string))))
      (read-key next)
      (when (funcall next) (add-octets (edited-ahead input) octets)))))

(defun discard-waiting-lines (input)
  "Move the waiting lines from INPUT to the history, as one entry. Return the number of lines."
  (let ((lines (take-waiting-lines input)))
    (when lines (add-to-history input (format nil "~{~A~^~%~}" lines) nil))
    (length lines)))

;;;; Windows

;;; A window passes on keys, and shows the line on its console. All else is as at a terminal: keys,
;;; history, Tab. The terminal's state is not affected.

(defclass window-text (edited-text) ()
  (:default-initargs :by-hand-p t)
  (:documentation "The text that is typed in a window."))

(defun make-window-input (console)
  "Return an input stream for keys pressed in a window. The line being typed is shown on CONSOLE.
The history file is that of the prompt at the terminal."
  (make-instance 'window-text :console console :history (make-history (history-pathname))
                              :octets (make-instance 'queued-octets)))

(defmethod ensure-key-mode ((stream window-text) &key interrupts)
  (declare (ignore interrupts)))

(defmethod suspend-prompt ((stream window-text)))

(defmethod call-with-typed-input (function (stream window-text))
  (unwind-protect (funcall function)
    (save-newest-entry (edited-history stream))
    (note-answered (edited-console stream))))

(defun reading-line-p (stream)
  "True if STREAM is reading a line, so that keys go to that line at once."
  (and (drawn-line-of stream) t))

(defmethod save-type-ahead ((stream window-text))
  (let ((octets (coerce (remove-all-octets (edited-ahead stream)) 'string)))
    (change-unread-octets (typed-octets stream) (lambda (left) (concatenate 'string octets left)))))

(defun type-ahead-of (stream octets)
  (parse-type-ahead octets (history-entries (edited-history stream))))

(defun send-key (stream key)
  "Send KEY (see keys.lisp) to STREAM. While STREAM reads no line, KEY is kept as type-ahead."
  (flet ((with-key (octets)
           (if (reading-line-p stream)
               (uiop:strcat octets (octets-of-key key))
               (let ((ahead (type-ahead-of stream octets)))
                 (apply-key-to-type-ahead ahead key (history-entries (edited-history stream)))
                 (type-ahead-octets ahead)))))
    (change-unread-octets (typed-octets stream) #'with-key)))

;;; What waits.

(defun type-ahead-state (stream)
  "Return three values for the type-ahead of STREAM: the number of finished lines, the text being
typed, and the cursor's position in that text."
  (let ((ahead (type-ahead-of stream (unread-octets (typed-octets stream)))))
    (values (+ (length (edited-lines stream)) (length (ahead-lines ahead)))
            (ahead-text ahead)
            (ahead-point ahead))))

(defmethod take-waiting-lines ((stream window-text))
  (let ((lines '()))
    (change-unread-octets (typed-octets stream)
                          (lambda (octets)
                            (let ((ahead (type-ahead-of stream octets)))
                              (setf lines (shiftf (ahead-lines ahead) '()))
                              (type-ahead-octets ahead))))
    (append (call-next-method) lines)))
