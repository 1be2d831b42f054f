;;;; manual-3-7.lisp -- error messages, queued until somebody reads them (manual 3.7).

(in-package :ars-magna.tests)

(def-suite* manual-3-7 :in ars-magna)

(defmacro with-stroller ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh STROLLER, and a message queue of its own."
  `(ars:with-simulation (stroller ,@options) ,@body))

(defun displayed-lines ()
  "Return what ERROR-DISPLAY displays, a list of lines."
  (uiop:split-string (string-right-trim '(#\Newline) (texts)) :separator '(#\Newline)))

(test manual-3-7.messages-are-queued-until-they-are-displayed
  "3.7: nothing is printed before ERROR-DISPLAY is called; it prints messages of all types, oldest
first."
  (with-stroller ()
    (is (string= "" (with-output-to-string (*standard-output*)
                      (ars:error-set "one")
                      (ars:message-set "two")
                      (ars:warning-set "three")
                      (ars:error-set "four")
                      (ars:run-ticks 5))))
    (is (equal '("*ERROR* -> one" "two" "*WARNING* -> three" "*ERROR* -> four")
               (displayed-lines)))))

(test manual-3-7.displaying-flushes-the-queue
  "3.7: each message is printed once."
  (with-stroller ()
    (ars:message-set "once")
    (is (string= (format nil "once~%") (texts)))
    (is (string= "" (texts)))
    (ars:message-set "twice")
    (is (string= (format nil "twice~%") (texts)))))

(test manual-3-7.the-default-is-standard-output
  "3.7: ERROR-DISPLAY prints to the stream that it is given, or to standard output."
  (with-stroller ()
    (ars:message-set "here")
    (is (string= (format nil "here~%")
                 (with-output-to-string (*standard-output*) (ars:error-display))))
    (ars:message-set "there")
    (let ((stream (make-string-output-stream)))
      (is (string= "" (with-output-to-string (*standard-output*) (ars:error-display stream))))
      (is (string= (format nil "there~%") (get-output-stream-string stream))))))

(test manual-3-7.no-message-is-lost-for-want-of-a-stream
  "3.7: NIL and T are standard output, too; anything else than a stream is refused, and the messages
remain."
  (with-stroller ()
    (dolist (stream '(nil t))
      (ars:message-set "here")
      (is (string= (format nil "here~%")
                   (with-output-to-string (*standard-output*) (ars:error-display stream)))))
    (ars:message-set "still here")
    (dolist (stream '(7 "text" :stdout))
      (signals ars:wrong-argument (ars:error-display stream)))
    (is (string= (format nil "still here~%") (texts)))))

(test manual-3-7.items-are-printed-one-after-the-other
  "3.7, reading 36: like OUT does it: strings without quotes, T as a new line, other things as
PRINC prints them."
  (with-stroller ()
    (loop for (text . items) in `(("Robot turned 0.5 radians" "Robot turned " .5d0 " radians")
                                  ("0.25 -3 1/2 2.0e20" .25 " " -3 " " 1/2 " " 2d20)
                                  ("LATE STOPPED (A x)" late " " :stopped " " (a "x"))
                                  (,(format nil "one~%two~%") "one" t "two" t)
                                  ("STROLLER" ,stroller) ("NIL" nil) (""))
          do (loop for (set marker) in `((,#'ars:error-set "*ERROR* -> ")
                                         (,#'ars:warning-set "*WARNING* -> ")
                                         (,#'ars:message-set ""))
                   do (apply set items)
                      (is (string= (format nil "~A~A~%" marker text) (texts)))))))

(test manual-3-7.items-are-printed-when-they-are-read
  "3.7: the queue has the items, not their text; the printer's variables count when they are
displayed."
  (with-stroller ()
    (ars:message-set 10 " " 'name)
    (let ((*print-base* 2) (*print-case* :downcase))
      (is (string= (format nil "1010 name~%") (texts))))))

(test manual-3-7.they-return-nothing
  "3.7: neither setting nor displaying has a value."
  (with-stroller ()
    (dolist (function (list #'ars:error-set #'ars:warning-set #'ars:message-set))
      (is (null (multiple-value-list (funcall function "something")))))
    (is (null (multiple-value-list (ars:error-display (make-broadcast-stream)))))))

(test manual-3-7.flush-all-errors*-is-nil-by-default
  "3.7."
  (is (null ars:flush-all-errors*)))

(test manual-3-7.flush-all-errors*-displays-nothing
  "3.7, reading 207: where it is true messages are thrown away when they would be displayed, so
that none of them comes up later."
  (with-stroller ()
    (ars:error-set "never seen")
    (let ((ars:flush-all-errors* t))
      (ars:warning-set "never seen either")
      (is (string= "" (texts))))
    (is (string= "" (texts)))
    (let ((ars:flush-all-errors* t)) (ars:message-set "late"))
    (is (string= (format nil "late~%") (texts)) "what was not displayed meanwhile is still there")))

(test manual-3-7.commands-queue-messages
  "3.7, reading 229: all of them do, and nothing is printed unless somebody asks. Success is a
message, failure an error, an interruption a warning; errors have no prefix."
  (with-stroller (:clean t)
    (is (string= "" (with-output-to-string (*standard-output*)
                      (ars:robot-turn stroller 1)
                      (ars:run-ticks 2)
                      (ars:robot-go-forward stroller 20)
                      (ars:run-ticks 20)
                      (ars:robot-set-speed stroller .25)
                      (ars:run-ticks 1))))
    (is (equal '("*WARNING* -> robot-turn was interrupted" "*ERROR* -> Robot is blocked"
                 "robot-set-speed: Speed set to 0.25")
               (displayed-lines)))))

(test manual-3-7.warnings-come-before-what-they-follow-from
  "3.7, reading 87: a camera that goes into a bin first says what it loses thereby; its
continuations are called the other way round."
  (with-sprinter (:clean t)
    (follow-ball 9.5 5.5)
    (texts)
    (ars:camera-insert (lens) (ars:robot-storage-bin sprinter 0) (recorder :insert))
    (ars:run-ticks 5)
    (is (equal '("*WARNING* -> Camera 0 moved. No longer tracking Designator 0"
                 "*WARNING* -> Removing Designator 0"
                 "camera-insert: Camera 0 inserted into Storage-bin 0")
               (displayed-lines)))
    (is (equal '((:track nil) (:insert nil) (:track :lost-track))
               (mapcar (lambda (answer) (subseq answer 0 2)) (reverse *answers*))))))

(test manual-3-7.users-mistakes-are-messages
  "3.7, reading 86: an error in a continuation, kicker or event is queued, with its origin, and
the simulator goes on."
  (with-stroller (:clean t)
    (ars:robot-turn stroller .1 (lambda (&rest call) (declare (ignore call)) (error "oops")))
    (ars:schedule (nil) (error "ouch"))
    (ars:put-kicker moan (thing (put 'gnome '(2.5 2.5))) (:prob 1) (error "alas ~A" thing))
    (ars:run-ticks 2)
    (let ((texts (texts)))
      (dolist (words '("robot-turn" "oops" "ouch" "MOAN" "alas"))
        (is-true (search words texts :test #'char-equal) "~A" words)))
    (is (= 2 (ars:simulation-tick)))
    (is (null (end-code 'ars:robot-turn stroller 1)))))

(test manual-3-7.users-may-say-things-themselves
  "3.7: users can queue error and warning messages, too, anywhere; they come up in order."
  (with-stroller (:clean t)
    (ars:robot-turn stroller .1 (lambda (err robot angle)
                                  (declare (ignore err angle))
                                  (ars:warning-set robot " has turned")))
    (ars:run-ticks 2)
    (ars:error-set "later")
    (is (equal '("robot-turn: Robot turned 0.10" "*WARNING* -> STROLLER has turned"
                 "*ERROR* -> later")
               (displayed-lines)))))

(test manual-3-7.the-queue-is-bounded
  "3.7, reading 229: messages need not be read; the newest 1000 are kept, and a warning says how
many were dropped."
  (with-stroller ()
    (loop for i from 1 to 5000 do (ars:message-set "message " i))
    (let ((lines (displayed-lines)))
      (is (= 1001 (length lines)))
      (is (string= "*WARNING* -> 4000 earlier messages were forgotten" (first lines)))
      (is (string= "message 4001" (second lines)))
      (is (string= "message 5000" (first (last lines)))))))
