;;;; editor.lisp -- editing a line at a terminal, key by key.

(in-package :ars-magna.cli)

;;; Why not rlwrap or GNU readline? Output that arrives while a line is typed must appear above it,
;;; from any thread. Control-C must end only what was typed before it. Tab must complete names of
;;; the simulator. A program around this one can do none of that; readline can be called by one
;;; thread only, and has a different kind of licence.

(defclass edited-text (typed-text)
  ((console :initarg :console :reader edited-console)
   (history :initarg :history :initform (make-history) :reader edited-history)
   ;; Octets that arrived early, and lines that were pasted.
   (ahead :initform (make-octet-queue) :reader edited-ahead)
   (lines :initform '() :accessor edited-lines)
   (killed :initform "" :accessor edited-killed)
   ;; What Tab has listed last, if nothing has changed since, or NIL.
   (listed :initform nil :accessor edited-listed)
   ;; What was being typed when another line was entered, as a list of text and point, or NIL.
   (put-off :initform nil :accessor edited-put-off)
   ;; The entries of the history before the shown one, and those after it, the nearest first; after
   ;; the newest comes what was typed.
   (older :initform '() :accessor edited-older)
   (newer :initform '() :accessor edited-newer))
  (:documentation "The text typed at this process's terminal, with line editing and history. The
line being typed is shown on CONSOLE."))

(defmethod initialize-instance :after ((stream edited-text) &key)
  (setf (console-edited-p (edited-console stream)) t))

(defgeneric take-keys (stream &key interrupts)
  (:documentation "Make the terminal pass each key to STREAM at once. If INTERRUPTS is true,
Control-C and similar keys are signals instead.")
  (:method ((stream edited-text) &key interrupts)
    (hand-over-keys :interrupts interrupts)))

(defun show-again (stream)
  "Draw the line being typed into STREAM again, after this process was suspended."
  (mark-pastes (edited-console stream) t)
  (change-line (edited-console stream) (constantly nil)))

(defgeneric suspend-prompt (stream)
  (:documentation "Suspend this process until the user at STREAM resumes it.")
  (:method ((stream edited-text))
    (hide-line (edited-console stream))
    (mark-pastes (edited-console stream) nil)
    (suspend-process)
    (show-again stream)))

(defvar *while-typing* nil
  "NIL, or a function that is called several times a second while a line is typed.")

;;; Octets.

(defun next-octet (stream)
  "Return the next octet of STREAM, as a character, or NIL at the end."
  (cond ((not (empty-queue-p (edited-ahead stream))) (take-octet (edited-ahead stream)))
        (t (when (typep (typed-octets stream) 'descriptor-stream)
             (loop until (octets-within-p (typed-octets stream) (if *while-typing* 0.05 0.25))
                   do (redraw-if-resized (edited-console stream))
                      (when (shiftf *continued-p* nil) (show-again stream))
                      (when *while-typing* (funcall *while-typing*))))
           (handler-case (read-char (typed-octets stream) nil)
             (stream-error () nil)))))

(defun octet-reader (stream)
  "Return a function that returns the next octet of STREAM. Called with an octet, the function puts
the octet back into STREAM."
  (lambda (&optional octet)
    (if octet
        (progn (put-back-octet (edited-ahead stream) octet) nil)
        (next-octet stream))))

(defun octets-come (stream)
  (loop for char = (handler-case (read-char-no-hang (typed-octets stream) nil)
                     (stream-error () nil))
        while char collect char))

(defun octets-at-hand-p (stream)
  (let ((ahead (edited-ahead stream)))
    (when (empty-queue-p ahead) (add-octets ahead (octets-come stream)))
    (not (empty-queue-p ahead))))

(defgeneric keep-ahead (stream)
  (:documentation "Save the type-ahead of STREAM for its next reader.")
  (:method ((stream edited-text))))

(defun mark-pastes (console on)
  "Switch bracketed paste mode of the terminal of CONSOLE on, or off if ON is NIL. In this mode the
terminal marks pasted text."
  (with-console (stream console)
    (write-string (paste-in-brackets on) stream)
    (finish-output stream)))

;;; The line.

(defun line-of (stream)
  (console-line (edited-console stream)))

(defun typed-text-of (stream)
  (drawn-line-text (line-of stream)))

(defun change-to (stream text point)
  "Make TEXT the line being typed, with the cursor at POINT."
  (setf (edited-listed stream) nil)
  (change-line (edited-console stream)
               (lambda (line)
                 (setf (drawn-line-text line) text
                       (drawn-line-point line) point))))

(defun insert-typed (stream string)
  (let ((line (line-of stream)))
    (multiple-value-call #'change-to stream
      (inserted string (drawn-line-text line) (drawn-line-point line)))))

(defun do-change (stream function)
  (let ((line (line-of stream)))
    (multiple-value-bind (text point killed)
        (funcall function (drawn-line-text line) (drawn-line-point line))
      (when (and killed (string/= "" killed)) (setf (edited-killed stream) killed))
      (change-to stream text point))))

;;; Keys that do other things.

(defvar *actions* (make-hash-table)
  "Table from keys to functions of the input stream. If a function returns a text or :EOF, its key
ends the line; other values are ignored.")

(define-key *actions* (:return) (stream)
  "End the line."
  (typed-text-of stream))

(define-key *actions* (:control-c) (stream)
  "Clear the line. If the line is empty, or a program reads it, interrupt that program instead."
  (if (or (string= "" (typed-text-of stream)) (console-asked-p (edited-console stream)))
      (handle-interrupt)
      (change-to stream "" 0)))

(define-key *actions* (:control-d) (stream)
  "Delete the character under the cursor; if the line is empty, end the input."
  (cond ((string= "" (typed-text-of stream)) :eof)
        (t (do-change stream (gethash :delete *changes*)))))

(define-key *actions* (:control-y) (stream)
  "Insert the text that was killed last."
  (insert-typed stream (edited-killed stream)))

(define-key *actions* (:control-l) (stream)
  "Clear the screen."
  (clear-window (edited-console stream)))

(define-key *actions* (:control-z) (stream)
  "Suspend this process until the user resumes it."
  (suspend-prompt stream))

(define-key *actions* (:control-\\) (stream)
  "End this process at once."
  (hide-line (edited-console stream))
  (mark-pastes (edited-console stream) nil)
  (quit-by-signal))

;;; The history.

(defun show-entry (stream from to)
  "Show the first history entry in the slot FROM of STREAM. Push the text shown until now onto the
slot TO."
  (let ((entry (first (slot-value stream from))))
    (when entry
      (pop (slot-value stream from))
      (push (typed-text-of stream) (slot-value stream to))
      (change-to stream entry (length entry)))))

(define-key *actions* (:up :control-p) (stream)
  "Go to the line above, or to the previous history entry."
  (let* ((line (line-of stream))
         (start (line-start (drawn-line-text line) (drawn-line-point line))))
    (if (zerop start)
        (show-entry stream 'older 'newer)
        (change-to stream (drawn-line-text line) (1- start)))))

(define-key *actions* (:down :control-n) (stream)
  "Go to the line below, or to the next history entry."
  (let* ((line (line-of stream))
         (text (drawn-line-text line))
         (end (line-end text (drawn-line-point line))))
    (if (= end (length text))
        (show-entry stream 'newer 'older)
        (change-to stream text (line-end text (1+ end))))))

;;; Reading a line.

(defun insert-pasted (stream text)
  "Insert TEXT, which was pasted. Report if lines at its end are taken for output and left out."
  (let ((count (answers-at-end text)))
    (when (plusp count)
      (write-fresh (format nil "~D line~:P after the last pasted prompt ~:*~[~;is~:;are~] taken ~
                                for output and left out.~%" count)
                   (edited-console stream))))
  (insert-typed stream (without-answers text)))

(defun enter-chosen (stream text)
  "Make TEXT the line, and return TEXT. The text being typed is kept for the next line."
  (let ((line (line-of stream)))
    (setf (edited-put-off stream)
          (and (string/= "" (drawn-line-text line))
               (list (drawn-line-text line) (drawn-line-point line)))))
  (change-to stream text (length text))
  text)

(defun do-key (stream key)
  "Handle KEY. If KEY ends the line, return the text of the line, or :EOF; else return NIL."
  (cond ((stringp key) (insert-typed stream key) nil)
        ((consp key) (ecase (first key)
                       (:paste (insert-pasted stream (second key)) nil)
                       (:entry (enter-chosen stream (second key)))))
        ((null key) (if (string= "" (typed-text-of stream)) :eof (typed-text-of stream)))
        ((gethash key *changes*) (do-change stream (gethash key *changes*)) nil)
        ((gethash key *actions*) (let ((end (funcall (gethash key *actions*) stream)))
                                   (and (typep end '(or string (eql :eof))) end)))))

(defun call-editing (function stream)
  (let ((console (edited-console stream)))
    (unwind-protect (progn (take-keys stream)
                           (begin-line console)
                           (setf (edited-older stream) (history-entries (edited-history stream))
                                 (edited-newer stream) '()
                                 (edited-listed stream) nil)
                           (when (edited-put-off stream)
                             (apply #'change-to stream (shiftf (edited-put-off stream) nil)))
                           (funcall function))
      (when (console-line console) (end-line console))
      (take-keys stream :interrupts t))))

(defun insert-typed-text (stream text)
  "Insert TEXT and all characters that are available after it, and draw the line once. So unmarked
pasted text is drawn fast. If the key after the text ends the line, return the text of the line, or
:EOF."
  (let ((texts (list text)) (next :none))
    (loop while (and (eq next :none) (octets-at-hand-p stream))
          do (let ((key (read-key (octet-reader stream))))
               (if (stringp key) (push key texts) (setf next key))))
    (insert-typed stream (format nil "~{~A~}" (reverse texts)))
    (unless (eq next :none) (do-key stream next))))

(defun do-keys (stream)
  "Handle keys until one ends the line. Return the text of the line, or :EOF."
  (when (console-asked-p (edited-console stream)) (announce-program-input (edited-console stream)))
  (loop for key = (read-key (octet-reader stream))
        for end = (if (stringp key) (insert-typed-text stream key) (do-key stream key))
        until end
        ;; Only its first line is shown; the others appear when they are read.
        finally (let* ((text (typed-text-of stream)) (newline (position #\Newline text)))
                  (when newline (change-to stream (subseq text 0 newline) newline)))
                (return end)))

(defun edit-line (stream)
  "Return a line from the user, with newlines if several were pasted; :EOF at the end of the input."
  (flet ((edit () (call-editing (lambda () (do-keys stream)) stream)))
    (prog1 (if *program-reads* (call-reading-program-input (edited-console stream) #'edit) (edit))
      ;; A Control-C typed after the line is for that line.
      (let ((ahead (edited-ahead stream)))
        (add-octets ahead (octets-come stream))
        (let ((interrupt-p (forget-until-interrupt ahead)))
          (keep-ahead stream)
          (when interrupt-p (handle-interrupt)))))))

;;; As a stream.

(defmethod next-typed-line ((stream edited-text))
  (let ((line (pop (edited-lines stream))))
    (if line
        (show-answer (edited-console stream) (visible line))
        (let ((text (edit-line stream)))
          (unless (eq text :eof)
            (setf (edited-lines stream) (rest (lines-in text))
                  line (first (lines-in text))))))
    (if line (format nil "~A~%" line) "")))

(defmethod typed-ahead-p ((stream edited-text))
  (or (line-left-p stream)
      (and (edited-lines stream) t)
      (not (empty-queue-p (edited-ahead stream)))))

(defmethod stream-clear-input :after ((stream edited-text))
  (setf (edited-lines stream) '())
  (take-all-octets (edited-ahead stream)))

;;;; Control R

;;; The prompt shows what is searched for. Control-R again goes on to an older line; Control-G
;;; cancels; any other key takes the found line and acts on it.

(defun found-entry (stream sought skipped)
  "Search the history for SOUGHT, from the newest entry back, and skip SKIPPED matches. Return the
entry found and the position of SOUGHT in the entry; NIL if there is none."
  (let* ((entries (remove-if-not (lambda (entry) (search sought entry :test #'char-equal))
                                 (remove-duplicates (history-entries (edited-history stream))
                                                    :test #'string= :from-end t)))
         (entry (and (string/= "" sought) (nth skipped entries))))
    (values entry (and entry (search sought entry :test #'char-equal)))))

(defun show-search (stream sought skipped)
  "Show and return the history entry that FOUND-ENTRY returns for SOUGHT and SKIPPED, or NIL."
  (multiple-value-bind (entry place) (found-entry stream sought skipped)
    (change-line (edited-console stream)
                 (lambda (line)
                   (setf (drawn-line-label line)
                         (format nil "(search~:[, not found~;~]) ~A: "
                                 (or entry (string= "" sought)) sought))
                   (when entry
                     (setf (drawn-line-text line) entry
                           (drawn-line-point line) place))))
    entry))

(defun search-keys (stream)
  "Read a search text key by key, and show the entry found. Return the first key that does not
belong to the search."
  (loop with sought = "" and skipped = 0
        for key = (read-key (octet-reader stream))
        do (cond ((stringp key) (setf sought (uiop:strcat sought key)
                                      skipped 0))
                 ((eq key :rubout) (setf sought (subseq sought 0 (max 0 (1- (length sought))))
                                         skipped 0))
                 ((eq key :control-r) (when (found-entry stream sought (1+ skipped))
                                        (incf skipped)))
                 (t (return key)))
           (show-search stream sought skipped)))

(define-key *actions* (:control-r) (stream)
  "Search the history for a line."
  (let* ((line (line-of stream))
         (prompt (drawn-line-label line))
         (text (drawn-line-text line))
         (point (drawn-line-point line)))
    (show-search stream "" 0)
    (let ((key (search-keys stream)))
      (change-line (edited-console stream)
                   (lambda (line) (setf (drawn-line-label line) prompt)))
      (if (member key '(:control-g :control-c))
          (change-to stream text point)
          (do-key stream key)))))
