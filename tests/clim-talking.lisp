;;;; clim-talking.lisp -- typing in the window, on CLIM's null port. See clim.lisp.

(in-package :ars-magna.tests)

(in-suite clim)

(defun talk-in (window &rest lines)
  "Let LINES be entered in WINDOW, and wait until its prompt is over; QUIT is to be the last."
  (apply #'talk-as 'studio-robot window lines))

(defun talk-as (robot window &rest lines)
  "Do what TALK-IN does in WINDOW, which commands ROBOT, the name of one."
  (let ((conversation (window::window-conversation window)))
    (window::start-conversation conversation (time:current-simulation) robot)
    (dolist (line lines) (window::run-line-at-prompt conversation line))
    (base:join-thread (window::conversation-thread conversation))
    (said-in window)))

(test talking.lines-and-answers-are-in-the-transcript
  (in-window (window robot)
    (let ((said (talk-in window "(+ 20 22)" "nonsense" "quit")))
      (dolist (part '("(+ 20 22)" "42" "*ERROR* ->" "quit"))
        (is (mentions-p said part))))))

(test talking.read-and-break-are-answered-in-the-window
  (in-window (window robot)
    (let ((said (talk-in window "(list (read) 2)" "one" "(progn (break \"oh\") 33)" "0" "quit")))
      (dolist (part '("(ONE 2)" "*BREAK* -> oh" "0  continue" "33"))
        (is (mentions-p said part))))))

(defun entries-of (window)
  "Return what the history of the prompt of WINDOW has, newest first."
  (cli::history-entries (cli::edited-history (cli:session-input (window::conversation-session
                                                                 (window::window-conversation
                                                                  window))))))

(test talking.answers-to-breaks-are-not-in-the-history
  (in-window (window robot)
    (talk-in window "(break \"oh\")" "(list 7" "8)" "0" "turn 1" "quit")
    (is (equal (list "quit" "turn 1" (format nil "(list 7~%8)") "(break \"oh\")")
               (subseq (entries-of window) 0 4)))))

(test talking.pasted-lines-are-done-one-after-the-other
  (in-window (window robot)
    (window::pass-key (window::window-conversation window)
                      (list :paste (format nil "Robot> (+ 20 22)~%42~%Robot> (+ 1 1)~%2~%~
                                                Robot> quit")))
    (window::pass-key (window::window-conversation window) :return)
    (is (mentions-p (cli:unpainted-text (talk-in window))
                    (format nil "Robot> (+ 20 22)~%42~%Robot> (+ 1 1)~%2~%Robot> quit")))))

;;; Typing ahead: nobody reads yet.

(defun typed-ahead-of (session)
  "Return how many lines of SESSION wait, what is being typed after them, and where the cursor is."
  (multiple-value-list (cli:type-ahead-state (cli:session-input session))))

(defun typed-ahead-in (window)
  (typed-ahead-of (window::window-session window)))

(defun give-keys (window &rest keys)
  (dolist (key keys) (window::pass-key (window::window-conversation window) key)))

(test ahead.is-seen-and-edited
  (in-window (window robot)
    (give-keys window "t" "u" "rx" :rubout "n" :control-a :right)
    (is (equal '(0 "turn" 1) (typed-ahead-in window)))
    (give-keys window :return "go" :return "größer" :tab :left)
    (is (equal '(2 "größer" 5) (typed-ahead-in window)))
    (give-keys window :up)
    (is (equal '(2 "größer" 5) (typed-ahead-in window)) "what is being typed is not lost")
    (give-keys window :control-e :control-u :up :up :up)
    (is (equal '(2 "turn" 4) (typed-ahead-in window)) "lines are recalled, as at a prompt")
    (give-keys window :down)
    (is (equal '(2 "go" 2) (typed-ahead-in window)))
    (give-keys window :down :rubout)
    (is (equal '(1 "go" 2) (typed-ahead-in window)) "and taken back")
    (give-keys window :control-u (list :paste (format nil "a~%b")) :return)
    (is (equal '(3 "" 0) (typed-ahead-in window)))))

(test ahead.is-read-in-its-order
  (in-window (window robot)
    (give-keys window "(+ 20 22)" :return "(+ 30 33)" :return "qui" "t" :return)
    (is (mentions-p (cli:unpainted-text (talk-in window))
                    (format nil "Robot> (+ 20 22)~%42~%Robot> (+ 30 33)~%63~%Robot> quit")))))

(test ahead.what-waits-is-dropped-into-the-history
  (in-window (window robot)
    (give-keys window "turn 1" :return "turn 2" :return "tur")
    (let ((input (cli:session-input (window::conversation-session
                                     (window::window-conversation window)))))
      (is (= 2 (cli::discard-waiting-lines input)))
      (is (equal '(0 "tur" 3) (typed-ahead-in window)))
      (is (equal (format nil "turn 1~%turn 2") (first (entries-of window))))
      (is (= 0 (cli::discard-waiting-lines input))))))

(test ahead.says-how-many-lines-wait
  (is (equal "Next> " (window::waiting-lines-label 0)))
  (is (mentions-p (window::waiting-lines-label 1) "1 line waits"))
  (is (mentions-p (window::waiting-lines-label 2) "2 lines wait;"))
  (is (mentions-p (cli::dropped-lines-text 1) "1 line that waited was dropped"))
  (is (mentions-p (cli::dropped-lines-text 2) "2 lines that waited were dropped; the up arrow "))
  (is (equal "" (cli::dropped-lines-text 0))))

(test ahead.an-interrupt-says-what-it-drops
  "The line that is ended is one that never does."
  (in-studio (robot)
    (let* ((there (base:make-semaphore "there"))
           (news (base:make-semaphore "news"))
           (transcript (window::make-transcript (lambda () (base:signal-semaphore news))))
           (conversation (window::make-window-conversation transcript (lambda () (values 80 24))
                                                     (constantly nil) (constantly nil))))
      (flet ((give (&rest keys)
               (dolist (key keys) (window::pass-key conversation key)))
             (said-p (part)
               (mentions-p (format nil "~{~A~%~}" (window::latest-lines transcript 50)) part)))
        (setf (symbol-value (intern "*THERE*" :ars-user)) there)
        (give "(progn (ars-magna.base:signal-semaphore *there*) (loop))" :return)
        (window::start-conversation conversation (time:current-simulation) 'studio-robot)
        (is (base:wait-on-semaphore there 20))
        (give "turn 1" :return "quit")
        (is (equal '(1 "quit" 4)
                   (typed-ahead-of (window::conversation-session conversation))))
        (cli:interrupt-session (window::conversation-session conversation))
        (loop until (said-p "Interrupted.") while (base:wait-on-semaphore news 20))
        (is (said-p "Interrupted. 1 line that waited was dropped"))
        (give :return)
        (base:join-thread (window::conversation-thread conversation))
        (is (said-p "quit"))))))

(test talking.the-command-interrupt-ends-the-line-under-way
  "As it is chosen in the menu Run; the prompt goes on."
  (in-window (window robot)
    (let ((there (base:make-semaphore "there")) (conversation (window::window-conversation window)))
      (setf (symbol-value (intern "*THERE*" :ars-user)) there)
      (window::start-conversation conversation (time:current-simulation) 'studio-robot)
      (window::run-line-at-prompt
       conversation "(progn (ars-magna.base:signal-semaphore *there*) (loop))")
      (is (base:wait-on-semaphore there 20))
      (window::com-interrupt)
      ;; What is entered before that is said would be dropped with the line.
      (loop repeat 2000 until (mentions-p (said-in window) "Interrupted.")
            do (base:wait-on-semaphore there 0.01))
      (window::run-line-at-prompt conversation "(+ 20 22)")
      (window::run-line-at-prompt conversation "quit")
      (base:join-thread (window::conversation-thread conversation))
      (is (mentions-p (said-in window) "Interrupted."))
      (is (mentions-p (said-in window) "42")))))

(defun await-in (conversation news test)
  "Wait until TEST is true of CONVERSATION, of which NEWS, a semaphore, tells. Return its value."
  (loop for value = (funcall test conversation)
        until value while (base:wait-on-semaphore news 20)
        finally (return value)))

(test talking.a-program-that-reads-says-so-until-it-is-answered
  (in-window (window robot)
    (let* ((news (base:make-semaphore "news"))
           (transcript (window::make-transcript (lambda () (base:signal-semaphore news))))
           (conversation (window::make-window-conversation transcript (lambda () (values 80 24))
                                                     (constantly nil) (constantly nil))))
      (setf (window::window-conversation window) conversation)
      (window::start-conversation conversation (time:current-simulation) 'studio-robot)
      (is (not (mentions-p (window::run-status-text window) "waits for your answer")))
      (window::run-line-at-prompt conversation "(list (read) 2)")
      (is (equal "(list (read) 2)" (await-in conversation news #'window::line-awaiting-input)))
      (is (mentions-p (note-above window) "(list (read) 2) waits for your answer -- Control-C"))
      (is (mentions-p (window::run-status-text window) "; a program waits for your answer"))
      (is (equal "Answer> " (first (await-in conversation news #'window::shown-input-line))))
      (window::pass-key conversation "half")
      (cli:interrupt-session (window::conversation-session conversation))
      (is (await-in conversation news
                    (lambda (conversation)
                      (declare (ignore conversation))
                      (find-if (lambda (line) (mentions-p line "Interrupted."))
                               (window::latest-lines transcript 20)))))
      (is (null (window::line-awaiting-input conversation)))
      (window::run-line-at-prompt conversation "quit")
      (base:join-thread (window::conversation-thread conversation)))))

(defvar *typed* nil "A semaphore that a line waits for.")

(defun wait-for-typing () (base:wait-on-semaphore *typed* 60))

(test talking.lines-that-were-entered-are-not-replaced-by-what-is-typed-then
  (in-window (window robot)
    (let ((conversation (window::window-conversation window)))
      (setf *typed* (base:make-semaphore "typed"))
      (window::start-conversation conversation (time:current-simulation) 'studio-robot)
      (window::run-line-at-prompt conversation "(ars-magna.tests::wait-for-typing)")
      (window::run-line-at-prompt conversation "(+ 20 2)")
      (window::pass-key conversation "x")
      (window::run-line-at-prompt conversation "(+ 30 3)")
      (base:signal-semaphore *typed*)
      (window::run-line-at-prompt conversation "quit")
      (base:join-thread (window::conversation-thread conversation))
      (let ((said (said-in window)))
        (dolist (answer '("22" "33"))
          (is (mentions-p said (format nil "~%~A~%" answer))))))))

(test talking.each-window-commands-its-own-robot
  "A line that is typed in one window never drives another one's robot."
  (with-own-definitions
    (eval '(world:defmap pair-room (9 9) (rect (0 0) (8 8) bricks 10)))
    (eval '(robot:defrobot castor (pair-room (2.5 2.5) 0)))
    (eval '(robot:defrobot pollux (pair-room (6.5 6.5) 0)))
    (run:call-with-simulation
     (lambda ()
       (destructuring-bind (one other) (run:simulation-robots)
         (call-with-window
          (lambda (first)
            (call-with-window
             (lambda (second)
               (talk-as (robot:robot-name other) second "turn 2" "quit")
               (talk-as (robot:robot-name one) first "turn 1" "quit")
               (run:run-ticks 100)
               (is (near 1 (robot:robot-angle one) 1/2))
               (is (near 2 (robot:robot-angle other) 1/2)))
             other))
          one)))
     '(castor pollux))))

;;; Keys.

(defun press-in (window name char &rest modifiers)
  (let ((pane (pane window 'window::interactor)))
    (clim:handle-event pane (make-instance 'clim:key-press-event
                                           :sheet pane :key-name name :key-character char
                                           :x 0 :y 0
                                           :modifier-state (apply #'logior modifiers)))))

(test talking.control-shift-c-copies-and-interrupts-nothing
  "CLIM tells of the shift key by the capital alone."
  (in-window (window robot)
    (let ((pane (pane window 'window::interactor)))
      (flet ((action (character)
               (window::window-key-action
                (make-instance 'clim:key-press-event
                               :sheet pane :key-name (base:make-keyword (string character))
                               :key-character character :x 0 :y 0
                               :modifier-state clim:+control-key+))))
        (is (eq #'window::copy-text (action #\C)))
        (is (functionp (action #\V)))
        (is (null (action #\c)))))))

(test talking.keys-go-to-the-prompt
  (in-window (window robot)
    (press-in window :|t| #\t)
    (press-in window :up nil)
    (press-in window :|a| #\a clim:+control-key+)
    (press-in window :return #\Return)
    (press-in window :shift-left nil)
    (is (equal (cli::octets-of-key '(:entry "t")) (keys-given window)))))

(test talking.keys-go-to-the-window-that-has-them
  "The null port gives keys to nobody, so this is only about which window has them."
  (in-window (one robot)
    (is (eq one (window::robot-window-of (clim:frame-top-level-sheet one))))
    (is (eq one (window::robot-window-of (pane one 'window::interactor))))
    (is (null (window::robot-window-of nil)))))

(test talking.what-is-pasted-is-not-entered
  (in-window (window robot)
    (window::pass-key (window::window-conversation window) (list :paste (format nil "a~%b")))
    (is (mentions-p (keys-given window) (format nil "a~%b")))
    (is (not (find #\Return (keys-given window))))))

;;; The transcript.

(defun fill-transcript (window count)
  (dotimes (line count)
    (window::write-to-transcript (window::window-transcript window) (format nil "line ~D~%" line)))
  (let ((pane (pane window 'window::transcript)))
    (window::repaint pane)
    pane))

(defun rows-shown (pane)
  "Return the numbers of the lines in view in PANE."
  (mapcar #'window::text-row-number (window::pane-rows pane)))

(defun last-numbers (pane count)
  "Return the numbers of the last COUNT lines in view in PANE, the newest first."
  (subseq (reverse (rows-shown pane)) 0 count))

(test transcript.long-lines-go-on-in-the-next-row
  (is (equal '((0 10) (10 18) (18 26))
             (mapcar (lambda (row) (list (window::text-row-start row) (window::text-row-stop row)))
                     (window::rows-of-line 0 "0123456789abcdefg hi there" 10)))))

(test transcript.long-lines-are-whole
  "An error stays red in all its rows, is copied as one line, and is broken anew with the window."
  (in-window (window robot)
    (let* ((console (window::conversation-console (window::window-conversation window)))
           (text (format nil "*ERROR* -> ~{~A~^ ~}" (loop repeat 60 collect "trouble")))
           (painted (cli::paint text :red)))
      (is (equal painted (cli:fit-to-window painted console)))
      (dolist (columns '(40 80))
        (let ((rows (window::rows-of-line 0 painted columns)))
          (is (< 2 (length rows)))
          (loop for row in rows
                do (is (<= (- (window::text-row-stop row) (window::text-row-start row)) columns))
                   (is (equal '(:red) (mapcar #'second (window::text-row-spans row)))))))
      (window::write-to-transcript (window::window-transcript window) (format nil "~A~%" painted))
      (is (mentions-p (window::selected-text (pane window 'window::transcript)) text)))))

(test transcript.what-is-counted-stands-in-one-line
  (let ((transcript (window::make-transcript (constantly nil))))
    (window::write-to-transcript transcript (format nil "~C1 of 2" #\Return))
    (window::write-to-transcript transcript (format nil "~C2 of 2" #\Return))
    (is (equal '("2 of 2") (window::latest-lines transcript 5)))))

(test transcript.stays-where-one-has-scrolled-to
  (in-window (window robot)
    (let* ((pane (fill-transcript window 100)) (end (rows-shown pane)))
      (window::handle-wheel pane -10 0 0)
      (let ((before (rows-shown pane)))
        (is (= 30 (- (first (last end)) (first (last before)) -1)))
        (fill-transcript window 10)
        (is (equal before (rows-shown pane))))
      (window::handle-wheel pane 1000 0 0)
      (is (null (window::last-line-in-view pane))))))

(test transcript.goes-to-its-end-when-a-line-is-entered
  (in-window (window robot)
    (let ((pane (fill-transcript window 100)))
      (window::handle-wheel pane -10 0 0)
      (window::write-entered-line (window::window-transcript window) (format nil "Robot> status~%"))
      (is (equal (list 101 100 99)
                 (progn (fill-transcript window 0) (last-numbers pane 3)))))))

(test transcript.shows-something-where-one-has-scrolled-to-is-forgotten
  (in-window (window robot)
    (let* ((transcript (window::window-transcript window)) (pane (fill-transcript window 100)))
      (window::handle-wheel pane -1000 0 0)
      (let ((room (length (rows-shown pane))))
        (is (equal (list 0 (1- room)) (list (first (rows-shown pane))
                                            (first (last (rows-shown pane))))))
        (fill-transcript window (* 3 window::+transcript-length+))
        (is (= room (length (rows-shown pane))))
        (window::clear-transcript transcript)
        (fill-transcript window 2)
        (is (= 2 (length (rows-shown pane))))))))

(test transcript.what-is-selected-can-be-copied
  (in-window (window robot)
    (let ((pane (fill-transcript window 20)))
      (is (mentions-p (window::selected-text pane) (format nil "line 1~%line 2")))
      (let ((row (first (window::pane-rows pane))))
        (setf (window::pane-mark pane) (list (1+ (window::text-row-number row)) 4)
              (window::pane-point pane) (list (window::text-row-number row) 2))
        (is (equal (format nil "ne ~D~%line" (1- (window::text-row-number row)))
                   (window::selected-text pane)))))))

;;; Menus.

(test menus.hold-lines-by-their-families
  (flet ((group (name) (window::prompt-menu-title (cli:find-line-command name))))
    (is (equal '("Cameras" "Cameras" "Moving" "Plans" "Prompt" "Hands")
               (mapcar #'group '("OBJ-DESIG" "CAM-TRACK" "TURN" "PLAN" "QUIT" "HAND-GRASP"))))
    (loop for (family) in cli::*line-families*
          do (is (assoc family window::*prompt-menu-titles*) "~A has no menu" family))))

;;; Which robot.

(test window.goes-on-with-the-robot-that-its-prompt-chooses
  (in-window (window robot)
    (let ((cli:*prompt-robot* 'somebody))
      (window::match-window-and-prompt window)
      (is (eq 'somebody (window::watcher-robot (window::window-watcher window))))
      (is (mentions-p (clim:frame-pretty-name window) "SOMEBODY")))))

(test window.has-its-present-title-before-each-line
  "A run that was rewound may have become live since the title was set."
  (in-window (window robot)
    (let ((cli:*prompt-robot* (robot:robot-name robot)))
      ;; The null port has no titles, but the window has.
      (ignore-errors (setf (clim:frame-pretty-name window) "ARS MAGNA: STUDIO-ROBOT, a fork"))
      (is (mentions-p (clim:frame-pretty-name window) "a fork"))
      (window::match-window-and-prompt window)
      (is (equal (window::title-now window) (clim:frame-pretty-name window)))
      (is (not (mentions-p (clim:frame-pretty-name window) "fork"))))))

(test window.says-why-it-closes-when-its-run-is-over
  (let ((reasons '()))
    (in-studio (robot)
      (let ((watcher (window::make-watcher 'studio-robot (constantly nil)
                                          (lambda (reason) (push reason reasons)))))
        (window::watch-simulation watcher (time:current-simulation))
        (window::check-run-over watcher)
        (run:end-simulation (time:current-simulation) "enough")
        (window::check-run-over watcher)
        (is (null reasons))
        (window::check-run-over watcher)
        (is (equal '("enough") reasons))))))
