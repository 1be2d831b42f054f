;;;; clim-going-on.lisp -- which run windows continue in after theirs is over, on CLIM's null port.

(in-package :ars-magna.tests)

(in-suite clim)

(defmacro with-window-of ((window robot-name) &body body)
  "Run BODY with WINDOW bound to a window of the live robot ROBOT-NAME that counts as open."
  `(call-with-window (lambda (,window)
                       (let ((window::*windows* (cons ,window window::*windows*))) ,@body))
                     (robot:find-robot ,robot-name)))

(defun let-others-type (window)
  "Let the prompt of WINDOW count as one of another thread than this."
  (setf (window::conversation-thread (window::window-conversation window)) "another"))

(defun shown-in (window)
  "Return the name of the robot that WINDOW shows, and its run."
  (list (window::shown-robot-name window) (window::window-simulation window)))

(test going-on.a-window-goes-where-world-has-led-and-says-so-once
  (in-shed
    (with-window-of (window 'mole)
      (type-here "world hayloft")
      (window::leave-finished-run window "it was left")
      (window::match-window-and-prompt window)
      (is (equal (list 'heifer time:*simulation*) (shown-in window)))
      (is (= 1 (occurrences "HEIFER in HAYLOFT." (said-in window)))))))

(test going-on.the-line-world-is-all-that-tells-of-its-own-window
  (in-shed
    (with-window-of (window 'mole)
      (let ((old time:*simulation*)
            (conversation (window::window-conversation window)))
        (setf (window::conversation-thread conversation) (base:current-thread))
        (type-here "world hayloft")
        (window::switch-to-robot window (robot:find-robot 'heifer))
        (window::follow-prompt nil old time:*simulation*)
        (window::match-window-and-prompt window)
        (is (equal (list 'heifer time:*simulation*) (shown-in window)))
        (is (= 0 (occurrences "HEIFER in HAYLOFT." (said-in window))))))))

(test going-on.a-window-closes-where-another-shows-the-only-robot
  (in-shed
    (with-window-of (left 'mole)
      (let-others-type left)
      (type-here "world hayloft")
      (is (eq 'heifer (window::robot-to-show left)))
      (with-window-of (other 'heifer)
        (is (eq other (window::window-to-show-robot (robot:find-robot 'heifer))))
        (is (null (window::robot-to-show left)))))))

(test going-on.a-window-stays-when-there-is-no-run-to-go-on-in
  "As while a file is loaded anew that defines the map: what starts then is shown there."
  (in-shed
    (with-window-of (window 'mole)
      (let ((old time:*simulation*))
        (run:end-simulation old "enough")
        (window::leave-finished-run window "enough")
        (window::leave-finished-run window "enough")
        (is (equal (list 'mole old) (shown-in window)))
        (is (= 1 (occurrences "The run of MOLE is over: enough." (said-in window))))
        (is (eq window (window::window-to-show-robot (robot:find-robot 'mole))))))))

(test going-on.a-window-is-not-led-out-of-the-trial-of-its-prompt
  (in-shed
    (with-window-of (window 'mole)
      (let ((session (window::window-session window)))
        (is (eq window (window::window-to-show-robot (robot:find-robot 'mole))))
        (setf (cli::session-forks session) 1)
        (is (null (window::window-to-show-robot (robot:find-robot 'mole))))))))

(test going-on.a-second-window-on-a-run-comes-back-to-its-robot
  (in-shed
    (eval '(robot:defrobot vole (woodshed (9 6) 0)))
    (run:simulator 'mole :rate :free :display nil)
    (with-window-of (first 'mole)
      (with-window-of (second 'vole)
        (let-others-type first)
        (setf (window::conversation-thread (window::window-conversation second))
              (base:current-thread))
        (let* ((run time:*simulation*) (fork (run:fork-simulation)) (cli:*prompt-robot* 'vole))
          (run:call-in-fork fork (lambda () (window::follow-prompt nil run fork)))
          (is (equal (list 'vole fork) (shown-in second)))
          (setf (window::watcher-robot (window::window-watcher second)) 'mole)
          (window::follow-prompt nil fork run)
          (is (equal (list 'vole run) (shown-in second)))
          (window::match-window-and-prompt second)
          (is (not (mentions-p (said-in second) "WOODSHED")))
          (is (equal (list 'mole run) (shown-in first))))))))

(test going-on.one-set-of-words-tells-of-windows-that-close
  (in-shed
    (with-window-of (window 'mole)
      (is (mentions-p (window::closing-message window "out of ink")
                      "MOLE has closed: out of ink. The run continues; the line WINDOW"))
      (run:end-simulation time:*simulation* "enough")
      (is (equal "The window of MOLE has closed: out of ink"
                 (window::closing-message window "out of ink"))))))

;;; What was said before there was a window.

(test going-on.a-new-window-tells-what-was-said-of-definitions
  (in-window (window robot)
    (let ((window::*last-preferences* nil) (window::*window-states* '())
          (cli::*definition-messages* (let ((base:*message-queue* (base:make-message-queue)))
                                   (base:warning-set "The poster is inside a wall.")
                                   (base:take-messages))))
      (window::restore-settings window)
      (is (mentions-p (said-in window) "The poster is inside a wall")))))

;;; When something ends the thread of a prompt.

(defun join-prompt (window)
  "Wait until the thread of the prompt of WINDOW has ended, by itself or not."
  (ignore-errors
   (base:join-thread (window::conversation-thread (window::window-conversation window)))))

(test going-on.a-prompt-whose-thread-is-ended-begins-anew
  (in-window (window robot)
    (let ((conversation (window::window-conversation window))
          (simulation (time:current-simulation)))
      (window::start-conversation conversation simulation 'studio-robot)
      (window::run-line-at-prompt conversation "(sb-thread:abort-thread)")
      (join-prompt window)
      (window::restart-prompt-if-lost conversation simulation 'studio-robot)
      (is (mentions-p (said-in window) "A new thread starts"))
      (window::run-line-at-prompt conversation "(* 6 7)")
      (window::run-line-at-prompt conversation "quit")
      (join-prompt window)
      (is (mentions-p (said-in window) "42"))
      (is (not (window::conversation-lost-p conversation))))))
