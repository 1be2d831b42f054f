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

(defgeneric ensure-key-mode (stream &key interrupts)
  (:documentation "Make the terminal pass each key to STREAM at once. If INTERRUPTS is true,
Control-C and similar keys are signals instead.")
  (:method ((stream edited-text) &key interrupts)
    (enter-key-mode :interrupts interrupts)))

(defun redraw-after-suspension (stream)
  (set-paste-marking (edited-console stream) t)
  (change-typed-line (edited-console stream) (constantly nil)))

(defgeneric suspend-prompt (stream)
  (:documentation "Suspend this process until the user at STREAM resumes it.")
  (:method ((stream edited-text))
    (hide-typed-line (edited-console stream))
    (set-paste-marking (edited-console stream) nil)
    (suspend-process)
    (redraw-after-suspension stream)))

(defvar *typing-callback* nil
  "NIL, or a function that is called several times a second while a line is typed.")

;;; Octets.

(defun next-octet (stream)
  "Return the next octet of STREAM, as a character, or NIL at the end."
  (cond ((not (empty-queue-p (edited-ahead stream))) (pop-octet (edited-ahead stream)))
        (t (when (typep (typed-octets stream) 'descriptor-stream)
             (loop until (octets-within-p (typed-octets stream) (if *typing-callback* 0.05 0.25))
                   do (redraw-if-outdated (edited-console stream))
                      (when (shiftf *continued-p* nil) (redraw-after-suspension stream))
                      (when *typing-callback* (funcall *typing-callback*))))
           (handler-case (read-char (typed-octets stream) nil)
             (stream-error () nil)))))

(defun make-octet-reader (stream)
  "Return a function that returns the next octet of STREAM or, called with an octet, puts it back."
  (lambda (&optional octet)
    (if octet
        (progn (put-back-octet (edited-ahead stream) octet) nil)
        (next-octet stream))))

(defun read-available-octets (stream)
  (loop for char = (handler-case (read-char-no-hang (typed-octets stream) nil)
                     (stream-error () nil))
        while char collect char))

(defun octets-available-p (stream)
  (let ((ahead (edited-ahead stream)))
    (when (empty-queue-p ahead) (add-octets ahead (read-available-octets stream)))
    (not (empty-queue-p ahead))))

(defgeneric save-type-ahead (stream)
  (:documentation "Save the type-ahead of STREAM for its next reader.")
  (:method ((stream edited-text))))

(defun set-paste-marking (console on)
  "Switch bracketed paste mode of CONSOLE's terminal on, so that it marks pasted text, or off."
  (with-console (stream console)
    (write-string (paste-marking-code on) stream)
    (finish-output stream)))

;;; The line.

(defun drawn-line-of (stream)
  (console-line (edited-console stream)))

(defun text-being-typed (stream)
  (drawn-line-text (drawn-line-of stream)))

(defun replace-line-text (stream text point)
  (setf (edited-listed stream) nil)
  (change-typed-line (edited-console stream)
                     (lambda (line)
                       (setf (drawn-line-text line) text
                             (drawn-line-point line) point))))

(defun insert-string (stream string)
  (let ((line (drawn-line-of stream)))
    (multiple-value-call #'replace-line-text stream
      (insert-in-text string (drawn-line-text line) (drawn-line-point line)))))

(defun apply-change (stream function)
  (let ((line (drawn-line-of stream)))
    (multiple-value-bind (text point killed)
        (funcall function (drawn-line-text line) (drawn-line-point line))
      (when (and killed (string/= "" killed)) (setf (edited-killed stream) killed))
      (replace-line-text stream text point))))

;;; Keys that do other things.

(defvar *action-keys* (make-hash-table)
  "Table from keys to functions, which take the input stream. If a function returns a text or :EOF,
its key ends the line; other values are ignored.")

(define-key *action-keys* (:return) (stream)
  "End the line."
  (text-being-typed stream))

(define-key *action-keys* (:control-c) (stream)
  "Clear the line. If the line is empty, or a program reads it, signal an interrupt instead."
  (if (or (string= "" (text-being-typed stream)) (console-asked-p (edited-console stream)))
      (handle-interrupt)
      (replace-line-text stream "" 0)))

(define-key *action-keys* (:control-d) (stream)
  "Delete the character under the cursor; if the line is empty, end the input."
  (cond ((string= "" (text-being-typed stream)) :eof)
        (t (apply-change stream (gethash :delete *editing-keys*)))))

(define-key *action-keys* (:control-y) (stream)
  "Insert the text that was killed last."
  (insert-string stream (edited-killed stream)))

(define-key *action-keys* (:control-l) (stream)
  "Clear the screen."
  (clear-window (edited-console stream)))

(define-key *action-keys* (:control-z) (stream)
  "Suspend this process until the user resumes it."
  (suspend-prompt stream))

(define-key *action-keys* (:control-\\) (stream)
  "End this process at once."
  (hide-typed-line (edited-console stream))
  (set-paste-marking (edited-console stream) nil)
  (exit-by-sigquit))

;;; The history.

(defun show-history-entry (stream from to)
  "Show the first entry in slot FROM of STREAM, and push the previous text onto slot TO."
  (let ((entry (first (slot-value stream from))))
    (when entry
      (pop (slot-value stream from))
      (push (text-being-typed stream) (slot-value stream to))
      (replace-line-text stream entry (length entry)))))

(define-key *action-keys* (:up :control-p) (stream)
  "Go to the line above, or to the previous history entry."
  (let* ((line (drawn-line-of stream))
         (start (line-start (drawn-line-text line) (drawn-line-point line))))
    (if (zerop start)
        (show-history-entry stream 'older 'newer)
        (replace-line-text stream (drawn-line-text line) (1- start)))))

(define-key *action-keys* (:down :control-n) (stream)
  "Go to the line below, or to the next history entry."
  (let* ((line (drawn-line-of stream))
         (text (drawn-line-text line))
         (end (line-end text (drawn-line-point line))))
    (if (= end (length text))
        (show-history-entry stream 'newer 'older)
        (replace-line-text stream text (line-end text (1+ end))))))

;;; Reading a line.

(defun insert-pasted-text (stream text)
  "Insert TEXT, which was pasted. Report if the last lines are taken for output and left out."
  (let ((count (count-output-lines text)))
    (when (plusp count)
      (write-on-fresh-line
       (format nil "~D line~:P after the last pasted prompt ~:*~[~;is~:;are~] taken for output ~
                    and left out.~%"
               count)
       (edited-console stream))))
  (insert-string stream (without-pasted-output text)))

(defun enter-chosen-line (stream text)
  "Make TEXT the line, and return TEXT. The text being typed is kept for the next line."
  (let ((line (drawn-line-of stream)))
    (setf (edited-put-off stream)
          (and (string/= "" (drawn-line-text line))
               (list (drawn-line-text line) (drawn-line-point line)))))
  (replace-line-text stream text (length text))
  text)

(defun handle-key (stream key)
  "Handle KEY. If KEY ends the line, return the text of the line, or :EOF; else return NIL."
  (cond ((stringp key) (insert-string stream key) nil)
        ((consp key) (ecase (first key)
                       (:paste (insert-pasted-text stream (second key)) nil)
                       (:entry (enter-chosen-line stream (second key)))))
        ((null key) (if (string= "" (text-being-typed stream)) :eof (text-being-typed stream)))
        ((gethash key *editing-keys*) (apply-change stream (gethash key *editing-keys*)) nil)
        ((gethash key *action-keys*) (let ((end (funcall (gethash key *action-keys*) stream)))
                                       (and (typep end '(or string (eql :eof))) end)))))

(defun call-with-line-editing (function stream)
  (let ((console (edited-console stream)))
    (unwind-protect (progn (ensure-key-mode stream)
                           (begin-typed-line console)
                           (setf (edited-older stream) (history-entries (edited-history stream))
                                 (edited-newer stream) '()
                                 (edited-listed stream) nil)
                           (when (edited-put-off stream)
                             (apply #'replace-line-text stream
                                    (shiftf (edited-put-off stream) nil)))
                           (funcall function))
      (when (console-line console) (end-typed-line console))
      (ensure-key-mode stream :interrupts t))))

(defun insert-available-text (stream text)
  "Insert TEXT and all characters available after TEXT. Draw the line only once, because unmarked
pasted text may be long. If the key after the text ends the line, return the line's text, or :EOF."
  (let ((texts (list text)) (next :none))
    (loop while (and (eq next :none) (octets-available-p stream))
          do (let ((key (read-key (make-octet-reader stream))))
               (if (stringp key) (push key texts) (setf next key))))
    (insert-string stream (format nil "~{~A~}" (reverse texts)))
    (unless (eq next :none) (handle-key stream next))))

(defun handle-keys (stream)
  "Handle keys until one ends the line. Return the text of the line, or :EOF."
  (when (console-asked-p (edited-console stream)) (announce-program-input (edited-console stream)))
  (loop for key = (read-key (make-octet-reader stream))
        for end = (if (stringp key) (insert-available-text stream key) (handle-key stream key))
        until end
        ;; Only its first line is shown; the others appear when they are read.
        finally (let* ((text (text-being-typed stream)) (newline (position #\Newline text)))
                  (when newline (replace-line-text stream (subseq text 0 newline) newline)))
                (return end)))

(defun edit-line (stream)
  "Return a line from the user, or several pasted lines with newlines; :EOF at the end of input."
  (flet ((edit () (call-with-line-editing (lambda () (handle-keys stream)) stream)))
    (prog1 (if *before-program-reads*
               (call-reading-program-input (edited-console stream) #'edit)
               (edit))
      ;; A Control-C typed after the line is for that line.
      (let ((ahead (edited-ahead stream)))
        (add-octets ahead (read-available-octets stream))
        (let ((interrupt-p (drop-until-interrupt ahead)))
          (save-type-ahead stream)
          (when interrupt-p (handle-interrupt)))))))

;;; As a stream.

(defmethod next-typed-line ((stream edited-text))
  (let ((line (pop (edited-lines stream))))
    (if line
        (show-answer (edited-console stream) (escape-controls line))
        (let ((text (edit-line stream)))
          (unless (eq text :eof)
            (setf (edited-lines stream) (rest (lines-in text))
                  line (first (lines-in text))))))
    (if line (format nil "~A~%" line) "")))

(defmethod typed-ahead-p ((stream edited-text))
  (or (unread-line-p stream)
      (and (edited-lines stream) t)
      (not (empty-queue-p (edited-ahead stream)))))

(defmethod stream-clear-input :after ((stream edited-text))
  (setf (edited-lines stream) '())
  (remove-all-octets (edited-ahead stream)))

;;;; Control R

;;; The prompt shows what is searched for. Control-R again goes on to an older line; Control-G
;;; cancels; any other key takes the found line and acts on it.

(defun find-history-entry (stream sought skipped)
  "Search the history for SOUGHT, from the newest entry back, and skip SKIPPED matches. Return the
entry found and the position of SOUGHT in the entry; NIL if there is none."
  (let* ((entries (remove-if-not (lambda (entry) (search sought entry :test #'char-equal))
                                 (remove-duplicates (history-entries (edited-history stream))
                                                    :test #'string= :from-end t)))
         (entry (and (string/= "" sought) (nth skipped entries))))
    (values entry (and entry (search sought entry :test #'char-equal)))))

(defun show-search-result (stream sought skipped)
  "Show and return the entry that FIND-HISTORY-ENTRY returns for SOUGHT and SKIPPED, or NIL."
  (multiple-value-bind (entry place) (find-history-entry stream sought skipped)
    (change-typed-line (edited-console stream)
                       (lambda (line)
                         (setf (drawn-line-label line)
                               (format nil "(search~:[, not found~;~]) ~A: "
                                       (or entry (string= "" sought)) sought))
                         (when entry
                           (setf (drawn-line-text line) entry
                                 (drawn-line-point line) place))))
    entry))

(defun read-search-keys (stream)
  "Read a search text key by key, and show the entry found. Return the first key after the search."
  (loop with sought = "" and skipped = 0
        for key = (read-key (make-octet-reader stream))
        do (cond ((stringp key) (setf sought (uiop:strcat sought key)
                                      skipped 0))
                 ((eq key :rubout) (setf sought (subseq sought 0 (max 0 (1- (length sought))))
                                         skipped 0))
                 ((eq key :control-r) (when (find-history-entry stream sought (1+ skipped))
                                        (incf skipped)))
                 (t (return key)))
           (show-search-result stream sought skipped)))

(define-key *action-keys* (:control-r) (stream)
  "Search the history for a line."
  (let* ((line (drawn-line-of stream))
         (prompt (drawn-line-label line))
         (text (drawn-line-text line))
         (point (drawn-line-point line)))
    (show-search-result stream "" 0)
    (let ((key (read-search-keys stream)))
      (change-typed-line (edited-console stream)
                         (lambda (line) (setf (drawn-line-label line) prompt)))
      (if (member key '(:control-g :control-c))
          (replace-line-text stream text point)
          (handle-key stream key)))))
