;;;; facts.lisp -- what people want to know of commands, manipulations and robots to be made.

(in-package :ars-magna.command)

(defun specification-text (specification)
  "Return what SPECIFICATION, of a command's argument or result, says."
  (format nil "~(~A~)~@[, ~A~]" (spec-name specification)
          (and (string/= "" (spec-text specification)) (spec-text specification))))

(defun specifications-text (specifications)
  (and specifications (format nil "~{~A~^; ~}" (mapcar #'specification-text specifications))))

(define-facts (command command)
  "What it does" (command-documentation command)
  "Given to" (specification-text (command-resource command))
  "Arguments" (specifications-text (command-parameters command))
  "Its continuation gets, after an error code or NIL"
  (specifications-text (cons (command-resource command) (command-results command)))
  "Error codes" (format nil "~{~S~^, ~}" (append (mapcar #'error-code-keyword
                                                         (command-errors command))
                                                 '(:interrupt)))
  "At the prompt" (command-prompt-name command)
  "Manual" (command-section command))

(define-facts (manipulation manipulation)
  "Methods, the newest first" (format nil "~{~A~^; ~}"
                                      (mapcar (lambda (method) (fact-text (method-form method)))
                                              (manipulation-methods manipulation))))

(define-facts (blueprint blueprint)
  "Starts in" (format nil "~(~A~) at (~,2F,~,2F), heading ~,2F" (blueprint-map blueprint)
                      (blueprint-x blueprint) (blueprint-y blueprint)
                      (blueprint-angle blueprint))
  "Parts" (and (blueprint-parts blueprint)
               (format nil "~{~(~A~@[ (~{~A ~A~^, ~})~]~)~^; ~}" ; Kind, initargs, kind, initargs.
                       (loop for (kind . initargs) in (blueprint-parts blueprint)
                             collect kind
                             collect initargs))))

(defmethod function-meant ((name symbol))
  (let ((command (find-command name nil)))
    (and command
         (not (same-name-p name (command-name command)))
         (command-name command))))
