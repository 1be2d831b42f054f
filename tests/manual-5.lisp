;;;; manual-5.lisp -- the package in which the claims of chapter 5 and the appendices are tested.

;;; Each section of the manual has a suite, manual-5-1 for 5.1, in a file of that name. A test
;;; checks a claim or a reading of the manual with the exports of ARS and NISP only, in worlds that
;;; its file defines. Its docstring has the section, the reading and the claim.

;; Not from ARS-MAGNA.TESTS, where NISP is the nickname of a layer.
(in-package :ars-user)

(ars:define-user-package :ars-test-manual-5
  (:documentation "A user's package: Common Lisp, ARS and NISP, and what tests are written with.")
  (:import-from :ars-magna.tests
                #:def-suite* #:test #:is #:is-true #:is-false #:signals #:ars-magna
                #:call-times #:call-once #:end-code #:near #:frequent-p #:warnings-of
                #:complaints #:has-words-p #:wall-picture #:map-of #:picture-map
                #:lines-of #:joined #:elements #:of-element #:drawn-with #:value-of #:web
                #:message-texts)
  (:import-from :ars-magna.display #:svg-picture)
  (:import-from :ars-magna.cli #:make-session #:run-session #:session-errors))

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(defun walls (map x y &rest more)
  "Return the substance parameters of the cells (X Y) and MORE, by turns, of MAP; NIL for an empty
one."
  (loop for (x y) on (list* x y more) by #'cddr
        collect (and (wall-at-p map x y) (cell-substance-parameter (map-cell map x y)))))

(defun where (thing)
  "Return the position of THING, a list (x y)."
  (multiple-value-list (thing-position thing)))

(defun names (things)
  "Return the names of THINGS with their numbers."
  (mapcar #'princ-to-string things))

(defun same-name-p (name other) (string= name other))

(defun answer (command &rest arguments)
  "Issue COMMAND with ARGUMENTS and pass ticks until its continuation is called. Return the
arguments of the continuation."
  (let ((answers '()))
    (apply command (append arguments (list (continuation (&rest answer) (push answer answers)))))
    (run-until (lambda () answers) :limit 2000)
    (first answers)))
