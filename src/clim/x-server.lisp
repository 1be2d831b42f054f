;;;; x-server.lisp -- what goes wrong with the X server, and which of that ends windows.

(in-package :ars-magna.clim)

;;; CLIM has one thread that reads the events of all windows. When the X server goes, that thread is
;;; the first to know; it must not take Lisp along. But not all errors there mean that: CLIM asks
;;; the server about windows that have just been closed, and other programs may send events that
;;; make no sense. These events are dropped, and all windows stay.

;;; What users set for all programs on a screen, a fine one above all.

(defun resolution-in (resources)
  "Return the number of Xft.dpi in RESOURCES, the lines that xrdb keeps on an X server, or NIL."
  (loop for line in (uiop:split-string resources :separator '(#\Newline))
        for (name value) = (uiop:split-string line :separator '(#\:))
        when (string= name "Xft.dpi")
          return (parse-integer value :junk-allowed t)))

(defgeneric screen-resolution (port)
  (:documentation "Return the resolution in dots per inch that the user of PORT's screen has asked
for, or NIL.")
  (:method ((port clim:basic-port)) nil)
  (:method ((port clim-clx:clx-port))
    (let ((screen (xlib:display-default-screen (clim-clx:clx-port-display port))))
      (resolution-in (or (xlib:get-property (xlib:screen-root screen) :resource_manager
                                            :type :string :result-type 'string
                                            :transform #'code-char)
                         "")))))

(defun lose-port (port)
  "Close the windows on PORT, whose X server has gone, if any had come to it; end the thread that
reads its events."
  (when (with-lock (*windows-lock*) (member port (shiftf *ports* (remove port *ports*))))
    (lose-windows port)
    (ignore-errors (clim:destroy-port port))
    (abort)))

;;; Another program may destroy a window, as XKILL does with all of ours.

;;; A window manager that comes or goes takes windows off the screen and puts them there again.

;; McCLIM does not export the names of these events.
(defun event-called-p (name event)
  (string= name (type-of event)))

(defmethod clim:handle-event :after ((sheet clime:top-level-sheet-mixin)
                                     (event clim:window-event))
  (let ((window (robot-window-of sheet)))
    (cond ((null window))
          ((event-called-p "WINDOW-DESTROY-EVENT" event)
           (warn-of-closing window "another program has destroyed it")
           (clim:frame-exit window))
          ((event-called-p "WINDOW-MAP-EVENT" event) (request-repaint window)))))

;; McCLIM would take the window off the screen itself then, after the manager has put it there.
(defmethod clim:handle-event :around ((sheet clime:top-level-sheet-mixin)
                                      (event clim:window-event))
  (unless (and (robot-window-of sheet) (event-called-p "WINDOW-UNMAP-EVENT" event))
    (call-next-method)))

(defun muffle-servers-warning (condition)
  "If CONDITION is McCLIM's warning of what the X server could not do, say nothing of it."
  (when (eql 0 (search "Received CLX" (princ-to-string condition)))
    (muffle-warning condition)))

;; CLX keeps an event that led to an error, and would come to it again.
(defgeneric drop-event (port)
  (:documentation "Forget the event that PORT is reading.")
  (:method ((port clim:basic-port)))
  (:method ((port clim-clx:clx-port))
    (xlib:discard-current-event (clim-clx:clx-port-display port))))

;; McCLIM warns of what the server could not do at once, such as to give keys to a window that is
;; just being hidden. That is nobody's fault, and nothing for the terminal.
(defun call-dropping-trouble (port function)
  "Call FUNCTION, which reads an event of PORT; if that makes trouble, drop it, or lose PORT."
  (handler-bind ((warning #'muffle-warning)
                 (error (lambda (condition)
                          ;; What comes of one event says nothing of the connection.
                          (cond ((typep condition '(or xlib:request-error xlib:lookup-error
                                                    type-error))
                                 (drop-event port)
                                 ;; It may have been the word that something is to be painted.
                                 (mapc #'request-repaint (windows-on port))
                                 (return-from call-dropping-trouble t))
                                (t (lose-port port))))))
    (funcall function)))

;;; The user may end that thread, as any of Lisp's. Then windows would hear of nothing any more; one
;;; of them starts another. (That is not for the thread that ends: Lisp may be ending all.)

(defvar *unread-ports* '()
  "The ports whose events nobody reads any more, though windows are there.")

(defun note-unread (port)
  "Note that the thread which reads the events of PORT ends, and wake the windows there, if any."
  (with-lock (*windows-lock*)
    (when (member port *ports*) (pushnew port *unread-ports*)))
  (mapc #'request-refresh (windows-on port)))

(defun read-events-again (port)
  "See to it that the events of PORT are read, if that has ended."
  (when (with-lock (*windows-lock*)
          (member port (shiftf *unread-ports* (remove port *unread-ports*))))
    (start-thread (lambda () (loop (clim:process-next-event port))) "events of windows")))

(defmethod clim:process-next-event :around ((port clim:basic-port) &key &allow-other-keys)
  (let ((ended-p t))
    (unwind-protect (multiple-value-prog1 (call-dropping-trouble port #'call-next-method)
                      (setf ended-p nil))
      (when ended-p (note-unread port)))))
