;;;; clim-window.lisp -- the window, on CLIM's null port: no X server is needed. See clim.lisp.

(in-package :ars-magna.tests)

(in-suite clim)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :window :ars-magna.clim :ars-magna.tests)
  (sb-ext:add-package-local-nickname :client :ars-magna.window-client :ars-magna.tests))

(defun preferences-with-displays-open ()
  "Return preferences for a window whose displays are open, but for plans and parameters."
  (window::make-preferences :folded '(window::plan window::parameters) :unseen '()))

(defun call-with-window (function robot)
  "Call FUNCTION with a window of ROBOT, adopted by the null port but not running. Its displays are
open, as if each had had something to show; it suggests no lines to try."
  (let* ((watcher (window::make-watcher (robot:robot-name robot) (constantly nil)))
         (port (clim:find-port :server-path '(:null)))
         (manager (clim:find-frame-manager :port port)))
    (window::watch-simulation watcher (run:robot-simulation robot))
    (let ((window (window::make-robot-window watcher :frame-manager manager)))
      (setf (window::window-preferences window) (preferences-with-displays-open)
            (window::transcript-entered (window::window-transcript window)) 1)
      (clim:adopt-frame manager window)
      (unwind-protect
           (let ((clim:*application-frame* window)) (funcall function window))
        (window::stop-watching watcher)
        (clim:disown-frame manager window)))))

(defmacro in-window ((window robot) &body body)
  `(in-studio (,robot)
     (call-with-window (lambda (,window) (declare (ignorable ,window)) ,@body) ,robot)))

(defun pane (window name) (clim:find-pane-named window name))

(defun keys-given (window)
  "Return the octets that WINDOW has handed over to its prompt, which has not begun."
  (cli::unread-octets (cli::typed-octets (cli:session-input (window::window-session window)))))

(defun said-in (window)
  (format nil "~{~A~%~}" (window::latest-lines (window::window-transcript window) 100)))

(test window.has-a-pane-for-each-display-and-for-commands
  (in-window (window robot)
    (dolist (name '(window::world window::state window::designators window::cameras window::hands
                    window::bins window::plan window::transcript window::strip window::bar))
      (is (typep (pane window name) 'window::display-pane)))
    (is (typep (pane window 'window::interactor) 'window::interactor-pane))))

;;; Painting and pointing.

(defun painted-world (window)
  "Return the display of the world in WINDOW, painted at 8 pixels a cell from its corner on."
  (let ((pane (pane window 'window::world)))
    (window::repaint pane)
    (setf (window::pane-fitting-p pane) nil
          (window::pane-scale pane) 8
          (window::pane-left pane) 0
          (window::pane-top pane) 0
          (window::preferences-layers (window::window-preferences window))
          (set-difference (window::window-layers window) '(:coordinates :scale-bar)))
    (window::repaint pane)
    pane))

(test window.remembers-where-it-painted-what
  (in-window (window robot)
    (let ((subjects (window::pane-subjects (painted-world window))))
      (flet ((title-at (x y)
               (let ((subject (window::subject-at subjects x y)))
                 (and subject (canvas:subject-title subject)))))
        (is (equal "BOX#1" (title-at 28 36)))
        (is (equal "PEN#2" (title-at 44 36)))
        (is (equal "STUDIO-ROBOT" (title-at 52 52)))
        (is (null (title-at 120 20)))))))

(test window.a-click-describes-what-it-hits
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (window::handle-click pane :left 28 36)
      (window::handle-click pane :left 84 36)
      (window::handle-click pane :left 84 12)
      (dolist (part '("BOX#1 at 3.50, 4.50" ":color red" "Cell 10, 4: doorway"
                      "Cell 10, 1: a wall of wood, parameter 50.0"))
        (is (mentions-p (said-in window) part))))))

(defun press (pane button)
  (clim:handle-event pane (make-instance 'clim:pointer-button-press-event
                                         :sheet pane :button button :x 5 :y 5
                                         :modifier-state 0)))

(test window.designators-scroll-down-by-the-left-and-up-by-the-right-button
  "Manual B."
  (in-window (window robot)
    (dotimes (count 40) (robot:add-designator robot :x 2 :y 2))
    (let ((pane (pane window 'window::designators)))
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (window::refresh window)
      (is (= 0 (window::pane-offset pane)))
      (press pane clim:+pointer-left-button+)
      (press pane clim:+pointer-left-button+)
      (is (= 96 (window::pane-offset pane)))
      (press pane clim:+pointer-right-button+)
      (is (= 48 (window::pane-offset pane)))
      (loop repeat 5 do (press pane clim:+pointer-right-button+))
      (is (= 0 (window::pane-offset pane)))
      (loop repeat 50 do (press pane clim:+pointer-left-button+))
      (is (< 300 (window::pane-offset pane) 700)))))

(test window.zooming-keeps-what-is-under-the-mouse
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (flet ((cell () (let ((cell (window::cell-at pane 84 36)))
                        (list (world:cell-x cell) (world:cell-y cell)))))
        (is (= 8 (window::pane-scale pane)))
        (is (equal '(10 4) (cell)))
        (window::handle-wheel pane -1 84 36)
        (is (= 16 (window::pane-scale pane)))
        (is (equal '(10 4) (cell)))
        (window::handle-wheel pane 1 84 36)
        (window::handle-wheel pane 1 84 36)
        (is (= 4 (window::pane-scale pane)))
        (window::fit-whole-map pane)
        (is (integerp (window::pane-scale pane)))))))

(defun painted-contents (window)
  (loop for pane in (window::display-panes window)
        collect (cons (clim:pane-name pane) (window::pane-painted pane))))

(defun panes-changed (before after)
  "Return the names of the panes that were painted between BEFORE and AFTER, both contents."
  (loop for (name . old) in before
        unless (eq old (cdr (assoc name after))) collect name))

(test window.paints-only-what-has-changed
  (in-window (window robot)
    (window::refresh window)
    (window::refresh window)
    (let ((before (painted-contents window)))
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (window::refresh window)
      (is (null (panes-changed before (painted-contents window))))
      (robot:place-robot robot 7.5 6.5 0)
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (window::refresh window)
      (is (equal '(window::world window::state)
                 (panes-changed before (painted-contents window)))))))

;;; Watching.

(test watcher.makes-snapshots-only-when-one-is-wanted
  (in-studio (robot)
    (let* ((count 0)
           (watcher (window::make-watcher 'studio-robot (lambda () (incf count)))))
      (window::watch-simulation watcher (time:current-simulation))
      (is (= 1 count))
      (run:run-ticks 10)
      (is (= 1 count))
      (is (= 0 (display:snapshot-tick (window::watcher-snapshot watcher))))
      (setf (window::watcher-wanted-p watcher) t)
      (run:run-ticks 10)
      (is (= 2 count))
      (is (= 11 (display:snapshot-tick (window::watcher-snapshot watcher))))
      (window::stop-watching watcher)
      (setf (window::watcher-wanted-p watcher) t)
      (run:run-ticks 1)
      (is (= 2 count)))))

(test watcher.follows-a-live-run-and-what-programs-change-between-ticks
  "The pacer looks for such changes by itself; nothing here passes ticks."
  (in-studio (robot)
    (let* ((simulation (time:current-simulation))
           (news (base:make-semaphore "news"))
           (watcher (window::make-watcher 'studio-robot
                                         (lambda () (base:signal-semaphore news)))))
      (run:start-clock simulation)
      (unwind-protect
           (progn
             (window::start-watching watcher simulation)
             (is (base:wait-on-semaphore news 20))
             (window::report-painted watcher)
             (robot:place-robot robot 2.5 2.5 0)
             ;; Other news, such as that time stands still, may come before.
             (is (loop while (base:wait-on-semaphore news 20)
                       thereis (= 2.5d0 (display:robot-image-x
                                         (display:snapshot-robot
                                          (window::watcher-snapshot watcher)
                                          'studio-robot))))))
        (window::stop-watching watcher)
        (run:stop-clock simulation)))))

;;; The transcript.

(test transcript.keeps-the-last-lines
  (let ((transcript (window::make-transcript (constantly nil))))
    (window::write-to-transcript transcript (format nil "one~%tw"))
    (window::write-to-transcript transcript (format nil "o~%"))
    (is (equal '("one" "two" "") (window::latest-lines transcript 10)))
    (dotimes (line 5000) (window::write-to-transcript transcript (format nil "~D~%" line)))
    (is (<= (length (window::latest-lines transcript 5000)) 4001))
    (is (equal '("4999" "") (window::latest-lines transcript 2)))))

(test transcript.tabs-reach-the-next-of-the-columns-that-are-eight-apart
  (let ((transcript (window::make-transcript (constantly nil))))
    (window::write-to-transcript transcript (format nil "a~Cb~C~Cc" #\Tab #\Tab #\Tab))
    (is (equal '("a       b               c") (window::latest-lines transcript 1)))
    (window::write-to-transcript transcript (format nil "~Cd~%1234567~C8~%" #\Tab #\Tab))
    (is (equal '("a       b               c       d" "1234567 8" "")
               (window::latest-lines transcript 3)))
    (window::write-to-transcript transcript (format nil "~C[31mred~C[0m~C.~%"
                                                    #\Escape #\Escape #\Tab))
    (is (equal "red     ."
               (cli:unpainted-text (first (window::latest-lines transcript 2)))))))

;;; Characters that the font lacks.

(test fonts.the-package-named-is-that-of-the-script
  (loop for (code package) in '((#x4E2D "fonts-droid-fallback") (#xAC00 "fonts-droid-fallback")
                                (#x2603 "fonts-symbola") (#x16A0 "fonts-noto-core"))
        do (is (equal package (window::font-package-for (code-char code))))
           (is (mentions-p (window::missing-character-text (code-char code)) package)))
  (is (null (window::font-package-for (code-char #x1F600))))
  (is (mentions-p (window::missing-character-text (code-char #x1F600)) "up to U+FFFF")))

(test fonts.mcclims-own-has-letters-but-no-runes
  (let ((file (window::standard-font-file)))
    (is (< 0.6 (window::advance-in-font file #\a) 0.61))
    (is (null (window::advance-in-font file (code-char #x16A0))))
    (is (equal '(nil 0) (window::font-for (code-char #x3B1))))
    (is (null (window::font-for (code-char #x1F600))))))

(test fonts.what-is-missing-is-said-once
  (in-window (window robot)
    (let ((window::*packages-named* '()))
      (dotimes (count 3)
        (window::report-missing-character window (code-char (+ #x16A0 count))))
      (is (= 1 (count-if (lambda (line) (search "fonts-noto-core" line))
                         (lines-of (said-in window))))))))

(test transcript.wide-characters-take-two-columns
  (let ((rows (window::rows-of-line 0 (make-string 7 :initial-element (code-char #x4E2D)) 10)))
    (is (equal '((0 5) (5 7))
               (loop for row in rows
                     collect (list (window::text-row-start row) (window::text-row-stop row)))))
    (is (= 4 (window::text-columns (window::text-row-text (first rows)) 5 7)))))

;;; Commands.

(test window.commands-steer-a-live-run
  (in-window (window robot)
    (let ((simulation (time:current-simulation)))
      (run:start-clock simulation :rate 20)
      (unwind-protect
           (progn
             (window::com-pause)
             (is (time:paused-p simulation))
             (window::com-resume)
             (is (not (time:paused-p simulation)))
             (window::com-faster)
             (is (= 40 (run:simulation-rate simulation)))
             (window::com-free)
             (is (eq :free (run:simulation-rate simulation))))
        (run:stop-clock simulation)))))

(test window.layers-and-colours-can-be-switched
  "The panel has a row for each layer that there is."
  (in-window (window robot)
    (let ((layers (window::window-layers window)))
      (loop for layer in (remove :legend (remove :title (display:picture-layers)))
            for row in (window::layer-rows window)
            do (let ((ticked-p (window::row-ticked-p row)))
                 (is (eq ticked-p (and (member layer (window::window-layers window)) t)))
                 (funcall (window::row-action row))
                 (is (not (eq ticked-p (window::row-ticked-p row))))
                 (funcall (window::row-action row))))
      (is (null (set-exclusive-or layers (window::window-layers window))))
      (window::com-color)
      (is (not (window::window-color-p window))))))

(test window.saves-a-picture-of-what-it-shows
  (in-window (window robot)
    (uiop:with-current-directory ((uiop:temporary-directory))
      (let ((*default-pathname-defaults* (uiop:temporary-directory)))
        (window::com-save-svg)
        (let ((file (merge-pathnames "studio-robot-000000.svg")))
          (is (mentions-p (said-in window) "studio-robot-000000.svg"))
          (is (mentions-p (uiop:read-file-string file) "Robot designators"))
          (delete-file file))))))

(test window.trouble-in-a-command-is-said
  (in-window (window robot)
    (window::call-guarded-command window "Save" (lambda () (base:reject-use "no paper")))
    (is (mentions-p (said-in window) "*ERROR* -> Save: no paper"))))

(test window.a-line-with-arguments-waits-for-them
  (in-window (window robot)
    (window::choose-prompt-line window "POS")
    (is (mentions-p (keys-given window) "pos "))
    (is (not (find #\Return (keys-given window))))))

;;; Opening and closing.

(test window.closing-it-leaves-the-simulator-running
  (in-studio (robot)
    (let* ((simulation (time:current-simulation))
           (observers (length (run:simulation-observers simulation)))
           (clim:*default-server-path* '(:null)))
      (run:start-clock simulation :rate :free)
      (unwind-protect
           (let ((window (window::open-window robot)))
             (is (eq window (window::open-window robot)))
             (is (member window (window::open-window-list)))
             (window::close-window window)
             (base:join-thread (window::window-thread window))
             (base:join-thread (window::conversation-thread
                                (window::window-conversation window)))
             ;; The next tick takes the observers of both away.
             (command:robot-turn robot 1 nil)
             (run:await-idle simulation 20)
             (is (not (member window (window::open-window-list))))
             (is (eq :disowned (clim:frame-state window)))
             (is (time:live-p simulation))
             ;; The history goes on.
             (is (= (1+ observers) (length (run:simulation-observers simulation)))))
        (run:stop-clock simulation)))))

(test watcher.watches-something-at-each-moment
  "Other threads ask what it watches while it leaves a run for another."
  (in-studio (robot)
    (let ((old (time:current-simulation))
          (new (run:fork-simulation))
          (watcher (window::make-watcher 'studio-robot (constantly nil)))
          (meanwhile '()))
      (window::watch-simulation watcher old)
      (host:wrap-function 'window::stop-observing
                          (lambda (leave &rest arguments)
                            (push (window::watcher-simulation watcher) meanwhile)
                            (apply leave arguments))
                          'test)
      (unwind-protect (window::watch-simulation watcher new)
        (host:unwrap-function 'window::stop-observing 'test))
      (is (equal (list new) meanwhile)))))
