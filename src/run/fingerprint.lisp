;;;; fingerprint.lisp -- the definitions that a run depends on, and how the current ones differ.

(in-package :ars-magna.run)

(export '(definitions-depended-on definition-registry-entry))

;;; A journal has a list (kind name number) for each definition that the run depends on, where the
;;; number is a digest of the form that was read. It has (:file name number) for each file with
;;; these definitions, as the run may depend on other forms there too. Comments and layout do not
;;; count. A definition made by a function has no form, so it has no number and is not compared.
;;;
;;; A run depends on what it uses: its map and robots; the kickers and attributes of its things; the
;;; place types, substances and users' map clauses in the map; the robots' parts of users' kinds;
;;; the kickers, manipulations and users' commands in its journal; the run variables that it has
;;; read or set. It also depends on everything in the files that define these. Functions in other
;;; files, or typed, are not covered.

(defparameter *definition-kinds*
  (list (cons :map *maps*) (cons :robot *robots*) (cons :kicker *kickers*)
        (cons :map-clause *map-clauses*) (cons :place-type *place-types*)
        (cons :attribute *attributes*) (cons :substance *substances*)
        (cons :part *object-kinds*) (cons :command *commands*)
        (cons :run-variable *run-variables*))
  "An alist of the kinds of definitions and their registries. Manipulations are not in the list:
their methods are compared instead.")

;;; Definitions in use, as lists (kind name).

(defun names-used-by-things (simulation name entries)
  "Return the names of the entries of all things in SIMULATION, without duplicates. ENTRIES is a
function that returns a thing's list of entries, NAME one that returns an entry's name."
  (let ((names '()))
    (do-things (thing (simulation-world simulation))
      (dolist (entry (funcall entries thing))
        (pushnew (funcall name entry) names)))
    names))

(defun elements-at-indices (numbers elements)
  "Return the elements of the vector ELEMENTS whose indices are in NUMBERS. Index 0 is ignored."
  (let ((used (make-array (length elements) :element-type 'bit :initial-element 0)))
    (loop for number across numbers do (setf (sbit used number) 1))
    (loop for index from 1 below (length elements)
          when (plusp (sbit used index)) collect (aref elements index))))

(defun journal-entries-so-far (simulation)
  (let ((journal (simulation-journal simulation)))
    (and journal (journal-newest-first journal))))

(defun journalled-arguments (operator position simulation)
  (remove-duplicates
   (loop for entry in (journal-entries-so-far simulation)
         when (eq operator (second entry)) collect (nth (+ 2 position) entry))))

(defun user-defined-commands (simulation)
  (loop for name in (remove-duplicates (mapcar #'second (journal-entries-so-far simulation)))
        for entry = (lookup-entry name *commands*)
        when (and entry (users-entry-p entry)) collect name))

(defun names-of-kinds (simulation)
  "Return the names of the definitions of the robots that are or were in SIMULATION."
  (remove-duplicates
   (append (loop for robot in (simulation-robots simulation)
                 collect (blueprint-name (robot-blueprint robot)))
           (remove nil (mapcar (lambda (name)
                                 (let ((blueprint (find-blueprint name nil)))
                                   (and blueprint (blueprint-name blueprint))))
                               (journalled-arguments 'robot-joined 1 simulation))))
   :from-end t))

(defun definition-names-in-use (kind simulation)
  (let ((map (world-map (simulation-world simulation))))
    (ecase kind
      (:map (list (map-name map)))
      (:map-clause (map-clause-kinds map))
      (:robot (names-of-kinds simulation))
      (:kicker (append (names-used-by-things simulation
                                             (lambda (attachment)
                                               (kicker-name (attachment-kicker attachment)))
                                             #'thing-kickers)
                       (journalled-arguments 'set-kicker 1 simulation)))
      (:place-type (loop for type in (elements-at-indices (map-places map) (map-place-types map))
                         collect (if (place-type-p type) (place-type-name type) type)))
      (:attribute (names-used-by-things simulation #'first #'thing-attributes))
      (:part (remove-duplicates
              (loop for robot in (simulation-robots simulation)
                    append (cl:map 'list #'type-of (robot-sensors robot)))))
      (:command (user-defined-commands simulation))
      (:run-variable (mapcar #'first (run-variables-used (simulation-world simulation)
                                                         :read :set)))
      (:substance (elements-at-indices (map-substances map) (map-substance-types map))))))

(defun definition-of-entry (kind entry)
  (list kind (qualified-name (entry-name entry))))

(defun definitions-in-use (simulation)
  (append (loop for (kind . registry) in *definition-kinds*
                append (loop for name in (definition-names-in-use kind simulation)
                             for entry = (lookup-entry name registry)
                             when entry collect (definition-of-entry kind entry)))
          (loop for name in (journalled-arguments 'manipulate 0 simulation)
                collect (list :manipulation (name-string name)))))

;;; The files that contain them.

(defun definition-registry-entry (definition)
  "Return the registry entry of DEFINITION, (kind name ...), or NIL."
  (let ((registry (cdr (assoc (first definition) *definition-kinds* :test #'same-name-p))))
    (and registry (lookup-entry (second definition) registry))))

(defun methods-of-definition (definition)
  (let ((manipulation (and (same-name-p :manipulation (first definition))
                           (find-manipulation (second definition) nil))))
    (and manipulation (manipulation-methods manipulation))))

(defun sources-of (definitions)
  "Return those sources of DEFINITIONS that are files, without duplicates."
  (remove-duplicates
   (loop for definition in definitions
         for entry = (definition-registry-entry definition)
         append (remove-if-not #'rest
                               (cons (and entry (entry-source entry))
                                     (mapcar #'method-source (methods-of-definition definition)))))
   :test #'equal))

(defun definitions-in-files (sources)
  "Return all definitions in the files SOURCES, except maps and robots."
  (append (loop for (kind . registry) in *definition-kinds*
                unless (member kind '(:map :robot))
                  append (loop for entry in (registry-entries registry)
                               when (member (entry-source entry) sources :test #'equal)
                                 collect (definition-of-entry kind entry)))
          (loop for manipulation in (all-manipulations)
                when (intersection (mapcar #'method-source (manipulation-methods manipulation))
                                   sources :test #'equal)
                  collect (list :manipulation (name-string (manipulation-name manipulation))))))

(defun source-file-name (source)
  (file-base-name (native-path (source-file source))))

;;; Their digests.

(defun sum-of-digests (numbers)
  "Return one number computed from NUMBERS, which does not depend on their order."
  (ldb (byte 64 0) (reduce #'+ numbers)))

(defun current-digest (definition sources)
  "Return the current digest of DEFINITION, and true if it is defined. SOURCES are the source files
of all definitions that are compared."
  (destructuring-bind (kind name &rest number) definition
    (declare (ignore number))
    (let ((entry (definition-registry-entry definition))
          (methods (methods-of-definition definition))
          (files (and (same-name-p :file kind)
                      (remove name sources :key #'source-file-name :test-not #'string=))))
      (values (cond (entry (entry-digest entry))
                    (methods (sum-of-digests (remove nil (mapcar #'method-digest methods))))
                    (files (sum-of-digests (mapcar #'second files))))
              (or entry methods files)))))

(defun current-definitions (definitions)
  "Return a list of the DEFINITIONS that are loaded, with their current digests."
  (loop with sources = (sources-of definitions)
        for definition in definitions
        for (number there) = (multiple-value-list (current-digest definition sources))
        when there collect (list (first definition) (second definition) number)))

(defun same-definition-p (a b)
  (and (same-name-p (first a) (first b))
       (string= (second a) (second b))))

(defun undefined-attributes (simulation)
  "Return the undefined attributes of things in SIMULATION, in the form of definitions."
  (loop for name in (definition-names-in-use :attribute simulation)
        unless (lookup-entry name *attributes*)
          collect (list :attribute (name-string name) :undefined)))

(defun recorded-as-undefined-p (definition)
  (same-name-p :undefined (or (and (symbolp (third definition)) (third definition)) "")))

(defun definitions-depended-on (simulation)
  "Return the definitions that SIMULATION depends on, as lists (kind name number)."
  (let* ((used (definitions-in-use simulation)) (sources (sources-of used)))
    (append (current-definitions
             (remove-duplicates
              (append used
                      (definitions-in-files sources)
                      (mapcar (lambda (source) (list :file (source-file-name source))) sources))
              :test #'same-definition-p :from-end t))
            (undefined-attributes simulation))))

;;; How they differ.

(defun unchanged-p (definition now)
  "True if DEFINITION is in NOW, the current definitions, or was recorded as undefined and still
is."
  (if (recorded-as-undefined-p definition)
      (not (member definition now :test #'same-definition-p))
      (member definition now :test #'equal)))

(defun merge-definitions (before after)
  "Return the definitions BEFORE, followed by the definitions AFTER that are not among BEFORE. The
number of a definition that has changed becomes :CHANGED. A robot that is no longer defined has only
left the run."
  (let ((now (current-definitions before)))
    (append (loop for definition in before
                  for (kind name number) = definition
                  collect (if (or (unchanged-p definition now)
                                  (and (same-name-p :robot kind)
                                       (not (member definition now :test #'same-definition-p))))
                              definition
                              (list kind name :changed)))
            (remove-if (lambda (definition) (member definition before :test #'same-definition-p))
                       after))))

(defun kind-and-name-text (definition)
  (destructuring-bind (kind name &rest number) definition
    (declare (ignore number))
    (let* ((colons (search "::" name)) (bare (if colons (subseq name (+ 2 colons)) name)))
      (format nil "~(~A~) ~:[~(~A~)~;~A~]" (substitute #\Space #\- (string kind))
              (same-name-p :file kind) bare))))

(defun difference-text (definition others)
  "Return a text about how DEFINITION (kind name number) differs from the one in OTHERS, or NIL."
  (let ((other (find definition others :test #'same-definition-p))
        (number (third definition)))
    (cond ((recorded-as-undefined-p definition)
           (and other (format nil "~A has been defined since the recording"
                              (kind-and-name-text definition))))
          ((null other)
           (format nil "~A is not loaded" (kind-and-name-text definition)))
          ((and number (symbolp number))
           (format nil "~A was defined anew during the recorded run"
                   (kind-and-name-text definition)))
          ((and number (third other) (/= number (third other)))
           (format nil "~A has changed since the recording" (kind-and-name-text definition))))))

(defun definition-difference-texts (definitions)
  (let ((others (current-definitions definitions)))
    (remove nil (mapcar (lambda (definition) (difference-text definition others)) definitions))))

;;; Which have changed while a run goes on. A run of plans may use any plan, as plans can compute
;;; the names of plans that they call. Maps and robots in a run are not redefined.

(defun changed-definition-texts (registry names number)
  "Return a text for each definition in REGISTRY that has changed after the change NUMBER of
definitions. If NAMES is not T, return only the texts of definitions with NAMES."
  (loop for entry in (registry-entries registry)
        when (and (< number (entry-changed entry))
                  (or (eq t names) (member (entry-name entry) names :test #'same-name-p)))
          collect (format nil "~A ~(~A~)" (registry-text registry) (entry-name entry))))

(defun definitions-changed-since (number simulation)
  "Return two lists of texts about definitions that SIMULATION may use and that have changed after
the change NUMBER of definitions: those that plans use by name, and others."
  (if (= number *definition-changes*)
      (values '() '())
      (values (and (simulation-participants simulation)
                   (loop for registry in (registries-of-plans)
                         append (changed-definition-texts registry t number)))
              (loop for (kind . registry) in *definition-kinds*
                    unless (member kind '(:map :robot :map-clause))
                      append (changed-definition-texts
                              registry (definition-names-in-use kind simulation) number)))))
