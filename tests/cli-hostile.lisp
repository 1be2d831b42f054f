;;;; cli-hostile.lisp -- no typed input crashes the prompt.

(in-package :ars-magna.tests)

(def-suite* cli-hostile :in ars-magna)

;;; Octets.

(defun octets-typed (octets)
  "Return what is read when OCTETS, a list of octets and strings, are typed."
  (make-instance 'cli::typed-text
                 :octets (make-string-input-stream
                          (format nil "~{~A~}" (mapcar (lambda (part)
                                                         (if (integerp part) (code-char part) part))
                                                       octets)))))

(test input.may-be-any-octets
  (let ((input (octets-typed (list #xF7 #xB2 #xBB #x9B (string #\Newline)
                                   "a" #xC3 #xA9 "b" #xFF (string #\Newline) "last"))))
    (is (string= "����" (read-line input)))
    (is (string= (format nil "a~Cb�" (code-char 233)) (read-line input)))
    (is (equal '("last" t) (multiple-value-list (read-line input))))
    (is (null (read-line input nil)))))

(test input.can-be-read-by-characters
  (let ((input (octets-typed (list "(1 2)3" (string #\Newline) "4"))))
    (is (equal '(1 2) (read input)))
    (is (char= #\3 (peek-char nil input)))
    (is (string= "3" (read-line input)))
    (is (char= #\4 (read-char input)))
    (is (eq :end (read-char input nil :end)))))

(test input.has-lines-of-bounded-length
  (let ((input (octets-typed (list (make-string (* 10 cli::+longest-line-typed+)
                                                :initial-element #\a)
                                   (string #\Newline) "next" (string #\Newline)))))
    (signals cli:bad-line (read-line input))
    (is (string= "next" (read-line input))))
  (let ((longest (make-string cli::+longest-line-typed+ :initial-element #\b)))
    (is (string= longest (read-line (octets-typed (list longest (string #\Newline))))))))

(test files.may-have-any-octets
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp"
                             :element-type '(unsigned-byte 8))
    (write-sequence #(59 #xF7 #xB2 #xBB #x9B 10 40 43 32 49 32 #xFF 41 10) out)
    :close-stream
    (signals error (base:file-text path))
    (signals run:damaged-journal (run:read-journal path))
    (signals error (cli::load-lisp path))))

;;; What is shown.

(test complaints.have-nothing-that-a-terminal-obeys
  (let ((text (complaint (format nil "no~C[31m~Csuch~C" #\Esc (code-char 0) (code-char #x9B)))))
    (is (notany #'cli::control-character-p text))
    (is-true (has-words-p text "NO^[[31M^@SUCH?"))
    (is (notany #'cli::control-character-p
                (first (type-batch (format nil "(error-set \"a~Cb\")" #\Esc)))))))

(test complaints.say-whose-name-it-is-and-how-to-have-it
  (is-true (has-words-p (complaint "(defparameter robot-turn 1)")
                        "ROBOT-TURN is a name of the package ARS-MAGNA" "(shadow 'ROBOT-TURN)"))
  (is-true (has-words-p (complaint "(intern \"NO-NAME-OF-OURS\" :ars)") "lock" "NO-NAME-OF-OURS")))

(test complaints.are-short
  (is (< (length (complaint (format nil "turn ~A" (make-string 100000 :initial-element #\x))))
         1100))
  (is (< (length (complaint (format nil "(error \"~A\")"
                                    (make-string 100000 :initial-element #\x))))
         1100)))

(test lists.without-end-can-be-shown
  (is (equal '("#1=(1 . #1#)") (type-batch "(quote #1=(1 . #1#))")))
  (is-true (has-words-p (complaint "turn #1=(1 . #1#)") "#1=(1 . #1#)" "radians"))
  (is-true (has-words-p (complaint "turn #1=(#1# . #1#)") "radians")))

;;; What is read runs nothing.

(defvar *touched* nil "Whether something has been run that was to be read only.")

(defstruct (touching (:constructor make-touching (&key (a (setf *touched* t)))))
  "What touches as it is made."
  a)

(test arguments.run-nothing
  (setf *touched* nil)
  (dolist (datum '("#.(setf ars-magna.tests::*touched* t)"
                   "(1 #.(setf ars-magna.tests::*touched* t))"
                   "?#.ars-magna.tests::*touched*"
                   "#S(ars-magna.tests::touching)"))
    (dolist (name '("turn" "plan fetch-thing" "obj-desig 0 local" "params max-speed" "rate"))
      (is-true (complaint (format nil "~A ~A" name datum)))))
  (is (null *touched*)))

;;; Stacks.

(defun nested (count &optional (end ""))
  (format nil "~A~A" (make-string count :initial-element #\()
          (if (string= end "") end (make-string count :initial-element (char end 0)))))

(test stack.overflows-and-the-session-goes-on
  (let ((lines (append (loop repeat 4
                             collect (nested 300000)
                             collect (nested 300000 ")")
                             collect (format nil "turn ~A" (nested 300000))
                             collect "(labels ((f (n) (1+ (f n)))) (f 1))")
                       '("(+ 1 2)"))))
    (multiple-value-bind (written errors) (type-lines lines :batch t)
      (is (= 16 errors))
      (is (= 16 (count-if (lambda (line) (search "The stack has overflowed" line)) written)))
      (is (string= "3" (first (last written)))))))

(test stack.of-files-overflows-too
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (write-string (nested 300000) out)
    :close-stream
    (let ((line (format nil "(load ~S)" (uiop:native-namestring path)))
          (world (format nil "world ~A" (uiop:native-namestring path))))
      (is (equal '("3") (last (type-batch line world line world "(+ 1 2)"))))
      (is (= 4 (nth-value 1 (type-batch line world line world "(+ 1 2)")))))
    (signals run:damaged-journal (run:read-journal path))))

(test stack.may-overflow-because-the-program-says-so
  "SBCL ends at once when its stack overflows, if it is told to lose on corruption."
  (is (null (search "--lose-on-corruption" (base:read-file-into-string
                                            (project-file "cli/ars-magna"))))))

(test memory.that-is-not-there-is-a-message
  (is-true (has-words-p (complaint "(make-array (expt 2 40))") "not enough memory")))

(test memory.that-is-used-up-is-given-back
  "In a process of its own: what is used up is not this one's. Arrays are large, so that some room
is left: SBCL itself ends where there is none at all."
  (multiple-value-bind (status text)
      (with-input-from-string (input (format nil "~A~%~:*~A~%(+ 1 2)~%"
                                             "(loop with l do (push (make-array 20000000) l))"))
        (base:run-command "sh" (list (base:native-name (project-file "cli/ars-magna")) "--batch")
                          :input input :output :string))
    (is (eql 1 status))
    (is (= 2 (count-if (lambda (line) (search "not enough memory" line)) (lines-of text))))
    (is (equal '("3") (last (lines-of text))))))

(test maps.have-room-in-memory
  (handler-case (progn (world:define-map 'ars-user::vast 20000 20000)
                       (fail "a map of 400 million cells was made"))
    (base:malformed-definition (condition)
      (is-true (has-words-p (princ-to-string condition) "(20000 20000)" "at most" "cells"
                            (format nil "~D" (isqrt (floor (base:heap-bytes)
                                                           world::+cell-bytes+))))))))

;;; Who reads no more.

(defclass full-device (trivial-gray-streams:fundamental-character-output-stream) ()
  (:documentation "A stream that nothing can be written to."))
(defmethod trivial-gray-streams:stream-line-column ((stream full-device)) 0)
(defmethod trivial-gray-streams:stream-write-char ((stream full-device) char)
  (declare (ignore char))
  (error 'stream-error :stream stream))

(test output.that-is-lost-ends-the-program
  (let ((console (cli::make-console (make-instance 'full-device))))
    (is (= 1 (cli::call-for-status (lambda ()
                                     (loop repeat 3 do (format console "lost~%"))
                                     0))))
    (finishes (format console "nobody hears~%"))
    (is (= 1 (cli::finish-console console 0)))))

;;; Interrupts.

(test interrupts.wait-for-their-place
  (let ((log '()))
    (base:call-holding-interrupts
     (lambda ()
       (bordeaux-threads:interrupt-thread (bordeaux-threads:current-thread)
                                          (lambda () (push :interrupt log)))
       (push :held log)
       (base:call-releasing-interrupts (lambda () (push :line log)))
       (push :held log)))
    (is (equal '(:held :interrupt :line :held) (reverse log)))))

(defun interrupts-in-order (function)
  "Return in order the keywords that FUNCTION gives to a function, and :INTERRUPT where one comes
that this thread sends itself when FUNCTION calls a second function."
  (let ((log '()))
    (funcall function
             (lambda (word) (push word log))
             (lambda ()
               (bordeaux-threads:interrupt-thread (bordeaux-threads:current-thread)
                                                  (lambda () (push :interrupt log)))))
    (reverse log)))

(test interrupts.held-off-come-where-they-are-let-in
  (is (equal '(:held :interrupt :open :held)
             (interrupts-in-order
              (lambda (note interrupt)
                (base:deferring-interrupts
                  (funcall interrupt)
                  ;; One around another holds off nothing more.
                  (base:deferring-interrupts
                    (funcall note :held)
                    (base:allowing-interrupts (funcall note :open)))
                  (funcall note :held)))))))

(test interrupts.held-off-come-where-we-wait-and-not-where-sbcl-does
  "SBCL's runtime dies if interrupts that it lets in where it waits come during a collection; and
locks would let them in, too."
  (is (equal '(:held :held :interrupt :waited :held :interrupt)
             (interrupts-in-order
              (lambda (note interrupt)
                (let ((semaphore (sb-thread:make-semaphore)) (lock (base:make-lock "any")))
                  (base:deferring-interrupts
                    (funcall interrupt)
                    (base:with-lock (lock) (funcall note :held))
                    (sb-thread:wait-on-semaphore semaphore :timeout 0.001)
                    (funcall note :held)
                    (base:wait-on-semaphore semaphore 0.001)
                    (funcall note :waited)
                    (funcall interrupt)
                    (base:call-holding-interrupts
                     (lambda () (base:allowing-interrupts (funcall note :held)))))))))))

(test interrupts.end-a-line
  (let ((lines '("(progn (ars-magna.host:signal-user-interrupt) 7)" "(+ 1 2)")))
    (is (equal '("Robot> Interrupted. QUIT leaves." "Robot> 3" "Robot> ")
               (values (type-lines lines))))
    (is (= 130 (catch 'cli::leave (type-lines lines :batch t))))))
