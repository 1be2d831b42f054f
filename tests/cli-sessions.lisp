;;;; cli-sessions.lisp -- several prompts side by side, as windows have them; needs no window.

(in-package :ars-magna.tests)

(def-suite* cli-sessions :in ars-magna)

;;; A talk is a prompt in a thread of its own that receives keys. It signals before and after it
;;; reads a line, so tests that wait need no clock.

(defclass mute-console (cli:console) ()
  (:documentation "A console that does not show the line that is being typed."))

(defmethod cli:erase-typed-line ((console mute-console) stream)
  (declare (ignore stream)))

(defmethod cli:draw-typed-line ((console mute-console) stream)
  (declare (ignore stream)))

(defmethod cli:finish-typed-line ((console mute-console) stream)
  (declare (ignore stream)))

(defstruct talk session thread (turns (base:make-semaphore "turns")) output)

(defvar *entered* '() "What the lines of talks have pushed, newest first.")
(defvar *gate* nil "What talks and those who test them have in common.")

(defun begin-talk (robot)
  (let* ((output (make-string-output-stream))
         (console (make-instance 'mute-console :stream output :window (lambda () (values 80 24))))
         (talk (make-talk :output output))
         (simulation (run:robot-simulation robot))
         (turn (lambda () (base:signal-semaphore (talk-turns talk))))
         (session (cli:make-session :input (cli:make-window-input console) :output console
                                    :place turn)))
    (setf (talk-session talk) session
          (talk-thread talk)
          (base:start-thread (lambda ()
                               (cli:run-additional-session session simulation
                                                           (robot:robot-name robot))
                               (funcall turn))
                             "talk"))
    ;; When a line has been done, it listens.
    (enter talk "; nothing")
    (await-turns talk 3)
    talk))

(defun await-turns (talk count)
  (loop repeat count
        always (base:wait-on-semaphore (talk-turns talk) 20)))

(defun enter (talk &rest lines)
  (dolist (line lines) (cli:enter-line (talk-session talk) line)))

(defun type-keys (talk &rest keys)
  (dolist (key keys) (cli:send-key (cli:session-input (talk-session talk)) key)))

(defun end-talk (talk)
  (cli:end-session (talk-session talk))
  (base:join-thread (talk-thread talk)))

(defun told-to (talk)
  "Return what TALK has said since this was asked last, while nobody goes on writing there."
  (let ((text ""))
    (cli::with-console (output (cli::session-console (talk-session talk)))
      (setf text (get-output-stream-string output)))
    text))

(defmacro in-talk ((talk) &body body)
  "Run BODY with TALK bound to a prompt of the studio's robot."
  `(in-studio (robot)
     (let ((,talk (begin-talk robot)))
       ;; Its thread sees the global value.
       (setf (base:global-value '*entered*) '())
       (unwind-protect (progn ,@body)
         (end-talk ,talk)))))

(defun entered () (reverse (base:global-value '*entered*)))

(defun pushing (value)
  (format nil "(push ~A ars-magna.tests::*entered*)" value))

;;; What is entered.

(test sessions.what-has-been-entered-is-done-and-nothing-else
  "Also what is entered while a line is under way, in the order in which it was."
  (in-talk (talk)
    (let ((gate (base:make-semaphore "gate")))
      (setf (base:global-value '*gate*) gate)
      (enter talk "(ars-magna.base:wait-on-semaphore ars-magna.tests::*gate*)" (pushing 1)
             (pushing 2))
      (type-keys talk (pushing 3))
      (base:signal-semaphore gate)
      (is-true (await-turns talk 6))
      (is (equal '(1 2) (entered)))
      (end-talk talk)
      (is (equal '(1 2) (entered))))))

(test sessions.a-line-chosen-elsewhere-leaves-what-is-being-typed
  (in-talk (talk)
    (type-keys talk "(push 7 ars-magna.tests::*en")
    (enter talk (pushing 1))
    (type-keys talk "tered*)" :return)
    (is-true (await-turns talk 4))
    (is (equal '(1 7) (entered)))))

(test sessions.keys-edit-as-at-the-terminal
  (in-talk (talk)
    (type-keys talk (pushing 1) :return :up :return)
    (is-true (await-turns talk 4))
    (type-keys talk "nonsense" :control-a :control-k (pushing 4) :return)
    (is-true (await-turns talk 2))
    (is (equal '(1 1 4) (entered)))))

;;; What blocks.

(test sessions.read-reads-what-is-typed-there
  (in-talk (talk)
    (enter talk (pushing "(read)") "(a 2)")
    (is-true (await-turns talk 2))
    (is (equal '("A" 2) (cons (string (first (first (entered)))) (rest (first (entered))))))))

(test sessions.an-interrupt-ends-the-line-and-nothing-else
  (in-talk (talk)
    (setf (base:global-value '*gate*) (base:make-semaphore "started"))
    (enter talk "(progn (ars-magna.base:signal-semaphore ars-magna.tests::*gate*) (loop))")
    (is-true (base:wait-on-semaphore *gate* 20))
    (is-true (cli:running-line-p (talk-session talk)))
    (cli:interrupt-session (talk-session talk))
    (is-true (await-turns talk 2))
    (is (mentions-p (told-to talk) "Interrupted."))
    (enter talk (pushing 5))
    (is-true (await-turns talk 2))
    (is (equal '(5) (entered)))))

(test sessions.break-asks-there-how-to-go-on
  (in-talk (talk)
    (enter talk (format nil "(progn (break \"oh\") ~A)" (pushing 3)) "0")
    (is-true (await-turns talk 2))
    (is (equal '(3) (entered)))
    (let ((written (told-to talk)))
      (dolist (part '("*BREAK* -> oh" "0  continue"))
        (is (mentions-p written part))))))

(defun await-break (talk)
  (awaiting (cli::session-other-breaks (talk-session talk))))

(test sessions.a-simulator-that-breaks-asks-those-who-watch-it
  (in-studio (robot)
    (let ((talk (begin-talk robot)) (simulation (time:current-simulation))
          (went-on (base:make-semaphore "went on")))
      (unwind-protect
           (progn
             (run:start-clock simulation)
             (command:robot-turn robot 1 (lambda (&rest results)
                                           (declare (ignore results))
                                           (break "stuck")
                                           (base:signal-semaphore went-on)))
             (await-break talk)
             (enter talk "0")
             (is-true (base:wait-on-semaphore went-on 20))
             (is (mentions-p (told-to talk) "*BREAK* -> stuck")))
        (end-talk talk)
        (run:stop-clock simulation)))))

(defclass waiting-front-end ()
  ((function :initarg :function :reader waiting-function))
  (:documentation "One that calls a function while a thread waits."))

(defmethod base:serve-while-waiting ((front-end waiting-front-end))
  (funcall (waiting-function front-end)))

(test sessions.waiting-for-ticks-ends-when-the-clock-stops
  "As when a break is answered so while the line STEP waits."
  (in-studio (robot)
    (let* ((simulation (time:current-simulation)) (calls 0)
           (base:*front-end* (make-instance 'waiting-front-end
                                            :function (lambda ()
                                                        (case (incf calls)
                                                          (1 (run:stop-clock simulation))
                                                          (9 (error "It waits for ever.")))))))
      (run:start-clock simulation :paused-p t)
      (is (null (cli::await-test-live (constantly nil) simulation))))))

(defun await-debugging (talk)
  "Wait until the user of TALK is asked how a line goes on: before that, to end the session ends the
line."
  (let ((session (talk-session talk)))
    (awaiting (and (cli::break-state-own (cli::session-break-state session))
                   (cli::reading-line-p (cli::session-input session))))))

(test sessions.break-of-one-that-is-lost-is-answered-in-another
  "As when the X server dies under a window."
  (in-studio (robot)
    (let ((lost (begin-talk robot)) (other (begin-talk robot)))
      (setf (base:global-value '*entered*) '())
      (unwind-protect
           (progn
             (enter lost (format nil "(progn (break \"oh\") ~A)" (pushing 3)))
             (await-debugging lost)
             (is-false (cli:answerable-by-others-p (talk-session lost)))
             (cli:abandon-session (talk-session lost))
             (is-true (cli:answerable-by-others-p (talk-session lost)))
             (cli:end-session (talk-session lost))
             (await-break other)
             (enter other "0")
             (base:join-thread (talk-thread lost))
             (is (equal '(3) (base:global-value '*entered*)))
             (is (mentions-p (told-to other) "*BREAK* -> oh")))
        (end-talk other)))))

(define-condition dying-window (condition)
  ((end :initarg :end :reader end-of-window))
  (:report (lambda (condition stream)
             (funcall (end-of-window condition))
             (write-string "oh" stream)))
  (:documentation "What breaks just when the window dies: when its user is about to be told."))

(defvar *dying* nil "What breaks in a line.")

(test sessions.break-in-the-instant-of-a-loss-is-answered-in-another
  (in-studio (robot)
    (let* ((lost (begin-talk robot)) (other (begin-talk robot)) (ended-p nil))
      (setf (base:global-value '*entered*) '()
            (base:global-value '*dying*)
            (make-condition 'dying-window
                            :end (lambda ()
                                   (unless (shiftf ended-p t)
                                     (cli:abandon-session (talk-session lost))
                                     (cli:end-session (talk-session lost))))))
      (unwind-protect
           (progn
             (enter lost (format nil "(progn (restart-case (invoke-debugger~%
                                                ars-magna.tests::*dying*)
                                              (continue ())) ~A)" (pushing 3)))
             (await-break other)
             (enter other "continue")
             (base:join-thread (talk-thread lost))
             (is (equal '(3) (base:global-value '*entered*)))
             (is (mentions-p (told-to other) "*BREAK* -> oh")))
        (end-talk other)))))

(test sessions.that-begin-know-how-often-an-error-has-come-up
  (in-talk (talk)
    (setf (gethash "jammed" (cli::session-error-counts (talk-session talk)))
          (cli::make-tally :count 42))
    (let ((new (cli:make-session :input (make-string-input-stream "")
                                 :output (make-broadcast-stream))))
      (cli::listen-to new (time:current-simulation))
      (cli::stop-listening new)
      (is (eql 42 (cli::tally-count (gethash "jammed" (cli::session-error-counts new))))))))

(test sessions.closing-one-carries-out-nothing
  (in-talk (talk)
    (type-keys talk (pushing 9))
    (end-talk talk)
    (is (null (entered)))))

;;; Side by side.

(test sessions.each-commands-its-own-robot
  (in-studio (first)
    (let ((one (begin-talk first)))
      (unwind-protect
           (in-studio (second)
             (let ((two (begin-talk second)))
               (unwind-protect
                    (flet ((says-which (talk)
                             (enter talk "(eq (ars-magna.cli:session-robot)
                                              ars-magna.tests::*gate*)")
                             (await-turns talk 2)
                             (told-to talk)))
                      (setf (base:global-value '*gate*) first)
                      (is (mentions-p (says-which one) "T"))
                      (is (mentions-p (says-which two) "NIL")))
                 (end-talk two))))
        (end-talk one)))))

(test sessions.all-that-listen-are-told
  (in-studio (robot)
    (let ((one (begin-talk robot)) (two (begin-talk robot)))
      (unwind-protect
           (progn
             (base:error-set "a shelf has fallen")
             (enter one (pushing 1))
             (is-true (await-turns one 2))
             (is (mentions-p (told-to one) "a shelf has fallen"))
             (is (mentions-p (told-to two) "a shelf has fallen")))
        (end-talk one)
        (end-talk two)))))

(defvar *late-session* nil "The session of a prompt that is over.")

(test sessions.that-are-over-write-to-no-stream-of-their-users
  "Another thread may still want to: what is left to say stays for others. A stream of
WITH-OUTPUT-TO-STRING is gone by then."
  (in-studio (robot)
    (let ((stream (make-string-output-stream)))
      (cli:prompt :input (make-string-input-stream
                          (format nil "(setf ars-magna.tests::*late-session* ~
                                       ars-magna.cli::*session*)~%quit~%"))
                  :output stream)
      (get-output-stream-string stream)
      (let ((session (shiftf *late-session* nil)))
        (base:message-set "still said")
        (cli::show-messages session)
        (format (cli::session-console session) "late")
        (finish-output (cli::session-console session))
        (is (string= "" (get-output-stream-string stream)))
        (is (find "still said" (base:take-messages) :key #'base:message-text :test #'search))))))

(test sessions.are-told-of-their-own-runs-only
  "Also where several runs share a queue, as live ones do."
  (in-studio (first)
    (let ((queue base:*message-queue*) (one (begin-talk first)) (run time:*simulation*))
      (unwind-protect
           (in-studio (second)
             (setf (run:simulation-messages time:*simulation*) queue)
             (let ((two (begin-talk second)) (base:*message-queue* queue))
               (unwind-protect
                    (progn
                      (let ((time:*simulation* run)) (base:error-set "the first has news"))
                      (base:error-set "so has the second")
                      (let ((first-told (told-to one)) (second-told (told-to two)))
                        (is (mentions-p first-told "the first has news"))
                        (is (not (search "so has" first-told)))
                        (is (mentions-p second-told "so has the second"))
                        (is (not (search "the first" second-told)))))
                 (end-talk two))))
        (end-talk one)))))

;;; Keys.

(defun reader-of (octets)
  (let ((octets (coerce octets 'list)))
    (lambda (&optional octet)
      (if octet (progn (push octet octets) nil) (pop octets)))))

(test keys.are-handed-over-as-a-terminal-does
  (dolist (key '(:up :down :left :right :home :end :delete :rubout :return :tab :control-a
                 :control-c :control-k :meta-f :meta-rubout "x" "é" (:paste "turn")
                 (:entry "go 1")))
    (is (equal key (cli::read-key (reader-of (cli::octets-of-key key)))))))

(test painted-spans.are-what-was-painted
  (is (equal '(("a " nil) ("red" :red) (" b" nil))
             (cli:painted-spans (format nil "a ~A b" (cli::paint "red" :red)))))
  (is (equal '() (cli:painted-spans ""))))

;;; Windows.

(test window.robot-has-to-be-in-a-run-that-lives
  (in-studio (robot)
    (is (eq robot (cli::find-running-robot 'studio-robot)))))

(test window.needs-a-run-that-lives
  (signals cli::usage-error
    (cli::check-window-option (cli::parse-options '("--window" "--batch"))))
  (is (null (cli::check-window-option (cli::parse-options '("--world" "hall"))))))
