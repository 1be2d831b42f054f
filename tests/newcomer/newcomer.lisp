;;;; newcomer.lisp -- a new user types what the pages show into a terminal, and makes mistakes.

(in-package :ars-magna.tests)

(def-suite* newcomer :in ars-magna)

;;; Reading sessions and pages.

(test newcomer.types-what-follows-a-prompt
  (let ((block (make-page-block :lines '("$ ./cli/ars-magna" "Robot> turn 1" "Robot>"
                                         "Robot> robot-turn: Robot turned 1.00" "Robot> map"
                                         "# wall" "  ..." "Robot> quit"))))
    (is (session-block-p block))
    (is (equal '(("$" "./cli/ars-magna")
                 ("Robot>" "turn 1" "robot-turn: Robot turned 1.00")
                 ("Robot>" "map" "# wall" "  ...")
                 ("Robot>" "quit"))
               (session-turns block)))))

(test newcomer.holds-answers-against-the-page
  (let ((screen '("Robot> one 1.5" "" "two" "     three four")))
    (loop for (expected . patterns) in '((t "one 1.5") (t "two") (t "one 1.5" "two" "three four")
                                         (t "one ..." "..." "three four") (t "... four")
                                         (t "..." "two" "...") (t "one 1.5" "...")
                                         (nil "one") (nil "one 1.5" "three four") (nil "two" "two")
                                         (nil "three four" "two") (nil "one... 2" "two")
                                         (nil "two" "three four" "five"))
          do (is (eq expected (and (answered-p patterns screen) t)) "~S" patterns))))

(test newcomer.finds-blocks-and-forms-in-pages
  (let ((blocks (page-blocks "README.md")))
    (is (find "lisp" blocks :key #'page-block-kind :test #'equal))
    (is (find-if (lambda (block)
                   (and (session-block-p block)
                        (equal "A session at the prompt" (page-block-heading block))))
                 blocks)))
  (is (equal '(("(a ; b" "   c)") ("#t") ("'(d)"))
             (forms-in '("; x" "(a ; b" "   c)   ; y" "" "#t" "'(d) ; z")))))

(test newcomer.finds-what-it-holds
  "Each screen is held by one session, and each that a session holds is there."
  (let ((held (loop for name in (session-names)
                    append (loop for (word text) in (session-steps name)
                                 when (string= word "screen") collect text))))
    (is (< 8 (length held)))
    (is (equal (texts-in "screens") (sort held #'string<)))))

(defun call-with-programs (function)
  "Call FUNCTION, unless something is missing that it takes to play."
  (let ((missing (missing-program)))
    (if missing
        (skip "There is no ~A: no newcomer is played." missing)
        (funcall function))))

(defmacro when-there-are-programs (&body body)
  `(call-with-programs (lambda () ,@body)))

(defmacro with-shell ((terminal) &body body)
  "Run BODY with TERMINAL bound to one that is new."
  `(call-with-home (lambda (home) (call-with-terminal (lambda (,terminal) ,@body) home)) "shell"))

(test newcomer.says-what-is-wrong
  "A screen that is another, and what does not come, are troubles; a word that there is not, an
error."
  (when-there-are-programs
    (with-shell (terminal)
      (await-prompt terminal "$")
      (let ((*longest-wait* 1/10) (*grace* 1/10))
        (is (search "nowhere.txt" (play-step terminal "screen" "nowhere")))
        (is (search "does not come" (play-step terminal "wait" "no such thing"))))
      (is (null (play-step terminal "type" "echo 'one' \"two\"; # #{x} $HOME")))
      (is (null (play-step terminal "wait" "one two")))
      (signals error (play-step terminal "frobnicate" "")))))

;;; The sessions.

(test newcomer.plays-its-sessions
  "All at once, since most of their time is the robots'."
  (when-there-are-programs
    (is (eql 0 (make-core)))
    (loop for (name . troubles) in (play-sessions (session-names))
          do (dolist (trouble troubles)
               (is (null trouble) "The session ~A: ~A" name trouble)))))
