;;;; undeclared.lisp -- attributes that nobody has declared: legal, but perhaps slips of the pen.

(in-package :ars-magna.world)

(export '(note-strange-name warn-of-slips))

;;; Things may have attributes that no DEFATTRIBUTE declares, and specifications may ask for them.
;;; A name that looks like a declared one is remarked on where a thing is defined; one that no
;;; thing of the world has, where it is asked for, once in a run.

(defparameter *options-of-things*
  '((:prototype "(obj (~A :prototype box) ...)" "(new-thing ~A place (...) :prototype box)")
    (:kickers "(obj (~A :kickers (sway)) ...)" "(make-new-thing '~A place '(...) :kickers '(sway))")
    (:contents "(obj ~A (x y) (...) thing...)" "(make-new-thing '~A place '(...) :contents list)"))
  "What is said of a thing beside its attributes: the option, and how it is written in a map and on
the fly.")

(defun option-called (name)
  "Return what *OPTIONS-OF-THINGS* says of the option that NAME, an attribute's, is or is a slip
for; or NIL."
  (let ((key (attribute-key name)))
    (or (assoc key *options-of-things*)
        (find-if (lambda (option) (resembles-p key (first option))) *options-of-things*))))

(defun slips-in (descriptor)
  "Return a list of lists (name like): the names in the object DESCRIPTOR that are not declared, but
may be slips for the declared name LIKE, or, if that is NIL, are options of things."
  (loop for (name) in descriptor
        for like = (declared-name-like name)
        when (or like (option-of-things-p name))
          collect (list name like)))

(defun option-of-things-p (name)
  "True if NAME, an attribute's, is that of an option, and no attribute is declared so."
  (and (option-called name) (not (attribute-of (attribute-key name)))))

(defun text-of-slip (thing-name slip &optional map-p)
  "Return in words what the thing has that is no attribute, and how it is written, in a map if
MAP-P."
  (destructuring-bind (name like &aux (option (option-called name))) slip
    (if like
        (format nil "~(~A~) has ~(~S~), which is not declared; did you mean ~(~S~)?"
                thing-name name like)
        (format nil "~(~A~) has ~(~S~) among its attributes, where it does nothing; write ~@?"
                thing-name name (if map-p (second option) (third option))
                (string-downcase thing-name)))))

(defun warn-of-slips (definition name descriptor &key clause)
  "Warn of what may be slips in DESCRIPTOR of the thing NAME in DEFINITION, in its CLAUSE if it is a
map's."
  (dolist (slip (slips-in descriptor))
    (warn-of-definition "~A~@[ (~A)~]: ~A" definition
                        (clause-place (or clause (assoc (first slip) descriptor)))
                        (text-of-slip name slip clause))))

(defun note-slips (name descriptor world)
  "Warn, once, of what may be slips in DESCRIPTOR of the thing NAME, made on the fly in WORLD."
  (dolist (slip (slips-in descriptor))
    (warn-once (first slip) world (text-of-slip name slip))))

(defun note-strange-name (key world)
  "Warn, once, if the attribute KEY of a specification is declared by nobody and had by nothing."
  (unless (or (attribute-of key)
              (said-p key world)
              (carried-p key world))
    (warn-once key world
               (format nil "No thing here has ~(~S~), nor is it declared~@[; did you mean ~(~S~)?~
                            ~]~:[~;: that is what a thing is made with, and no attribute~]"
                       key (declared-name-like key) (option-of-things-p key)))))

;;; An attribute that is declared anew may no longer have the values that things have.

(defun value-trouble (key value)
  "Return what is wrong with VALUE for the attribute KEY, a string, or NIL."
  (handler-case (progn (check-attribute-value 'defattribute key value) nil)
    (wrong-argument (condition) (princ-to-string condition))))

(defun unfit-recipe (recipes key)
  "Return the first of RECIPES, or of those in them, whose things have a value that KEY cannot have;
and what is wrong with it."
  (find-recipe (lambda (recipe)
                 (value-trouble key (second (assoc key (recipe-attributes recipe) :test #'eq))))
               recipes))

(defmethod attribute-redefined :before (old new)
  (declare (ignore old new))
  (clrhash *likenesses*))

(defmethod attribute-redefined ((old attribute) new)
  (dolist (map (all-maps))
    (multiple-value-bind (recipe trouble)
        (unfit-recipe (map-things map) (attribute-name new))
      (when (and recipe (not (from-this-file-p (map-name map) *maps*)))
        (warn-of-definition "In map ~(~A~), ~(~A~) has a value that it could not be given any ~
                             more: ~A"
                            (map-name map) (recipe-name recipe) trouble)))))
