;;;; entries.lisp -- an entry of the reference: what is known of one name.

(in-package :ars-magna.manual)

(export '(chapter-title))

(define-record entry
  "What the reference says of a name."
  (name "" string "what the entry is about, as people write it" :export)
  (chapter nil keyword "the key of the chapter that the entry is in" :export)
  (section "" string "the heading that it is listed under there")
  (symbol nil symbol)
  (use "" string "how it is written")
  (facts '() list "lists (label text)")
  (text "" string "what it is")
  (file nil (or null string) "the file where it is defined, or NIL"))

(defparameter *chapters*
  '((:commands "Commands" "What robots, cameras, hands and storage bins can be told to do.")
    (:prompt "The prompt's lines" "What can be typed after Robot> besides Lisp.")
    (:parameters "Parameters" "Special variables that say how the world and its noise are.")
    (:error-codes "Error codes" "What continuations are told, and who tells it.")
    (:definers "Definers" "Macros and functions by which users define what is theirs.")
    (:constructs "Plan constructs" "What plans can say beyond Lisp.")
    (:plan-functions "Plan functions" "What plans tell their robot, and ask it.")
    (:fluents "Fluents" "By which plans learn what came of their robot's commands.")
    (:attributes "Attributes" "What can be said of things, and how well it is sensed.")
    (:substances "Substances" "What walls and things are made of.")
    (:place-types "Place types" "What a robot can sense of where it stands.")
    (:colours "Colours" "For the drawing code of place types.")
    (:conditions "Conditions and restarts" "What is signalled when something is misused.")
    (:robots "Maps and robots" "The shipped worlds: the system ars-magna/worlds.")
    (:kickers "Kickers" "What makes things of the shipped worlds move by themselves.")
    (:manipulations "Manipulations" "What robots can do to things of the shipped worlds.")
    (:plans "Shipped plans" "Plans to start with.")
    (:experiments "Shipped experiments" "Experiments to be run as they are.")
    (:names "Functions, variables, types" "All other names of ARS and NISP, by layer.")
    (:worlds-names "Other names of the worlds" "What else ARS-WORLDS has: things, and functions."))
  "Lists (key title introduction), in order. Of names that several have, the first is meant.")

(defun chapter-title (chapter)
  "Return what CHAPTER, a key of *CHAPTERS*, is called."
  (second (assoc chapter *chapters*)))

(defun chapter-introduction (chapter) (third (assoc chapter *chapters*)))

(defun chapter-file (chapter)
  (format nil "reference-~(~A~).html" chapter))

(defun entry-address (entry)
  (format nil "~A#~A" (chapter-file (entry-chapter entry)) (anchor (entry-name entry))))

(defun entry-key (entry)
  "Return what the entry is looked for by: its name in lower case."
  (string-downcase (entry-name entry)))

(defun entry-sentence (entry)
  (let* ((text (entry-text entry))
         (end (loop for i = (position #\. text) then (position #\. text :start (1+ i))
                    while i
                    when (or (= (1+ i) (length text))
                             (find (char text (1+ i)) '(#\Space #\Newline)))
                      return (1+ i)
                    finally (return (length text)))))
    (one-line (subseq text 0 end))))

;;; What is known of symbols.

(defun project-name (path)
  "Return the name of the file PATH, as the system has it, in the project; NIL of others."
  (let ((root (native-name (root))))
    (and path
         (starts-with-subseq root path)
         (subseq path (length root)))))

(defun file-of-symbol (symbol)
  "Return the name of the file of the project in which SYMBOL is defined, or NIL."
  (some #'project-name
        (append (when (fboundp symbol)
                  (list (function-file (or (macro-function symbol) (fdefinition symbol)))))
                (mapcar #'first (files-besides-functions symbol)))))

(defun plain-use (name lambda-list)
  "Return how the function or macro NAME is called with LAMBDA-LIST, without names of packages."
  (let ((*print-case* :downcase) (*print-pretty* nil)
        (*package* (or (and (symbolp name) (symbol-package name)) *package*)))
    (format nil "(~A~{ ~A~})" (string-downcase name)
            (mapcar #'unqualified-text (without-hidden lambda-list)))))

(defun without-hidden (lambda-list)
  "Return LAMBDA-LIST without what a macro is told besides its arguments."
  (loop with rest = lambda-list
        while (consp rest)
        for item = (pop rest)
        if (member item '(&whole &environment)) do (pop rest)
        else if (eq item '&aux) do (loop-finish)
        else collect item into items
        finally (return (append items (and rest (list '&rest rest))))))

(defun text-of-symbol (symbol)
  (format nil "~{~A~^~2%~}" (documentation-texts symbol)))

(defun sorts-of-symbol (symbol)
  (append (cond ((macro-function symbol) '("macro"))
                ((not (fboundp symbol)) '())
                ((typep (fdefinition symbol) 'generic-function) '("generic function"))
                (t '("function")))
          (cond ((not (boundp symbol)) '())
                ((constantp symbol) '("constant"))
                (t '("variable")))
          (let ((class (find-class symbol nil)))
            (cond ((null class) '())
                  ((subtypep symbol 'condition) '("condition"))
                  (t '("type"))))))

(defun packages-showing (symbol)
  "Return the names of the users' packages that export the name of SYMBOL."
  (loop for face in '("ARS" "NISP" "ARS-WORLDS" "ARS-FIVEAM")
        when (and (find-package face)
                  (multiple-value-bind (other status) (find-symbol (symbol-name symbol) face)
                    (and (eq :external status)
                         (or (eq other symbol)
                             (and (fboundp symbol) (fboundp other)
                                  (eq (fdefinition other) (fdefinition symbol)))))))
          collect face))

(defun symbol-facts (symbol)
  (let ((sorts (sorts-of-symbol symbol)) (packages (packages-showing symbol)))
    (append (when sorts (list (list "Is a" (format nil "~{~A~^, ~}" sorts))))
            (when packages (list (list "Package" (format nil "~{~A~^, ~}" packages)))))))
