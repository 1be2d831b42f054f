;;;; map-lines.lisp -- MAP: the world as characters; WATCH: the same while time passes.

(in-package :ars-magna.cli)

;;; On a terminal a map is made to fit, and has colours; elsewhere it shows the whole world.

(defun terminal-size (session)
  "Return the numbers of columns and lines of SESSION's terminal; 80 and NIL without a terminal."
  (flet ((size-said (variable)
           (ignore-errors (parse-integer (environment-value variable)))))
    (multiple-value-bind (columns lines)
        (if (session-terminal-p session) (size-of-window session) (values 80 nil))
      (values (or (size-said "COLUMNS") columns)
              (and lines (or (size-said "LINES") lines))))))

;;; Which part, and which layers.

(defun words-for-map-line ()
  "Return the words that MAP accepts: LEGEND, and the names that MAP and PICTURE have for layers."
  (mapcar #'symbol-name
          (append (text-layers) '(:legend) (mapcar #'picture-layer-name (text-layers)))))

(defun keyword-for-word (text words line takes)
  "Return the first of WORDS that begins with TEXT, as a keyword. TEXT was typed after LINE. Signals
BAD-LINE if there is none. TAKES, a format control for WORDS, tells what LINE accepts."
  (let ((word (find-if (lambda (word) (starts-with-subseq (string-upcase text) word)) words)))
    (unless word
      (reject-line "~A does not take ~A.~@[ Did you mean ~A?~] It takes ~?." line text
                   (nearest-name text words) takes (list words)))
    (make-keyword word)))

(defun parse-typed-number (text)
  (let ((datum (ignore-errors (values (read-data-from-string text 0)))))
    (and (realp datum) (integer-if-whole datum))))

