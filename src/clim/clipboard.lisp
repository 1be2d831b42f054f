;;;; clipboard.lisp -- texts that programs on an X server copy from each other, however long.

(in-package :ars-magna.clim)

;;; McCLIM cannot copy texts that do not fit into one X message. So both directions use separate
;;; connections, on which nothing else happens: one for each text that is fetched, and one, with a
;;; thread, for each text that is offered until another program copies something. Long texts go in
;;; pieces (X calls this INCR): the receiver deletes each piece to acknowledge it.

(defconstant +piece-length+ 60000 "The number of octets in one piece of a long text.")
(defconstant +longest-paste+ 1000000 "The largest number of octets of a pasted text.")
(defconstant +transfer-timeout+ 2
  "The seconds to wait for the next piece of a text from another program.")

(defun connect-to-x-server (port)
  (destructuring-bind (&key host display-id protocol &allow-other-keys)
      (rest (clim:port-server-path port))
    (xlib:open-display host :display display-id :protocol protocol)))

(defun make-transfer-window (display)
  "Return an invisible X window through which DISPLAY transfers texts."
  (xlib:create-window :parent (xlib:screen-root (xlib:display-default-screen display))
                      :x 0 :y 0 :width 1 :height 1 :event-mask '(:property-change)))

;;; Fetching.

(defun reject-paste (reason)
  (reject-use "~A. Save the text in a file, and type (load \"FILE\")." reason))

(defun read-property-octets (mailbox)
  "Return the contents of the X window MAILBOX, as a string of octets."
  (with-output-to-string (out)
    ;; The X server hands it over in parts; it counts in fours.
    (loop for start from 0 by (floor +piece-length+ 4)
          do (multiple-value-bind (octets type format left)
                 (xlib:get-property mailbox :mcclim :start start
                                                    :end (+ start (floor +piece-length+ 4))
                                                    :result-type 'list)
               (declare (ignore type format))
               (dolist (octet octets) (write-char (code-char octet) out))
               (when (zerop left) (return))))))

(defun take-next-piece (mailbox)
  "Return the contents of the X window MAILBOX, as a string of octets, and their X type; then delete
them. The type is NIL if MAILBOX is empty, and :INCR if a text will come in pieces."
  (let ((type (nth-value 1 (xlib:get-property mailbox :mcclim :end 0))))
    (multiple-value-prog1
        (values (if (member type '(nil :incr)) "" (read-property-octets mailbox))
                type)
      (when type (xlib:delete-property mailbox :mcclim)))))

(defun await-selection-answer (display)
  "Wait until the program that owns the selection answers on DISPLAY. Return T if the program has
sent the selection, :NONE if it cannot, and NIL if it does not answer in time."
  (xlib:event-case (display :timeout +transfer-timeout+ :discard-p t :force-output-p t)
    (:selection-notify (property) (if property t :none))))

(defun await-piece (display)
  "Wait for the next piece of a text on DISPLAY. Return true if a piece has come in time."
  (xlib:event-case (display :timeout +transfer-timeout+ :discard-p t :force-output-p t)
    (:property-notify (state) (eq state :new-value))))

(defun fetch-pieces (display mailbox)
  "Return the text that arrives in pieces on DISPLAY; an empty piece ends the text. Signals MISUSE
if a piece does not come or the text is too long."
  (with-output-to-string (out)
    (loop with count = 0
          do (unless (await-piece display)
               (reject-paste "Only a part of the text to be pasted has arrived"))
             (multiple-value-bind (piece type) (take-next-piece mailbox)
               (when (and type (string= piece "")) (return))
               (when (< +longest-paste+ (incf count (length piece)))
                 (reject-paste "The text is too long to be pasted")) (write-string piece out)))))

(defun fetch-selection-as (type selection display mailbox)
  "Return SELECTION as a string of octets of the X type TYPE, or NIL if there is no text."
  (xlib:convert-selection selection type mailbox :mcclim nil)
  (ecase (await-selection-answer display)
    ((nil) (reject-paste "The program with the text to be pasted does not answer"))
    (:none nil)
    ((t) (multiple-value-bind (octets type) (take-next-piece mailbox)
           (cond ((eq type :incr) (fetch-pieces display mailbox))
                 ((< +longest-paste+ (length octets))
                  (reject-paste "The text is too long to be pasted")) (t octets))))))

(defgeneric fetch-text (port selection)
  (:documentation "Return the text of SELECTION, :PRIMARY or :CLIPBOARD, on the X server of PORT, or
NIL if there is no text. Signals MISUSE if the text does not arrive or is too long.")
  (:method (port selection) (declare (ignore port selection)) nil)
  (:method ((port clim-clx:clx-port) selection)
    (let ((display (connect-to-x-server port)))
      (unwind-protect (let* ((mailbox (make-transfer-window display))
                             (octets (fetch-selection-as :utf8_string selection display mailbox)))
                        (if octets
                            (utf-8-decoded octets)
                            (fetch-selection-as :string selection display mailbox)))
        (xlib:close-display display :abort t)))))

;;; Holding.

(defstruct (offered-text (:constructor make-offered-text (octets)) (:copier nil))
  "A text offered to other programs, as a string of OCTETS. TRANSFERS are lists (window property
start), one for each program that receives it in pieces. START is where the next piece begins."
  (octets "" :type string :read-only t)
  (selections '() :type list)
  (transfers '() :type list))

(defun write-property-octets (window property octets)
  (xlib:change-property window property octets :utf8_string 8 :transform #'char-code))

(defun begin-transfer-in-pieces (offered window property)
  (setf (xlib:window-event-mask window) '(:property-change))
  (push (list window property 0) (offered-text-transfers offered))
  (xlib:change-property window property (list (length (offered-text-octets offered))) :incr 32))

(defun send-next-piece (offered window property)
  "Put the next piece of OFFERED into PROPERTY of WINDOW if a program waits. The last is empty."
  (let ((transfer (find-if (lambda (transfer)
                             (and (xlib:window-equal window (first transfer))
                                  (eq property (second transfer))))
                           (offered-text-transfers offered))))
    (when transfer
      (let* ((octets (offered-text-octets offered))
             (start (third transfer))
             (end (min (length octets) (+ start +piece-length+))))
        (write-property-octets window property (subseq octets start end))
        (setf (third transfer) end)
        (when (= start end) (removef (offered-text-transfers offered) transfer))))))

(defun send-offered-text (offered window target property)
  "Put OFFERED into PROPERTY of WINDOW as the X type TARGET. Return true if TARGET is available."
  (case target
    (:targets (xlib:change-property window property '(:targets :utf8_string :string) :atom 32
                                    :transform (lambda (name)
                                                 (xlib:intern-atom (xlib:window-display window)
                                                                   name)))
     t)
    ((:utf8_string :string :text)
     (if (< +piece-length+ (length (offered-text-octets offered)))
         (begin-transfer-in-pieces offered window property)
         (write-property-octets window property (offered-text-octets offered)))
     t)))

(defun answer-selection-request (offered window selection target property time)
  (let ((property (or property target)))
    (xlib:send-event window :selection-notify nil
                     :window window :event-window window :selection selection :target target
                     :property (and (send-offered-text offered window target property) property)
                     :time time)))

(defun serve-offered-text (offered display)
  "Answer programs that ask on DISPLAY for the text OFFERED. Return when another program has copied
something and all transfers are complete or given up."
  (loop while (or (offered-text-selections offered) (offered-text-transfers offered))
        always
           (xlib:event-case (display :timeout (if (offered-text-selections offered)
                                                  nil
                                                  +transfer-timeout+)
                                     :discard-p t :force-output-p t)
             (:selection-request (requestor selection target property time)
               (answer-selection-request offered requestor selection target property time)
               t)
             (:property-notify (window atom state)
               (when (eq state :deleted) (send-next-piece offered window atom))
               t)
             (:selection-clear (selection)
               (removef (offered-text-selections offered) selection)
               t))))

(defun serve-until-copied (offered display)
  ;; The X server may go; the receiver may vanish before it gets an answer.
  (setf (xlib:display-error-handler display) (constantly nil))
  (unwind-protect (ignore-errors (serve-offered-text offered display))
    (ignore-errors (xlib:close-display display :abort t))))

(defun claim-selections (offered display selections)
  (let ((mailbox (make-transfer-window display)))
    (dolist (selection selections)
      (xlib:set-selection-owner display selection mailbox nil)
      (when (xlib:window-equal mailbox (xlib:selection-owner display selection))
        (push selection (offered-text-selections offered))))))

(defgeneric offer-text (port text selections)
  (:documentation "Offer TEXT to other programs on the X server of PORT as each of SELECTIONS, a
list of :PRIMARY or :CLIPBOARD or both. The offer ends when another program copies something.")
  (:method (port text selections) (declare (ignore port text selections)))
  (:method ((port clim-clx:clx-port) text selections)
    (let ((display (connect-to-x-server port)) (offered (make-offered-text (utf-8-encoded text))))
      (claim-selections offered display selections)
      (start-thread (lambda () (serve-until-copied offered display)) "what was copied"))))
