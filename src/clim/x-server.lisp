;;;; x-server.lisp -- the X server: connecting, its errors, and which of them close windows.

(in-package :ars-magna.clim)

;;; CLIM has one thread that reads the events of all windows. It is the first to see that the X
;;; server has gone, and must not end Lisp then. But not all errors there mean that: CLIM asks the
;;; server about windows that have just been closed, and other programs may send invalid events.
;;; These events are dropped, and all windows stay.

;;; Settings that users make for all programs on a screen, such as its resolution.

(defun resolution-in-resources (resources)
  "Return the value of Xft.dpi in RESOURCES, the X resources of a screen as a string, or NIL."
  (loop for line in (uiop:split-string resources :separator '(#\Newline))
        for (name value) = (uiop:split-string line :separator '(#\:))
        when (string= name "Xft.dpi")
          return (values (parse-integer value :junk-allowed t))))

(defgeneric screen-resolution (port)
  (:documentation "Return the dots per inch that the X resources of PORT's screen give, or NIL.")
  (:method ((port clim:basic-port)) nil)
  (:method ((port clim-clx:clx-port))
    (let ((screen (xlib:display-default-screen (clim-clx:clx-port-display port))))
      (resolution-in-resources (or (xlib:get-property (xlib:screen-root screen) :resource_manager
                                                      :type :string :result-type 'string
                                                      :transform #'code-char)
                                   "")))))

(defun close-lost-port (port)
  "Close the windows on PORT, whose X server has gone, and end the thread that reads its events."
  (when (with-lock (*windows-lock*) (member port (shiftf *ports* (remove port *ports*))))
    (close-lost-windows port)
    (ignore-errors (clim:destroy-port port))
    (abort)))

;;; Another program may destroy a window, as XKILL does with all of ours.

;;; A window manager that comes or goes takes windows off the screen and puts them there again.

;; McCLIM does not export the names of these events.
(defun event-class-named-p (name event)
  (string= name (type-of event)))

(defmethod clim:handle-event :after ((sheet clime:top-level-sheet-mixin)
                                     (event clim:window-event))
  (let ((window (robot-window-of sheet)))
    (cond ((null window))
          ((event-class-named-p "WINDOW-DESTROY-EVENT" event)
           (warn-of-closing window "another program has destroyed it")
           (clim:frame-exit window))
          ((event-class-named-p "WINDOW-MAP-EVENT" event) (request-repaint window)))))

;; McCLIM would now take the window off the screen, after the manager has put it there.
(defmethod clim:handle-event :around ((sheet clime:top-level-sheet-mixin)
                                      (event clim:window-event))
  (unless (and (robot-window-of sheet) (event-class-named-p "WINDOW-UNMAP-EVENT" event))
    (call-next-method)))

(defun muffle-x-server-warning (condition)
  "Muffle CONDITION if it is McCLIM's warning about a request that the X server could not fulfil."
  (when (eql 0 (search "Received CLX" (princ-to-string condition)))
    (muffle-warning condition)))

;; CLX keeps an event that led to an error, and would process it again.
(defgeneric drop-event (port)
  (:documentation "Discard the event that PORT is processing.")
  (:method ((port clim:basic-port)))
  (:method ((port clim-clx:clx-port))
    (xlib:discard-current-event (clim-clx:clx-port-display port))))

;; McCLIM warns of what the server could not do at once, such as giving the focus to a window that
;; is just being hidden. That is harmless and not shown at the terminal.
(defun call-dropping-bad-event (port function)
  "Call FUNCTION, which reads an event of PORT. If it signals an error, discard the event, or close
PORT if the connection is lost."
  (handler-bind ((warning #'muffle-warning)
                 (error (lambda (condition)
                          ;; An error from one event does not mean that the connection is lost.
                          (cond ((typep condition '(or xlib:request-error xlib:lookup-error
                                                    type-error))
                                 (drop-event port)
                                 ;; The event may have requested painting.
                                 (mapc #'request-repaint (windows-on-port port))
                                 (return-from call-dropping-bad-event t))
                                (t (close-lost-port port))))))
    (funcall function)))

;;; The user may end that thread, as any of Lisp's. Then windows would get no events; one of them
;;; starts another. (The thread that ends cannot do it: Lisp may be ending all.)

(defvar *ports-without-reader* '()
  "The ports whose events no thread reads, because the thread has ended.")

(defun record-unread-port (port)
  "Record that the thread which reads the events of PORT ends, and refresh the windows on PORT."
  (with-lock (*windows-lock*)
    (when (member port *ports*) (pushnew port *ports-without-reader*)))
  (mapc #'request-refresh (windows-on-port port)))

(defun restart-event-thread (port)
  "Start a new thread that reads the events of PORT, if the old thread has ended."
  (when (with-lock (*windows-lock*)
          (member port (shiftf *ports-without-reader* (remove port *ports-without-reader*))))
    (start-thread (lambda () (loop (clim:process-next-event port))) "events of windows")))

(defmethod clim:process-next-event :around ((port clim:basic-port) &key &allow-other-keys)
  (let ((ended-p t))
    (unwind-protect (multiple-value-prog1 (call-dropping-bad-event port #'call-next-method)
                      (setf ended-p nil))
      (when ended-p (record-unread-port port)))))

;;; Connecting, and the message if that fails.

;;; If the X server cannot be reached, another value of DISPLAY may help. If it answers and a
;;; library fails then, only another library does.

(deftype program-fault ()
  "Errors in a program, not in its connection to the X server."
  '(or type-error cell-error program-error control-error arithmetic-error))

(defun clx-read-fails-p ()
  "True if CLX fails to read an answer of the X server that is longer than 32 bytes. The test asks
which keys are down: this answer has 40 bytes."
  (handler-case (let ((display (xlib:open-default-display)))
                  (unwind-protect (xlib:query-keymap display)
                    (xlib:close-display display :abort t))
                  nil)
    (program-fault () t)
    (error () nil)))

(defun library-fault-message (condition clx-fails-p)
  "Return the message on CONDITION, an error of CLX if CLX-FAILS-P is true, else of McCLIM."
  (format nil "No window: ~A fails on SBCL ~A, though the X server ~A answers (~A).~@[ ~A~]"
          (ars-magna.clx:library-text (if clx-fails-p "CLX" "McCLIM"))
          (lisp-implementation-version)
          (environment-value "DISPLAY")
          (one-line-text condition)
          (and clx-fails-p ars-magna.clx:*clx-remedy*)))

(defun connection-failure-message (condition)
  "Return the message about CONDITION, an error in opening the connection to the X server."
  (typecase condition
    (program-fault (library-fault-message condition (clx-read-fails-p)))
    (xlib:connection-failure
     (format nil "No display: the X server ~A (DISPLAY) refuses the connection (~A). Allow it with ~
                  xauth or xhost." (environment-value "DISPLAY") (one-line-text condition)))
    (t (format nil "No display: the X server ~A, which DISPLAY names, does not answer (~A). Start ~
                    it, or set DISPLAY to another X server."
               (environment-value "DISPLAY") (one-line-text condition)))))

(defgeneric unsuitable-server-text (port)
  (:documentation "Return what PORT's X server lacks for a window, and the remedy; NIL if nothing.")
  (:method ((port clim:basic-port)) nil)
  (:method ((port clim-clx:clx-port))
    (let* ((display (clim-clx:clx-port-display port))
           (bits (xlib:screen-root-depth (xlib:display-default-screen display))))
      (cond ((< bits 15)
             (format nil "has a screen of ~D bits per pixel. Set the screen to 24 or 16 bits" bits))
            ((null (xlib:query-extension display "RENDER"))
             "lacks the extension RENDER. Start the X server with RENDER")))))

(defun window-port ()
  "Return CLIM's port for the X server. Signals MISUSE if the X server cannot be reached, or cannot
show a window."
  (unless (or clim:*default-server-path*
              (not (member (environment-value "DISPLAY") '(nil "") :test #'equal)))
    (reject-use "No display: the environment variable DISPLAY is not set. ~
                 Set DISPLAY to an X server."))
  (let* ((port (handler-case (clim:find-port)
                 (error (condition) (reject-use "~A" (connection-failure-message condition)))))
         (lack (unsuitable-server-text port)))
    (with-lock (*windows-lock*) (pushnew port *ports*))
    (when lack
      (reject-use "No window: the X server ~A ~A, or set DISPLAY to another X server."
                  (environment-value "DISPLAY") lack))
    port))

;;; Waiting for the X server's answers in several threads of one connection.

;;; A thread that waits for an answer or an event of the X server first checks whether it has come.
;;; Then CLX lets it read, as the only thread, and wait until there is something. In between, the
;;; thread that read before may have read its event. Then the new reader would wait for the next
;;; event, perhaps for ever, and the picture would stand still until the mouse moves. So it checks
;;; once more when no other thread reads.

;;; While another thread reads, CLX would check again and again without a pause, and keep a
;;; processor busy while the X server paints.

(defvar *input-arrived-p* (constantly nil)
  "A function that returns true if this thread's awaited input from the X server has arrived.")

(defun read-x-server-input (read display timeout force-output-p come-p &rest arguments)
  "Call READ, CLX's function, with the other arguments. The function COME-P of ARGUMENTS returns
true when the awaited input has arrived."
  (let* ((*input-arrived-p* (lambda () (apply come-p arguments)))
         (end (apply read display timeout force-output-p come-p arguments)))
    (if (eq end :come) nil end)))

(defun wait-unless-input-arrived (wait display timeout)
  "If the awaited input has arrived, return :COME. Otherwise call WAIT, a function of CLX."
  (if (funcall *input-arrived-p*) :come (funcall wait display timeout)))

(defconstant +seconds-between-answer-checks+ 0.0005
  "The interval, in seconds, at which a thread checks whether another one has read its answer.")

(defun check-until-true (block why test &rest arguments)
  "Return when the function TEST returns true for ARGUMENTS. BLOCK is CLX's function for this."
  (declare (ignore block why))
  (loop with pause = (make-semaphore "never signalled")
        until (apply test arguments)
        do (wait-on-semaphore pause +seconds-between-answer-checks+)))

(wrap-function (find-symbol "READ-INPUT" "XLIB") #'read-x-server-input)
(wrap-function (find-symbol "PROCESS-BLOCK" "XLIB") #'check-until-true)
(wrap-function (find-symbol "BUFFER-INPUT-WAIT" "XLIB") #'wait-unless-input-arrived)
