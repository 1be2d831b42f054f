;;;; subjects.lisp -- what HELP tells besides of names: keys, units, scripts.

(in-package :ars-magna.cli)

(defparameter *subjects*
  '(("KEYS" "At a terminal, and where one types in a window, a line is edited as in a shell or
Emacs. Left, right, Home, End, control-A and control-E move in it; with Alt or control, left and
right go by words. Backspace, Delete and control-D delete a character, control-W the word before,
control-U and control-K all before and after; control-Y brings back what was deleted so. Up and down
bring back lines typed before, in earlier sessions too (HISTORY); control-R searches them for what
is typed next. Tab completes; twice, it lists what there is. Control-L clears the screen. Control-C
clears the line, or ends what is under way. Control-D in an empty line leaves. At a terminal only,
control-Z goes back to the shell, where fg comes here again, and control-\\ ends the program at
once. A window's button Help lists the keys of its displays.")
    ("HISTORY" "What was typed at a terminal is kept in ~/.local/state/ars-magna/history, or under
$XDG_STATE_HOME: the last thousand lines. Up and control-R bring them back. Remove the file, and
they are forgotten.")
    ("UNITS" "A number alone is in radians, metres (a cell is one wide) or ticks. Otherwise say
the unit: 90 deg, pi/2, 1/4 turn; 5 m, 250 cm; 0.5 m/tick; 20 ticks.")
    ("SCRIPTS" "A file of lines as they are typed is a script: ./cli/ars-magna FILE carries it
out, each line when the one before it has ended. With --json it writes objects for other programs.
A session that is pasted or saved is a script, too: the prompt before a line is passed over, and
so is a message after one; other answers would be taken for lines.")
    ("NUMERIC" "What DEFATTRIBUTE takes where the values of an attribute are numbers, as in
(defattribute :height numeric).")
    ("COLOURS" "Colours are for terminals, unless the environment has NO_COLOR, or the program
was started with --color never."))
  "Lists (name text): what has no name in the simulator, but is asked for.")

(defun all-subjects () *subjects*)

(defun subject-name (subject) (first subject))

(defun subject-words (subject) (one-line (second subject)))
