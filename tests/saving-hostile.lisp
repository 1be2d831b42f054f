;;;; saving-hostile.lisp -- files that are no saved runs, or damaged, or forged.

(in-package :ars-magna.tests)

(in-suite saving)

(defun write-saved-ride (file)
  "Save a moment of a random ride in FILE. Return the digest."
  (run:with-simulation ((keeper helper) :seed 34 :journal t)
    (let ((*ride* (make-ride (base:make-dice 34 "hostile")))
          (*commands-to-draw* (recorded-commands)))
      (populate)
      (loop repeat 40 do (step-ride) (base:take-messages))
      (run:save-simulation file)
      (run:state-digest))))

(defun loading-outcome (file &rest options)
  "Return the digest of what is saved in FILE, or the condition of ours that its loading signals.
What else may be signalled is not caught."
  (handler-case (run:state-digest (apply #'run:load-simulation file options))
    (base:ars-magna-error (trouble) trouble)))

(defun harmless-p (outcome digest)
  "True if OUTCOME of a loading is that damage was found, or did no harm."
  (or (typep outcome 'run:damaged-simulation) (eql digest outcome)))

(test saved-damage.is-found
  "200 damages to the text, 100 to its bytes."
  (with-temporary-file (file)
    (let* ((digest (write-saved-ride file)) (dice (base:make-dice 79))
           (bytes (alexandria:read-file-into-byte-vector file))
           (text (base:read-file-into-string file)))
      (dotimes (i 200)
        (write-text (damaged-text text dice) file)
        (is (harmless-p (loading-outcome file) digest) "damage ~D" i))
      (dotimes (i 100)
        (let ((copy (copy-seq bytes)))
          (setf (aref copy (base:roll-index (length copy) dice)) (base:roll-index 256 dice))
          (alexandria:write-byte-vector-into-file copy file :if-exists :supersede))
        (is (harmless-p (loading-outcome file) digest) "damage ~D to bytes" i)))))

;;; Forgeries: the check sums are right.

(defun saved-texts (file)
  "Return the texts of the lines of the saved run in FILE, without check sums."
  (loop for line in (rest (journal-lines file))
        collect (subseq line 0 (- (length line) 10))))

(defun write-saved-texts (texts file)
  (write-lines (cons run::+saved-title+ (sealed-lines texts)) file))

(defun word-places (text)
  "Return where the words in TEXT, outside of quotes, begin and end: conses."
  (loop with start = nil and quote = nil
        for char across text
        for position from 0
        for inside = (not (find char "() \"|"))
        do (when (find char "\"|")
             (setf quote (cond ((null quote) char) ((eql quote char) nil) (t quote))))
        if (and inside (null quote) (null start))
          do (setf start position)
        else if (and start (not inside))
               collect (cons start position) into places and do (setf start nil)
        finally (return places)))

(defun forged-text (text words dice)
  "Return TEXT with one of WORDS instead of one that it has, by DICE."
  (let ((places (rest (word-places text))))
    (if places
        (destructuring-bind (start . end) (base:roll-element places dice)
          (concatenate 'string (subseq text 0 start) (base:roll-element words dice)
                       (subseq text end)))
        text)))

(defun load-and-run (file)
  "Load the saved run in FILE, whatever its digest, and pass some ticks. Return :RAN, or the
condition of ours that loading signals."
  (handler-case
      (run::reading-file (in file :run 'run:damaged-simulation)
        (let* ((reading (run::make-line-reader in 0 0)) (head (run::read-head reading)))
          (run::simulation-from-lines reading head (file-length in))))
    (base:ars-magna-error (trouble) trouble)
    (:no-error (simulation) (run:run-ticks 30 simulation) :ran)))

(defun tells-of-fault-p (outcome)
  "True if OUTCOME of a loading, or a message since then, tells that memory was read that should not
have been."
  (some (lambda (told) (search "emory fault" (princ-to-string told)))
        (cons outcome (base:take-messages))))

(test saved-forgery.does-no-harm
  "400 words replaced by others: what makes no sense is found, and what is not found runs."
  (with-temporary-file (file)
    (write-saved-ride file)
    (let* ((texts (saved-texts file)) (dice (base:make-dice 80)) (found 0)
           (words (append '("nil" "t" "0" "-1" "1" "7" "99999" "4611686018427387904" "1.5" "1.0e300"
                            "floor" "(1 2)" "(nil . t)" "\"x\"" "|COMMON-LISP::ABORT|"
                            "|ARS-MAGNA.COMMAND::COAST|" "@0" "@1" "@999999")
                          (loop for number from 1 to 99 by 3 collect (format nil "@~D" number))))
           (count (length texts)))
      (dotimes (i 400)
        (let ((copy (copy-list texts)) (number (1+ (base:roll-index (1- count) dice))))
          (setf (nth number copy) (forged-text (nth number copy) words dice))
          (write-saved-texts copy file)
          (let ((outcome (load-and-run file)))
            (is-false (tells-of-fault-p outcome) "~A" (nth number copy))
            (unless (eq :ran outcome)
              (incf found)
              (is (typep outcome '(or run:damaged-simulation base:unknown-name))
                  "~A: ~A" (nth number copy) outcome)))))
      (is (< 250 found)))))

(defun write-with-forgery (texts old new file)
  "Write the saved run of TEXTS to FILE, with NEW instead of OLD in each of them."
  (write-saved-texts (mapcar (lambda (text)
                               (let ((place (search old text)))
                                 (if place
                                     (concatenate 'string (subseq text 0 place) new
                                                  (subseq text (+ place (length old))))
                                     text)))
                             texts)
                     file))

(defun says-when-forged-p (words file texts old new)
  "True if loading a file of TEXTS, in which NEW stands instead of OLD, says WORDS."
  (write-with-forgery texts old new file)
  (says-p words (loading-outcome file)))

(test saved-objects.are-not-shown-before-they-are-filled
  "What is in them has not been checked then. A forged file may put any into an array of numbers."
  (let ((array (make-array 3 :element-type 'double-float)))
    (dolist (type (mapcar #'definitions:kind-name (definitions:all-kinds)))
      (let* ((object (copying:blank-object type (copying:fields-of-type type)))
             (said (handler-case (run::store-elements array 1 object (run::make-loader 9))
                     (error (trouble) (princ-to-string trouble)))))
        (is-true (has-words-p said "double-float" (string-downcase type)))))))

(test saved-forgery.is-named
  (with-temporary-file (file)
    (with-rover (:seed 3 :journal t)
      (command:robot-go-forward rover 30)
      (run:run-ticks 9)
      (run:save-simulation file))
    (let ((texts (saved-texts file)))
      (loop for (old new words)
              in '(("(ars-magna-run 1 " "(ars-magna-run 2 " "another version")
                   ("(ars-magna-run 1 " "(ars-magna-journal 1 " "begin like a saved run")
                   ("tick 9" "tick 8" "last line") ("digest " "digest -" "not a digest")
                   ("motion-noise*" "no-noise*" "no simulation parameter")
                   ("::DRIVE-A-WHILE|" "::DRIVE-TICK|" "no step")
                   ("|ARS-MAGNA.COMMAND::DRIVE-A-WHILE|" "|COMMON-LISP::ABORT|" "no step")
                   ("|ARS-MAGNA.COMMAND::DRIVE-A-WHILE|" "|ARS-MAGNA.COMMAND::WATCH-GRIP|"
                    "does not fit")
                   ("function |ARS-MAGNA.COMMAND::RUN-OPERATION|" "function |COMMON-LISP::ABORT|"
                    "may refer to")
                   ("found map " "found file " "not a kind of object")
                   ("found map " "find map " "the numbers of its objects")
                   ("found map \"" "found map \"NO-" "NO-")
                   ("new dice 9" "new dice 999999999" "more objects")
                   ("new dice 9" "new dice 8" "as many objects as it says")
                   ("new dice 9" "new dice -9" "more objects")
                   ("new agenda 1 1" "new agenda 2 1" "as many objects as it says")
                   ("new agenda 1 1" "new agenda 1 0" "too many values")
                   ("t (9) nil" "t (4000000000) nil" "more memory")
                   ("t (9) nil" "nil (9) nil" "array makes no sense")
                   ("|ARS-MAGNA.WORLD::THING|" "|COMMON-LISP::PATHNAME|" "not loaded")
                   ("(\"NAME\" \"SERIAL\"" "(\"SERIAL\" \"NAME\"" "another version")
                   ("(waiting)" "(waiting @1)" "waiting requests is missing")
                   ("(waiting)" "(journal)" "waiting requests is missing"))
            do (is-true (says-when-forged-p words file texts old new) "~A" new))
      (write-saved-texts (butlast texts) file)
      (is-true (says-p "end of the file is missing" (loading-outcome file)))
      (write-saved-texts (append texts '("(end 9)")) file)
      (is-true (says-p "after its last line" (loading-outcome file))))))

(defun all-steps ()
  "Return the names of all steps of our commands, in the order of the alphabet."
  (let ((steps '()))
    (do-symbols (symbol :ars-magna.command)
      (when (command::step-p symbol) (pushnew symbol steps)))
    (sort (remove-if #'base:users-symbol-p steps) #'string<)))

(defun steps-taken (old issue)
  "Return the names of those of all steps with which a saved run goes on instead of OLD, the step of
the command that the function ISSUE gives. It must be said of the others that they do not fit."
  (with-temporary-file (file)
    (with-rover (:seed 3 :thinking :charged)
      (funcall issue)
      (run:run-ticks 1)
      (run:save-simulation file))
    (loop with texts = (saved-texts file)
          for step in (all-steps)
          for outcome = (progn (write-with-forgery texts (format nil "::~A|" old)
                                                   (format nil "::~A|" step) file)
                               (load-and-run file))
          if (eq :ran outcome) collect (symbol-name step)
          else do (is-true (says-p "would continue with a step that does not fit it" outcome)
                           "~A" step))))

(test saved-forgery.of-steps-is-found
  "Each step that there is, in place of that of a command of each kind of resource."
  (flet ((check (old issue &rest steps)
           (is (equal (sort (list* "START-BODY" "SUCCEED" steps) #'string<)
                      (steps-taken old issue)))))
    (check 'start-body (lambda () (command:robot-go-forward rover 30))
           "COAST" "DRIVE-A-WHILE" "DRIVE-THE-REST" "DRIVE-TO-WALL" "TURN-ON")
    (check 'start-body (lambda ()
                         (command:camera-get-place-designator (robot:robot-camera rover 0) 'door))
           "DESIGNATE-FOUND")
    (check 'start-body (lambda () (command:hand-remove (robot:robot-hand rover 0))) "WATCH-GRIP")
    (check 'start-body (lambda () (command:storage-bin-open (robot:robot-storage-bin rover 0))))
    (check 'succeed (lambda () (command:think rover 9)))))

(test saved-forgery.of-what-is-occupied-is-found
  "A turn that occupied a mind would pass that to what turns robots."
  (with-temporary-file (file)
    (with-rover (:seed 3 :thinking :charged)
      (command:think rover 9)
      (run:run-ticks 1)
      (run:save-simulation file))
    (is-true (says-when-forged-p "occupy" file (saved-texts file)
                                 "::THINK\"" "::ROBOT-FOLLOW-WALL\""))))

(test saved-forgery.of-what-a-track-tells-is-found
  (with-temporary-file (file)
    (write-saved-ride file)
    (let* ((texts (saved-texts file))
           (command (position "CAMERA-TRACK\")" texts :test #'search)))
      (is-true (says-when-forged-p "command in progress is invalid" file texts
                                   (format nil " @~D (@" command) " @1 (@")))))

(test saved-forgery.shows-nothing-before-it-is-whole
  "What cannot be in an array of numbers may be an object that is still to be read."
  (with-temporary-file (file)
    (with-rover (:seed 3) (run:save-simulation file))
    (let* ((texts (saved-texts file))
           (contents (remove "(@" texts :test-not #'alexandria:starts-with-subseq))
           (thing (find "|ARS-MAGNA.TESTS::CRATE|" contents :test #'search))
           (name (subseq thing 1 (position #\Space thing)))
           (places 0))
      (dolist (text (remove " 0)" contents :test-not #'alexandria:ends-with-subseq))
        (write-with-forgery texts text (format nil "~A~A)" (string-right-trim "0)" text) name) file)
        (let ((outcome (load-and-run file)))
          (when (says-p "element" outcome) (incf places))
          (is-false (tells-of-fault-p outcome) "~A" text)))
      (is (plusp places)))))

(test saved-forgery.of-dice-is-named
  "SBCL trusts what is in its dice: a place behind their end would read what is not theirs."
  (with-temporary-file (file)
    (flet ((says-p (old new)
             (says-when-forged-p "dice" file (saved-texts file) old new)))
      (dolist (new '("(-1)" "(4294967296)" "(1 2)" "(nil)" "7" "t"))
        (with-rover (:seed 3) (run:save-simulation file))
        (let* ((head (first (saved-texts file))) (start (+ 6 (search " dice (" head))))
          (is-true (says-p (subseq head start (1+ (position #\) head :start start))) new))))
      (dolist (new '("dice (625 " "dice (1.5 " "dice (" "dice (0 0 "))
        (with-rover (:seed 3) (random 9) (run:save-simulation file))
        (is-true (says-p "dice (1 " new))))))

(test saved-files.that-are-none
  (with-temporary-file (file)
    (loop for (text words) in `(("" "end of the file is missing") ("hello" "damaged")
                                (,(make-string 2000000 :initial-element #\() "damaged")
                                ("(ars-magna-run 1 ())" "damaged"))
          do (write-text text file)
             (is-true (says-p words (loading-outcome file)) "~A" words))
    (write-text "" file)
    (with-rover (:journal t) (run:save-journal file))
    (is (typep (loading-outcome file) 'run:damaged-simulation))
    (is (typep (loading-outcome (uiop:temporary-directory)) 'run:damaged-simulation))
    (is (typep (loading-outcome "/no-such-directory/run") 'run:damaged-simulation))
    (signals base:wrong-argument (run:load-simulation 7))
    (signals base:wrong-argument (with-rover () (run:save-simulation 7)))))

(test saving.replaces-nothing-else
  (with-temporary-file (file)
    (with-rover (:journal t)
      (write-text "My own." file)
      (signals base:misuse (run:save-simulation file))
      (signals base:misuse (run:save-journal file))
      (is (equal '("My own.") (journal-lines file)))
      (write-text "" file)
      (run:save-journal file)
      (signals base:misuse (run:save-simulation file))
      (run:save-journal file)
      (write-text "" file)
      (run:save-simulation file)
      (run:run-ticks 1)
      (is (equal (truename file) (run:save-simulation file)))
      (is (= 1 (run:simulation-tick (run:load-simulation file))))
      (signals base:misuse (run:save-simulation "/no-such-directory/run"))
      (signals base:misuse (run:save-simulation (uiop:temporary-directory)))
      (time:schedule (nil) (is (typep (saving-refusal file) 'base:misuse) "inside a tick"))
      (run:run-ticks 1))))

(test loading.interns-nothing-of-users
  (with-temporary-file (file)
    (with-rover ()
      (world:set-attribute (world:find-thing 'crate) :mood 'ars-magna.tests::glum-or-so)
      (run:save-simulation file))
    (let ((texts (saved-texts file)) (before (count-symbols)))
      (is-true (says-when-forged-p "digest in the head" file texts "::GLUM-OR-SO" "::NO SUCH NAME"))
      (is (= before (count-symbols))))))

(test loading.needs-the-same-definitions
  (with-temporary-file (file)
    (base:with-own-definitions ()
      (eval '(world:defkicker saved-sway (thing) (:prob 1/2) (world:kick-thing thing .01 0 nil)))
      (with-rover ()
        (world:set-kicker (world:find-thing 'crate) 'saved-sway)
        (run:save-simulation file))
      (is (integerp (loading-outcome file)))
      (eval '(world:defkicker saved-sway (thing) (:prob 1/2) (world:kick-thing thing .02 0 nil)))
      (is (typep (loading-outcome file) 'run:different-definitions))
      (is (integerp (loading-outcome file :anyway t)))
      (handler-bind ((run:different-definitions
                       (lambda (trouble)
                         (declare (ignore trouble))
                         (invoke-restart 'run:load-anyway))))
        (is (integerp (run:state-digest (run:load-simulation file)))))
      (base:undefine 'world:kicker 'saved-sway)
      (is (typep (loading-outcome file) 'run:different-definitions))
      (is (typep (loading-outcome file :anyway t) 'base:unknown-name)))))
