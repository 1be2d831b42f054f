;;;; cli-films.lisp -- films of a part of a run, and films recorded at the prompt.

(in-package :ars-magna.tests)

(def-suite* cli-films :in ars-magna)

(defmacro with-film-file ((file name) &body body)
  "Run BODY with NAME bound to the name of an HTML file that is deleted afterwards, and FILE to a
function that returns its text."
  (let ((path (gensym)))
    `(with-scratch-file (,path "html")
       (let ((,name (uiop:native-namestring ,path)))
         (flet ((,file () (uiop:read-file-string ,path)))
           ,@body)))))

(test film.of-some-ticks
  (with-film-file (film name)
    (type-batch "turn 1" "step 20" (format nil "film ~A from 5 to 9" name))
    (is (mentions-p (film) "\"ticks\":[5,6,7,8,9]"))
    (is (mentions-p (film) "ticks 5 to 9</title>"))
    (type-batch "step 3" (format nil "film ~A bare from 3" name))
    (is (mentions-p (film) "\"ticks\":[3]")))
  (is-true (has-words-p (complaint "film run.html from 9") "FROM" "0 to 0" "not 9"))
  (is-true (has-words-p (complaint "film run.html from") "FROM must be followed"))
  (is-true (has-words-p (joined (type-batch "step 9" "film run.html from 5 to 2"))
                        "ends before it begins")))

(test film.part-shows-what-the-whole-shows
  "Trails and what has happened come from the beginning of the run; earlier moments are left out."
  (in-studio (robot)
    (let* ((whole (film-of robot #'ungrasp-nothing :layers '(:trail)))
           (part (film-of robot #'identity :layers '(:trail) :from 10)))
      (is (equal (nthcdr 10 (frames-shown whole)) (frames-shown part)))
      (is (mentions-p whole "not holding anything"))
      (is (not (mentions-p part "not holding anything")))
      (signals base:wrong-argument (film-of robot #'identity :from 21)))))

(test record.makes-a-film-of-what-happens-meanwhile
  (with-film-file (film name)
    (let ((lines (type-batch "step 3" "record on bare trail" "step 4" "record"
                             (format nil "record off ~A" name) "record")))
      (is (equal "Recording a film since tick 3." (fourth lines)))
      (is-true (has-words-p (fifth lines) "Film of ticks 3 to 7: " name))
      (is-true (has-words-p (sixth lines) "web browser"))
      (is (equal "No film is being recorded." (car (last lines)))))
    (is (mentions-p (film) "\"ticks\":[3,4,5,6,7]"))))

(test record.loses-nothing-if-the-film-cannot-be-saved
  (with-film-file (film name)
    (let ((text (joined (type-batch "record on" "step 2" "record off /no/such/directory/a.html"
                                    "record on" "step 1" (format nil "record off ~A" name)))))
      (is-true (has-words-p text "/no/such/directory" "RECORD off first" "Film of ticks 0 to 3")))
    (is (mentions-p (film) "\"ticks\":[0,1,2,3]"))))

(defun call-recording-in-studio (function)
  "Call FUNCTION with a session that records a film of a run in the studio since tick 0, and with
the run, at tick 4."
  (in-studio (robot)
    (let ((session (cli:make-session :batch t :input (make-string-input-stream ""))))
      (cli::begin-recording session '())
      (run:run-ticks 4)
      (funcall function session (time:current-simulation)))))

(test record.ends-at-the-tick-at-which-it-was-stopped
  "The run goes on while the film is being saved. Meanwhile the status says so."
  (with-film-file (film name)
    (call-recording-in-studio
     (lambda (session simulation)
       (let ((texts '()))
         (flet ((go-on (tick)
                  (declare (ignore tick))
                  (push (list (cli:recording-text session simulation)
                              (cli:recording-film-p session))
                        texts)
                  (run:run-ticks 1 simulation)))
           (is (equal '("recording a film since tick 0" t)
                      (list (cli:recording-text session) (cli:recording-film-p session))))
           (is-true (has-words-p (cli::end-recording session name #'go-on) "Film of ticks 0 to 4:"))
           (is (equal '(("saving a film from tick 0 to 4" nil))
                      (remove-duplicates texts :test #'equal)))
           (is (< 4 (run:simulation-tick simulation)))
           (is (null (cli:recording-text session)))))))
    (is (mentions-p (film) "\"ticks\":[0,1,2,3,4]"))))

(test record.goes-on-after-an-error-unless-the-prompt-has-ended
  (with-film-file (film name)
    (call-recording-in-studio
     (lambda (session simulation)
       (flet ((fail-once ()
                (signals error (cli::end-recording session name
                                                   (lambda (tick) (error "At ~D." tick))))
                (run:run-ticks 1 simulation)))
         (fail-once)
         (is (cli:recording-film-p session))
         (setf (cli::session-over-p session) t)
         (fail-once)
         (is-true (has-words-p (cli::end-recording session name) "Film of ticks 0 to 5:")))))
    (is (mentions-p (film) "\"ticks\":[0,1,2,3,4,5]"))))

(test film.ends-at-the-tick-at-which-it-was-begun
  (with-film-file (film name)
    (in-studio (robot)
      (run:run-ticks 3)
      (let* ((simulation (time:current-simulation))
             (display:*frame-hook* (lambda (tick)
                                     (declare (ignore tick))
                                     (run:run-ticks 1 simulation))))
        (display:save-animation nil name)
        (is (< 3 (run:simulation-tick simulation)))))
    (is (mentions-p (film) "\"ticks\":[0,1,2,3]"))))

(test record.follows-a-rewind
  "The film begins no later than where the run went back to, and has no discarded ticks."
  (with-film-file (film name)
    (type-batch "(keep-forks)" "step 10" "record on" "step 4" "rewind 9" "step 3"
                (format nil "record off ~A" name))
    (is (mentions-p (film) "\"ticks\":[5,6,7,8]"))))

(test record.shows-the-run-in-which-it-was-begun
  (with-film-file (film name)
    (let ((text (joined (type-batch "(keep-forks)" "step 2" "record on" "step 2" "fork" "step 5"
                                    "record" (format nil "record off ~A" name)))))
      (is-true (has-words-p text "recording a film of PARLOUR since tick 2"
                            "Film of ticks 2 to 4"))
      (is (mentions-p (film) "\"ticks\":[2,3,4]")))))

(test record.ends-with-the-prompt
  "The file gets a name of its own. Nothing is saved after RECORD cancel."
  (call-in-directory
   (lambda (directory)
     (uiop:with-current-directory (directory)
       (flet ((films ()
                (mapcar #'file-namestring (directory (merge-pathnames "*.html" directory)))))
         (type-batch "record on" "record cancel" "step 1")
         (is (null (films)))
         (dotimes (count 2)
           (is-true (has-words-p (joined (type-batch "record on" "step 2"))
                                 "Film of ticks 0 to 2")))
         (is (null (set-exclusive-or '("butler-000000-000002.html" "butler-000000-000002-2.html")
                                     (films) :test #'equal))))))))

(test record.answers-wrong-words
  (is-true (has-words-p (complaint "record off") "No film is being recorded" "RECORD on"))
  (is-true (has-words-p (complaint "record often") "on, off or cancel"))
  (is-true (has-words-p (complaint "record on trial") "RECORD on does not take" "TRAIL")))
