;;;; idle-kickers.lisp -- what is said of kickers that can never run, or fail again and again.

(in-package :ars-magna.world)

(export '(doubt-idle-kickers))

;;; All threads that run worlds share kickers. The slots CHECKED-P and TEST-OUTCOME change in one
;;; direction only, by single writes, so a race can at most repeat a warning.

(defun on-map-p (kicker map)
  (find-recipe (lambda (recipe)
                 (member kicker (recipe-kickers recipe) :key (lambda (it) (find-kicker it nil))))
               (map-things map)))

(defun code-names-p (name package)
  "True if the code of a function whose name is in PACKAGE, or of another kicker, has NAME, that of
a kicker, in it."
  (flet ((names-it-p (function) (member name (code-references function))))
    (or (loop for kicker in (all-kickers)
                thereis (and (not (eq name (kicker-name kicker)))
                             (names-it-p (kicker-body kicker))))
        (and package
             (do-symbols (symbol package)
               (when (and (users-symbol-p symbol) (fboundp symbol)
                          (not (macro-function symbol))
                          (names-it-p (fdefinition symbol)))
                 (return t)))))))

(defun perhaps-used-p (entry world)
  "True if a program may put the kicker of ENTRY on things of WORLD: a function names it, or it is
from another file than the map, or named there more than once."
  (let ((name (entry-name entry)) (file (source-file (entry-source entry)))
        (map-entry (lookup-entry (map-name (world-map world)) *maps*)))
    (if file
        (not (and map-entry
                  (equal file (source-file (entry-source map-entry)))
                  (eql 1 (count-in-file (name-string name) file))))
        (code-names-p name (symbol-package name)))))

(defun doubt-unused-kicker (entry world)
  "Say if the kicker of ENTRY is new, no program seems to use it, and nothing in WORLD has it, nor
will by any map."
  (let ((kicker (entry-object entry)))
    (unless (or (shiftf (kicker-checked-p kicker) t)
                (perhaps-used-p entry world)
                (some (lambda (map) (on-map-p kicker map)) (all-maps)))
      (warn-once (list :kicker (kicker-name kicker)) world
                 (format nil "No thing has the kicker ~(~A~), so it never ran. Attach it: ~
                              (obj (NAME :kickers (~:*~(~A~))) ...) in the map, or ~
                              (set-kicker THING '~:*~(~A~))."
                         (kicker-name kicker))))))

(defun doubt-untrue-kicker (kicker world)
  "Say if KICKER is on a thing of WORLD, and its test was never true and asks for what nothing has."
  (let ((key (and (eq :no (kicker-test-outcome kicker))
                  (some-kicker (lambda (each) (eq each kicker)) world)
                  (find-if-not (lambda (key) (or (attribute-of key) (carried-p key world)))
                               (kicker-test-attributes kicker)))))
    (when key
      (warn-once (list :kicker (kicker-name kicker)) world
                 (format nil "The :test of the kicker ~(~A~) was never true. It reads ~(~S~), ~
                              which no thing here has and no DEFATTRIBUTE declares."
                         (kicker-name kicker) key)))))

(defun doubt-idle-kickers (world)
  "Say, when a run in WORLD ends, which kickers were most likely meant to do something in it, and
cannot."
  (dolist (entry (registry-entries *kickers*))
    (doubt-unused-kicker entry world)
    (doubt-untrue-kicker (entry-object entry) world)))

;;; What can be done about a kicker that fails again and again.

(defun where-to-mend (attachment)
  (let* ((kicker (attachment-kicker attachment))
         (file (function-file (kicker-body kicker))))
    (cond (file (format nil "in ~A, and load that again" file))
          ((eq kicker (find-kicker (kicker-name kicker) nil)) "by DEFKICKER")
          (t "by PUT-KICKER"))))

(defmethod recurring-code ((attachment attachment))
  (kicker-body (attachment-kicker attachment)))

(defmethod recurring-remedy ((attachment attachment))
  (let ((name (attachment-name attachment)))
    (format nil "Mend the kicker ~A ~A; or take it off: ~
                 (put-kicker ~(~A~) (thing (find-thing \"~A\")))."
            name (where-to-mend attachment) name (attachment-thing attachment))))

;; An origin that has nobody to blame is of a group that was read ahead.
(defmethod recurring-code ((origin origin))
  (recurring-code (origin-attachment origin)))

(defmethod recurring-remedy ((origin origin))
  (recurring-remedy (origin-attachment origin)))
