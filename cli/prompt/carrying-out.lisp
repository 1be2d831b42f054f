;;;; carrying-out.lisp -- doing what a line says.

(in-package :ars-magna.cli)

(defun expand-alias (text &optional known)
  "Return TEXT with the alias that it begins with, if any, replaced; again, but each only once."
  (multiple-value-bind (name rest) (split-line text)
    (let ((alias (assoc name *aliases* :test #'string-equal)))
      (if (and alias (not (member alias known)))
          (expand-alias (concatenate 'string (second alias) rest) (cons alias known))
          text))))

(defun unhurried-p (line)
  "True if what LINE prints is to be seen as it comes."
  (or (line-full-name line)
      (member (line-name line) '("EVAL" "REPEAT" "TRIAL" "FORK" "WATCH" "WINDOW" "DISPLAY")
              :test #'string=)))

(defun text-width (session)
  "Return how many characters a line of running text may have for SESSION: as its window has room
for, or 79."
  (if (session-terminal-p session) (max 40 (min 79 (1- (size-of-window session)))) 79))

(defun run-line (session line text)
  "Do what LINE does with the arguments in TEXT. What it prints comes out in one piece."
  (let ((arguments (read-arguments line text))
        (*text-width* (text-width session))
        (*asker* (asker-for (session-account session) :typed-p t)))
    (if (unhurried-p line)
        (apply (line-action line) session arguments)
        (write-string (fitted (printing-words ()
                                (with-output-to-string (*standard-output*)
                                  (apply (line-action line) session arguments)))
                              (session-console session))))))

(defun evaluate-line (session text)
  "Evaluate TEXT as Lisp. The tables that it prints fit the window of SESSION, if it has one."
  (if (session-terminal-p session)
      (call-on-page (lambda () (evaluate-text session text)) (1- (size-of-window session)))
      (evaluate-text session text)))

(defun run-text (session text)
  "Do what TEXT, a line as typed, says; what it asks for, the prompt asks for."
  (let* ((*asker* (asker-for (session-account session)))
         (*told-of* *asker*))
    (cond ((comment-p text))
          ((lisp-p text) (evaluate-line session text))
          (t (let ((text (expand-alias text)))
               (if (lisp-p text)
                   (evaluate-line session text)
                   (multiple-value-bind (name rest) (split-line text)
                     (tell-of-comment text)
                     (check-legible session text 0 nil)
                     (run-line session (find-line name) rest))))))))
