;;;; terminal.lisp -- a terminal of 80 x 24 that can be typed into and read.

(in-package :ars-magna.tests)

;;; The terminal is tmux's, through its control mode. Commands go in, one a line, and each is
;;; answered between %begin and %end. All other lines are notices, such as of new output on the
;;; screen. So a step that waits for a text sleeps until the next notice, and only a step that hangs
;;; reaches the limit. Home directory, history and socket are in a directory that is removed
;;; afterwards. The cache is the checkout's, so its core is not built again.

(defparameter *longest-wait* 60 "After how many seconds what is waited for counts as hung.")

(defparameter *terminal-programs* '("tmux")
  "The programs without which a newcomer cannot be played.")

(define-condition newcomer-stuck (error)
  ((fact :initarg :fact)
   (screen :initarg :screen))
  (:report (lambda (condition stream)
             (with-slots (fact screen) condition
               (format stream "~A; the screen shows~%~A" fact screen))))
  (:documentation "Something has not come on the screen."))

(defstruct (terminal (:copier nil))
  "A terminal. ROW is the first row of the latest answer, counted from the first row ever. NEWS-P is
true if there is new output on the screen. HOME is its home directory."
  (client nil :read-only t)
  (home nil :read-only t)
  (row 0 :type integer)
  (news-p nil :type boolean))

(defun missing-program ()
  "Return the name of a program that playing takes and that is not installed, or NIL."
  (find-if-not (lambda (name)
                 (eql 0 (base:run-command "sh" (list "-c" (format nil "command -v ~A" name)))))
               *terminal-programs*))

;;; Starting and stopping.

(defun cache-home ()
  "Return where the caches of this user's programs lie."
  (let ((given (uiop:getenvp "XDG_CACHE_HOME")))
    (if (begins-with-p "/" (or given ""))
        given
        (uiop:strcat (uiop:getenv "HOME") "/.cache"))))

(defun terminal-environment (home)
  "Return the environment of a terminal whose user lives in HOME, a directory's name."
  (list (uiop:strcat "HOME=" home) (uiop:strcat "XDG_CACHE_HOME=" (cache-home))
        (uiop:strcat "PATH=" (uiop:getenv "PATH"))
        "LANG=C.UTF-8" "TERM=screen-256color"
        (uiop:strcat "ENV=" home "shell-settings")))

