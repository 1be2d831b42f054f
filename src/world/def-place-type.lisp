;;;; def-place-type.lisp -- DEF-PLACE-TYPE: from its options to a place type (manual 5.1.1).

(in-package :ars-magna.world)

(export '(define-place-type))

;;; The form is checked when it is expanded, the values of its options when it is evaluated; then
;;; its code is tried on small maps.

(defun check-place-type-options (definition name lambda-list options)
  (check-name definition name "place type")
  (unless (and (consp lambda-list) (null (cdr lambda-list))
               (first lambda-list) (symbolp (first lambda-list)))
    (reject-clause definition lambda-list "a list of one variable, to be bound to the cell"))
  (check-options definition options
                 '(:confusion :check-matchers :checker :directions :invisible :graphics :before
                   :documentation))
  (when (eq (null (getf options :check-matchers)) (null (getf options :checker)))
    (reject-clause definition options "either :check-matchers or :checker, one of them")))

(defun checked-direction (definition matcher direction)
  (unless (within-reason-p direction)
    (reject-clause definition matcher (argument-type-text 'angle)))
  (when (perhaps-degrees-p direction)
    (queue-message (make-message :warning (list definition ": " (degrees-advice direction))
                                 :notable-p t)
                   *message-queue*))
  (double direction))

(defun matcher-form (matcher definition)
  (unless (and (proper-list-p matcher) (<= 2 (length matcher) 4)
               (loop for step in (cddr matcher) always (typep step '(signed-byte 16))))
    (reject-clause definition matcher
                   "(match-form direction), or (match-form direction dx dy) for a place beside it"))
  (destructuring-bind (form direction &optional (dx 0) (dy 0)) matcher
    `(make-rule ',(normal-form form definition)
                (checked-direction ,definition ',matcher ,direction) ,dx ,dy)))

;; As reading 76 says.
(defun graphics-form (graphics definition)
  (when graphics
    (unless (and (proper-list-p graphics) (proper-list-p (first graphics))
                 (= 3 (length (first graphics))) (every #'symbolp (first graphics)))
      (reject-clause definition graphics "((window x y) body...), three variables and a body"))
    `(lambda ,(first graphics) (declare (ignorable ,@(first graphics))) ,@(rest graphics))))

(defun place-type-forms (name lambda-list options)
  (let ((definition (title "def-place-type" name)))
    (check-place-type-options definition name lambda-list options)
    (destructuring-bind (&key confusion check-matchers checker directions invisible graphics before
                           &allow-other-keys)
        options
      (flet ((cell-function (form)
               (and form `(lambda ,lambda-list (declare (ignorable ,@lambda-list)) ,form))))
        (unless (proper-list-p check-matchers)
          (reject-clause definition check-matchers "a list of (match-form direction)"))
        `((define-place-type ',name
            :confusion ,(or confusion 0) :invisible ,invisible
            :rules (list ,@(loop for matcher in check-matchers
                                 collect (matcher-form matcher definition)))
            :checker ,(cell-function checker)
            :directions ,(cell-function directions)
            :graphics ,(graphics-form graphics definition)
            :before ',before
            :key ,(digest-value (digest-add (make-digest) (cons name options)))))))))

(public def-place-type)
(define-user-macro def-place-type (&whole form name (&rest lambda-list) &body options
                          &environment environment)
  "Define the place type NAME (manual 5.1.1). LAMBDA-LIST is (CELL); options, in any order:
  :confusion p -- probability of a false designator in a search for the type; default 0
  :check-matchers ((match-form direction)...) -- wall patterns centred on the place
  :checker form -- or a form of four values: true to classify, integers dx and dy to the place
    from CELL, its basic canonical direction; CELL is one cursor that moves over the map
  :directions form -- of two values, radians; default the basic direction and its opposite
  :invisible true -- no designator can be acquired for it
  :graphics ((window x y) body...) -- draws it (manual B.1)
  :before name -- ours: where a cell could be of both, this type wins over the one called NAME,
    or over all others if NAME is T; without it, a type that was defined earlier wins
  :documentation text -- ours: what the place type is
A matcher may go on with integers dx dy, as a checker's values do: ours too. Checker and
directions are tried once on a small map of their own. Maps built earlier learn of the type from
REBUILD-MAP. Signals MALFORMED-DEFINITION. Return the name."
  (expand-definition form environment
                     (lambda () (place-type-forms name lambda-list options))))

(defun type-to-precede (definition before)
  (cond ((null before) nil)
        ((eq before t) (first (registry-objects *place-types*)))
        ((find-place-type before nil))
        (t (reject-clause definition (list :before before)
                          (format nil "T or the name of a place type: ~{~(~A~)~^, ~}"
                                  (defined-names *place-types*))))))

(defun define-place-type (name &key (confusion 0) invisible rules checker directions graphics
                                 before (key 0))
  "Define the place type NAME; what DEF-PLACE-TYPE expands to, with functions of a cell for
CHECKER and DIRECTIONS. KEY stands for the definition in the key of a map's cache. Return NAME."
  (let* ((definition (title "def-place-type" name))
         (old (definition-to-replace name *place-types*))
         (next (type-to-precede definition before))
         (new (%make-place-type name)))
    (check-probability definition :confusion confusion)
    (when (> (length rules) 255)
      (reject-clause definition (list :check-matchers '|...|) "at most 255 matchers"))
    (when (and (null old) (= (length (registry-objects *place-types*)) 255))
      (reject-clause definition name "at most 255 place types"))
    (setf (place-type-confusion new) (double confusion)
          (place-type-invisible-p new) (and invisible t)
          (place-type-rules new) rules
          (place-type-table new) (and rules
                                      (every #'small-form-p (mapcar #'rule-form rules))
                                      (rules-table rules))
          (place-type-checker new) checker
          (place-type-directions new) directions
          (place-type-graphics new) graphics
          (place-type-key new) key)
    (try-place-type new)
    (register *place-types* name (if old (become old new) new)
              :before (and (not (eq next old)) next))
    (warn-of-vain-rules definition (find-place-type name))
    name))
