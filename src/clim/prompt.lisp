;;;; prompt.lisp -- the prompt that each window has, the same as the terminal's.

(in-package :ars-magna.clim)

;;; The prompt runs in a thread, so that the window paints during a long line. The window passes on
;;; the keys that are pressed, as a terminal does; the prompt's editor makes lines of them. Output
;;; goes to the transcript, and the interactor shows the line being typed. So history, Tab,
;;; Control-C, the debugger and questions work as at the terminal.

(defclass window-console (ars-magna.cli:console)
  ((transcript :initarg :transcript :reader console-transcript)
   ;; The last line that was entered.
   (entered :initform "" :accessor console-entered)
   ;; Label, text and cursor position of the input line, as a list, or NIL. Output of other threads
   ;; goes to the transcript and leaves this unchanged, also output that is not flushed.
   (input-line :initform nil :accessor console-input-line))
  (:documentation "A console that writes to a transcript. Another pane shows the input line."))

(defun notify-window (console)
  (funcall (transcript-news (console-transcript console))))

(defmethod ars-magna.cli:erase-typed-line ((console window-console) stream)
  (declare (ignore stream))
  (let* ((line (ars-magna.cli:console-line console))
         (shown (and line (shiftf (ars-magna.cli:drawn-line-shown line) '()))))
    ;; What was written last may have become what stands before the line.
    (when (and shown (string/= "" (first shown)))
      (erase-last-line (console-transcript console) (first shown)))))

(defmethod ars-magna.cli:draw-typed-line ((console window-console) stream)
  (declare (ignore stream))
  (let ((line (ars-magna.cli:console-line console)))
    (when (and line (null (ars-magna.cli:drawn-line-shown line)))
      (let ((shown (list (ars-magna.cli:drawn-line-label line)
                         (ars-magna.cli:drawn-line-text line)
                         (ars-magna.cli:drawn-line-point line))))
        (setf (ars-magna.cli:drawn-line-shown line) shown
              (console-input-line console) shown))
      (notify-window console))))

(defmethod ars-magna.cli:finish-typed-line ((console window-console) stream)
  (let ((line (ars-magna.cli:console-line console)))
    (unless (ars-magna.cli:console-asked-p console)
      (setf (console-entered console) (ars-magna.cli:drawn-line-text line)))
    (setf (console-input-line console) nil)
    (fresh-line stream)
    (write-entered-line (console-transcript console)
                        (format nil "~A~A~%" (ars-magna.cli:drawn-line-label line)
                                (ars-magna.cli:drawn-line-text line)))))

;; The interactor and the strip say so meanwhile.
(defmethod ars-magna.cli:announce-program-input ((console window-console))
  (notify-window console))

;; The transcript breaks its lines itself, again whenever its width changes.
(defmethod ars-magna.cli:fit-to-window (text (console window-console) &optional label)
  (declare (ignore label))
  text)

(defmethod ars-magna.cli:clear-screen ((console window-console) stream)
  (declare (ignore stream))
  (clear-transcript (console-transcript console)))

;;; A prompt at work.

(defstruct (conversation (:constructor make-conversation (session console over)) (:copier nil))
  "The prompt of a window. The function OVER, of no arguments, is called when the user leaves."
  (session nil :read-only t)
  (console nil :type window-console :read-only t)
  (over nil :type function :read-only t)
  (thread nil)
  ;; Its thread was ended from elsewhere, not by its user.
  (lost-p nil :type boolean))

(defun make-window-conversation (transcript size place over)
  "Return a prompt that writes to TRANSCRIPT and starts in the package of this thread. SIZE is a
function that returns the columns and rows of TRANSCRIPT. The function PLACE is called before each
line, and OVER when the user leaves the prompt."
  (let ((console (make-instance 'window-console
                                :transcript transcript :window size
                                :stream (make-instance 'transcript-stream
                                                       :transcript transcript))))
    (make-conversation (ars-magna.cli:make-session
                        :input (ars-magna.cli:make-window-input console) :output console
                        :color :always :place place
                        :package (ars-magna.cli:package-for-new-prompt))
                       console over)))

(defun run-conversation (conversation simulation robot-name)
  "Run lines until the user leaves. Mark CONVERSATION as lost if its thread ends otherwise."
  (let ((lost-p t))
    (unwind-protect
         (progn (ars-magna.cli:run-additional-session (conversation-session conversation)
                                                      simulation robot-name)
                (setf lost-p nil))
      (setf (conversation-lost-p conversation) lost-p)
      (notify-window (conversation-console conversation))))
  (funcall (conversation-over conversation)))

(defun start-conversation (conversation simulation robot-name)
  (setf (conversation-lost-p conversation) nil
        (conversation-thread conversation)
        (start-thread (lambda () (run-conversation conversation simulation robot-name))
                      (format nil "prompt of ~A's window" robot-name))))

;; The window does this, not the thread that ends: when Lisp ends all threads, no new one may begin.
(defun restart-prompt-if-lost (conversation simulation robot-name)
  "Start a new thread for the prompt if a line or a program has ended the old thread."
  (when (conversation-lost-p conversation)
    (write-at-prompt conversation "The thread of this prompt was ended, and its running line with ~
                                   it. A new thread starts.~%")
    (start-conversation conversation simulation robot-name)))

(defun text-in-input-line (conversation)
  "Return the text in the input line of CONVERSATION, not entered yet, or NIL if the line is empty."
  (let ((line (ars-magna.cli:console-line (conversation-console conversation))))
    (and line
         (not (running-line conversation))
         (string/= "" (ars-magna.cli:drawn-line-text line))
         (ars-magna.cli:drawn-line-text line))))

(defun write-at-prompt (conversation &rest arguments)
  (write-to-transcript (console-transcript (conversation-console conversation))
                       (apply #'format nil arguments)))

(defun request-answer-first (conversation what)
  (write-at-prompt conversation "~A: answer the break first, with one of ~A.~%"
                   what (ars-magna.cli:restart-choices-text (conversation-session conversation))))

;; While a break waits for an answer, other lines would be taken for a wrong answer.
(defun line-refused-at-break-p (conversation line)
  "Return true if LINE cannot run because a break waits for an answer at the prompt and LINE is no
answer. Print a message in this case."
  (when (and (ars-magna.cli:restart-choices-text (conversation-session conversation))
             (not (ars-magna.cli:valid-at-any-break-p line)))
    (request-answer-first conversation (string-upcase (string-right-trim " " line)))
    t))

(defun run-line-at-prompt (conversation line)
  "Make the prompt run LINE, a string, as if the user had entered it, but keep the input line."
  (unless (line-refused-at-break-p conversation line)
    (ars-magna.cli:enter-line (conversation-session conversation) line)
    (notify-window (conversation-console conversation))))

(defun pass-key (conversation key)
  (ars-magna.cli:send-key (ars-magna.cli:session-input (conversation-session conversation)) key)
  ;; It is shown even before it is read.
  (notify-window (conversation-console conversation)))

(defun replace-input-line (conversation text)
  (unless (line-refused-at-break-p conversation text)
    (mapc (lambda (key) (pass-key conversation key))
          (list :control-e :control-u text))))

(defun running-line (conversation)
  (and (conversation-thread conversation)
       (ars-magna.cli:running-line-p (conversation-session conversation))
       (console-entered (conversation-console conversation))))

(defun line-awaiting-input (conversation)
  "Return the text of the running line if a program in it waits for typed input, else NIL."
  (let ((console (conversation-console conversation)))
    (and (ars-magna.cli:console-asked-p console) (console-entered console))))

