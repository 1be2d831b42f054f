;;;; fingerprint.lisp -- which definitions decide a run, and how they differ from those at hand.

(in-package :ars-magna.run)

;;; A journal has, for each definition that decides its run, a list (kind name number), where the
;;; number stands for the form that was read, and (:file name number) for each file that they are
;;; from, whose other forms may decide it too. Comments and layout do not count. What has no form,
;;; because a function made it, has no number and is not compared.

(defun entries-for (simulation)
  "Return the registry entries of the map and the robots of SIMULATION."
  (remove nil (cons (lookup-entry (map-name (world-map (simulation-world simulation))) *maps*)
                    (loop for robot in (simulation-robots simulation)
                          collect (lookup-entry (robot-name robot) *robots*)))))

(defun kickers-at-work (simulation)
  "Return the names of the kickers in SIMULATION."
  (let ((names '()))
    (do-things (thing (simulation-world simulation))
      (dolist (attachment (thing-kickers thing))
        (pushnew (kicker-name (attachment-kicker attachment)) names)))
    names))

(defun files-of (entries)
  "Return a list of the sources of ENTRIES, (file number), each once; NIL for what was typed."
  (remove-duplicates (mapcar #'entry-source entries) :test #'equal))

(defun entries-from (registry sources &optional names)
  "Return the entries of REGISTRY, of users' definitions, that are from SOURCES or called by NAMES."
  (remove-if-not (lambda (entry)
                   (and (users-p entry)
                        (or (member (entry-source entry) sources :test #'equal)
                            (member (entry-name entry) names :test #'same-name-p))))
                 (registry-entries registry)))

(defun describe-entries (kind entries)
  (loop for entry in entries
        collect (list kind (name-string (entry-name entry)) (entry-digest entry))))

(defun describe-methods (sources)
  "Return what stands for the methods of manipulations that are from SOURCES."
  (loop for manipulation in (all-manipulations)
        for methods = (remove-if-not (lambda (method)
                                       (member (method-source method) sources :test #'equal))
                                     (manipulation-methods manipulation))
        when methods
          collect (list :manipulation (name-string (manipulation-name manipulation))
                        (reduce #'logxor methods
                                :key (lambda (method) (or (method-digest method) 0))))))

(defun describe-files (sources)
  (loop for source in sources
        when (cdr source)
          collect (list :file (file-namestring (first source)) (second source))))

(defun definitions-of (simulation)
  "Return what stands for the definitions that decide SIMULATION, lists (kind name number)."
  (let* ((entries (entries-for simulation))
         (sources (files-of entries))
         (map (lookup-entry (map-name (world-map (simulation-world simulation))) *maps*)))
    (append (and map (describe-entries :map (list map)))
            (describe-entries :robot (remove map entries))
            (describe-entries :kicker
                              (entries-from *kickers* sources (kickers-at-work simulation)))
            (describe-entries :place-type (entries-from *place-types* sources))
            (describe-entries :attribute (entries-from *attributes* sources))
            (describe-entries :substance (entries-from *substances* sources))
            (describe-methods sources)
            (describe-files sources))))

(defun same-definition-p (a b)
  (and (same-name-p (first a) (first b))
       (string-equal (second a) (second b))))

(defun merge-definitions (before after)
  "Return the definitions BEFORE with those AFTER that they lack. One that has changed has :CHANGED
for its number."
  (append (loop for (kind name number) in before
                for other = (find (list kind name) after :test #'same-definition-p)
                collect (list kind name (if (and other (not (equal number (third other))))
                                            :changed
                                            number)))
          (set-difference after before :test #'same-definition-p)))

(defun difference-text (definition others)
  "Return in words how DEFINITION, (kind name number), differs from what OTHERS say, or NIL."
  (destructuring-bind (kind name number) definition
    (let* ((other (find definition others :test #'same-definition-p))
           (what (format nil "~(~A ~A~)" (substitute #\Space #\- (string kind)) name)))
      (cond ((null other) (format nil "~A is not loaded" what))
            ((same-name-p :changed (or (and (symbolp number) number) ""))
             (format nil "~A was defined anew while it was recorded" what))
            ((and (integerp number) (integerp (third other)) (/= number (third other)))
             (format nil "~A is not as it was" what))))))

(defun differences (definitions others)
  "Return in words, in a list, how DEFINITIONS of a journal differ from OTHERS, those at hand."
  (remove nil (mapcar (lambda (definition) (difference-text definition others)) definitions)))
