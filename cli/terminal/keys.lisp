;;;; keys.lisp -- the terminal that this process reads: its size, and keys one by one.

(in-package :ars-magna.cli)

;;; It is asked and told by the program stty, which the system has wherever it has terminals.

(defun stty (&rest arguments)
  "Have stty do ARGUMENTS, strings, to the terminal that this process reads. Return what it says, or
NIL if there is no terminal."
  (multiple-value-bind (status text)
      (run-command "stty" arguments :input :interactive :output :string)
    (and (eql status 0) (string-trim '(#\Newline) text))))

(defun lines-and-columns ()
  "Return how many lines and columns the terminal has that this process reads, a list, or NIL."
  (let ((numbers (ignore-errors (mapcar #'parse-integer
                                        (uiop:split-string (or (stty "size") ""))))))
    (and (= 2 (length numbers)) (every #'plusp numbers) numbers)))

;; A program cannot be waited for while interrupts are held.
(defun stty-surely (&rest arguments)
  "Do as STTY does; if control C comes meanwhile, once more."
  (loop (handler-case (return (call-open-to-interrupts (lambda () (apply #'stty arguments))))
          (user-interrupt () nil))))

(defun call-with-keys (function)
  "Call FUNCTION, interrupts being held, while the terminal gives each key as it is pressed, and
does not show it. Control C still interrupts."
  (let ((manner (stty-surely "-g")))
    (unwind-protect (progn (stty-surely "-icanon" "-echo" "min" "1" "time" "0")
                           (funcall function))
      (when manner (stty-surely manner)))))
