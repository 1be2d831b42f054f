;;;; definition-entries.lisp -- the reference: entries of definitions and of names of Lisp.

(in-package :ars-magna.manual)

(export '(all-entries))

;;; Parameters.

(defparameter *parameter-kind-texts*
  '((:noise . "`clean-simulation` takes it out") (:delay . "a delay") (:limit . "a limit")
    (:setting . "a setting"))
  "Pairs (kind . text) that describe the kinds of parameters.")

(defun shortest-number-text (value)
  ;; A double-float made from a single-float is written like the latter, which has fewer digits.
  (let ((value (if (and (typep value 'double-float) (= value (coerce value 'single-float)))
                   (coerce value 'single-float)
                   value))
        (*print-case* :downcase))
    (if (and (floatp value) (< 1d-6 (abs value) 1d-3))
        (format nil "~F" value)
        (let ((*read-default-float-format* (if (floatp value) (type-of value) 'single-float)))
          (prin1-to-string value)))))

(defun parameter-facts (parameter)
  `(("Default" ,(format nil "~A ~A" (shortest-number-text (parameter-default parameter))
                        (parameter-unit parameter)))
    ("Range" ,(describe-type (parameter-type parameter)))
    ("Kind" ,(rest (assoc (parameter-kind parameter) *parameter-kind-texts*)))))

(defun parameter-entries ()
  (loop for parameter in (all-parameters)
        for symbol = (parameter-symbol parameter)
        when (packages-exporting symbol)
          collect (make-entry :name (parameter-name parameter) :chapter :parameters :symbol symbol
                              :section (parameter-group parameter)
                              :use (parameter-name parameter)
                              :facts (append (parameter-facts parameter) (symbol-facts symbol))
                              :text (parameter-sentence parameter)
                              :file (file-of-symbol symbol))))

;;; Definitions by name. The files of the simulator's own definitions are not recorded with them.

(defun make-entries (kind function)
  "Call FUNCTION with name, object and file of each definition of KIND in the project. Return the
entries that FUNCTION makes. The file is NIL if it is not known."
  (loop for (name object source) in (all-definitions kind)
        for name-of-file = (and source
                                (not (eq :own source))
                                (project-file-name (native-name source)))
        for file = (and name-of-file
                        (not (starts-with-subseq "tests/" name-of-file))
                        name-of-file)
        when (or file (eq :own source))
          collect (funcall function name object file)))

(defun attribute-facts (attribute)
  (append
   (list (list "Values" (format nil "~:[numbers~;~:*~(~{~A~^, ~}~)~]"
                                (attribute-domain attribute))))
   (if (eq :discrete (attribute-kind attribute))
       (list (list "Read rightly" (format nil "with probability ~A, close by"
                                          (shortest-number-text (attribute-success attribute)))))
       (list (list "Error" (format nil "deviation ~A close by, up to ~A times larger far away"
                                   (shortest-number-text (attribute-base attribute))
                                   (shortest-number-text (attribute-max-mult attribute))))))
   (list (list "Noticed unasked"
               (format nil "with probability ~A~@[; more often with ~(~{~S~^, ~}~)~]"
                       (shortest-number-text (attribute-noticed attribute))
                       (attribute-supporters attribute))))))

(defun attribute-entry (name attribute file)
  (declare (ignore name))
  (make-entry :name (format nil "~(~S~)" (attribute-name attribute)) :chapter :attributes
              :use (format nil "(~(~S~) value)" (attribute-name attribute))
              :facts (attribute-facts attribute)
              :text "An attribute of things, which designators report; see DEFATTRIBUTE."
              :file (or file "src/world/thing.lisp")))

(defun substance-entry (name substance file)
  (make-entry :name (string-downcase name) :chapter :substances
              :use (format nil "(:substance ~(~A~))" name)
              :facts (list (list "Viewed as"
                                 (shortest-number-text (substance-parameter substance))))
              :text "A substance of walls and things; see DEFSUBSTANCE and CAMERA-VIEW."
              :file (or file "src/world/substances.lisp")))

(defun place-type-entry (name type file)
  (make-entry :name (string-downcase name) :chapter :place-types
              :use (string-downcase name)
              :facts (list (list "Rank" (format nil "~:R; the first type that fits counts"
                                                (1+ (place-type-rank type))))
                           (list "Confusion"
                                 (format nil "~A, the chance of a false designator"
                                         (shortest-number-text (place-type-confusion type))))
                           (list "Seen" (if (place-type-invisible-p type)
                                            "not by cameras" "by cameras, too")))
              :text (format nil "A place type, which ROBOT-PLACE senses; see DEF-PLACE-TYPE.")
              :file (or file "src/world/built-in-places.lisp")))

(defun kicker-entry (name kicker file)
  (make-entry :name (string-downcase name) :chapter :kickers
              :use (format nil "(:kickers (~(~A~)))" name) :symbol name
              :facts (list (list "Probability"
                                 (format nil "~A a tick"
                                         (shortest-number-text (kicker-prob kicker)))))
              :text (or (documentation-or-nil name)
                        "A kicker of the shipped worlds; see DEFKICKER.")
              :file file))

(defun documentation-or-nil (name)
  (let ((text (symbol-documentation name)))
    (and (string/= "" text) text)))

(defun method-call-text (name method)
  (multiple-value-bind (objects by others) (method-signature method)
    (format nil "(manipulate ~(~A~{ ~A~} ~A~{ ~A~}~) [continuation])" name objects (first by)
            (mapcar #'first others))))

(defun manipulation-entry (name manipulation file)
  (make-entry :name (string-downcase name) :chapter :manipulations
              :use (format nil "~{~A~^ or ~}"
                           (manipulation-usages manipulation #'method-call-text))
              :facts (list (list "At the prompt"
                                 (format nil "~{`manipulate ~A`~^ or ~}"
                                         (manipulation-usages manipulation))))
              :text "A manipulation of the shipped worlds: see DEFMANIPULATION and MANIPULATE.
Things are given as designators, the hand as a part of a robot, such as `(robot-hand robbie 0)`."
              :file file))

(defun map-entry (name map file)
  (make-entry :name (string-downcase name) :chapter :robots :section "Maps"
              :use (string-downcase name) :symbol name
              :facts (list (list "Size" (format nil "~D x ~D cells" (map-width map)
                                                (map-height map))))
              :text (or (documentation-or-nil name) "A map; see DEFMAP.") :file file))

(defun robot-entry (name blueprint file)
  (declare (ignore blueprint))
  (let ((robot (find-robot name)))
    (make-entry :name (string-downcase name) :chapter :robots :section "Robots"
                :use (string-downcase name) :symbol name
                :facts (list (list "Map" (code-markup (map-name (world-map (robot-world robot)))))
                             (list "Parts" (format nil "~R camera~:P, ~R hand~:P, ~R storage bin~:P"
                                                   (length (robot-cameras robot))
                                                   (length (robot-hands robot))
                                                   (length (robot-bins robot)))))
                :text (or (documentation-or-nil name) "A robot; see DEFROBOT.") :file file)))

(defun plan-entry (name procedure file)
  (make-entry :name (string-downcase name) :chapter :plans :symbol name
              :use (call-as-text name (procedure-lambda-list procedure))
              :text (symbol-documentation name) :file file))

(defun experiment-entry (name experiment file)
  (make-entry :name (string-downcase name) :chapter :experiments :symbol name
              :use (format nil "(run-experiment '~(~A~))" name)
              :text (or (experiment-documentation experiment) "") :file file))

(defun shipped-entries ()
  (append (make-entries 'attribute #'attribute-entry)
          (make-entries 'substance #'substance-entry)
          (make-entries 'place-type #'place-type-entry)
          (make-entries 'map #'map-entry)
          (make-entries 'robot #'robot-entry)
          (make-entries 'kicker #'kicker-entry)
          (make-entries 'manipulation #'manipulation-entry)
          ;; Plans that users call, without their parts.
          (remove-if-not (lambda (entry) (packages-exporting (entry-symbol entry)))
                         (make-entries 'plan #'plan-entry))
          (make-entries 'experiment #'experiment-entry)))

;;;; Names of Lisp

;;; The chapter of a symbol depends on what it is.

(defun definer-p (symbol)
  (let ((name (symbol-name symbol)))
    (and (fboundp symbol)
         (or (and (starts-with-subseq "DEF" name)
                  (not (search "WARNING" name)))
             (member name '("UNDEFINE" "WITH-OWN-DEFINITIONS" "NEW-THING" "THING-DESCRIPTOR"
                            "MAKE-ODOMETER" "MAKE-POLICY" "MAKE-VALVE" "INTERP-LAMBDA" "MAKE-PLAN"
                            "SET-KICKER" "PUT-KICKER" "REBUILD-MAP")
                     :test #'string=)))))

(defun colour-name-p (symbol)
  (and (string= "ARS-MAGNA.CANVAS" (package-name (symbol-package symbol)))
       (boundp symbol)
       (typep (symbol-value symbol) '(or simple-vector (unsigned-byte 24)))
       (not (string= "GRAPHICS-SCALE*" (symbol-name symbol)))))

(defparameter *plain-symbol-texts*
  '((("NUMERIC") "The domain of an attribute whose values are numbers; see DEFATTRIBUTE.")
    (("RED" "GREEN" "BLUE" "VIOLET" "LIGHTRED" "LIGHTGREEN" "LIGHTBLUE" "LIGHTVIOLET")
     "A value of the attribute :COLOR.")
    (("VOID" "LST" "~" "THING-DESCRIPTOR" "ROBOT-CONTINUATION")
     "A name of a type in Nisp. DEFFUNC, DEFPROC and LET accept and ignore it (manual 3.1)."))
  "Lists (names text): descriptions of names that have no definition.")

(defun plain-symbol-text (symbol)
  (second (find-if (lambda (names) (member (symbol-name symbol) names :test #'string=))
                   *plain-symbol-texts* :key #'first)))

(defun restart-name-p (symbol)
  (and (null (symbol-kinds symbol)) (null (plain-symbol-text symbol))))

(defun chapter-of-symbol (symbol)
  (cond ((member symbol (all-constructs)) :constructs)
        ((assoc symbol (all-fluent-variables)) :fluents)
        ((and (fboundp symbol) (starts-with-subseq "RPL-" (symbol-name symbol))) :plan-functions)
        ((colour-name-p symbol) :colours)
        ((or (and (find-class symbol nil) (subtypep symbol 'condition))
             (restart-name-p symbol))
         :conditions)
        ((definer-p symbol) :definers)
        ((string= "ARS-WORLDS" (package-name (symbol-package symbol))) :worlds-names)
        (t :names)))

(defun section-of-symbol (symbol chapter)
  (case chapter
    (:names (let* ((package (package-name (symbol-package symbol)))
                   (start (if (starts-with-subseq "ARS-MAGNA." package) (length "ARS-MAGNA.") 0)))
              (string-downcase (subseq package start))))
    (:fluents (format nil "Of the ~(~A~)" (or (second (assoc symbol (all-fluent-variables)))
                                              'robot)))
    (:conditions (if (restart-name-p symbol) "Restarts" "Conditions"))
    (t "")))

(defun value-facts (symbol)
  "Return a list of one fact, the value of the variable SYMBOL if a number, keyword or boolean."
  (when (and (boundp symbol) (not (constantp symbol)))
    (let ((value (symbol-value symbol)) (*print-case* :downcase))
      (when (typep value '(or real keyword boolean))
        (list (list "Value" (prin1-to-string value)))))))

(defun restart-text (symbol)
  (format nil "~@[~A ~]The name of a restart: (invoke-restart '~(~A~))."
          (restart-documentation symbol) symbol))

(defun symbol-entry (symbol)
  (let ((chapter (chapter-of-symbol symbol)))
    (make-entry :name (string-downcase symbol) :chapter chapter :symbol symbol
                :section (section-of-symbol symbol chapter)
                :use (if (fboundp symbol)
                         (call-as-text symbol (lambda-list-of symbol))
                         (string-downcase symbol))
                :facts (append (symbol-facts symbol)
                               (unless (member chapter '(:fluents :colours)) (value-facts symbol)))
                :text (or (documentation-or-nil symbol) (plain-symbol-text symbol)
                          (restart-text symbol))
                :file (file-of-symbol symbol))))

;;; Which symbols.

(defun exported-symbols (package)
  (let ((found '()))
    (when (find-package package)
      (do-external-symbols (symbol package)
        (push symbol found)))
    (sort found #'string<)))

(defun reference-symbols ()
  "Return the symbols for users: public symbols, and the exports of ARS-WORLDS and ARS-FIVEAM."
  (remove-duplicates (append (public-symbols :ars) (public-symbols :nisp)
                             (exported-symbols :ars-worlds) (exported-symbols :ars-fiveam))
                     :from-end t))

(defun has-other-entry-p (symbol entries)
  "True if SYMBOL is only the name of a substance or place type in ENTRIES."
  (and (null (symbol-kinds symbol))
       (find (symbol-name symbol) entries :key #'entry-name :test #'string-equal)))

(defun symbol-entries (others)
  (let ((told (let ((table (make-hash-table :test 'eq)))
                (dolist (entry others table)
                  (when (entry-symbol entry) (setf (gethash (entry-symbol entry) table) t))))))
    (loop for symbol in (reference-symbols)
          unless (or (gethash symbol told) (has-other-entry-p symbol others))
            collect (symbol-entry symbol))))

;;; All.

(defun all-entries ()
  "Return all entries of the reference, in the order of their chapters."
  (let ((entries (append (mapcar #'command-entry (simulator-commands)) (error-entries)
                         (mapcar #'line-entry (simulator-lines)) (parameter-entries)
                         (shipped-entries))))
    (stable-sort (append entries (symbol-entries entries)) #'<
                 :key (lambda (entry)
                        (position (entry-chapter entry) *chapters* :key #'first)))))
