;;;; relations.lisp -- what a claim says of agents: its syntax, and the games that it compares.

(in-package :ars-magna.experiment)

(export '(settings-text))

;;; A claim is a list (text settings relation...), perhaps with a part (:measure name) or (:measure
;;; name :less) among the relations. A game is a list (agent setting...): an agent, and the settings
;;; of knobs that it plays under, of which the last for a knob counts.

(defparameter *relation-syntax*
  "(:better a b margin), (:within a b margin), (:not-worse a b margin) or (:narrows a b (knob v w)),
where A and B are agents of the testbed or lists (agent (knob value)...); or (:measure name), or
(:measure name :less) if less is better"
  "What the parts of a claim are after its text and settings.")

(defun setting-p (thing)
  "True if THING is a list (knob value)."
  (typep thing '(cons (and symbol (not null)) (cons t null))))

(defun settings-p (thing) (and (proper-list-p thing) (every #'setting-p thing)))

(defun side-p (thing agents)
  "True if THING is one of AGENTS, or a list of one and settings."
  (if (consp thing)
      (and (member (first thing) agents) (rest thing) (settings-p (rest thing)))
      (member thing agents)))

(defun measure-part-p (part) (and (consp part) (eq :measure (first part))))

(defun relation-p (part agents)
  "True if PART is a relation between AGENTS, or says the measure, as *RELATION-SYNTAX* tells."
  (if (measure-part-p part)
      (typep part '(cons t (cons (and symbol (not null))
                            (or null (cons (eql :less) null)))))
      (and (typep part '(cons symbol (cons t (cons t (cons t null)))))
           (side-p (second part) agents)
           (side-p (third part) agents)
           (case (first part)
             ((:better :within :not-worse) (typep (fourth part) '(real 0)))
             (:narrows (typep (fourth part) '(cons symbol (cons t (cons t null)))))))))

(defun claim-frame-p (claim)
  "True if CLAIM is a list (text settings part...)."
  (and (proper-list-p claim)
       (typep claim '(cons string (cons cons cons)))
       (proper-list-p (second claim))
       (every #'settings-p (second claim))
       (<= (count-if #'measure-part-p (cddr claim)) 1)
       (not (every #'measure-part-p (cddr claim)))))

(defun knobs-in-relation (part)
  "Return the knobs that PART, a relation, names."
  (unless (measure-part-p part)
    (destructuring-bind (kind a b more) part
      (append (loop for side in (list a b)
                    when (consp side) append (mapcar #'first (rest side)))
              (and (eq :narrows kind) (list (first more)))))))

(defun claim-relations (claim) (remove-if #'measure-part-p (cddr claim)))

;;; The games and their differences.

(defun side-game (side settings)
  "Return the game of SIDE, an agent or a list (agent setting...), which also has SETTINGS."
  (if (consp side)
      (list* (first side) (append settings (rest side)))
      (list* side settings)))

(defun relation-games (relation settings)
  "Return the games that RELATION compares under SETTINGS: two, or four if it is about a gap."
  (destructuring-bind (kind a b more) relation
    (loop for added in (if (eq :narrows kind)
                           (loop for value in (rest more) collect `((,(first more) ,value)))
                           '(()))
          append (loop for side in (list a b)
                       collect (side-game side (append settings added))))))

(defun relation-differences (relation settings scores-of)
  "Return the differences that RELATION is about, by seed: those of the scores of its sides, or of
two gaps. SCORES-OF returns the scores of a game."
  (destructuring-bind (first second &optional third fourth)
      (mapcar scores-of (relation-games relation settings))
    (let ((differences (mapcar #'- first second)))
      (if third
          (mapcar #'- differences (mapcar #'- third fourth))
          differences))))

;;; As text.

(defun settings-text (settings)
  "Return the text of SETTINGS, lists (knob value)."
  (format nil "~{~A~^ ~}"
          (loop for (name value) in settings
                collect (format nil "~(~A~)=~A" name (setting-text value)))))

(defun side-text (side)
  (if (consp side)
      (format nil "~(~A~) (~A)" (first side) (settings-text (rest side)))
      (string-downcase side)))

(defun relation-text (relation less)
  "Return RELATION as text. If LESS is true, less is better."
  (destructuring-bind (kind a b more) relation
    (let ((gap (format nil "~A - ~A" (side-text a) (side-text b))))
      (ecase kind
        (:better (format nil "~A, ~:[at least~;at most~] ~A" gap less
                         (value-text (if less (- more) more))))
        (:within (format nil "~A, within ~A" gap (value-text more)))
        (:not-worse (format nil "~A, interval ~:[above -~;below ~]~A" gap less (value-text more)))
        (:narrows (format nil "(~A) falls from ~(~A~) ~A to ~A" gap (first more)
                          (setting-text (second more)) (setting-text (third more))))))))
