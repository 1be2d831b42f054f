;;;; reader.lisp -- what the lines of a session are read from, and how.

(in-package :ars-magna.cli)

(defstruct (reader (:copier nil))
  "What lines come from."
  (input *standard-input* :type stream :read-only t)
  ;; Files to load, and lines to do, before any is read.
  (files '() :type list)
  (lines '() :type list)
  ;; In which package they are read at first; NIL for the users' own.
  (package nil :type (or null package) :read-only t)
  ;; No prompt is shown.
  (batch-p nil :type boolean :read-only t)
  ;; What is read is shown, for transcripts.
  (echo-p nil :type boolean :read-only t)
  ;; The first line that is an error is the last.
  (stop-p nil :type boolean :read-only t)
  ;; A line has been read of what is typed.
  (typed-p nil :type boolean)
  ;; Nothing more is typed: nobody has said QUIT.
  (ended-p nil :type boolean))
