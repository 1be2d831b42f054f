;;;; console.lisp -- an output stream that tracks the cursor and whether a prompt is shown.

(in-package :ars-magna.cli)

(export '(console console-line console-asked-p erase-typed-line draw-typed-line finish-typed-line
          clear-screen fit-to-window))

;;; Output of the simulator and of users' programs comes from other threads, at any time. The
;;; console keeps each write in one piece. It records when a prompt has been written over and must
;;; be shown again. A terminal moves the cursor when the user presses Return; only NOTE-ANSWERED
;;; tells the console of that. Output that cannot be delivered is lost, and the program ends.
;;;
;;; While the prompt edits a line itself, that line is below all output, after the prompt. It is
;;; erased before output is written, and drawn again when the output is shown.

(defconstant +longest-line-kept+ 500 "How many characters of an unfinished line are kept.")

(defclass console (fundamental-character-output-stream)
  ((stream :initarg :stream :reader console-stream)
   (window :initarg :window :initform nil :reader console-window)
   (lock :initform (make-lock "console") :reader console-lock)
   (column :initform 0 :accessor console-column)
   (rest :initform "" :accessor console-rest)
   (wrapped-p :initform nil :accessor console-wrapped-p)
   (edited-p :initform nil :accessor console-edited-p)
   (typed :initform nil :accessor console-line)
   (question :initform nil :accessor console-prompt)
   (asked-p :initform nil :accessor console-asked-p)
   (asking-told-p :initform nil :accessor console-asking-told-p)
   (prompt-overwritten-p :initform nil :accessor console-overwritten-p)
   (trouble :initform nil :accessor console-trouble)
   (colored-p :initform nil :accessor console-colored-p)
   (held-back-p :initform nil :accessor console-held-back-p)
   (held-back :initform '() :accessor console-held-back))
  (:documentation "An output stream that writes to STREAM, another stream. WINDOW is a function that
returns columns and rows of the terminal's window, or NIL if there is no window. REST is the output
since the last newline, if it is short. WRAPPED-P is true if REST fills a row and the cursor is in
the next row. EDITED-P is true if the prompt edits typed lines. TYPED is the drawn-line being typed,
or NIL. QUESTION is the prompt shown to the user, or NIL. PROMPT-OVERWRITTEN-P is true if output
follows the prompt. ASKED-P is true while a program, not the prompt, reads typed input.
ASKING-TOLD-P is true if the user has been told since the last prompt that a program reads. TROUBLE
is the error of a failed write, :OVER after DISCARD-OUTPUT, or NIL. COLORED-P is true if messages
and prompts have colours. While HELD-BACK-P is true, output is kept in HELD-BACK, a list of strings,
newest first."))

(setf (documentation 'console-line 'function)
      "Return the drawn-line that is being typed on the console, or NIL. Can be set."
      (documentation 'console-asked-p 'function)
      "True while a program, not the prompt, reads what is typed on the console.")

(defun make-console (stream &optional window)
  "Return a console that writes to STREAM, or STREAM if it is a console. WINDOW is as in CONSOLE."
  (if (typep stream 'console) stream (make-instance 'console :stream stream :window window)))

(defvar *leave-without-output-p* nil
  "True in a thread that ends this process when output cannot be written.")

(defun try-to-write (function console)
  "Call FUNCTION with CONSOLE's stream, unless a write has failed. Return true if FUNCTION fails."
  (with-lock ((console-lock console))
    (unless (console-trouble console)
      (handler-case (progn (funcall function (console-stream console)) nil)
        (stream-error (trouble) (setf (console-trouble console) trouble))))))

(defun discard-output (console)
  "Wait until no thread writes to CONSOLE. Discard later output, as the stream may be closed."
  (with-lock ((console-lock console)) (setf (console-trouble console) :over)))

(defun call-with-console (function console)
  "Call FUNCTION with the stream of CONSOLE, unless an earlier write failed."
  (when (and (call-holding-interrupts (lambda () (try-to-write function console)))
             *leave-without-output-p*)
    (throw 'leave 1)))

(defmacro with-console ((stream console) &body body)
  "Run BODY with STREAM bound to the stream of CONSOLE, while no other thread writes to CONSOLE."
  `(call-with-console (lambda (,stream) ,@body) ,console))

(defun paint-for-console (text ink console)
  (if (console-colored-p console) (paint text ink) text))

(defmethod stream-line-column ((console console))
  (console-column console))

(defconstant +most-held-back+ 1000 "How many strings a console holds back; older ones are lost.")

(defun hold-back (string console)
  (let ((held (cons string (console-held-back console))))
    (setf (console-held-back console)
          (if (nthcdr (* 2 +most-held-back+) held) (subseq held 0 +most-held-back+) held))))

;;; Where the cursor is.

(defun reset-row (console)
  (setf (console-column console) 0
        (console-rest console) ""
        (console-wrapped-p console) nil))

(defun track-output (console string start end)
  (let ((newline (position #\Newline string :start start :end end :from-end t)))
    (when newline
      (reset-row console)
      (setf start (1+ newline)))
    (incf (console-column console) (- end start))
    (setf (console-rest console)
          (if (<= (console-column console) +longest-line-kept+)
              (concatenate 'string (console-rest console) (subseq string start end))
              ""))))

(defun cursor-column (console)
  "Return the cursor's column in the window of CONSOLE; 0 if the cursor is after the last column."
  (mod (if (string= "" (console-rest console))
           (console-column console)
           (text-columns (console-rest console)))
       (values (funcall (console-window console)))))

;;; The line that is being typed.

(defun call-with-line-and-window (function console stream)
  (multiple-value-call function (console-line console) stream (funcall (console-window console))))

(defgeneric erase-typed-line (console stream)
  (:documentation "Erase the typed line, if shown. Move the cursor to the end of the output.")
  (:method ((console console) stream)
    (let ((line (console-line console)))
      (when (and line (drawn-line-shown line))
        (call-with-line-and-window #'erase-drawn-line console stream)
        (unless (or (zerop (console-column console)) (console-wrapped-p console))
          (format stream "~A~A" (cursor-up-code 1) (cursor-right-code (cursor-column console))))))))

(defgeneric draw-typed-line (console stream)
  (:documentation "Draw the line being typed below the output, unless it is shown already.")
  (:method ((console console) stream)
    (let ((line (console-line console)))
      (when (and line (null (drawn-line-shown line)))
        (unless (or (zerop (console-column console)) (console-wrapped-p console))
          (terpri stream)
          (setf (console-wrapped-p console) (zerop (cursor-column console))))
        (call-with-line-and-window #'draw-line console stream)))))

(defgeneric finish-typed-line (console stream)
  (:documentation "Leave the line being typed as it is; later output begins below.")
  (:method ((console console) stream)
    (let ((line (console-line console)))
      (erase-typed-line console stream)
      (setf (drawn-line-point line) (length (drawn-line-text line)))
      (draw-typed-line console stream)
      (when (plusp (drawn-line-column line)) (terpri stream)))))

(defun change-typed-line (console function)
  "Call FUNCTION with the line being typed, if any, and draw the line again."
  (with-console (stream console)
    (when (console-line console)
      (erase-typed-line console stream)
      (funcall function (console-line console))
      (draw-typed-line console stream)
      (finish-output stream))))

(defun begin-typed-line (console)
  "After the last output, begin a line for typing, unless a line is being typed already."
  (with-console (stream console)
    (unless (console-line console)
      (when (/= (console-column console) (length (console-rest console)))
        (write-or-hold-back (string #\Newline) console stream))
      (let ((prompt (console-rest console)))
        (setf (console-line console)
              (make-drawn-line :label prompt :shown (list prompt "" 0))))
      ;; The last output now belongs to the line. Under a shown line, it does not.
      (reset-row console))
    (erase-typed-line console stream)
    (draw-typed-line console stream)
    (finish-output stream)))

(defun outdated-line-p (line columns)
  "True if LINE is not on the screen, or was drawn for another number of columns than COLUMNS."
  (or (null (drawn-line-shown line))
      (and (drawn-line-columns line) (/= (drawn-line-columns line) columns))))

;; Not all programs flush what their threads print.
(defun redraw-if-outdated (console)
  "Draw the line being typed again if output has been written since it was drawn, or if the width of
the window has changed."
  (let ((line (console-line console)))
    (when (and line (outdated-line-p line (values (funcall (console-window console)))))
      (change-typed-line console (constantly nil)))))

(defun hide-typed-line (console)
  "Erase the line being typed. The next output draws the line again."
  (with-console (stream console)
    (erase-typed-line console stream)
    (finish-output stream)))

(defgeneric clear-screen (console stream)
  (:documentation "Clear the screen.")
  (:method ((console console) stream)
    (write-string (clear-window-code) stream)))

(defun clear-window (console)
  "Clear the window except for the line being typed."
  (hide-typed-line console)
  (with-console (stream console)
    (clear-screen console stream)
    (reset-row console)
    (draw-typed-line console stream)
    (finish-output stream)))

(defun end-typed-line (console)
  "Leave what was typed as it is; later output begins below."
  (with-console (stream console)
    (finish-typed-line console stream)
    (finish-output stream)
    (setf (console-line console) nil
          (console-prompt console) nil)
    (reset-row console)))

;;; Writing.

(defun write-below-now (string console stream start end)
  "Write STRING from START to END to STREAM, after CONSOLE's line being typed has been erased."
  ;; The cursor is there already.
  (when (and (shiftf (console-wrapped-p console) nil) (char= #\Newline (char string start)))
    (reset-row console)
    (incf start))
  (write-string string stream :start start :end end)
  (track-output console string start end)
  (unless (console-line console) (setf (console-overwritten-p console) t)))

(defun write-or-hold-back (string console stream &optional (start 0) (end (length string)))
  "Write STRING from START to END to CONSOLE's locked STREAM; keep STRING if output is held back."
  (cond ((= start end))
        ((console-held-back-p console) (hold-back (subseq string start end) console))
        (t (erase-typed-line console stream)
           (write-below-now string console stream start end))))

(defun write-on-new-line (text console stream)
  (when (plusp (console-column console)) (write-or-hold-back (string #\Newline) console stream))
  (write-or-hold-back text console stream))

(defgeneric mirrors-of (console)
  (:documentation "Return the other consoles that show what this thread writes to CONSOLE."))

(defvar *writing-to-mirrors-p* nil "True while output to a console is written to its mirrors.")

(defun call-with-mirrors (function console)
  "Call FUNCTION with each of the consoles that show what this thread writes to CONSOLE."
  (unless *writing-to-mirrors-p*
    (let ((*writing-to-mirrors-p* t)) (mapc function (mirrors-of console)))))

(defmethod stream-write-string ((console console) string &optional (start 0) end)
  (with-console (stream console)
    (write-or-hold-back string console stream start (or end (length string))))
  (call-with-mirrors (lambda (mirror) (write-string string mirror :start start :end end)) console)
  string)

(defun write-on-fresh-line (text console)
  "Write TEXT to CONSOLE at the beginning of a line, without output of other threads in between."
  (with-console (stream console) (write-on-new-line text console stream)))

(defun write-after-prompt (text console)
  "Write TEXT after the prompt; if something has been typed after the prompt, write TEXT above it."
  (with-console (stream console)
    (let ((line (console-line console)))
      (cond ((null line) (write-or-hold-back text console stream))
            ((string/= "" (drawn-line-text line)) (write-on-new-line text console stream))
            (t (write-on-new-line (concatenate 'string (drawn-line-label line) text)
                                  console stream))))))

(defgeneric fit-to-window (text console &optional label)
  (:documentation "Return TEXT for output after LABEL. If CONSOLE has a window, lines are broken
between words to fit the window.")
  (:method (text (console console) &optional (label ""))
    (if (console-window console)
        (text-broken-at-blanks text (1- (funcall (console-window console))) (text-columns label))
        text)))

(defun write-fitted (console control &rest arguments)
  "Format CONTROL with ARGUMENTS, break the lines to fit the window, and write the text at the
beginning of a line of CONSOLE."
  (write-on-fresh-line (fit-to-window (apply #'format nil control arguments) console) console))

(defmethod stream-write-char ((console console) char)
  (stream-write-string console (string char))
  char)

(defmethod stream-force-output ((console console))
  (with-console (stream console)
    (draw-typed-line console stream)
    (force-output stream))
  (call-with-mirrors #'force-output console))

(defmethod stream-finish-output ((console console))
  (with-console (stream console)
    (draw-typed-line console stream)
    (finish-output stream))
  (call-with-mirrors #'finish-output console))

;;; Prompts.

(defun put-prompt (prompt console stream)
  "Put PROMPT at the start of a line, or before the line that is being typed."
  (let ((typed (console-line console)))
    (cond ((not (null typed))
           (erase-typed-line console stream)
           (setf (drawn-line-label typed) prompt))
          ((console-edited-p console)
           (setf (console-line console) (make-drawn-line :label prompt)))
          (t (write-on-new-line prompt console stream)))))

(defun show-prompt (console prompt)
  (setf (console-asking-told-p console) nil)
  (with-console (stream console)
    (put-prompt (paint-for-console prompt :bold console) console stream)
    (draw-typed-line console stream)
    (finish-output stream)
    (setf (console-overwritten-p console) nil
          (console-prompt console) prompt)))

(defun prompt-unanswered-p (console)
  "True if a prompt is shown and nothing has been written after it."
  (and (console-prompt console) (not (console-overwritten-p console))))

(defun prompt-overwritten-p (console)
  "True if a prompt is shown and something has been written after it."
  (and (console-prompt console) (console-overwritten-p console)))

(defun restore-prompt (console)
  "Show the prompt again if something was written after it, and flush the output."
  (when (prompt-overwritten-p console)
    (show-prompt console (console-prompt console)))
  (finish-output console))

(defun note-answered (console)
  "Record that the user has finished the line after the prompt."
  (cond ((console-line console) (end-typed-line console))
        (t (setf (console-prompt console) nil)
           (unless (console-edited-p console) (reset-row console)))))

(defun show-answer (console text)
  "Show TEXT as if the user had typed TEXT and pressed Return."
  (if (console-line console)
      (change-typed-line console (lambda (line) (setf (drawn-line-text line) text)))
      (format console "~A~%" text))
  (note-answered console))
