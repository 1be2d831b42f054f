;;;; prompt.lisp -- how long the prompt takes to start.

(in-package :ars-magna.benchmarks)

(let ((program (base:native-name (asdf:system-relative-pathname "ars-magna" "cli/ars-magna"))))
  (flet ((start-and-leave ()
           (with-input-from-string (input "quit")
             (base:run-command program '("--world" "hall") :input input))))
    (start-and-leave)                   ; makes the core if there is none
    (say "start to end of a session that only quits"
         (* 1000 (median (loop repeat 20 collect (seconds-for #'start-and-leave)))) "ms")))
