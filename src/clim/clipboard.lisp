;;;; clipboard.lisp -- texts that programs on an X server copy from each other, however long.

(in-package :ars-magna.clim)

;;; McCLIM cannot copy texts that do not fit into one X message. So both directions use separate
;;; connections, on which nothing else happens: one for each text that is fetched, and one, with a
;;; thread, for each text that is offered until another program copies something. Long texts go in
;;; pieces (X calls this INCR): the receiver deletes each piece to acknowledge it.

(defconstant +piece+ 60000 "The number of octets in one piece of a long text.")
(defconstant +longest-paste+ 1000000 "The largest number of octets of a pasted text.")
(defconstant +patience-with-others+ 2
  "The seconds to wait for the next piece of a text from another program.")

(defun connect (port)
  (destructuring-bind (&key host display-id protocol &allow-other-keys)
      (rest (clim:port-server-path port))
    (xlib:open-display host :display display-id :protocol protocol)))

(defun make-mailbox (display)
  "Return an invisible X window through which DISPLAY transfers texts."
  (xlib:create-window :parent (xlib:screen-root (xlib:display-default-screen display))
                      :x 0 :y 0 :width 1 :height 1 :event-mask '(:property-change)))

;;; Fetching.

(defun reject-paste (reason)
  (reject-use "~A. Save it in a file, and type (load \"FILE\")." reason))

(defun octets-in (mailbox)
  "Return the contents of the X window MAILBOX, as a string of octets."
  (with-output-to-string (out)
    ;; The X server hands it over in parts; it counts in fours.
    (loop for start from 0 by (floor +piece+ 4)
          do (multiple-value-bind (octets type format left)
                 (xlib:get-property mailbox :mcclim :start start :end (+ start (floor +piece+ 4))
                                                    :result-type 'list)
               (declare (ignore type format))
               (dolist (octet octets) (write-char (code-char octet) out))
               (when (zerop left) (return))))))

(defun take-piece (mailbox)
  "Return the contents of the X window MAILBOX, as a string of octets, and their X type; then delete
them. The type is NIL if MAILBOX is empty, and :INCR if a text will come in pieces."
  (let ((type (nth-value 1 (xlib:get-property mailbox :mcclim :end 0))))
    (multiple-value-prog1
        (values (if (member type '(nil :incr)) "" (octets-in mailbox))
                type)
      (when type (xlib:delete-property mailbox :mcclim)))))

(defun await-answer (display)
  "Wait for the answer of the program that was asked on DISPLAY for its selection. Return T if the
program has sent it, :NONE if the program cannot, and NIL if the program does not answer in time."
  (xlib:event-case (display :timeout +patience-with-others+ :discard-p t :force-output-p t)
    (:selection-notify (property) (if property t :none))))

(defun await-piece (display)
  "Wait for the next piece of a text on DISPLAY. Return true if a piece has come in time."
  (xlib:event-case (display :timeout +patience-with-others+ :discard-p t :force-output-p t)
    (:property-notify (state) (eq state :new-value))))

(defun fetch-pieces (display mailbox)
  "Return the text that arrives in pieces on DISPLAY; an empty piece ends the text. Signals MISUSE
if a piece does not come or the text is too long."
  (with-output-to-string (out)
    (loop with count = 0
          do (unless (await-piece display)
               (reject-paste "Only a part of the text to be pasted has arrived"))
             (multiple-value-bind (piece type) (take-piece mailbox)
               (when (and type (string= piece "")) (return))
               (when (< +longest-paste+ (incf count (length piece)))
                 (reject-paste "The text is too long to be pasted")) (write-string piece out)))))

(defun fetch-as (type selection display mailbox)
  "Return the text of SELECTION in the X type TYPE, as a string of octets. Return NIL if SELECTION
has no such text."
  (xlib:convert-selection selection type mailbox :mcclim nil)
  (ecase (await-answer display)
    ((nil) (reject-paste "The program with the text to be pasted does not answer"))
    (:none nil)
    ((t) (multiple-value-bind (octets type) (take-piece mailbox)
           (cond ((eq type :incr) (fetch-pieces display mailbox))
                 ((< +longest-paste+ (length octets))
                  (reject-paste "The text is too long to be pasted")) (t octets))))))

(defgeneric fetch-text (port selection)
  (:documentation "Return the text of SELECTION, :PRIMARY or :CLIPBOARD, on the X server of PORT, or
NIL if there is none. Signals MISUSE if the text does not arrive or is too long.")
  (:method (port selection) (declare (ignore port selection)) nil)
  (:method ((port clim-clx:clx-port) selection)
    (let ((display (connect port)))
      (unwind-protect (let* ((mailbox (make-mailbox display))
                             (octets (fetch-as :utf8_string selection display mailbox)))
                        (if octets
                            (decoded octets)
                            (fetch-as :string selection display mailbox)))
        (xlib:close-display display :abort t)))))

;;; Holding.

(defstruct (shared (:constructor make-shared (octets)) (:copier nil))
  "A text that is offered to other programs, as a string of OCTETS. TRANSFERS are lists (window
property start), one for each program that receives the text in pieces. START is where the next
piece begins in OCTETS."
  (octets "" :type string :read-only t)
  (selections '() :type list)
  (transfers '() :type list))

(defun put-octets (window property octets)
  (xlib:change-property window property octets :utf8_string 8 :transform #'char-code))

(defun begin-pieces (shared window property)
  (setf (xlib:window-event-mask window) '(:property-change))
  (push (list window property 0) (shared-transfers shared))
  (xlib:change-property window property (list (length (shared-octets shared))) :incr 32))

(defun hand-next-piece (shared window property)
  "Put the next piece of SHARED into PROPERTY of WINDOW if a program waits for a piece there. An
empty piece ends the text."
  (let ((transfer (find-if (lambda (transfer)
                             (and (xlib:window-equal window (first transfer))
                                  (eq property (second transfer))))
                           (shared-transfers shared))))
    (when transfer
      (let* ((octets (shared-octets shared))
             (start (third transfer))
             (end (min (length octets) (+ start +piece+))))
        (put-octets window property (subseq octets start end))
        (setf (third transfer) end)
        (when (= start end) (removef (shared-transfers shared) transfer))))))

(defun hand-over (shared window target property)
  "Put the text of SHARED into PROPERTY of WINDOW as the X type TARGET. Return true if the text is
available as TARGET."
  (case target
    (:targets (xlib:change-property window property '(:targets :utf8_string :string) :atom 32
                                    :transform (lambda (name)
                                                 (xlib:intern-atom (xlib:window-display window)
                                                                   name)))
     t)
    ((:utf8_string :string :text)
     (if (< +piece+ (length (shared-octets shared)))
         (begin-pieces shared window property)
         (put-octets window property (shared-octets shared)))
     t)))

(defun answer-request (shared window selection target property time)
  (let ((property (or property target)))
    (xlib:send-event window :selection-notify nil
                     :window window :event-window window :selection selection :target target
                     :property (and (hand-over shared window target property) property)
                     :time time)))

(defun serve (shared display)
  "Answer programs that ask on DISPLAY for the text SHARED. Return when another program has copied
something and all transfers are complete or given up."
  (loop while (or (shared-selections shared) (shared-transfers shared))
        always
           (xlib:event-case (display :timeout (if (shared-selections shared)
                                                  nil
                                                  +patience-with-others+)
                                     :discard-p t :force-output-p t)
             (:selection-request (requestor selection target property time)
               (answer-request shared requestor selection target property time)
               t)
             (:property-notify (window atom state)
               (when (eq state :deleted) (hand-next-piece shared window atom))
               t)
             (:selection-clear (selection)
               (removef (shared-selections shared) selection)
               t))))

(defun serve-until-over (shared display)
  ;; The X server may go; the receiver may vanish before it gets an answer.
  (setf (xlib:display-error-handler display) (constantly nil))
  (unwind-protect (ignore-errors (serve shared display))
    (ignore-errors (xlib:close-display display :abort t))))

(defun claim-selections (shared display selections)
  (let ((mailbox (make-mailbox display)))
    (dolist (selection selections)
      (xlib:set-selection-owner display selection mailbox nil)
      (when (xlib:window-equal mailbox (xlib:selection-owner display selection))
        (push selection (shared-selections shared))))))

(defgeneric share-text (port text selections)
  (:documentation "Offer TEXT to other programs on the X server of PORT as each of SELECTIONS, a
list of :PRIMARY or :CLIPBOARD or both. The offer ends when another program copies something.")
  (:method (port text selections) (declare (ignore port text selections)))
  (:method ((port clim-clx:clx-port) text selections)
    (let ((display (connect port)) (shared (make-shared (encoded text))))
      (claim-selections shared display selections)
      (start-thread (lambda () (serve-until-over shared display)) "what was copied"))))
