;;;; film-lines.lisp -- runs as films: FILM, RECORD.

(in-package :ars-magna.cli)

;;; The words FROM and TO.

(defun tick-after-word (word words line)
  "Return the tick typed after WORD, a string, in the list WORDS, or NIL if WORD is not in WORDS.
Signals BAD-LINE, about LINE, for anything else than a tick of the run."
  (let ((place (member word words :test #'string-equal)))
    (when place
      (let ((tick (and (rest place) (parse-typed-number (second place))))
            (now (simulation-tick (current-simulation))))
        (if (whole-p tick 0 now)
            tick
            (reject-line "~A ~A must be followed by a tick from 0 to ~D, the present tick~@[; not ~
                          ~A~]."
                         line word now (second place)))))))

(defun words-without (words pairs)
  "Return the list WORDS without the words in PAIRS and without the words that follow them."
  (loop while words
        for word = (pop words)
        if (member word pairs :test #'string-equal) do (pop words)
        else collect word))

(defun film-options (what)
  "Return the options of SAVE-ANIMATION for WHAT, the words typed after FILM and the file's name."
  (let* ((words (split-words (or what "")))
         (from (or (tick-after-word "FROM" words "FILM") 0))
         (until (tick-after-word "TO" words "FILM"))
         (others (words-without words '("FROM" "TO")))
         (look (remove "ANYWAY" others :test #'string-equal)))
    (when (and until (< until from))
      (reject-line "FILM FROM ~D TO ~D ends before it begins. Give the earlier tick first."
                   from until))
    (list* :from from :until until :anyway (/= (length look) (length others))
           (picture-options (format nil "~{~A~^ ~}" look) "FILM"))))

(define-line "FILM" (session (file :file "a name that ends in .html or .svg")
                             (what :rest "FROM tick, TO tick, ANYWAY; words as for PICTURE"
                                   :optional))
    (:seeing
     "FILM run.html FROM 100 TO 250 shows these ticks only.")
    "Save a film of the run so far in FILE, replacing it: an HTML page for any browser, to play,
stop and step through, or an animated SVG. The film marks what robots grasped, released and stowed,
failed commands and plans, and errors in your code. After FILE, give the words that PICTURE takes.
ANYWAY saves the film even if definitions have changed since the run began."
  (check-run-not-over)
  (let ((options (film-options what)))
    (flet ((save (*frame-hook*)
             (apply #'save-animation nil (path-of-name file) options)))
      (format t "~A~%" (native-name (call-showing-progress
                                     #'save session
                                     (or (getf options :until)
                                         (simulation-tick (current-simulation)))))))))

;;; RECORD.

(defun record-on (session what)
  (when (session-recording session)
    (reject-line "RECORD off first: this prompt is ~A. RECORD cancel discards that film."
                 (recording-text session)))
  (when (search ".html" what :test #'char-equal)
    (reject-line "RECORD on takes no file. RECORD off FILE saves the film in a file."))
  (begin-recording session (picture-options what "RECORD on"))
  (format t "R~A. RECORD off saves the film.~%" (subseq (recording-text session) 1)))

(defun record-off (session file)
  (let ((recording (session-recording session)))
    (unless recording
      (reject-line "No film is being recorded. RECORD on begins a film; FILM file saves a film of ~
                    the run so far."))
    (format t "~A~%" (call-showing-progress (lambda (tell) (end-recording session file tell))
                                            session (stop-recording recording)))))

(defun record-cancel (session)
  (if (shiftf (session-recording session) nil)
      (format t "The film is discarded.~%")
      (format t "No film is being recorded.~%")))

(define-line "RECORD" (session (action :record-action "on, off or cancel" :optional)
                               (what :rest "words as for PICTURE after ON; a file after OFF"
                                     :optional))
    (:seeing
     "RECORD on begins a film at the present tick. RECORD on BARE TRAIL chooses layers, as PICTURE
does."
     "RECORD off run.html saves the film in run.html, replacing it. RECORD off chooses a new name.
If the film cannot be saved, it is still being recorded: give another file."
     "RECORD cancel ends the recording without a film. RECORD tells whether a film is being
recorded."
     "The film shows the run in which it was begun. After a rewind it shows the run as it continues,
without the discarded ticks, and begins no later than the tick to which you went back. The film is
also saved if the prompt ends, or its window is closed."
     "Recording takes no time: the film is made from the journal when you save it.")
    "Record a film of the run, from RECORD on to RECORD off. The film is an HTML page for any
browser."
  (cond ((null action)
         (format t "~:[No film is being recorded~;~:*~@(~A~)~].~%" (recording-text session)))
        ((string-equal action "on") (record-on session what))
        ((string-equal action "off") (record-off session (and what (string-trim "\"" what))))
        ((string-equal action "cancel") (record-cancel session))
        (t (reject-line "RECORD takes on, off or cancel; not ~A." action))))

(define-argument-choices :record-action '(on off cancel))
