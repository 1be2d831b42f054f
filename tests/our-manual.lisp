;;;; our-manual.lisp -- what ./cli/ars-magna --manual writes: pages whose links have targets.

(in-package :ars-magna.tests)

(def-suite* our-manual :in ars-magna)

;;; Without cmark-gfm, the program that reads Markdown, these tests are skipped.

(defun markdown-program-p ()
  (and (base:run-command "cmark-gfm" '("--version")) t))

(defvar *manual* nil "The directory of the manual that tests read, or NIL before it is written.")

(defun delete-manual ()
  (uiop:delete-directory-tree *manual* :validate t :if-does-not-exist :ignore))

(defun written-manual ()
  "Return the directory of the manual, which is written once and deleted when this process ends."
  (or *manual*
      (uiop:with-temporary-file (:pathname place)
        (let ((directory (uiop:ensure-directory-pathname (format nil "~A-manual" place))))
          (manual:write-manual (base:native-name directory))
          (pushnew 'delete-manual sb-ext:*exit-hooks*)
          (setf *manual* directory)))))

(defun call-with-manual (function)
  "Call FUNCTION with the directory of the manual, which it does not change."
  (if (markdown-program-p)
      (funcall function (written-manual))
      (skip "There is no cmark-gfm: no manual is written.")))

(defmacro with-manual ((directory) &body body)
  `(call-with-manual (lambda (,directory) ,@body)))

(defun manual-files (directory)
  "Return a list (name tokens) for each page in DIRECTORY."
  (loop for path in (directory (merge-pathnames "*.html" directory))
        collect (list (file-namestring path) (manual:html-tokens (base:file-text path)))))

(defun tag-values (attribute tokens)
  "Return the values of ATTRIBUTE in the tags among TOKENS."
  (loop for token in tokens
        for value = (and (manual:tag-p token) (manual:attribute-value attribute token))
        when value collect value))

;;; Pages.

(defun nested-properly-p (tokens)
  "True if each element in TOKENS, HTML, ends inside of that in which it begins."
  (let ((open '()))
    (dolist (token tokens (null open))
      (let ((name (and (manual:tag-p token) (manual:tag-name token))))
        (cond ((or (null name)
                   (member name '("!DOCTYPE" "!--" "meta" "link" "img" "input" "br" "hr")
                           :test #'string=)))
              ((char/= #\/ (char name 0)) (push name open))
              ((equal (subseq name 1) (first open)) (pop open))
              (t (return nil)))))))

(defun ids-of-pages (files)
  "Return a table of the ids of FILES, lists (name tokens): name#id."
  (let ((table (make-hash-table :test #'equal)))
    (loop for (name tokens) in files
          do (dolist (id (tag-values "id" tokens))
               (setf (gethash (format nil "~A#~A" name id) table) t)))
    table))

(defun leads-somewhere-p (address file ids directory)
  "True if ADDRESS, in FILE in DIRECTORY, is of something elsewhere, of a file, or one of IDS."
  (destructuring-bind (name &optional id) (uiop:split-string address :separator "#")
    (let ((name (if (string= "" name) file name)))
      (cond ((search "://" address) t)
            (id (gethash (format nil "~A#~A" name id) ids))
            (t (uiop:file-exists-p (merge-pathnames name directory)))))))

(defun addresses (tokens)
  (let ((table (make-hash-table :test #'equal)))
    (dolist (attribute '("href" "src"))
      (dolist (value (tag-values attribute tokens))
        (setf (gethash value table) t)))
    (loop for address being the hash-keys of table collect address)))

(test our-manual.pages-nest-properly
  (is (nested-properly-p (manual:html-tokens "<p>a<br>b <b>c</b></p>")))
  (is (not (nested-properly-p (manual:html-tokens "<p>a <b>c</p></b>")))))

(test our-manual.pages-are-proper-and-links-lead-somewhere
  "Pages are well formed, need no network, show what HTML takes for its own, and their links lead to
what is there."
  (with-manual (directory)
    (let* ((files (manual-files directory)) (ids (ids-of-pages files)) (count 0))
      (is (< 30 (length files)))
      (loop for (name tokens) in files
            for own = (tag-values "id" tokens)
            do (is (nested-properly-p tokens) "~A is not well formed" name)
               (is (= (length own) (length (remove-duplicates own :test #'string=)))
                   "~A has an id twice" name)
               (dolist (address (tag-values "src" tokens))
                 (is (not (search "//" address)) "~A takes ~A from elsewhere" name address))
               (dolist (address (addresses tokens))
                 (incf count)
                 (unless (leads-somewhere-p address name ids directory)
                   (fail "~A leads to ~A, which is not there" name address))))
      (is (< 5000 count))
      (let ((page (base:file-text (merge-pathnames "reference-names.html" directory))))
        (is (and (search "&amp;key" page) (not (search "&key" page))))))))

(test our-manual.escapes-what-html-takes-for-its-own
  (is (string= "a &lt;b&gt; &amp; &quot;c&quot;" (manual:escape-html "a <b> & \"c\"")))
  (is (string= "make-pt" (manual:entry-anchor "MAKE-PT")))
  (is (string/= (manual:entry-anchor "add") (manual:entry-anchor "add!")))
  (is (every (lambda (char) (or (alphanumericp char) (find char "-_")))
             (manual:entry-anchor ":color <a href=\"x\">*"))))

(test our-manual.writes-numbers-as-people-do
  (is (equal '("0.0005" "0.004" "1" "0.1")
             (mapcar #'manual::shortest-number-text (list 5d-4 .004 1 .1d0)))))

;;; Entries.

(test our-manual.has-the-plans-for-users-and-not-their-parts
  (let ((plans (mapcar #'manual:entry-name
                       (remove :plans (manual:all-entries)
                               :key #'manual:entry-chapter :test-not #'eq))))
    (is (subsetp '("fetch-thing" "turn-by" "choose-way") plans :test #'string=))
    (is (null (intersection '("bring-thing" "follow-way") plans :test #'string=)))))

(defun undescribed (package entries)
  "Return the names that PACKAGE exports and none of ENTRIES has."
  (let ((names (make-hash-table :test #'equal)))
    (dolist (entry entries)
      (setf (gethash (string-left-trim ":" (string-downcase (manual:entry-name entry))) names) t))
    (loop for symbol in (external-symbols (face-package package))
          unless (gethash (string-downcase symbol) names) collect symbol)))

(test our-manual.has-an-entry-for-each-name
  (let ((entries (manual:all-entries)))
    (dolist (package '(:ars :nisp :ars-worlds :ars-magna.fiveam))
      (is (null (undescribed package entries))))))

(test our-manual.has-entries-of-all-kinds
  (let ((entries (manual:all-entries)))
    (loop for (chapter name) in '((:commands "robot-turn") (:prompt "turn")
                                  (:parameters "motion-noise*") (:error-codes ":robot-blocked")
                                  (:error-codes ":interrupt") (:definers "defmap")
                                  (:constructs "par") (:plan-functions "rpl-robot-turn")
                                  (:fluents "robot-stopped*") (:attributes ":color")
                                  (:substances "wood") (:place-types "doorway")
                                  (:colours "red*") (:conditions "unknown-name")
                                  (:robots "robbie") (:kickers "roll-away")
                                  (:manipulations "unlock") (:plans "fetch-thing")
                                  (:experiments "three-ways-of-searching")
                                  (:names "run-ticks") (:worlds-names "table*"))
          do (is (find-if (lambda (entry)
                            (and (eq chapter (manual:entry-chapter entry))
                                 (string-equal name (manual:entry-name entry))))
                          entries)
                 "~A is no entry of ~(~S~)" name chapter))))

(defun entry-called (name chapter)
  (find-if (lambda (entry)
             (and (eq chapter (manual:entry-chapter entry))
                  (string= name (manual:entry-name entry))))
           (manual:all-entries)))

(test our-manual.shows-how-manipulations-are-called
  (loop for (name use) in '(("open" "(manipulate open door hand [continuation]) or ~
                                      (manipulate open container hand [continuation])")
                            ("lock" "(manipulate lock door key hand [continuation]) or ~
                                      (manipulate lock container key hand [continuation])"))
        do (is (string= (format nil use) (manual::entry-use (entry-called name :manipulations))))))

(test our-manual.has-no-entries-of-others
  "What the tests define is not told of."
  (let ((names (mapcar #'manual:entry-name (manual:all-entries))))
    (base:with-own-definitions ()
      (eval '(world:defsubstance custard 7))
      (is (equal names (mapcar #'manual:entry-name (manual:all-entries)))))))

;;; What the search finds.

(defun search-rows (directory)
  "Return the rows of the index of what the search in DIRECTORY looks through, in lower case."
  (remove-if-not (lambda (line) (begins-with-p "[" line))
                 (mapcar #'string-downcase
                         (file-lines (merge-pathnames "search-index.js" directory)))))

(test our-manual.is-searched-for-words-in-the-guide
  (with-manual (directory)
    (let ((rows (search-rows directory)))
      (dolist (words '("json" "slurm" "degrees" "exit status" "--seed" "control-r" "line editing"
                       "completion" "no_color" "xdg_cache_home" "#t" "!>" "--trials"))
        (is-true (some (lambda (row)
                         (every (lambda (word) (search word row)) (uiop:split-string words)))
                       rows)
                 "~A is not found" words))
      (is (< (reduce #'+ rows :key #'length) 600000)))))
;;; Synonyms. Node.js runs the search as a browser does, with a document that does nothing.

(defparameter *searching*
  "const stub = new Proxy(function () {}, {get: () => stub, apply: () => stub, set: () => true});
globalThis.document = stub;
const read = (name) => require('fs').readFileSync(process.argv[1] + name, 'utf8');
(0, eval)(read('search-index.js') + read('search.js'));
process.argv.slice(2).forEach(function (text) {
  const first = findRows(text)[0] || [];
  console.log(first[1] + ' at ' + first[2]); });"
  "JavaScript that prints kind and address of the first result of each search.")

(defun first-results (directory searches)
  "Return a text, KIND at ADDRESS, for the first result of each of SEARCHES; NIL without Node.js."
  (when (base:run-command "node" '("--version"))
    (let ((results (lines-of (nth-value 1 (base:run-command
                                           "node" (list* "-e" *searching*
                                                         (base:native-name directory) searches)
                                           :output :string)))))
      (is (= (length searches) (length results)))
      results)))

(test our-manual.finds-pages-by-words-of-other-simulators
  (with-manual (directory)
    (let* ((pairs '(("lidar" "reference-commands.html#rangefinder-read")
                    ("range" "reference-commands.html#rangefinder-read")
                    ("collision" "reference-error-codes.html#_3arobot-blocked")
                    ("Velocity" "reference-commands.html#robot-set-speed")
                    ("gif" "worlds-how-to-pictures.html#pictures-films-and-timelines")
                    ("door" "reference-place-types.html#doorway")
                    ("define a kicker" "reference-definers.html#defkicker")
                    ("how do I define a map?" "reference-definers.html#defmap")
                    ("undefined plan" "reference-conditions.html#unknown-name")
                    ("checkpoint" "reference-names.html#save-simulation")
                    ("cite" "about.html#citing")))
           (results (first-results directory (mapcar #'first pairs))))
      (loop for (nil address) in pairs
            for result in results
            do (is (search (format nil " at ~A" address) result))))))

(test our-manual.shows-the-target-of-each-synonym-first
  (with-manual (directory)
    (let* ((pairs (loop for (name . synonyms) in manual::*synonyms*
                        append (loop for synonym in synonyms collect (list synonym name))))
           (rows (search-rows directory))
           (results (first-results directory (mapcar #'first pairs))))
      (loop for (name) in manual::*synonyms*
            do (is (find (format nil "[\"~(~A~)\"" name) rows :test #'begins-with-p)
                   "~A is no entry or heading" name))
      (loop for (synonym name) in pairs
            for result in results
            do (is (begins-with-p (format nil "see ~(~A~) at " name) (string-downcase result))
                   "~A leads to ~A, not to ~A" synonym result name)))))