(defun write-settings (home)
  "Write into the directory HOME the settings of the terminal and of the shell."
  (flet ((write-settings (name control)
           (with-open-file (out (base:native-path (uiop:strcat home name)) :direction :output)
             (format out control))))
    (write-settings "shell-settings" "PS1='$ '~%")
    (write-settings "terminal-settings"
                    "set -g status off~%set -g default-terminal screen-256color~%~
                     set -g history-limit 10000~%set -g escape-time 0~%")))

(defun start-client (home)
  "Start tmux, with a shell in the checkout. Return the process that drives it."
  (write-settings home)
  (sb-ext:run-program
   "tmux" (list "-S" (uiop:strcat home "socket") "-f" (uiop:strcat home "terminal-settings") "-C"
                "new-session" "-x" "80" "-y" "24"
                "-c" (base:native-name (project-file "")) "sh")
   :search t :wait nil :input :stream :output :stream :error nil
   :environment (terminal-environment home) :external-format :utf-8))

(defun stop-terminal (terminal)
  "End TERMINAL and all that runs in it."
  (let ((client (terminal-client terminal)))
    (unwind-protect (when (sb-ext:process-alive-p client)
                      (ignore-errors (tell-terminal terminal "kill-server")))
      (ignore-errors (close (sb-ext:process-input client)))
      (sb-ext:process-wait client)
      (sb-ext:process-close client))))

(defun call-with-terminal (function home)
  "Call FUNCTION with a new terminal whose user lives in the directory HOME."
  (let ((terminal (make-terminal :client (start-client home) :home home)))
    (unwind-protect (progn (next-answer terminal)
                           (tell-terminal terminal "set -g window-size manual")
                           (funcall function terminal))
      (stop-terminal terminal))))

;;; Commands to tmux, and its answers.

(defun next-notice (terminal)
  "Return the next line that tmux writes. Signals an error at its end, and if there is none in
*LONGEST-WAIT* seconds."
  (let ((line (read-line (sb-ext:process-output (terminal-client terminal)))))
    (when (begins-with-p "%output" line) (setf (terminal-news-p terminal) t))
    line))

(defun next-answer (terminal)
  "Return the lines of the next answer of tmux."
  (loop until (begins-with-p "%begin " (next-notice terminal)))
  (loop for line = (next-notice terminal)
        until (begins-with-p "%end " line)
        when (begins-with-p "%error " line)
          do (error "tmux says ~{~A~^ ~}" lines)
        collect line into lines
        finally (return lines)))

(defun tell-terminal (terminal control &rest arguments)
  "Run the tmux command of CONTROL, formatted with ARGUMENTS; return the lines of its answer."
  (let ((in (sb-ext:process-input (terminal-client terminal))))
    (format in "~?~%" control arguments)
    (finish-output in)
    (next-answer terminal)))

;;; The screen.

(defun without-blanks-after (line)
  (string-right-trim " " line))

(defun screen-lines (terminal)
  "Return the lines of the screen, from the top to the last that is not empty."
  (let ((lines (mapcar #'without-blanks-after (tell-terminal terminal "capture-pane -p"))))
    (subseq lines 0 (1+ (or (position "" lines :test #'string/= :from-end t) -1)))))

(defun cursor (terminal)
  "Return how many rows have left the screen, and the column and the row of the cursor on it."
  (with-input-from-string
      (in (first (tell-terminal
                  terminal "display-message -p '#{history_size} #{cursor_x} #{cursor_y}'")))
    (values (read in) (read in) (read in))))

(defun answered-lines (terminal)
  "Return what stands on the screen and above from the row of TERMINAL on, a line being as long as
it was written."
  (mapcar #'without-blanks-after
          (tell-terminal terminal "capture-pane -p -J -S ~D"
                         (- (terminal-row terminal) (cursor terminal)))))

(defun lines-to-cursor (terminal)
  "Return the rows from the row of TERMINAL on to the cursor, the last one up to the cursor only."
  (multiple-value-bind (gone column row) (cursor terminal)
    (let ((first (- (terminal-row terminal) gone)))
      (when (<= first row)
        (let ((lines (tell-terminal terminal "capture-pane -p -S ~D -E ~D" first row)))
          (append (butlast lines)
                  (let ((line (first (last lines))))
                    (list (subseq line 0 (min column (length line)))))))))))

;;; Waiting.

(defun await-news (terminal)
  "Wait until something has been written on the screen, if nothing has of late."
  (loop until (terminal-news-p terminal)
        do (next-notice terminal))
  (setf (terminal-news-p terminal) nil))

(defun await-fact (terminal fact function)
  "Wait until FUNCTION, called with TERMINAL, is true; return its value. Signals NEWCOMER-STUCK,
which says that there is no FACT, a string. A machine that slept longer than the limit is no
sign that something hangs, so the screen is asked once more at the end."
  (flet ((give-up ()
           (error 'newcomer-stuck
                  :fact fact
                  :screen (format nil "~{|~A~%~}with gone rows, column and row ~A, from row ~D"
                                  (screen-lines terminal)
                                  (multiple-value-list (cursor terminal))
                                  (terminal-row terminal)))))
    (or (handler-case
            (host:waiting-at-most (*longest-wait*)
              (loop thereis (funcall function terminal)
                    do (await-news terminal)))
          (host:deadline-passed () (funcall function terminal)))
        (give-up))))

(defun await-text (terminal text)
  "Wait until TEXT stands in what came after the last line that was typed."
  (await-fact terminal (format nil "~S does not come" text)
              (lambda (terminal)
                (some (lambda (line) (search text line)) (answered-lines terminal)))))

(defun prompt-shown (terminal prompts)
  "Return which of PROMPTS stands alone before the cursor, after the last line typed, or NIL."
  (let ((line (first (last (lines-to-cursor terminal)))))
    (and line (find (string-trim " " line) prompts :test #'string=))))

(defun await-prompt (terminal &rest prompts)
  "Wait until one of PROMPTS, strings, is to be answered; return it."
  (await-fact terminal (format nil "~{~A~^ or ~} does not come" prompts)
              (lambda (terminal) (prompt-shown terminal prompts))))

;;; Typing.

(defun bare (text)
  (remove #\Space text))

(defun ends-with-p (end text)
  (let ((start (- (length text) (length end))))
    (and (<= 0 start) (string= end text :start2 start))))

(defun echoed-p (terminal text)
  "True if TEXT, however it is broken into rows, stands before the cursor."
  (ends-with-p (bare text) (bare (format nil "~{~A~}" (lines-to-cursor terminal)))))

(defun quoted-for-tmux (text)
  (format nil "'~A'" (uiop:frob-substrings text '("'") "'\"'\"'")))

(defun type-text (terminal text)
  "Type TEXT, and wait until it stands on the screen."
  (unless (string= text "")
    (tell-terminal terminal "send-keys -l -- ~A" (quoted-for-tmux text))
    (await-fact terminal (format nil "~S is typed, but not seen" text)
                (lambda (terminal) (echoed-p terminal text)))))

(defun press-key (terminal key)
  "Press the KEY that tmux calls so: Enter, Tab, Up, C-c. What is waited for from then on stands,
after Enter and what interrupts, in the rows below."
  (when (member key '("Enter" "C-c" "C-d") :test #'string=)
    (multiple-value-bind (gone column row) (cursor terminal)
      (declare (ignore column))
      (setf (terminal-row terminal) (+ gone row (if (string= key "Enter") 1 0)))))
  (tell-terminal terminal "send-keys ~A" key))

(defun type-line (terminal text)
  (type-text terminal text)
  (press-key terminal "Enter"))

(defun resize-terminal (terminal columns rows)
  "Set the size of the window to COLUMNS and ROWS. Later waits look at the new screen."
  (tell-terminal terminal "resize-window -x ~D -y ~D" columns rows)
  (setf (terminal-row terminal) (cursor terminal)))
