;;;; clim-x-server.lisp -- the window on an X server of the tests' own. See clim.lisp.

(in-package :ars-magna.tests)

(in-suite clim)

;;; The server is Xvfb, which has no visible screen. The tests read its screen as a second client.
;;; They wait by calling functions in the window's thread, and poll only for the server's start.

(defvar *x-screen* "1300x900x24" "Width, height and depth of the X server's screen.")
(defvar *x-options* '() "More options of the X server.")
(defvar *x-resources* (format nil "*color: red~%Xft.dpi:~C96~%" #\Tab)
  "The X resources of the screen, as a desktop sets them.")

(defun set-x-resources (display-number)
  (let ((display (xlib:open-display "" :display display-number)))
    (xlib:change-property (xlib:screen-root (xlib:display-default-screen display))
                          :resource_manager (map 'list #'char-code *x-resources*) :string 8)
    (xlib:display-finish-output display)
    (xlib:close-display display)))

(defun start-x-server ()
  "Start an X server with *X-RESOURCES*; return its process and the number of its display."
  (let* ((process (uiop:launch-program `("Xvfb" "-displayfd" "1" "-screen" "0" ,*x-screen*
                                         "-nolisten" "tcp" "-noreset" ,@*x-options*)
                                       :output :stream))
         (display-number (parse-integer (read-line (uiop:process-info-output process)))))
    (set-x-resources display-number)
    (values process display-number)))

(defvar *display-number* nil "The number of the X server's display.")

(defun call-with-x-server (function)
  "Call FUNCTION while an X server runs, which is the one that new windows come to."
  (multiple-value-bind (process *display-number*) (start-x-server)
    (let ((before (or (uiop:getenv "DISPLAY") "")))
      (setf (uiop:getenv "DISPLAY") (format nil ":~D" *display-number*))
      (unwind-protect (funcall function)
        (setf (uiop:getenv "DISPLAY") before)
        (uiop:terminate-process process :urgent t)
        (uiop:wait-process process)))))

(defun program-found-p (name)
  (zerop (nth-value 2 (uiop:run-program (list "sh" "-c" (format nil "command -v ~A" name))
                                        :ignore-error-status t))))

(defmacro with-x-server (() &body body)
  "Run BODY while an X server runs; where there is no Xvfb, skip the test and say so."
  `(if (program-found-p "Xvfb")
       (call-with-x-server (lambda () ,@body))
       (skip "Xvfb is not installed: what is on the window's screen is not tested.")))

(defun end-window (window)
  (window::close-window window)
  (base:join-thread (window::window-thread window)))

(defmacro in-x-window ((window robot) &body body)
  "Run BODY with WINDOW, of the studio's ROBOT, on the screen of an X server; its run is live."
  `(with-x-server ()
     (in-studio (,robot)
       (run:start-clock (time:current-simulation) :rate :free)
       (unwind-protect
            (let ((,window (window::open-window ,robot)))
              (unwind-protect (progn (await-window ,window) ,@body)
                (end-window ,window)))
         (run:stop-clock (time:current-simulation))))))

;;; What the window's thread does for us: see clim-client.lisp.

(defmacro inside ((window) &body body)
  "Let the thread of WINDOW run BODY; return its value."
  `(client:run-in-window ,window (lambda () ,@body)))

(defvar *never-comes* (base:make-semaphore "never") "Nobody signals it.")

(defun await-window (window)
  "Wait until WINDOW can be asked, and is on the screen."
  (loop until (clim:frame-top-level-sheet window) do (base:wait-on-semaphore *never-comes* 0.01))
  (loop until (inside (window) (clim:sheet-grafted-p (pane window 'window::world)))))

;;; What is on the screen.

(defun call-as-other-client (function window)
  "Call FUNCTION with the X window of WINDOW, as a second client of the X server knows it."
  (client:call-with-x-window function window :display *display-number*))

(defun shown-on-screen (window name)
  "Return the pixels of the pane of WINDOW called NAME, four bytes each, and its width."
  (let ((pane (pane window name)) (size nil) (corner nil))
    (inside (window)
      (window::refresh window)
      (setf size (multiple-value-list (window::pane-size pane))
            corner (multiple-value-list (client:corner-of pane)))
      (clim:medium-finish-output (clim:sheet-medium pane)))
    (values (call-as-other-client
             (lambda (x-window)
               (xlib:get-raw-image x-window :x (round (first corner)) :y (round (second corner))
                                            :width (first size) :height (second size)
                                            :format :z-pixmap))
             window)
            (first size))))

(defun pixel-at (image width x y)
  (loop for position from (* 4 (+ x (* width y))) repeat 3 for shift from 0 by 8
        sum (ash (aref image position) shift)))

;;; The tests.

(test screen.what-went-leaves-nothing-behind
  "Designators that have gone are not to be seen any more."
  (in-x-window (window robot)
    (inside (window)
      (window::fold-section window 'window::designators nil)
      (lay-out window 1180 820))
    (flet ((look ()
             (time:asking (robot)
               (window::publish-snapshot (window::window-watcher window) (time:current-simulation)))
             (shown-on-screen window 'window::designators)))
      (let ((before (look)))
        (time:asking (robot) (dotimes (count 40) (robot:add-designator robot :x 2 :y 2)))
        (is (not (equalp before (look))))
        (time:asking (robot)
          (mapc #'robot:drop-designator (robot:live-designators robot)))
        (is (equalp before (look)))))))

(defun resize-from-outside (window width height)
  "Make WINDOW WIDTH times HEIGHT pixels as a window manager would; wait until it is laid out so.
Its thread may hear of width and height apart, and later than others see them."
  (call-as-other-client (lambda (x-window)
                          (setf (xlib:drawable-width x-window) width
                                (xlib:drawable-height x-window) height)
                          (xlib:display-finish-output (xlib:window-display x-window)))
                        window)
  (loop until (equal (list width height) (inside (window) (window-size window)))))

(defun window-size (window)
  (multiple-value-list (window::pane-size (clim:frame-top-level-sheet window))))

(defun share-of-black (window name)
  (multiple-value-bind (image width) (shown-on-screen window name)
    (let ((count (floor (length image) 4)))
      (/ (loop for x below count count (zerop (pixel-at image width x 0))) count))))

(defun painted-p (window name)
  "True if the pane of WINDOW called NAME is not black, or is so no longer after a while: the X
server blackens what is resized, and has it painted by what it sends to the window's thread then."
  (loop repeat 200
        thereis (< (share-of-black window name) 1/5)
        do (base:wait-on-semaphore *never-comes* 0.01)))

(test screen.what-is-widened-is-not-black
  "Where one types, and elsewhere."
  (in-x-window (window robot)
    (loop for (width height) in '((640 480) (1280 880) (700 500) (1200 700))
          do (resize-from-outside window width height)
             (dolist (name '(window::interactor window::transcript window::state window::strip
                             window::bar window::designators))
               (is-true (painted-p window name) "~A" name)))))

(defun column-inked-p (image width x top bottom)
  (loop for y from top below bottom thereis (/= #xFFFFFF (pixel-at image width x y))))

(defun row-inked-p (image width y left right)
  (loop for x from left below right thereis (/= #xFFFFFF (pixel-at image width x y))))

(test screen.a-circle-in-a-cell-has-all-its-sides
  "Manual B.1: draw-arc with the cell's corner and graphics-scale*, as wide and high as the cell."
  (in-x-window (window robot)
    (eval '(world:def-place-type doorway (cell)
            :check-matchers ((((* - *) (* - *) (* - *)) 0))
            :graphics ((win cx cy)
                       (canvas:draw-arc win canvas:draw-gcontext* cx cy canvas:graphics-scale*
                        canvas:graphics-scale* 0 (* 2 pi)))))
    (inside (window) (painted-world window))
    (multiple-value-bind (image width) (shown-on-screen window 'window::world)
      (is-true (column-inked-p image width 80 32 40))
      (is-true (column-inked-p image width 87 32 40))
      (is-true (row-inked-p image width 32 80 88))
      (is-true (row-inked-p image width 39 80 88)))))

(defun turn-over-and-over (robot)
  (command:robot-turn robot 3 (lambda (err robot angle)
                                (declare (ignore angle))
                                (unless err (turn-over-and-over robot)))))

(test screen.pictures-go-on-while-ticks-pass-as-fast-as-they-can
  "How many come in a second is measured by tests/benchmarks/window-figures.lisp."
  (in-x-window (window robot)
    (turn-over-and-over robot)
    (loop with seen = nil with count = 0
          repeat 1000000 until (= count 60)
          do (let ((shown (inside (window)
                          (window::painting-snapshot (window::window-painting window)))))
               (unless (eq shown seen) (setf seen shown) (incf count)))
          finally (is (= 60 count)))))

(defun hide-from-outside (window)
  "Let WINDOW vanish from the screen, as when a window manager makes an icon of it."
  (call-as-other-client (lambda (x-window)
                          (xlib:unmap-window x-window)
                          (xlib:display-finish-output (xlib:window-display x-window)))
                        window))

(test screen.window-that-is-asked-for-again-is-seen
  "It may be an icon, or lie below others."
  (in-x-window (window robot)
    (hide-from-outside window)
    (is (eq window (window::open-window robot)))
    (inside (window) (clim:medium-finish-output (clim:sheet-medium (pane window 'window::world))))
    (is (eq :viewable (call-as-other-client #'xlib:window-map-state window)))))

;;; Trouble with the X server.

(defclass quarrelsome-port (clim:basic-port)
  ((trouble :initarg :trouble :reader port-trouble))
  (:documentation "A port in which each event leads to an error."))

(defmethod clim:process-next-event ((port quarrelsome-port) &key &allow-other-keys)
  (error (port-trouble port)))

(defun window-outlives-p (trouble)
  "True if a window stays when TROUBLE comes up in the thread that reads its port's events."
  (let ((port (make-instance 'quarrelsome-port :trouble trouble :server-path '(:quarrel))))
    (handler-case (clim:process-next-event port)
      (error () nil))))

(test x-server.events-that-make-no-sense-are-dropped
  "CLIM asks about windows that have just been closed; other programs send what they like."
  (is-true (window-outlives-p (make-condition 'xlib:window-error :display nil :error-key 'window)))
  (is-true (window-outlives-p (make-condition 'type-error :datum 1770009600
                                                          :expected-type '(unsigned-byte 29))))
  (is-false (window-outlives-p (make-condition 'xlib:closed-display :display nil)))
  (is-false (window-outlives-p (make-condition 'end-of-file))))

(test x-server.closing-a-window-leaves-the-others
  (with-x-server ()
    (with-own-definitions
      (eval '(world:defmap pair-room (9 9) (rect (0 0) (8 8) bricks 10)))
      (eval '(robot:defrobot castor (pair-room (2.5 2.5) 0)))
      (eval '(robot:defrobot pollux (pair-room (6.5 6.5) 0)))
      (run:with-simulation ((castor pollux))
        (let ((simulation (time:current-simulation)) window)
          (run:start-clock simulation :rate :free)
          (mapc #'turn-over-and-over (run:simulation-robots simulation))
          (unwind-protect
               (destructuring-bind (one other) (run:simulation-robots simulation)
                 (setf window (window::open-window one))
                 (await-window window)
                 (dotimes (count 12)
                   (let ((second (window::open-window other)))
                     (await-window second)
                     (end-window second)))
                 (is (member window (window::open-window-list))))
            (end-window window)
            (run:stop-clock simulation)))))))

(test x-server.windows-can-be-opened-anew-after-it-has-gone
  "Ten X servers, one after the other, are killed under a window of a run, which goes on."
  (in-studio (robot)
    (let ((simulation (time:current-simulation)) (tick 0))
      (run:start-clock simulation :rate :free)
      (turn-over-and-over robot)
      (unwind-protect
           (dotimes (count 10)
             (let (window)
               (with-x-server ()
                 (setf window (window::open-window robot))
                 (await-window window))
               (base:join-thread (window::window-thread window))
               (is (not (member window (window::open-window-list))))
               (is (time:live-p simulation))
               (is (< tick (setf tick (run:simulation-tick simulation))))))
        (run:stop-clock simulation)))))

(test x-server.what-a-lost-window-was-at-is-told
  (in-studio (robot)
    (let ((simulation (time:current-simulation)) (window nil)
          (*never-comes* (base:make-semaphore "started")))
      (setf (base:global-value '*gate*) *never-comes*)
      (run:start-clock simulation)
      (unwind-protect
           (progn
             (with-x-server ()
               (setf window (window::open-window robot))
               (await-window window)
               (window::run-line-at-prompt (window::window-conversation window)
                                           (format nil "(progn (ars-magna.base:signal-semaphore ~
                                                        ars-magna.tests::*gate*) (loop))"))
               (window::run-line-at-prompt (window::window-conversation window) "turn 1")
               (is-true (base:wait-on-semaphore *never-comes* 60)))
             (base:join-thread (window::window-thread window))
             (let ((said (format nil "~{~A~%~}"
                                 (mapcar #'base:message-text
                                         (base:take-messages
                                          (run:simulation-messages simulation))))))
               (is-true (has-words-p said "the connection to the X server has ended"
                                      "The running line"
                                     "signal-semaphore" "not run: turn 1")
                        "~A" said)))
        (run:stop-clock simulation)))))

;;; What is said if CLIM's port cannot be opened.

(defparameter *misreading*
  (make-condition 'type-error :datum -20 :expected-type '(unsigned-byte 44))
  "What CLX 0.7.5 signals on SBCL 2.5.2 when it reads a short answer of the X server's.")

(defun words-where-clx-cannot-read ()
  "Return what is said of *MISREADING* where CLX itself fails with it on an X server that answers."
  (let ((read #'xlib::buffer-read-default))
    (with-x-server ()
      (unwind-protect
           (progn (setf (fdefinition 'xlib::buffer-read-default)
                        (lambda (display vector start &rest arguments)
                          (if (plusp start)
                              (error *misreading*)
                              (apply read display vector start arguments))))
                  (window::connection-failure-message *misreading*))
        (setf (fdefinition 'xlib::buffer-read-default) read)))))

(test port.clx-is-named-when-it-fails-on-a-server-that-answers
  (let ((text (words-where-clx-cannot-read)))
    (when (stringp text)
      (is-true (has-words-p text "CLX" "fails on SBCL" (lisp-implementation-version) "answers"
                            "-20 is not 0 or more" "CLX 0.7.6 or newer" "~/common-lisp/clx")
               "~A" text)
      (is-true (mentions-p text (namestring (asdf:system-source-directory "clx"))))
      (is-false (mentions-p text "does not answer")))))

(test port.mcclim-is-named-when-it-fails-and-clx-reads
  (with-x-server ()
    (let ((text (window::connection-failure-message *misreading*)))
      (is-true (has-words-p text "McCLIM" "fails on SBCL" "-20 is not 0 or more") "~A" text)
      (is-false (mentions-p text "CLX 0.7.6")))))

(test port.servers-that-are-not-there-or-refuse-are-told-apart
  (flet ((words (display)
           (let ((before (uiop:getenv "DISPLAY")))
             (setf (uiop:getenv "DISPLAY") display)
             (unwind-protect (handler-case (progn (window::window-port) "")
                               (base:misuse (condition) (princ-to-string condition)))
               (setf (uiop:getenv "DISPLAY") (or before ""))))))
    (dolist (display '(":5999" "no-such-host.invalid:0" "nonsense" ":abc"))
      (is-true (has-words-p (words display) display "does not answer" "Start it") "~A" display)))
  (is-true (has-words-p (window::connection-failure-message
                         (make-condition 'xlib:connection-failure
                                         :display nil :host "" :major-version 11 :minor-version 0
                                         :reason "No protocol specified"))
                        "refuses the connection" "No protocol specified")))

;;; Threads of a window that the user ends.

(defun threads-called (name)
  (remove-if-not (lambda (thread) (search name (base:thread-name thread)))
                 (bordeaux-threads:all-threads)))

(defun end-threads-called (name)
  (let ((threads (threads-called name)))
    (mapc #'bordeaux-threads:destroy-thread threads)
    (mapc #'base:join-thread threads)
    threads))

(test threads.the-pacer-and-the-reader-of-events-come-back
  "They are any user's to end, who may not know what they are for."
  (in-x-window (window robot)
    (dolist (names '(("pacer of STUDIO-ROBOT" "pacer of STUDIO-ROBOT")
                     ("event process" "events of windows")))
      (is-true (end-threads-called (first names)))
      (loop until (threads-called (second names)) do (base:wait-on-semaphore *never-comes* 0.01)))
    (resize-from-outside window 700 500)
    (is (equal '(700 500) (inside (window) (window-size window))))))

;;; Two threads wait for the X server on one connection; see x-server.lisp.

(test replies.who-may-read-does-not-wait-for-what-has-come-meanwhile
  "Another thread reads the answer after we have looked for it and before we may read."
  (let ((looks '()) (waits 0))
    (flet ((read-input (display timeout force-output-p come-p &rest arguments)
             (declare (ignore force-output-p))
             (loop until (apply come-p arguments)
                   do (let ((end (window::wait-unless-input-arrived
                                  (lambda (display timeout)
                                    (declare (ignore display timeout))
                                    (incf waits)
                                    :timeout)
                                  display timeout)))
                        (when end (return end)))))
           (come-p (answers)
             (pop (first answers))))
      (flet ((wait (answers) (window::read-x-server-input #'read-input nil 1 nil
                                                          #'come-p (list answers))))
        (setf looks (list nil t))
        (is (null (wait looks)))
        (is (= 0 waits))
        (is (eq :timeout (wait (list nil nil))))
        (is (= 1 waits))))))

(test replies.are-waited-for-so-by-clx
  (is (host:wrapped-p 'xlib::read-input))
  (is (host:wrapped-p 'xlib::buffer-input-wait)))
