;;;; keyboard.lisp -- what keys do while displays have the focus, and what keyboards type.

(in-package :ars-magna.clim)

;;; Tab, or a click on the world or the details, gives them the focus. Return, Escape, a click on
;;; the transcript, or a character that is none of their keys gives it back to the prompt. While a
;;; line is half typed, all characters go to it.

(defun focus-input-line (window)
  (focus-and-repaint (pane-named window 'interactor)))

(defun focus-clicked-pane (pane)
  "Send keys to the clicked PANE from now on, or to the prompt if PANE is the transcript."
  (typecase pane
    ((or world-pane detail-pane plan-pane parameter-pane)
     (setf (window-typing-p (window-of pane)) nil)
     (focus-on pane))
    (transcript-pane (focus-input-line (window-of pane)))))

(defun type-at-prompt (window character)
  "Send CHARACTER, and the keys typed after it, to the input line of WINDOW."
  ;; What is typed fast may still come to a display.
  (setf (window-typing-p window) t)
  (pass-key-to-prompt window (string character))
  (focus-input-line window))

(defconstant +arrow-step+ 60 "The number of pixels that an arrow key moves the view.")

(defun arrow-key-offset (key-name)
  "Return two values, the pixels by which the arrow key KEY-NAME moves the view right and down; or
NIL."
  (case key-name
    (:left (values (- +arrow-step+) 0))
    (:right (values +arrow-step+ 0))
    (:up (values 0 (- +arrow-step+)))
    (:down (values 0 +arrow-step+))))

(defun handle-key (window key-name character)
  "Handle the key KEY-NAME, with CHARACTER or NIL, in WINDOW. Return true if the key has an effect."
  (let ((button (and character (find character *bar-buttons* :key #'button-key)))
        (shown (shown-input-line (window-conversation window))))
    (multiple-value-bind (dx dy) (arrow-key-offset key-name)
      (cond ((handle-key-in-popup window key-name) t)
            ((eq key-name :f10) (toggle-first-menu window) t)
            ((and (or (window-typing-p window) (and shown (string/= "" (second shown))))
                  character
                  (graphic-char-p character))
             (type-at-prompt window character)
             t)
            ;; The key that has opened the panel on top of the window closes it.
            (button (unless (eq (button-command button) (close-popup window))
                      (funcall (button-command button)))
                    t)
            ((handle-choice-key window key-name character) t)
            (dx (handle-arrow (pane-for-keys window) dx dy) t)
            ((member key-name '(:return :escape))
             (or (if (eq key-name :escape) (close-by-escape window) (close-popup window))
                 (focus-input-line window))
             t)
            ((and character (graphic-char-p character))
             (type-at-prompt window character)
             t)))))

(defun key-modified-p (event)
  (or (modifier-pressed-p event clim:+control-key+) (modifier-pressed-p event clim:+meta-key+)))

(defun for-input-line-p (event)
  "True if the key of EVENT is for the input line even while a display has the focus."
  (or (key-modified-p event) (eq (clim:keyboard-event-key-name event) :insert)))

;; Some keyboards have a symbol of X for shift and Tab together, some do not.
(defun key-name-of-event (event)
  (let ((name (clim:keyboard-event-key-name event)))
    (if (and (eq name :tab) (modifier-pressed-p event clim:+shift-key+)) :iso-left-tab name)))

(defmethod clim:handle-event ((pane display-pane) (event clim:key-press-event))
  (let ((window (window-of pane)))
    (with-guarded-command (window "That key")
      (if (or (typep pane 'interactor-pane) (for-input-line-p event))
          (handle-key-in-input-line window event)
          (handle-key window (key-name-of-event event)
                      (clim:keyboard-event-character event))))))

;;;; Keyboards that are not American

;;; X lists the meanings of a key: alone, with shift, the same two for a second layout, and then
;;; with AltGr. McCLIM looks at the first four only, so a German keyboard would have neither { nor
;;; |. It also does not combine a dead key with the character after it. The names that McCLIM uses
;;; are key symbols of X, which are numbers.

(defconstant +altgr+ #x80 "The bit for AltGr in the keyboard state of an X event.")

(defun altgr-key-symbol (symbol-at state)
  "Return the X key symbol for a key pressed with AltGr, or NIL if STATE has no AltGr or the key has
no separate symbol for AltGr. The function SYMBOL-AT returns the symbol of the key at an X index."
  (flet ((own (index)
           (let ((symbol (funcall symbol-at index)))
             (and (plusp symbol) (/= symbol (funcall symbol-at 0)) symbol))))
    (and (logtest +altgr+ state)
         ;; With a second layout, X says by the same bit that it is in use.
         (eql (funcall symbol-at 0) (funcall symbol-at 2))
         (or (and (logtest 1 state) (own 5)) (own 4)))))

(defconstant +euro-symbol+ #x20AC "The X key symbol of the Euro sign.")

(defun key-symbol-character (display symbol)
  "Return the character of the X key symbol SYMBOL, or NIL if it has none."
  (cond ((xlib:keysym->character display symbol))
        ((= symbol +euro-symbol+) (code-char symbol))
        ;; The symbols of all other characters are made of their codes.
        ((< #x1000000 symbol #x1110000) (code-char (- symbol #x1000000)))))

(defun mcclim-key-function (name)
  "Return the symbol of McCLIM's internal function NAME for X keys, or NIL if McCLIM has none."
  (let* ((package (find-package "CLIM-XCOMMON"))
         (symbol (and package (find-symbol name package))))
    (and symbol (fboundp symbol) symbol)))

(defvar *mcclim-key-reader-name* (mcclim-key-function "X-EVENT-TO-KEY-NAME-AND-MODIFIERS")
  "The name of McCLIM's function that returns the character, modifiers and name of a key, or NIL.")

(defvar *mcclim-key-reader* (and *mcclim-key-reader-name* (fdefinition *mcclim-key-reader-name*))
  "McCLIM's original function that DECODE-X-KEY replaces, or NIL.")

(defun decode-x-key (port kind code state)
  "Return the character, modifiers and name of the key with the X key code CODE. KIND is the kind of
the event, a press or a release, and STATE the X keyboard state."
  (let* ((display (clim-clx:clx-port-display port))
         (symbol (altgr-key-symbol (lambda (index)
                                     ;; The list may be shorter.
                                     (or (ignore-errors (xlib:keycode->keysym display code index))
                                         0))
                                   state)))
    (if symbol
        (values (key-symbol-character display symbol) 0
                (funcall (mcclim-key-function "KEYSYM-TO-KEYSYM-NAME") symbol))
        (funcall *mcclim-key-reader* port kind code state))))

(when *mcclim-key-reader-name* (setf (fdefinition *mcclim-key-reader-name*) #'decode-x-key))

;;; Dead keys.

(defparameter *dead-keys*
  '((:dead-grave #\` "aàeèiìoòuùAÀEÈIÌOÒUÙ")
    (:dead-acute #\' "aáeéiíoóuúyýcćnńsśzźAÁEÉIÍOÓUÚYÝCĆNŃSŚZŹ")
    (:dead-circumflex #\^ "aâeêiîoôuûAÂEÊIÎOÔUÛ")
    (:dead-tilde #\~ "aãnñoõAÃNÑOÕ")
    (:dead-diaeresis #\" "aäeëiïoöuüyÿAÄEËIÏOÖUÜ")
    (:dead-cedilla #\, "cçsşCÇSŞ")
    (:dead-caron #\^ "cčeěnňrřsšzžCČEĚNŇRŘSŠZŽ")
    (:dead-abovering #\* "aåuůAÅUŮ"))
  "Lists (name character pairs). NAME is McCLIM's name of a dead key. CHARACTER is the result of the
dead key and a space. PAIRS is a string of pairs: a letter and its result with the dead key.")

(defun compose-after-dead-key (dead character)
  "Return, as a string, the result of CHARACTER typed after DEAD, an element of *DEAD-KEYS*."
  (destructuring-bind (own pairs) (rest dead)
    (let ((letter (loop for index from 0 below (length pairs) by 2
                        when (char= character (char pairs index))
                          return (char pairs (1+ index)))))
      (cond (letter (string letter))
            ((char= character #\Space) (string own))
            (t (format nil "~C~C" own character))))))

(defvar *dead-key* nil
  "The element of *DEAD-KEYS* that waits for a character, or NIL. All windows share one keyboard.")

(defun make-key-press (character event)
  (make-instance 'clim:key-press-event
                 :sheet (clim:event-sheet event) :key-name (make-keyword (string character))
                 :key-character character :modifier-state 0
                 :x 0 :y 0 :timestamp (clim:event-timestamp event)))

(defun update-dead-key (name character)
  "Record in *DEAD-KEY* the effect of pressing the key NAME. CHARACTER is its character, or NIL.
Return two values, elements of *DEAD-KEYS* or NIL: one for the key that was waiting, one for NAME."
  (let ((before *dead-key*) (now (assoc name *dead-keys*)))
    ;; Keys like shift have no character, and leave a dead key waiting.
    (when (or now character)
      (setf *dead-key* (if (eq now before) nil now)))
    (values before now)))

(defun events-after-dead-key (event)
  "Return a list of events to handle for the key press EVENT, with dead keys already combined."
  (let ((character (clim:keyboard-event-character event)))
    (multiple-value-bind (before now)
        (update-dead-key (clim:keyboard-event-key-name event) character)
      (flet ((typed (text)
               (map 'list (lambda (character) (make-key-press character event)) text)))
        (cond (now (typed (if before (string (second before)) "")))
              ((and before character (graphic-char-p character) (not (key-modified-p event)))
               (typed (compose-after-dead-key before character)))
              (t (list event)))))))

(defmethod clim:distribute-event :around ((port clim:basic-port) (event clim:key-press-event))
  (if (robot-window-of (clim:event-sheet event))
      (dolist (event (events-after-dead-key event)) (call-next-method port event))
      (call-next-method)))
