;;;; editing.lisp -- lines typed at a terminal, key by key.

(in-package :ars-magna.tests)

(def-suite* editing :in ars-magna)

;;; A keyboard with given keys. Each is typed when it is read, unless a test is about type-ahead.

(defclass keyboard (trivial-gray-streams:fundamental-character-input-stream)
  ((octets :initarg :octets :accessor keyboard-octets)
   (at-hand :initarg :at-hand :initform nil :reader keyboard-at-hand)
   (before :initarg :before :initform (constantly nil) :reader keyboard-before))
  (:documentation "A terminal that hands over OCTETS, a list; BEFORE is called before each. AT-HAND
is true if they are typed all at once."))

(defmethod trivial-gray-streams:stream-read-char ((keyboard keyboard))
  (funcall (keyboard-before keyboard))
  (or (pop (keyboard-octets keyboard)) :eof))

(defmethod trivial-gray-streams:stream-read-char-no-hang ((keyboard keyboard))
  (and (keyboard-at-hand keyboard) (or (pop (keyboard-octets keyboard)) :eof)))

(defparameter *key-codes*
  (flet ((escape (code) (format nil "~C[~A" #\Escape code)))
    `((:up . ,(escape "A")) (:down . ,(escape "B")) (:right . ,(escape "C"))
      (:left . ,(escape "D")) (:home . ,(escape "H")) (:end . ,(escape "4~"))
      (:delete . ,(escape "3~")) (:paste . ,(escape "200~")) (:pasted . ,(escape "201~"))
      (:word-left . ,(escape "1;5D")) (:enter . ,(string #\Return))
      (:rubout . ,(string (code-char 127))) (:tab . ,(string #\Tab))
      (:escape . ,(string #\Escape)) (:unknown . ,(escape "17~"))))
  "What a terminal hands over for keys that type nothing.")

(defun octets-of-key (key)
  "Return what a terminal hands over for KEY: a text, a character that is typed with control, or a
name in *KEY-CODES*."
  (etypecase key
    (string (map 'list #'code-char (sb-ext:string-to-octets key :external-format :utf-8)))
    (character (list (code-char (- (char-code key) 64))))
    (keyword (coerce (cdr (assoc key *key-codes*)) 'list))))

(defun keyboard-for (keys &rest options)
  (apply #'make-instance 'keyboard :octets (mapcan #'octets-of-key keys) options))

(defun typed-text-for (keyboard console &rest options)
  (apply #'make-instance 'cli::edited-text :octets keyboard :console console :by-hand-p t options))

(defun terminal-console (&optional (columns 80) (rows 24))
  "Return a console on a terminal of that size, and the stream that hears it."
  (let ((out (make-string-output-stream)))
    (values (cli::make-console out (lambda () (values columns rows))) out)))

(defun keyed-in (&rest keys)
  "Return the lines that KEYS type, a list."
  (let ((stream (typed-text-for (keyboard-for keys) (terminal-console))))
    (loop for line = (read-line stream nil)
          while line
          collect line
          do (cli::add-to-history stream line nil))))

(defmacro types-p (expected &rest keys)
  `(is (equal ',expected (keyed-in ,@keys))))

;;; Editing.

(test editing.types-what-is-typed
  (types-p ("turn 1" "" "go") "turn 1" :enter :enter "go" :enter)
  (types-p ("größer 漢字 é") "größer 漢字 é" :enter)
  (types-p ("at the end") "at the end")
  (types-p () #\D))

(test editing.draws-once-what-comes-at-once
  "Where a terminal pastes without saying so, what is pasted is not drawn letter by letter."
  (multiple-value-bind (console out) (terminal-console)
    (let ((text (make-string 5000 :initial-element #\x)))
      (is (string= text (read-line (typed-text-for (keyboard-for (list text :enter) :at-hand t)
                                                   console))))
      (is (< (length (get-output-stream-string out)) 20000)))))

(test editing.many-lines-that-come-at-once-cost-no-more-each
  (flet ((lines (count)
           (loop repeat count collect "(list 1 2 3" collect :enter)))
    (let* ((console (terminal-console))
           (stream (typed-text-for (keyboard-for (lines 3000) :at-hand t) console)))
      (is (> 400000000 (bytes-consed-by (lambda ()
                                         (loop while (read-line stream nil)))))))))

(test editing.control-c-forgets-what-waits
  "It is for the line that was under way; what was typed after it stays."
  (let ((queue (cli::make-octet-queue)))
    (cli::add-octets queue (octets-of-key (format nil "one~Ctwo~:*~Cthree"
                                                  (code-char 3))))
    (cli::put-back-octet queue #\x)
    (is-true (cli::drop-until-interrupt queue))
    (is (equal "three" (coerce (cli::remove-all-octets queue) 'string)))
    (is-false (cli::drop-until-interrupt queue))
    (cli::put-back-octet queue (code-char 3))
    (cli::add-octets queue (list #\y))
    (is (eql (code-char 3) (cli::pop-octet queue)))
    (is-false (cli::drop-until-interrupt queue))
    (is (equal '(#\y) (cli::remove-all-octets queue)))))

(test editing.moves
  (types-p ("xabc") "abc" #\A "x" :enter)
  (types-p ("xabcy") "abc" :home "x" :end "y" :enter)
  (types-p ("abxc") "abc" :left "x" :enter)
  (types-p ("aybxc") "abc" #\B "x" :left :left "y" :enter)
  (types-p ("axbc") "abc" :home :right "x" :enter)
  (types-p ("one xtwo") "one two" :word-left "x" :enter)
  (types-p ("xone two") "one two" :escape "b" :escape "b" "x" :enter)
  (types-p ("onex two") "one two" :home :escape "f" "x" :enter)
  (types-p ("xabcy") "abc" :left :left :left :left :left "x" #\E :right :right "y" :enter))

(test editing.deletes
  (types-p ("ab") "abc" :rubout :enter)
  (types-p ("bc") "abc" :home :delete :enter)
  (types-p ("ac") "abc" :left :left #\D :enter)
  (types-p ("" "x") :rubout :delete :enter #\H "x" :enter))

(test editing.kills-and-brings-back
  (types-p ("ab") "abc" :left #\K :enter)
  (types-p ("c") "abc" :left #\U :enter)
  (types-p ("two one ") "one two" #\W #\A #\Y " " #\E :enter)
  (types-p ("robot- robot-turn-left") "robot-turn-left" #\U "robot-" " " #\Y :enter)
  (types-p ("robot-") "robot-turn" :escape :rubout :enter)
  (types-p (" two") "one two" :home :escape "d" :enter)
  (types-p ("abc") "abc" #\K :enter))

(test editing.ignores-what-it-does-not-know
  (types-p ("abc") "a" :unknown "b" :escape "?" "c" #\G :enter))

(test editing.reads-on-whatever-octets
  (let ((stream (typed-text-for
                 (make-instance 'keyboard :octets (map 'list #'code-char '(97 200 13 255 98 13)))
                 (terminal-console))))
    (is (= 2 (length (loop for line = (read-line stream nil) while line collect line))))))

;;; Pasting.

(test editing.takes-what-is-pasted-at-once
  "Nothing of it is carried out, or completed, before the user presses return."
  (types-p ("turn 1" "map 4") :paste "turn 1" :enter "map 4" :enter :pasted :enter)
  (types-p ("turn 1!" "map 4") :paste (format nil "turn 1~%map 4~%") :pasted :up "!" :enter)
  (is (equal (list (format nil "(list~A1)" #\Tab))
             (keyed-in :paste (format nil "(list~A1)" #\Tab) :pasted :enter)))
  (is (equal '("[201" "~x") (keyed-in :paste "[201" :enter "~x" :pasted :enter))))

(test editing.shows-pasted-lines-one-by-one
  (multiple-value-bind (console out) (terminal-console)
    (let ((stream (typed-text-for (keyboard-for '(:paste "one" :enter "two" :pasted :enter))
                                  console)))
      (cli::show-prompt console "Robot> ")
      (read-line stream)
      (get-output-stream-string out)
      (cli::show-prompt console "Robot> ")
      (read-line stream)
      (let ((shown (get-output-stream-string out)))
        (is (search "Robot> two" shown))
        (is (char= #\Newline (char shown (1- (length shown)))))))))

(test editing.leaves-the-answers-out-of-what-is-pasted
  "Prompts tell which lines were typed; without any, all were."
  (types-p ("turn 1" "(list 1" "2)" "0")
           :paste (format nil "Robot> turn 1~%Robot> robot-turn: Robot turned 1.00~%~
                               *WARNING* -> Removing Designator 0~%Robot> (list 1~%     > 2)~%~
                               (1 2)~%Break> 0~%33~%Robot> ")
           :pasted :enter)
  (types-p ("rn 1" "go 1")
           :paste (format nil "rn 1~%Robot> go 1~%on") :pasted :enter)
  (types-p ("turn 1" "33") :paste (format nil "turn 1~%33") :pasted :enter))

(test editing.says-how-many-lines-after-the-last-prompt-it-leaves-out
  (is (equal '(0 0 2 1 0)
             (mapcar (lambda (text) (cli::count-output-lines (format nil text)))
                     '("turn 1~%33" "Robot> turn 1~%33~%Robot> "
                       "Robot> (list :p)~%(:p)~%(list 2)~%" "Robot> (list~%1)~%(1)"
                       "33~%Robot> (list~%     > 1)~%~%"))))
  (multiple-value-bind (console out) (terminal-console)
    (read-line (typed-text-for (keyboard-for (list :paste (format nil "Robot> 1~%1~%2") :pasted
                                                   :enter))
                               console))
    (is-true (search "2 lines after the last pasted prompt" (get-output-stream-string out)))))

(test editing.keeps-all-lines-of-a-form-that-is-pasted-with-prompts
  "Pages show a form of several lines below one prompt."
  (types-p ("(list 1" "  (+ 1" "     1))" "go 1")
           :paste (format nil "Robot> (list 1~%  (+ 1~%     1))~%(1 2)~%Robot> go 1~%Robot> ")
           :pasted :enter))

(test editing.takes-many-lines-and-long-ones
  (let ((lines (loop for i below 20000 collect (format nil "turn ~D" i)))
        (long (make-string 100000 :initial-element #\x)))
    (is (equal lines (keyed-in :paste (format nil "~{~A~%~}" lines) :pasted :enter)))
    (is (equal lines (keyed-in :paste (format nil "~{~A~C~%~}" (mapcan (lambda (line)
                                                                         (list line #\Return))
                                                                       lines))
                               :pasted :enter)))
    (is (equal (list long) (keyed-in :paste long :pasted :enter)))))

;;; Tab.

(test tab.lists-again-only-what-has-changed
  (flet ((listings (&rest keys)
           (multiple-value-bind (console out) (terminal-console)
             (let ((cli::*completer* (lambda (text point)
                                       (declare (ignore text point))
                                       (values 0 '("camera" "cam-track") " "))))
               (read-line (typed-text-for (keyboard-for keys) console) nil))
             (occurrences "cam-track" (get-output-stream-string out)))))
    (is (= 1 (listings "cam" :tab :enter)))
    (is (= 1 (listings "cam" :tab :tab :tab :enter)))
    (is (= 2 (listings "cam" :tab "x" :rubout :tab :enter)))))

(test tab.completes-nothing-that-a-program-reads
  (let ((cli::*completer* (lambda (text point)
                            (declare (ignore text point))
                            (values 0 '("camera") " ")))
        (cli::*before-program-reads* (constantly nil)))
    (is (equal "cam" (read-line (typed-text-for (keyboard-for '("cam" :tab :enter))
                                                (terminal-console))
                                nil)))))

;;; Control C and D.

(defun interrupted-p (keys &rest options)
  "True if KEYS interrupt the line that is being read."
  (let ((stream (typed-text-for (apply #'keyboard-for keys options) (terminal-console))))
    (handler-case (progn (read-line stream nil) nil)
      (host:user-interrupt () t))))

(test interrupts.clear-what-is-typed
  (types-p ("go") "turn 1" #\C "go" :enter)
  (is-false (interrupted-p '("turn 1" #\C :enter))))

(test interrupts.end-what-waits-for-a-line
  (is-true (interrupted-p '(#\C)))
  (is-true (interrupted-p '("turn 1" #\C #\C))))

(test interrupts.straight-after-a-line-are-for-that-line
  "Also if they have come before the line was read."
  (is-true (interrupted-p '("(loop)" :enter #\C) :at-hand t))
  (is-false (interrupted-p '("(loop)" :enter "go" :enter) :at-hand t)))

(test interrupts.leave-what-was-pasted
  (let ((stream (typed-text-for (keyboard-for '(:paste "one" :enter "two" :pasted :enter
                                                "three" :enter))
                                (terminal-console))))
    (is (equal "one" (read-line stream)))
    (is (= 1 (cli::discard-waiting-lines stream)))
    (is (equal '("two") (cli::history-entries (cli::edited-history stream))))
    (is (equal "three" (read-line stream)))))

(test editing.keeps-what-is-typed-ahead
  (let ((stream (typed-text-for (keyboard-for '("one" :enter "two" :enter) :at-hand t)
                                (terminal-console))))
    (is (equal "one" (read-line stream)))
    (is-true (cli::typed-input-within-p stream 0))
    (is (equal "two" (read-line stream)))))

(test editing.takes-for-pasted-what-comes-all-at-once
  "Where the terminal does not say so: as lines that wait for each other, also to be dropped."
  (flet ((typed (&rest keys)
           (let ((stream (typed-text-for (keyboard-for keys :at-hand t) (terminal-console))))
             (values stream (read-line stream)))))
    (is-true (cli::pasted-lines-waiting-p (typed "one" :enter "two" :enter)))
    (is-false (cli::pasted-lines-waiting-p (typed "one" :enter)))
    (is-false (cli::pasted-lines-waiting-p (typed "one" :enter "t")))
    (let ((stream (typed "one" :enter "two" :enter "three" :enter "fo")))
      (is (= 2 (cli::discard-waiting-lines stream)))
      (is (equal "fo" (read-line stream))))))

(test editing.swallows-one-key-and-no-more
  (flet ((rest-of (&rest keys)
           (let ((stream (typed-text-for (keyboard-for keys :at-hand t) (terminal-console))))
             (cli::discard-next-key stream)
             (read-line stream nil))))
    (is (null (rest-of "q")))
    (is (null (rest-of :up)))
    (is (equal "go 3" (rest-of "go 3" :enter)))))

(test editing.answers-programs-that-ask
  (multiple-value-bind (console out) (terminal-console)
    (let* ((stream (typed-text-for (keyboard-for '("x" :enter "y" :rubout "y" :enter)) console))
           (*query-io* (make-two-way-stream stream console)))
      (is-true (y-or-n-p "Really?"))
      (is (search "Really? (y or n) y" (get-output-stream-string out))))))

(defun screen-while-lines-are-done (&rest keys)
  "Return what the terminal hears while KEYS are pressed at a prompt."
  (multiple-value-bind (console out) (terminal-console)
    (cli:run-session (cli:make-session :input (typed-text-for (keyboard-for keys) console)
                                       :output console :color :never))
    (get-output-stream-string out)))

(test editing.programs-that-ask-say-so
  "What is typed next is no line of the prompt. It is told once for each line; control-C ends the
program, whatever has been typed."
  (let ((heard (screen-while-lines-are-done "(list (read) (y-or-n-p \"ok?\"))" :enter "7" :enter
                                            "y" :enter "quit" :enter)))
    (is (= 1 (occurrences "A program waits for your answer; control-C ends the program." heard)))
    (is (mentions-p heard "Answer> 7"))
    (is (mentions-p heard "ok? (y or n) y"))
    (is (mentions-p heard "(7 T)")))
  (let ((heard (screen-while-lines-are-done "(read)" :enter "half" #\C "(+ 20 22)" :enter
                                            "quit" :enter)))
    (is (mentions-p heard "Interrupted."))
    (is (mentions-p heard "42"))))
