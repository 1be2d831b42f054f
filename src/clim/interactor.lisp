;;;; interactor.lisp -- the place to type in: the line being typed, and keys that are pressed.

(in-package :ars-magna.clim)

;;; The prompt edits the line (cli/editing); this pane only shows it. While a line runs, a row above
;;; says so; what is typed meanwhile is read after it.

(defclass interactor-pane (display-pane)
  (;; The lines to try that were not clicked yet, :UNKNOWN until the robot is known, and how many
   ;; were clicked.
   (suggestions :initform :unknown :accessor pane-suggestions)
   (tried :initform 0 :accessor pane-tried))
  (:documentation "A pane that shows the input line and receives keys."))

(defun focused-p (pane)
  (eq pane (clim:port-keyboard-input-focus (clim:port pane))))

;;; What is to be seen.

(defun running-line-text (control line)
  "Return a text about the running LINE and how to end it. CONTROL is a format string for LINE."
  (format nil "~@? -- Control-C, or Interrupt in the menu Run, ends it." control (cut line 40)))

(defun waiting-lines-label (count)
  (format nil "~[~:;~:*~D line~:P wait~:*~[~;s~:;~]; Backspace removes the last line. ~]Next> "
          count))

(defun shown-input-line (conversation)
  "Return label, text and cursor position of the input line of CONVERSATION, as a list, or NIL."
  (console-input-line (conversation-console conversation)))

(defun waiting-breaks-text (answers)
  "Return the text above the input line while programs wait for answers. ANSWERS is a list of texts
about the waiting breaks. Return NIL if ANSWERS is empty."
  (when answers
    (format nil "~@[~D more wait~:*~[~;s~:;~]. ~]How to continue? ~A"
            (and (rest answers) (length (rest answers))) (first answers))))

