;;;; status.lisp -- the status of a robot as data, and why its last command failed.

(in-package :ars-magna.tests)

(def-suite* status :in ars-magna)

;;; The skater and its rink are those of ownership.lisp.

(defun plain-p (data)
  "True if DATA consists of numbers, symbols, strings and lists of such."
  (typecase data
    (cons (and (plain-p (car data)) (plain-p (cdr data))))
    (t (typep data '(or number symbol string)))))

(test status.says-all-of-a-robot-in-plain-data
  (with-skater ()
    (command:robot-turn skater 1)
    (run:run-ticks 3)
    (let ((status (run:status)))
      (is-true (plain-p status))
      (is (equal '(5d0 5d0) (getf status :position)))
      (is (eq 'rink (getf status :map)))
      (is (= 3 (getf status :tick)))
      (is (equal '(command:robot-turn) (mapcar (lambda (entry) (getf entry :command))
                                               (getf status :under-way))))
      (is (= 5 (length (getf (first (getf status :cameras)) :view))))
      (is (= 5 (getf (first (getf status :hands)) :strength)))
      (is (equal status (run:status 'skater)))
      (is (equal status (run:status skater))))))

(test status.tells-of-designators-as-the-prompt-does
  (with-skater ()
    (command:camera-get-object-designator (robot:robot-camera skater 0) :non-local
                                          '((:color world:red)))
    (run:run-ticks 20)
    (let ((designator (first (getf (run:status) :designators))))
      (is (equal '(0 :non-local :object)
                 (list (getf designator :number) (getf designator :type) (getf designator :of))))
      (is-true (find "0 Non-Local Object @" (at-the-prompt "status") :test #'search)))))

(test status.changes-nothing-in-the-run
  (flet ((digest-after (look)
           (run:with-simulation (skater :seed 3)
             (command:robot-go-forward skater 8)
             (loop repeat 20 do (run:run-ticks 1) (when look (run:status)))
             (run:state-digest))))
    (is (= (digest-after nil) (digest-after t)))))

(test status.of-what-is-no-robot-is-a-clear-error
  (with-skater ()
    (signals base:unknown-name (run:status 'nobody))))

;;; Why.

(defun why-said (&rest arguments)
  (with-output-to-string (out) (apply #'rpl:why (append arguments (list :stream out)))))

(test why.takes-names-of-robots
  (with-skater ()
    (dolist (name '(skater "skater")) (is (string= (why-said skater) (why-said name))))
    (signals base:unknown-name (why-said 'nobody-called-so))))

(test why.tells-of-the-command-that-failed-last
  (with-skater ()
    (is-true (has-words-p (why-said) "No command" "SKATER" "has failed"))
    (command:robot-set-speed skater 0)
    (command:robot-go-forward skater 3)
    (run:run-ticks 10)
    (let ((said (why-said)))
      (is-true (has-words-p said "(robot-go-forward skater 3)" "issued by Lisp" "after tick 0"
                            ":NOT-MOVING" "its speed is 0" "robot-set-speed"))
      (is (string= said (why-said skater)))
      (is (string= said (why-said (robot:robot-hand skater 0))) "of a part: of its robot")
      (is (eq :not-moving (getf (command:last-failure skater) :error)))
      (is (equal (command:last-failure skater) (getf (run:status) :failed))))))

(test why.names-what-took-over
  (with-skater ()
    (command:robot-turn skater 2)
    (run:run-ticks 3)
    (at-the-prompt "go-forward 3")
    (run:run-ticks 1)
    (is-true (has-words-p (why-said) "(robot-turn skater 2)" ":INTERRUPT"
                          "robot-go-forward, issued by the prompt"))))

(test why.tells-of-tracks-that-were-lost
  (with-skater ()
    (let ((camera (robot:robot-camera skater 0)) (seen nil))
      (command:camera-get-object-designator camera :non-local '((:color world:red))
                                            (lambda (err camera designator)
                                              (declare (ignore err camera))
                                              (setf seen designator)))
      (run:run-ticks 20)
      (command:camera-track camera seen)
      (run:run-ticks 10)
      (world:destroy-thing (world:find-thing 'puck))
      (run:run-ticks 3)
      (is (eq :lost-track (getf (command:last-failure skater) :error)))
      (is-true (has-words-p (why-said) "(camera-track (robot-camera skater 0)"
                            "(find-designator skater")))))

(test why.is-answered-at-the-prompt
  (with-skater ()
    (is-true (has-words-p (joined (at-the-prompt "set-speed 0" "go-forward 3" "why"))
                          ":NOT-MOVING" "issued by the prompt"))))

(test why.is-the-business-of-each-run
  (with-skater ()
    (command:robot-set-speed skater 0)
    (command:robot-go-forward skater 3)
    (run:run-ticks 10)
    (run:with-fork ()
      (is (eq :not-moving (getf (command:last-failure skater) :error)))
      (command:robot-set-speed skater -1)
      (run:run-ticks 10)
      (is (eq :negative-speed (getf (command:last-failure skater) :error))))
    (is (eq :not-moving (getf (command:last-failure skater) :error)))))

(test why.knows-each-code-of-the-manuals-commands
  (dolist (command (command:all-commands))
    (when (command:command-section command)
      (dolist (code (mapcar #'command:error-code-keyword (command:command-errors command)))
        (unless (command:manipulation-command-p command)
          (is-true (command:error-code-meaning code) "~S of ~A means nothing" code command)
          (is-true (or (command:error-code-remedy code) (eq code :grasping)))))))
  (is (null (command:error-code-meaning :my-own)))
  (is (null (command:error-code-remedy :my-own))))
