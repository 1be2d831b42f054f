;;;; guide.lisp -- the project's pages that make the guide, and their contents.

(in-package :ars-magna.manual)

(export '(read-guide))

(defstruct (page (:copier nil))
  "A page of the guide. SOURCE is the name of its Markdown file in the project, FILE the name of its
HTML file. TOKENS are the HTML, with anchors at the headings."
  (source "" :type string :read-only t)
  (file "" :type string :read-only t)
  (title "" :type string :read-only t)
  (tokens '() :type list :read-only t))

(defparameter *known-pages*
  '(("README.md" "introduction.html" "Introduction" :learning)
    ("worlds/tutorial/README.md" "tutorial.html" "Tutorial" :learning)
    ("worlds/README.md" "worlds.html" "The shipped worlds" :guide)
    ("cli/README.md" "prompt.html" "The prompt" :guide)
    ("cli/shell/usage.txt" "options.html" "Options of the command" :guide)
    ("worlds/examples/README.md" "shipped-examples.html" "The shipped worlds by example" :examples)
    ("worlds/plan-examples/README.md" "shipped-plan-examples.html" "The shipped plans by example"
     :examples)
    ("cli/lines/README.md" "prompt-examples.html" "The prompt by example" :examples)
    ("src/command/README.md" "command-examples.html" "Commands by example" :examples)
    ("src/definitions/README.md" "parameter-examples.html"
     "Parameters, chance and mistakes by example" :examples)
    ("src/world/README.md" "world-examples.html" "Maps, places and things by example" :examples)
    ("src/robot/README.md" "robot-examples.html" "Robots and their parts by example" :examples)
    ("src/run/README.md" "run-examples.html" "Runs by example" :examples)
    ("rpl/robot/README.md" "plan-robot-examples.html" "Plans and their robot" :examples)
    ("rpl/tasks/README.md" "task-examples.html" "Tasks and failures by example" :examples)
    ("rpl/seeing/README.md" "seeing-examples.html" "Looking at plans" :examples)
    ("src/experiment/report/README.md" "result-examples.html" "Results of experiments by example"
     :examples)
    ("src/statistics/README.md" "statistics-examples.html" "Statistics by example" :examples)
    ("src/geometry/README.md" "geometry-examples.html" "Points, intervals and angles by example"
     :examples)
    ("src/nisp/README.md" "nisp-examples.html" "Nisp by example" :examples)
    ("src/display/README.md" "picture-examples.html" "Pictures by example" :examples)
    ("rpl/README.md" "plans.html" "The plan language" :guide)
    ("rpl/constructs/README.md" "constructs.html" "Constructs of plans" :guide)
    ("rpl/fluents/README.md" "fluents.html" "Fluents" :guide)
    ("rpl/language/README.md" "plan-text.html" "The text of plans" :guide)
    ("rpl/projecting/README.md" "projection-examples.html" "Looking ahead" :guide)
    ("src/experiment/README.md" "experiments.html" "Experiments" :guide)
    ("src/experiment/trial/README.md" "trials.html" "Trials of an experiment" :guide)
    ("src/experiment/table/README.md" "tables.html" "Tables of experiments" :guide)
    ("src/ways/README.md" "ways.html" "Ways through a map" :guide)
    ("src/floors/README.md" "floors.html" "Floors from elsewhere" :guide)
    ("worlds/how-to/extend/README.md" "extending.html" "How to extend the simulator" :guide)
    ("src/README.md" "design.html" "The design" :inside)
    ("src/time/README.md" "time.html" "Time" :inside)
    ("src/copying/README.md" "copying.html" "State and copies" :inside)
    ("src/host/README.md" "host.html" "SBCL's internals" :inside)
    ("src/readings.md" "readings.html" "How the manual of 1992 is read" :inside)
    ("cli/manual/README.md" "about.html" "About this manual" :about))
  "Lists (source file title part) of pages. Other README.md files take their titles from headings.")

(defun project-root () (asdf:system-relative-pathname "ars-magna" ""))

(defun project-path (name)
  (merge-pathnames (native-path name) (project-root)))

(defun find-readmes ()
  (sort (loop for folder in '("src/" "rpl/" "worlds/" "cli/" "tests/")
              append (mapcar (lambda (path) (enough-namestring path (project-root)))
                             (directory (merge-pathnames "**/README.md" (project-path folder)))))
        #'string<))

(defun page-sources ()
  "Return the guide's source files: those of *KNOWN-PAGES* that exist, then other README.md files."
  (let ((known (remove-if-not (lambda (name) (existing-path (project-path name)))
                              (mapcar #'first *known-pages*))))
    (append known (remove-if (lambda (name) (member name known :test #'string=))
                             (find-readmes)))))

(defun known-page (source)
  (rest (assoc source *known-pages* :test #'string=)))

(defun contents-part (page)
  "Return the part of the contents for PAGE: :LEARNING, :GUIDE, :EXAMPLES, :INSIDE or :ABOUT."
  (let ((source (page-source page)))
    (cond ((third (known-page source)))
          ((starts-with-subseq "tests/" source) :inside)
          (t :guide))))

(defun html-file-name (source)
  "Return the name of the HTML file for the page SOURCE: src-run.html for src/run/README.md."
  (or (first (known-page source))
      (format nil "~A.html" (substitute #\- #\/ (subseq source 0 (search "/README.md" source))))))

;;; Headings.

(defun heading-level (token)
  "Return the level, from 1 to 6, of the heading that TOKEN begins; NIL if TOKEN begins no heading."
  (let ((name (and (tag-p token) (tag-name token))))
    (and name
         (= 2 (length name))
         (char= #\h (char name 0))
         (digit-char-p (char name 1)))))

(defun add-anchors (tokens)
  "Return TOKENS with a unique id in each heading."
  (let ((counts (make-hash-table :test #'equal)))
    (loop for rest on tokens
          for token = (first rest)
          collect (if (heading-level token)
                      (let* ((id (heading-id (html-text (split-element rest))))
                             (count (1- (incf (gethash id counts 0)))))
                        (tag-with-attribute "id" (format nil "~A~[~:;-~:*~D~]" id count) token))
                      token))))

(defun headings (tokens)
  "Return lists (level id text words) of headings in TOKENS. WORDS is the text below a heading."
  (loop for rest on tokens
        for token = (first rest)
        when (and (heading-level token) (attribute-value "id" token))
          collect (let* ((heading (split-element rest))
                         (below (nthcdr (length heading) rest)))
                    (list (heading-level token)
                          (attribute-value "id" token)
                          (html-text heading)
                          (html-text (subseq below 0 (position-if #'heading-level below)))))))

(defun add-reading-ids (tokens)
  "Return TOKENS, the page of readings, with an id such as reading-12 where each reading begins."
  (loop for (token next) on tokens
        for number = (and (tag-named-p "strong" token) next
                          (parse-integer next :junk-allowed t))
        collect (if number
                    (tag-with-attribute "id" (format nil "reading-~D" number) token)
                    token)))

;;; The usage texts together are one page.

(defparameter *usage-files*
  '(("ars-magna" "usage.txt") ("ars-magna experiment" "usage-experiment.txt")
    ("ars-magna merge" "usage-merge.txt") ("ars-magna compare" "usage-compare.txt")
    ("ars-magna testbed" "usage-testbed.txt"))
  "Lists (command file): the option --help of the command prints the file.")

(defun page-markdown (source)
  (if (string= source "cli/shell/usage.txt")
      (format nil "# Options of the command~%~%What `--help` prints.~%~%~
                   ~:{## ~A~%~%```text~%~A~%```~%~%~}"
              (loop for (command file) in *usage-files*
                    collect (list command
                                  (file-text (project-path (format nil "cli/shell/~A" file))))))
      (file-text (project-path source))))

(defun read-page (source)
  (let* ((tokens (add-anchors (html-tokens (markdown-html (page-markdown source)))))
         (first (find 1 (headings tokens) :key #'first)))
    (make-page :source source :file (html-file-name source)
               :title (or (second (known-page source)) (third first) source)
               :tokens (if (string= source "src/readings.md") (add-reading-ids tokens) tokens))))

(defun read-guide ()
  "Return all pages of the guide."
  (mapcar #'read-page (page-sources)))
