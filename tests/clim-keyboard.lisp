;;;; clim-keyboard.lisp -- keyboards of other countries, on CLIM's null port. See clim.lisp.

(in-package :ars-magna.tests)

(in-suite clim)

;;; Key symbols as X lists them: the keys 7 and Q of a German keyboard, Q of an American one, and a
;;; key with two layouts, the second of which is Russian.
(defparameter *symbols-of-7* #(#x37 #x2f #x37 #x2f #x7b #xac5))
(defparameter *symbols-of-q* #(#x71 #x51 #x71 #x51 #x40 #x7d9))
(defparameter *symbols-without* #(#x71 #x51 #x71 #x51 0 0))
(defparameter *symbols-of-two* #(#x71 #x51 #x6ca #x6ea #x40 #x7d9))

(defun symbol-of (symbols state)
  (window::altgr-key-symbol (lambda (index) (svref symbols index)) state))

(test keyboard.altgr-gives-what-stands-beside-it
  (is (eql (char-code #\{) (symbol-of *symbols-of-7* #x80)))
  (is (eql (char-code #\@) (symbol-of *symbols-of-q* #x80)))
  (is (eql #xac5 (symbol-of *symbols-of-7* #x81)))
  (is (null (symbol-of *symbols-of-7* 0)))
  (is (null (symbol-of *symbols-of-7* 1)))
  (is (null (symbol-of *symbols-without* #x80)))
  (is (null (symbol-of *symbols-of-two* #x80))))

(test keyboard.mcclim-asks-us
  (is (eq #'window::decode-x-key (fdefinition window::*mcclim-key-reader-name*))))

(defun typed-with (window &rest keys)
  "Return what WINDOW types when KEYS are pressed, which are characters or names of keys."
  (let ((window::*dead-key* nil))
    (format nil "~{~A~}"
            (loop for key in keys
                  append (loop for event in (window::events-after-dead-key (press-of window key))
                               collect (clim:keyboard-event-character event))))))

(defun press-of (window key)
  (make-instance 'clim:key-press-event
                 :sheet (pane window 'window::interactor)
                 :key-name (if (characterp key) (base:make-keyword (string key)) key)
                 :key-character (and (characterp key) key)
                 :x 0 :y 0 :modifier-state 0))

(test keyboard.dead-keys-change-the-next-character
  (in-window (window robot)
    (is (equal "é" (typed-with window :dead-acute #\e)))
    (is (equal "`" (typed-with window :dead-grave #\Space)))
    (is (equal "^x" (typed-with window :dead-circumflex :dead-circumflex #\x)))
    (is (equal "`(" (typed-with window :dead-grave #\()))
    (is (equal "'~ " (typed-with window :dead-acute :dead-tilde #\Space #\Space)))
    (is (equal (format nil "~Ae" #\Return) (typed-with window :dead-acute #\Return #\e)))))

(test keyboard.each-letter-stands-before-what-it-becomes
  (loop for (nil nil pairs) in window::*dead-keys*
        do (loop for index from 0 below (length pairs) by 2
                 do (is (< (char-code (char pairs index)) 128))
                    (is (<= 128 (char-code (char pairs (1+ index))))))))

(test keyboard.shift-leaves-a-dead-key-waiting
  (in-window (window robot)
    (is (equal "NILÉ" (typed-with window :dead-acute :shift-left #\E)))))
