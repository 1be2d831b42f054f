;;;; headers.lisp -- what the headers of journals and saved runs say about robots.

(in-package :ars-magna.run)

(export '(journal-robot-names remembered-robot-name))

;;; Robots are listed by full name. :STARTS lists the robots with another name or start than a
;;; definition says, as (name kind x y angle). :GHOSTS is true if robots have no bodies. A header
;;; with one robot lacks :GHOSTS unless it is true: one robot has no body and uses the world's dice.

(defun starts-for-header (simulation)
  (loop for robot in (simulation-robots simulation)
        when (robot-start robot)
          collect (list* (robot-full-name robot)
                         (qualified-name (blueprint-name (robot-blueprint robot)))
                         (robot-start robot))))

(defun robots-for-header (simulation)
  "Return the properties of a header that describe the robots of SIMULATION."
  (let ((starts (starts-for-header simulation))
        (ghosts-p (world-ghosts-p (simulation-world simulation))))
    `(:robots ,(mapcar #'robot-full-name (simulation-robots simulation))
      ,@(and starts `(:starts ,starts))
      ,@(and (or ghosts-p (rest (simulation-robots simulation))) `(:ghosts ,ghosts-p)))))

(defun refresh-journal-robots (simulation)
  "Nothing has happened in SIMULATION yet. List its robots in the header of its journal."
  (let* ((journal (simulation-journal simulation))
         (header (copy-list (journal-header journal))))
    (dolist (key '(:robots :starts :ghosts)) (remf header key))
    (setf (journal-header journal)
          (list* (first header) (second header)
                 (append (robots-for-header simulation) (cddr header))))))

(defun update-journal-ghosts (simulation)
  "Record in the header of SIMULATION's journal whether robots have bodies in this run, which
begins now."
  (let ((journal (simulation-journal simulation)))
    (if (null (journal-newest-first journal))
        (refresh-journal-robots simulation)
        (let ((header (uiop:remove-plist-key :ghosts (journal-header journal)))
              (ghosts-p (world-ghosts-p (simulation-world simulation))))
          (setf (journal-header journal)
                (append header
                        (and (or ghosts-p (rest (getf header :robots)))
                             (list :ghosts ghosts-p))))))))

;;; Reading.

(defun kind-of-robot (name header)
  "Return the full name of the kind of the robot NAME in HEADER."
  (or (second (find name (getf header :starts) :key #'first :test #'string=)) name))

(defun blueprint-of-kind (kind header)
  "Return the blueprint of KIND, the full name of the kind of a robot in HEADER. A definition of
that name in another package serves as well, unless HEADER needs that one itself. Signals
UNKNOWN-NAME."
  (let* ((blueprint (find-blueprint kind)) (found (qualified-name (blueprint-name blueprint))))
    (when (and (not (string-equal kind found))
               (find found (getf header :robots) :test #'string-equal
                                                 :key (lambda (name) (kind-of-robot name header))))
      (reject-name "robot" kind '()))
    blueprint))

(defun header-blueprints (header)
  "Return the blueprints of the robots in HEADER. Signals UNKNOWN-NAME."
  (loop for name in (getf header :robots)
        collect (blueprint-of-kind (kind-of-robot name header) header)))

(defun symbol-of-full-name (name)
  "Return the symbol with the full name NAME. Make it if its package exists."
  (let* ((colons (search "::" name))
         (package (and colons (find-package (subseq name 0 colons))))
         (short-name (if colons (subseq name (+ 2 colons)) name)))
    (cond ((null colons) (uninterned-symbol (concatenate 'string "::" name) name))
          ((null package) (reject-name "package" (subseq name 0 colons) '()))
          ((find-symbol short-name package) (values (find-symbol short-name package)))
          ((package-locked-p package)
           (reject-use "No robot can have the name ~A, because its package is locked." name))
          (t (values (intern short-name package))))))

(defun symbol-of-robot (name kind)
  "Return the symbol that names the robot with the full name NAME, of KIND, a full name, too."
  (if (string-equal name kind)
      (blueprint-name (find-blueprint kind))
      (symbol-of-full-name name)))

(defun header-entries (header)
  "Return a list of the ROBOT-ENTRIES of the robots in HEADER. Signals UNKNOWN-NAME."
  (loop for name in (getf header :robots)
        for (nil kind . start) = (find name (getf header :starts) :key #'first :test #'string=)
        for blueprint = (blueprint-of-kind (or kind name) header)
        collect (make-robot-entry blueprint (symbol-of-robot name (or kind name))
                                  (mapcar #'double start))))

(defun joining-robots (journal)
  "Return lists (name kind), full names, of the robots that join the run of JOURNAL later."
  (loop for (nil operator name kind) in (journal-entries journal)
        ;; Names that a file may have instead are refused when the entry is repeated.
        when (and (eq 'robot-joined operator) (stringp name) (stringp kind))
          collect (list name kind)))

(defun journal-robot-names (journal)
  "Return the names, symbols, of the robots in the run of JOURNAL. Signals UNKNOWN-NAME."
  (let ((header (journal-header journal)))
    (remove-duplicates
     (append (mapcar #'robot-entry-name (header-entries header))
             (loop for (name kind) in (joining-robots journal)
                   collect (symbol-of-robot name kind)))
     :from-end t)))

(defun remembered-robot-name (name)
  "Return the symbol that names the robot with the full name NAME, or NIL if there is none."
  (let* ((blueprint (find-blueprint name nil)) (colons (search "::" name))
         (package (and colons (find-package (subseq name 0 colons)))))
    (if blueprint
        (blueprint-name blueprint)
        (and package (values (find-symbol (subseq name (+ 2 colons)) package))))))

;;; Checking.

(defun starts-p (object)
  (list-of-p '(cons string (cons string (cons real (cons real (cons real null))))) object))

(defun robots-error-text (header)
  "Return a text about an error in what HEADER, a property list, says about robots; or NIL."
  (let ((names (getf header :robots)))
    (cond ((not (and names (list-of-p 'string names))) "the head names no robots")
          ((duplicates-p names) "the head names a robot twice")
          ((not (and (starts-p (getf header :starts))
                     (every #'sane-number-p (mapcan #'cddr (copy-tree (getf header :starts))))
                     (subsetp (mapcar #'first (getf header :starts)) names :test #'string=)))
           "its starts of robots make no sense")
          ((not (typep (getf header :ghosts) 'boolean)) "it does not say if robots have bodies"))))

(defun check-robots-of-header (header)
  "Signal an error if HEADER has several robots and is from a version in which they had no bodies."
  (when (and (rest (getf header :robots)) (eq :none (getf header :ghosts :none)))
    (error "it is a run of several robots that was recorded by version 1.10 or earlier. There, ~
            robots had no bodies and shared their dice, so the run would go another way now. ~
            Use that version, or record the run anew")))