(defun text-above-input (conversation text)
  "Return a list of the note above the input line (or NIL) and its ink. The input line has TEXT."
  (let ((reading (line-awaiting-input conversation))
        (asked (waiting-breaks-text
                (ars-magna.cli:waiting-break-texts (conversation-session conversation))))
        (lines (1+ (count #\Newline text))))
    (cond (reading (list (running-line-text "~A waits for your answer" reading) :red))
          (asked (list asked :red))
          ((= lines 1) (list nil :grey))
          (t (list (format nil "~D lines: Return enters them one after the other; Control-C ~
                                discards them."
                           lines)
                   :grey)))))

(defun interactor-contents (pane)
  "Return what PANE shows, as a list of label, text and cursor position of the input line, the text
above it and its ink. Return NIL if PANE is empty."
  (let* ((conversation (window-conversation (window-of pane)))
         (shown (shown-input-line conversation))
         (busy (running-line conversation)))
    (cond (shown (append shown (text-above-input conversation (second shown))))
          (busy (multiple-value-bind (count text point)
                    (ars-magna.cli:type-ahead-state
                     (ars-magna.cli:session-input (conversation-session conversation)))
                  (list (waiting-lines-label count) text point
                        (running-line-text "Running ~A" busy) :red))))))

;;; Lines to try.

(defun suggestions-wanted (pane)
  "Return the suggestions that PANE shows if there is room: none after the user has entered a line
other than a suggestion."
  (let* ((window (window-of pane)) (robot (window-robot window)))
    (when (and robot (eq :unknown (pane-suggestions pane)))
      (setf (pane-suggestions pane) (suggestions-for (window-snapshot window) robot)))
    (when (> (transcript-entered (window-transcript window)) (pane-tried pane))
      (setf (pane-suggestions pane) '()))
    (if (listp (pane-suggestions pane)) (pane-suggestions pane) '())))

(defun suggestions-in-view (pane)
  "Return those of the suggestions of PANE for which it has room above the input line."
  (let* ((suggestions (suggestions-wanted pane))
         (room (- (nth-value 1 (columns-and-rows pane)) (rows-of-input pane suggestions))))
    (subseq suggestions 0 (clamp room 0 (length suggestions)))))

(defun try-suggestion (pane suggestion)
  (setf (pane-suggestions pane) (remove suggestion (pane-suggestions pane)))
  (incf (pane-tried pane))
  (run-line-at-prompt (window-conversation (window-of pane)) (suggestion-line suggestion)))

(defun suggestion-at (pane y)
  (nth (max 0 (floor (- y 2) +line-height+)) (suggestions-in-view pane)))

(defmethod hover-text ((pane interactor-pane) x y)
  (declare (ignore x))
  (subject-description (suggestion-at pane y)))

(defun needed-rows (pane)
  (let ((suggestions (suggestions-wanted pane)))
    (+ (length suggestions) (rows-of-input pane suggestions))))

(defun note-rows (note suggestions)
  "Return the number of rows between SUGGESTIONS and the input line. Without suggestions, the row
for NOTE is there even if NOTE is NIL, so that the input line does not move."
  (if (or note (null suggestions)) 1 0))

(defun rows-of-input (pane suggestions)
  "Return the number of rows of PANE below SUGGESTIONS: those of the note and of the input line."
  (destructuring-bind (&optional label (text "") (point 0) note &rest ink)
      (interactor-contents pane)
    (declare (ignore ink))
    (+ (note-rows note suggestions)
       (length (ars-magna.cli:visible-rows-of-line (ars-magna.cli:unpainted-text (or label "")) text
                                                   point
                                                   (columns-and-rows pane) 1000)))))

(defmethod pane-appearance ((pane interactor-pane))
  (list (interactor-contents pane) (focused-p pane) (suggestions-in-view pane)
        (multiple-value-list (pane-size pane))))

;;; Painting.

(defun paint-cursor (canvas row column focused-p)
  (draw-rectangle canvas draw-gcontext* (column-x column) (+ 2 (* row +line-height+))
                  (if focused-p 2 (1- +character-width+)) (- +line-height+ 2) focused-p))

(defun paint-input-line (canvas pane label text point top)
  "Paint the input line from row TOP on: LABEL, then TEXT, with the cursor at POINT of TEXT."
  (multiple-value-bind (columns height) (columns-and-rows pane)
    (multiple-value-bind (rows row column)
        (ars-magna.cli:visible-rows-of-line (ars-magna.cli:unpainted-text label) text point
                                            columns (max 1 (- height top)))
      (loop for (string) in rows
            for y from (+ 14 (* top +line-height+)) by +line-height+
            do (paint-glyphs-at-column canvas string 0 y nil))
      (paint-cursor canvas (+ top row) column (focused-p pane)))))

(defun paint-suggestions (canvas pane suggestions)
  "Paint a row for each of SUGGESTIONS. Return the number of rows."
  (loop with label = "Try: "
        with column = (+ 2 (length label)
                         (loop for suggestion in suggestions
                               maximize (length (suggestion-line suggestion))))
        with columns = (columns-and-rows pane)
        for suggestion in suggestions
        for y from 14 by +line-height+
        do (paint-glyphs-at-column canvas label 0 y :grey)
           (paint-glyphs-at-column canvas (suggestion-line suggestion) (length label) y :blue)
           (paint-glyphs-at-column canvas
                                   (cut (suggestion-text suggestion) (max 4 (- columns column)))
                                   column y :grey))
  (length suggestions))

(defmethod paint ((pane interactor-pane))
  (with-pane-canvas (canvas pane)
    (let* ((suggestions (suggestions-in-view pane))
           (top (paint-suggestions canvas pane suggestions)))
      (destructuring-bind (&optional label text point note ink) (interactor-contents pane)
        (when note
          (paint-glyphs-at-column canvas (cut note (max 4 (columns-and-rows pane))) 0
                                  (+ 14 (* top +line-height+)) ink))
        (when label
          (paint-input-line canvas pane label text point (+ top (note-rows note suggestions))))))))

;;; Keys.

(defparameter *editor-keys-by-clim-name*
  '((:return :return) (:kp-enter :return) (:tab :tab) (:backspace :rubout) (:delete :delete)
    (:rubout :delete) (:up :up) (:down :down) (:left :left) (:right :right)
    (:home :home) (:end :end))
  "Lists (name key): the name of a key in CLIM, and its name in the prompt's line editor.")

(defun modifier-pressed-p (event modifier)
  (logtest modifier (clim:event-modifier-state event)))

(defun editor-key-named (name control-p meta-p)
  (let ((key (second (assoc name *editor-keys-by-clim-name*))))
    (case key
      (:left (if (or control-p meta-p) :meta-b key))
      (:right (if (or control-p meta-p) :meta-f key))
      (:rubout (if (or control-p meta-p) :meta-rubout key))
      (t key))))

(defun prefixed-key (prefix char)
  (make-keyword (format nil "~A-~:@(~C~)" prefix char)))

(defun editor-key-of-event (event)
  (let ((char (clim:keyboard-event-character event))
        (control-p (modifier-pressed-p event clim:+control-key+))
        (meta-p (modifier-pressed-p event clim:+meta-key+)))
    (cond ((editor-key-named (clim:keyboard-event-key-name event) control-p meta-p))
          ((or (null char) (not (graphic-char-p char))) nil)
          (control-p (and (alpha-char-p char) (prefixed-key "CONTROL" char)))
          (meta-p (prefixed-key "META" char))
          (t (string char)))))

;;; The window handles copy, paste and scrolling back itself.

(defun copy-text (window)
  "Copy the text selected in the transcript of WINDOW, or the whole transcript if none is selected."
  (let ((pane (pane-named window 'transcript)))
    (offer-text (clim:port pane) (selected-text pane) '(:clipboard :primary))
    (unless (selection-bounds pane)
      (show-hint window "Nothing was selected, so all text of the commands has been copied."))))

(defun paste-text (window selection)
  "Paste the text of SELECTION, :PRIMARY or :CLIPBOARD, into the input line of WINDOW."
  (let ((text (fetch-text (clim:port (pane-named window 'interactor)) selection)))
    (unless (member text '(nil "") :test #'equal)
      (pass-key (window-conversation window) (list :paste text)))))

(defun window-key-action (event)
  (let* ((name (clim:keyboard-event-key-name event))
         (typed (clim:keyboard-event-character event))
         ;; CLIM reports shift only by the capital letter.
         (shift-p (or (modifier-pressed-p event clim:+shift-key+) (and typed (upper-case-p typed))))
         (control-p (modifier-pressed-p event clim:+control-key+)))
    (flet ((is-p (char) (and typed (char= char (char-downcase typed)))))
      (cond ((and control-p shift-p (is-p #\c)) #'copy-text)
            ((and control-p (is-p #\v)) (lambda (window) (paste-text window :clipboard)))
            ((and shift-p (eq name :insert)) (lambda (window) (paste-text window :primary)))
            ((eq name :escape) #'close-by-escape)
            ((eq name :f10) #'toggle-first-menu)
            ((eq name :prior) (lambda (window) (scroll-page (pane-named window 'transcript) -1)))
            ((eq name :next) (lambda (window) (scroll-page (pane-named window 'transcript) 1)))))))

(defun pass-key-to-prompt (window key)
  "Pass KEY to the prompt of WINDOW. The key Control-C also ends the running line."
  (if (eq key :control-c)
      (ars-magna.cli:interrupt-session (window-session window))
      (pass-key (window-conversation window) key)))

(defun input-line-empty-p (window)
  (string= "" (or (second (interactor-contents (pane-named window 'interactor))) "")))

(defun handle-key-in-input-line (window event)
  "Handle the key of EVENT for the input line of WINDOW. Return true if the key has an effect."
  (let ((action (window-key-action event)) (key (editor-key-of-event event))
        (name (key-name-of-event event)))
    (cond ((handle-key-in-popup window name) t)
          ((and (member name '(:tab :iso-left-tab)) (input-line-empty-p window))
           (move-keys window (if (eq name :tab) 1 -1))
           t)
          (action (funcall action window) t)
          (key (pass-key-to-prompt window key) t))))

;;; CLIM has one place for the keys of all windows; they must go to the window that has the focus.

(defun robot-window-of (sheet)
  (let ((frame (and (typep sheet '(or clim:pane clime:top-level-sheet-mixin))
                    (clim:pane-frame sheet))))
    (and (typep frame 'robot-window) frame)))

;;; The events say which window that is, in their order, in the thread that reads them. A window's
;;; own thread may get to them late, so it only says which of its panes gets the keys.

(defun focused-window (port)
  (let ((sheet (clim:port-keyboard-input-focus port)))
    (and sheet (robot-window-of sheet))))

(defun focus-window-of-event (port event)
  "Direct the keys of PORT to the window of EVENT, if that window shows a robot."
  (let ((window (robot-window-of (clim:event-sheet event))) (before (focused-window port)))
    (unless (member window (list before nil))
      (setf (clim:port-keyboard-input-focus port)
            (or (window-focus window) (clim:frame-top-level-sheet window)))
      ;; The cursor says where keys go.
      (when before (request-refresh before))
      (request-refresh window))))

(defmethod clim:distribute-event :before ((port clim:basic-port) (event clim:event))
  (when (typep event '(or clim:keyboard-event clim:pointer-button-press-event
                       clime:window-manager-focus-event))
    (focus-window-of-event port event)))

(defmethod clim:handle-event :around ((sheet clime:top-level-sheet-mixin)
                                      (event clime:window-manager-focus-event))
  (unless (robot-window-of sheet) (call-next-method)))

(defun focus-on (pane)
  (let* ((window (window-of pane)) (port (clim:port pane))
         (before (shiftf (window-focus window) pane)))
    (unless (member before (list pane nil))
      (setf (pane-chosen before) nil)
      (request-refresh window))
    (when (member (focused-window port) (list window nil))
      (setf (clim:port-keyboard-input-focus port) pane))))

(defun focus-and-repaint (pane)
  (focus-on pane)
  (repaint-if-changed pane))

(defmethod handle-click ((pane interactor-pane) button x y)
  (declare (ignore x))
  (focus-and-repaint pane)
  (when (and (eq button :left) (suggestion-at pane y))
    (try-suggestion pane (suggestion-at pane y)))
  (when (eq button :middle)
    (with-guarded-command ((window-of pane) "Pasting") (paste-text (window-of pane) :primary))))

(defmethod handle-wheel ((pane interactor-pane) steps x y)
  (handle-wheel (pane-named (window-of pane) 'transcript) steps x y))

(defmethod handle-click :after ((pane transcript-pane) button x y)
  (handle-click (pane-named (window-of pane) 'interactor) button x y))
