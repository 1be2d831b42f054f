;;;; thing-attributes.lisp -- reading and setting attributes of things; warnings of misspelt ones.

(in-package :ars-magna.world)

(export '(attribute-holder warn-of-unknown-attribute warn-of-misspellings checked-descriptor
          descriptor-p))

(defun attribute-in-world-p (key world)
  "True if a thing in WORLD, or the body of a robot, has the attribute KEY."
  (loop for rank below (world-rank-count world)
        for thing = (thing-of-rank rank world)
        thereis (and thing (assoc key (thing-attributes thing) :test #'eq) t)))

(defun undeclared-name-like (key world)
  "Return an undeclared attribute of a thing of WORLD that KEY probably misspells, or NIL."
  (do-things (thing world)
    (loop for (other) in (thing-attributes thing)
          when (and (not (declared-attribute other)) (misspelling-p key other))
            do (return-from undeclared-name-like other))))

(defun similar-attribute-name (key world)
  "The undeclared KEY may be a misspelling. Return a similar name of an attribute that is declared
or that a thing in WORLD has; or NIL."
  (ensure-gethash key *likenesses* (or (declared-name-like key) (undeclared-name-like key world))))

(defun warn-of-misspelling (operator thing key &key read)
  "OPERATOR was called with THING and KEY. Warn once if KEY is undeclared, no thing has it, and it
resembles a declared attribute or, if READ is true, an attribute of some thing."
  (let ((world (thing-world thing)))
    (when (and world (not (declared-attribute key)))
      (let ((like (similar-attribute-name key world)))
        (when (and like
                   (or read (declared-name-like key))
                   (not (warning-given-p key world))
                   (not (attribute-in-world-p key world)))
          (warn-once key world
                     (format nil "~(~A~) of ~(~A~): ~(~S~) is not declared, and nothing here has ~
                                  it; did you mean ~(~S~)?"
                             operator (thing-name thing) key like)))))))

(defgeneric attribute-holder (operator object)
  (:documentation "Return the thing whose attributes OPERATOR reads or sets as those of OBJECT, a
thing or robot, or NIL; and these attributes, an object descriptor. Signals WRONG-ARGUMENT.")
  (:method (operator object)
    (reject-argument operator "thing" object (argument-type-text 'thing object)))
  (:method (operator (thing thing))
    (declare (ignore operator))
    (values thing (thing-attributes thing))))

(defun thing-to-change (operator object)
  "Return the thing whose attributes OPERATOR is to set as those of OBJECT, a thing or robot.
Signals WRONG-ARGUMENT, and MISUSE if OBJECT is a robot without a body."
  (or (attribute-holder operator object)
      (reject-use "~(~A~): ~A has no body, whose attributes could change, because it is alone in ~
                   its world or the run has :ghosts t." operator object)))

(public get-attribute)
(settable get-attribute)
(defun get-attribute (thing attribute)
  "Return the value of ATTRIBUTE, a keyword, of THING, or NIL if the value is unspecified. If THING
is a robot, return the value for its body or, without a body, the value in its DEFROBOT. SETF of
GET-ATTRIBUTE calls SET-ATTRIBUTE (manual 5.3). Do not modify a list that GET-ATTRIBUTE returns, as
SORT would: the list belongs to THING. Warn once in a run if ATTRIBUTE is probably a misspelling of
a declared attribute or of an attribute of some thing."
  (multiple-value-bind (holder attributes)
      (if (thing-p thing)
          (values thing (thing-attributes thing))
          (attribute-holder 'get-attribute thing))
    (let* ((key (attribute-key attribute))
           (entry (assoc key attributes :test #'eq)))
      (unless (or entry (null holder)) (warn-of-misspelling 'get-attribute holder key :read t))
      (second entry))))

(defun merge-descriptors (new old)
  "Return the descriptor OLD with values overridden by NEW, followed by attributes only in NEW."
  (append (loop for entry in old
                collect (or (assoc (first entry) new :test #'eq) entry))
          (remove-if (lambda (entry) (assoc (first entry) old :test #'eq)) new)))

(defun update-physics-slots (thing)
  (labels ((value-of (key) (second (assoc key (thing-attributes thing) :test #'eq)))
           (number-of (key) (let ((value (value-of key))) (if (realp value) (double value) 0d0)))
           (truth-of (key) (and (value-of key) t)))
    ;; Nothing can be in the body of a robot.
    (setf (thing-closed-p thing) (and (truth-of :closed) (not (body-p thing)))
          (thing-obsmove-p thing) (or (truth-of :obsmove) (closed-door-p thing))
          (thing-obsview-p thing) (or (truth-of :obsview) (closed-door-p thing))
          (thing-size thing) (number-of :size)
          (thing-weight thing) (number-of :weight)
          (thing-capacity thing) (if (body-p thing) 0d0 (number-of :capacity))
          (thing-substance-p thing) (truth-of :substance)
          (thing-substance-parameter thing)
          (substance-value-parameter (value-of :substance)))))

;;; Setting.

(defun change-attributes (thing descriptor)
  "Give THING the attributes in DESCRIPTOR, and update its cached slots and the flags of its cell."
  (setf (thing-attributes thing) (merge-descriptors descriptor (thing-attributes thing)))
  ;; What UPDATE-PHYSICS-SLOTS reads.
  (when (intersection '(:obsmove :obsview :closed :door :size :weight :capacity :substance)
                      (mapcar #'first descriptor))
    (update-physics-slots thing)
    (when (eq (thing-location thing) :floor)
      (record-thing-flags thing (world-stock (thing-world thing)))
      (refresh-cell-flags (thing-world thing) (thing-cell-index thing)))))

(defun checked-entry (operator name value)
  (let ((key (attribute-key name)))
    (check-attribute-value operator key value)
    (list key (if (eq key :draw-function) (stored-draw-function value) value))))

(defun checked-descriptor (operator descriptor)
  "Return a copy of DESCRIPTOR with keywords as names. Signals WRONG-ARGUMENT."
  (unless (descriptor-p descriptor)
    (reject-argument operator "descriptor" descriptor
                     "a list of lists (attribute value), each attribute once"))
  (loop for (name value) in (copy-argument operator "descriptor" descriptor)
        collect (checked-entry operator name value)))

(defun descriptor-p (object)
  "True if OBJECT is an object descriptor: a list of lists (attribute value), each attribute once."
  (and (proper-list-p object)
       (loop for entry in object
             always (and (proper-list-p entry) (= 2 (length entry))
                         (first entry) (symbolp (first entry))))
       (loop for ((name) . rest) on object
             never (find name rest :key #'first :test #'same-name-p))))

(public set-attribute)
(defun set-attribute (thing attribute new-value)
  "Set ATTRIBUTE, a keyword, of THING to NEW-VALUE and return NEW-VALUE (manual 5.3). A robot means
its body. NIL means false or unspecified. Lists, strings and vectors are copied.
Signals WRONG-ARGUMENT for a value that the attribute cannot have, MISUSE for a robot without a
body. Warns as GET-ATTRIBUTE does."
  (let ((thing (thing-to-change 'set-attribute thing)))
    (check-argument set-attribute attribute (and attribute (symbolp attribute)) "a keyword")
    (let ((descriptor (if (typep new-value '(or symbol number))
                          (list (checked-entry 'set-attribute attribute new-value))
                          (checked-descriptor 'set-attribute (list (list attribute new-value))))))
      (warn-of-misspelling 'set-attribute thing (first (first descriptor)))
      (changing ((world-of-living-thing thing) set-attribute
                 thing attribute (second (first descriptor)))
        (change-attributes thing descriptor))))
  new-value)

(defun set-attribute-in-replay (thing attribute new-value)
  (call-with-values-as-data #'set-attribute thing attribute new-value))

(define-operator 'set-attribute '(thing name datum) #'set-attribute-in-replay)

(defun (setf get-attribute) (new-value thing attribute)
  (set-attribute thing attribute new-value))

(public change-attribute)
(defun change-attribute (thing descriptor)
  "Set all attributes of THING that are in the object descriptor DESCRIPTOR; other attributes do not
change (manual 5.3). A robot means its body. Signals WRONG-ARGUMENT, and MISUSE for a robot without
a body. Return THING. See reading 173."
  (let ((holder (thing-to-change 'change-attribute thing))
        (descriptor (checked-descriptor 'change-attribute descriptor)))
    (loop for (key) in descriptor do (warn-of-misspelling 'change-attribute holder key))
    (changing ((world-of-living-thing holder) change-attribute holder descriptor)
      (change-attributes holder descriptor)))
  thing)

(define-operator 'change-attribute '(thing datum)
  (lambda (thing descriptor) (call-with-values-as-data #'change-attribute thing descriptor)))

;;; Things may have undeclared attributes, and specifications may ask for them. Where a thing is
;;; defined, a warning names an attribute that resembles a declared one. Where a specification asks
;;; for one that no thing of the world has, a warning says so once in a run.

(defparameter *options-of-things*
  '((:prototype "(obj (~A :prototype box) ...)" "(new-thing ~A place (...) :prototype box)")
    (:kickers "(obj (~A :kickers (sway)) ...)" "(make-new-thing '~A place '(...) :kickers '(sway))")
    (:contents "(obj ~A (x y) (...) thing...)" "(make-new-thing '~A place '(...) :contents list)"))
  "The options for making things. Each entry is an option, and its use in maps and in runs.")

(defun option-named (name)
  "Return the entry of *OPTIONS-OF-THINGS* that NAME equals or resembles, or NIL."
  (let ((key (attribute-key name)))
    (or (assoc key *options-of-things*)
        (find-if (lambda (option) (misspelling-p key (first option))) *options-of-things*))))

(defun find-misspelling (name)
  "Return (NAME like) if NAME, of an attribute, resembles the attribute LIKE, (NAME NIL) if NAME is
that of an option, else NIL."
  (let ((like (declared-name-like name)))
    (and (or like (option-of-things-p name)) (list name like))))

(defun find-misspellings (descriptor)
  "Return a list of probable mistakes in DESCRIPTOR, as FIND-MISSPELLING returns them."
  (loop for (name) in descriptor
        for slip = (ensure-gethash name *misspellings* (find-misspelling name))
        when slip collect slip))

(defun option-of-things-p (name)
  "True if NAME, used as an attribute, is an option for making things and not a declared attribute."
  (and (option-named name) (not (declared-attribute (attribute-key name)))))

(defun misspelling-text (thing-name slip &optional map-p)
  "Return a text that says which attribute is probably a mistake, and what to write instead."
  (destructuring-bind (name like &aux (option (option-named name))) slip
    (if like
        (format nil "~(~A~) has ~(~S~), which is not declared; did you mean ~(~S~)?"
                thing-name name like)
        (format nil "~(~A~) has ~(~S~) among its attributes, where it has no effect; write ~@?"
                thing-name name (if map-p (second option) (third option))
                (string-downcase thing-name)))))

(defun warn-of-misspellings (definition name descriptor &key clause)
  "Warn of probable misspellings in DESCRIPTOR of the thing NAME in DEFINITION. CLAUSE is the
thing's clause in a map, or NIL."
  (dolist (slip (find-misspellings descriptor))
    (warn-of-definition "~A~@[ (~A)~]: ~A" definition
                        (clause-location (or clause (assoc (first slip) descriptor)))
                        (misspelling-text name slip clause))))

(defun warn-once-of-misspellings (name descriptor world)
  (dolist (slip (find-misspellings descriptor))
    (warn-once (first slip) world (misspelling-text name slip))))

(defun warn-of-unknown-attribute (key world)
  "Warn once if the attribute KEY of a specification is undeclared and no thing has it."
  (unless (or (declared-attribute key)
              (warning-given-p key world)
              (attribute-in-world-p key world))
    (warn-once key world
               (format nil "No thing here has ~(~S~), which is not declared~@[; did you mean ~
                            ~(~S~)?~]~:[~;: it is an option for making things, not an ~
                            attribute~]~:[~;. Robots are ghosts in this run and are not seen~]"
                       key (declared-name-like key) (option-of-things-p key)
                       (and (world-ghosts-p world) (rest (world-robots world)))))))

;;; A redefined attribute may no longer accept the values that things have.

(defun find-unfit-recipe (recipes key)
  "Search RECIPES and their contents. Return the first recipe with an invalid value of the attribute
KEY, and a text that says what is wrong."
  (find-recipe-if (lambda (recipe)
                    (let ((value (second (assoc key (recipe-attributes recipe) :test #'eq))))
                      (handler-case (progn (check-attribute-value 'defattribute key value) nil)
                        (wrong-argument (condition) (princ-to-string condition)))))
                  recipes))

(defun warn-of-unfit-recipes (new)
  (dolist (map (all-maps))
    (multiple-value-bind (recipe trouble)
        (find-unfit-recipe (map-things map) (attribute-name new))
      (when (and recipe (not (defined-in-this-file-p (map-name map) *maps*)))
        (warn-of-definition "In map ~(~A~), ~(~A~) has a value that the new definition does not ~
                             allow: ~A"
                            (map-name map) (recipe-name recipe) trouble)))))

(define-facts (thing thing)
  "Where" (let ((location (thing-location thing)))
            (cond ((null location) "nowhere")
                  ((eq location :floor)
                   (format nil "(~,2F,~,2F)" (thing-x thing) (thing-y thing)))
                  (t (thing-holders-text thing))))
  "Attributes" (thing-attributes thing)
  "Contents" (comma-separated (thing-contents thing))
  "Kickers" (comma-separated (mapcar #'attachment-name (thing-kickers thing))))