(defun map-region-options (numbers)
  "Return the options of TEXT-MAP for NUMBERS, a typed radius or region or an empty list."
  (case (length numbers)
    (0 '())
    (1 (unless (whole-p (first numbers))
         (reject-line "The radius cannot be ~A. Give a whole number of cells, from 0 to 1e9."
                      (first numbers)))
     (list :radius (first numbers)))
    (4 (destructuring-bind (left top right bottom) numbers
         (unless (and (< left right) (< top bottom) (every #'finite-p numbers))
           (reject-line "~{~A~^ ~} is not a region. Give LEFT TOP RIGHT BOTTOM in metres, such as ~
                         MAP 0 0 40 20."
                        numbers)))
     (list :region numbers))
    (t (reject-line "MAP takes one number, a radius, or four, LEFT TOP RIGHT BOTTOM; not ~
                     ~{~A~^ ~}."
                    numbers))))

(defun map-options (text)
  "Return the options of TEXT-MAP for TEXT, the words typed after MAP."
  (loop with takes = "a radius, or LEFT TOP RIGHT BOTTOM, and ~{~A~#[~; or ~:;, ~]~}"
        for word in (split-words (or text ""))
        for number = (parse-typed-number word)
        if number collect number into numbers
        else collect (text-layer-name (keyword-for-word word (words-for-map-line) "MAP" takes))
               into words
        finally (return (append (map-region-options numbers)
                                (list :layers (remove :legend words)
                                      :only-legend (and (member :legend words) t))))))

(defun map-text (session options &optional (lines-below 1))
  "Return the map as text, for OPTIONS of TEXT-MAP. The map fits the terminal of SESSION and leaves
LINES-BELOW lines free."
  (let ((robot (session-robot))
        (console (session-console session)))
    (multiple-value-bind (columns lines) (terminal-size session)
      (with-output-to-string (*standard-output*)
        (with-time-stopped (write-string (apply #'text-map robot
                                                :columns (max 20 (1- columns))
                                                :rows (and lines (max 5 (- lines lines-below)))
                                                :paint (and (console-colored-p console) #'paint)
                                                options)))))))

(define-argument-choices :map-words (mapcar #'string-downcase (words-for-map-line)))

(define-line "MAP" (session (what :map-words
                                  "a radius or LEFT TOP RIGHT BOTTOM; names of layers; LEGEND"
                                  :optional))
    (:seeing
     (format nil "Layers shown if you name them: ~:{~A (~(~A~))~:^, ~}."
             (loop for name in (text-layers)
                   collect (list name (layer-title (picture-layer-name name))))))
    "Show the world as characters: all of it, a radius around the robot, or a region.
LEGEND shows only what the characters mean. The names of layers for PICTURE can be used, too."
  (write-string (map-text session (map-options what))))

;;; WATCH.

;;; On a terminal each map replaces the one before, and a key ends WATCH. Messages that arrive
;;; meanwhile are shown afterwards, their last line at once. Elsewhere, maps follow one another.

(defconstant +shortest-frame-seconds+ 0.1d0
  "The shortest time for which a map is shown, in seconds.")
(defconstant +default-watch-rate+ 20
  "The ticks per second that WATCH shows in a run without a rate.")

(defun time-passes-p (session simulation)
  (and (live-p simulation)
       (null (session-trial session))
       (not (paused-p simulation))))

(defun idle-in-session-p (session simulation)
  "True if SIMULATION, the run of SESSION, passes no ticks until a command or change is requested."
  (and (time-passes-p session simulation) (idle-p simulation)))

(defun pass-or-await-tick (session simulation)
  "Pass a tick of SIMULATION; if its clock runs, wait until a tick has passed or the run is idle."
  (let ((goal (1+ (simulation-tick simulation))))
    (unless (time-passes-p session simulation) (step-ticks 1 simulation))
    (await-test (lambda ()
                  (or (>= (simulation-tick simulation) goal)
                      (idle-in-session-p session simulation))))))

;;; One after the other.

(defun print-maps (session simulation count options)
  (loop repeat count
        until (or (simulation-over simulation) (idle-in-session-p session simulation))
        do (pass-or-await-tick session simulation)
           (format t "Tick ~D.~%~A" (simulation-tick simulation) (map-text session options))
           (finish-output))
  (when (idle-in-session-p session simulation)
    (format t "~A~%" (time-description session simulation))))

;;; In place.

(defun can-redraw-in-place-p (session)
  (and (can-poll-input-p session)
       (terminal-stream-p (session-input session))
       (not (session-batch-p session))
       (console-edited-p (session-console session))))

(defun watch-screen-text (session simulation options)
  "Return the text for the screen: the map, and below the map the time and the last message."
  (let ((columns (1- (terminal-size session)))
        (said (last-held-back-line (session-console session))))
    (format nil "~A~A A key ends WATCH.~%~A" (map-text session options 2)
            (time-description session simulation)
            (subseq said 0 (min columns (length said))))))

(defun seconds-between-maps (session simulation)
  (let ((rate (simulation-rate simulation)))
    (if (time-passes-p session simulation)
        +shortest-frame-seconds+
        (/ 1d0 (if (and (realp rate) (plusp rate)) rate +default-watch-rate+)))))

(defun watch-until-key (session simulation count options)
  "Show maps of SIMULATION in place until a key is pressed, a program breaks or the run is over.
With COUNT, stop also after COUNT ticks or when the run is idle; without COUNT, when a line was
typed. Return true if a key was pressed."
  (loop with end = (and count (+ (simulation-tick simulation) count))
        with console = (session-console session)
        do (write-immediately (overwrite-screen-code (watch-screen-text session simulation options))
                              console)
        until (or (if end
                      (or (>= (simulation-tick simulation) end)
                          (idle-in-session-p session simulation))
                      (typed-ahead-p (session-input session)))
                  (simulation-over simulation)
                  (session-other-breaks session))
        do (when (octets-within-p (source-stream (session-input session))
                                  (seconds-between-maps session simulation))
             (return t))
           (unless (time-passes-p session simulation) (pass-or-await-tick session simulation))))

(defun watch-in-place (session simulation count options)
  ;; The key that has ended it does not begin a line.
  (when (handler-case (call-with-screen
                       (lambda () (watch-until-key session simulation count options))
                       (session-console session))
          (user-interrupt () nil))
    (discard-next-key (session-input session)))
  (format t "~A~%" (time-description session simulation)))

;;; The line.

(defun split-off-count (text)
  "Return the number at the beginning of TEXT, or NIL, and the rest of TEXT."
  (let* ((words (split-words (or text "")))
         (count (and words (parse-typed-number (first words)))))
    (when (and count (not (whole-p count 1)))
      (reject-line "WATCH cannot show ~A ticks. Give a whole number, from 1 to 1e9." count))
    (values count (format nil "~{~A~^ ~}" (if count (rest words) words)))))

(defun check-watchable (session simulation count)
  "Signal BAD-LINE if WATCH would show nothing or would never end."
  (cond ((session-trial session)
         (reject-line "In a trial, time passes between lines only. Use STEP and MAP to see each ~
                       tick."))
        (count)
        ((not (can-redraw-in-place-p session))
         (reject-line "No key can end WATCH here. WATCH n shows n ticks."))
        ((not (time-passes-p session simulation))
         (reject-line "Time stands still here. WATCH n lets n ticks pass.~@[ RESUME ~
                       continues.~]"
                      (live-p simulation)))))

(define-line "WATCH" (session (what :map-words "how many ticks, then what MAP takes" :optional))
    (:seeing)
    "Show the map after each tick, in place on a terminal. WATCH 20 shows 20 ticks; WATCH ends when
nothing happens any more, at a key or at Control-C. After the number, give the words that MAP takes.
Where time stands still, WATCH 20 lets 20 ticks pass. Lines pasted meanwhile are read afterwards; if
no number was given, they end WATCH."
  (check-run-not-over)
  (multiple-value-bind (count rest) (split-off-count what)
    (let ((simulation (current-simulation)) (options (map-options rest)))
      (check-watchable session simulation count)
      (if (can-redraw-in-place-p session)
          (watch-in-place session simulation count options)
          (print-maps session simulation count options)))))
