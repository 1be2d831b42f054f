;;;; editors.lisp -- what inspectors show of our objects: SLIME's, SLY's and Lisp's own.

(in-package :ars-magna.faces)

;;; Their servers, SWANK and SLYNK, ask a generic function of the same name for the contents of an
;;; object's window: a list of strings, (:value object) for what can be looked into, and (:newline).

(defparameter *editor-server-packages* '("SWANK/BACKEND" "SWANK-BACKEND" "SLYNK-BACKEND")
  "The packages of SLIME and SLY that may contain the inspector's generic function.")

(defun inspector-names ()
  "Return the names of the generic functions that inspectors of loaded editor servers call."
  (remove-duplicates
   (loop for server in *editor-server-packages*
         for symbol = (and (find-package server) (find-symbol "EMACS-INSPECT" server))
         when (and symbol (fboundp symbol)) collect symbol)))

(defun inspector-extended-p (inspector)
  (find-method (fdefinition inspector) '(:around) (list (find-class 'structure-object)) nil))

(defun fact-line (label text)
  (list (format nil "~A: ~A" label text) '(:newline)))

(defun slot-line (name value text)
  (list (format nil "  ~(~22A~) " name) (list :value value) (format nil "~@[  ~A~]" text)
        '(:newline)))

(defun inspector-contents (object)
  "Return the contents of the inspector's window for OBJECT: properties (FACTS), then slots."
  (append (list (prin1-to-string object) '(:newline))
          (loop for (label text) in (facts object) append (fact-line label text))
          (loop for (title . slots) in (slots-to-show object)
                append (list* (format nil "~A:" title) '(:newline)
                              (loop for slot in slots append (apply #'slot-line slot))))))

(defun describable-p (object)
  (and (or (kind-of object) (facts object)) t))

(addition join-editors)
(defun join-editors ()
  "Make the inspectors of SLIME and SLY show robots, things, maps and the like as DESCRIBE does,
with descriptions of their slots. Loading the simulator calls this function. Call it again if a
server, SWANK or SLYNK, was loaded later. Return the names of the found servers' packages."
  (loop for inspector in (inspector-names)
        collect (package-name (symbol-package inspector))
        unless (inspector-extended-p inspector)
          do (eval `(defmethod ,inspector :around ((object structure-object))
                      (if (describable-p object) (inspector-contents object) (call-next-method))))))

(join-editors)

;;; The inspector of an editor, asked from here. Who asks may be no thread of the server's, such as
;;; that of a window, in which what the server binds for its own is unbound.

(defun serves-editor-p (server)
  "True if an editor is connected to SERVER, the name of a server's package."
  (let* ((package (find-package server))
         (own (and package (find-symbol "*EMACS-CONNECTION*" package)))
         (default (and package (find-symbol "DEFAULT-CONNECTION" package))))
    (or (and own (boundp own) (symbol-value own) t)
        (and default (fboundp default) (funcall default) t))))

(defun editor-server ()
  "If an editor is connected to a server, return the name of the server's package; else NIL."
  (find-if #'serves-editor-p '("SWANK" "SLYNK")))

(defun call-as-in-buffer (server function)
  "Call FUNCTION with the package and readtable as in a buffer of the editor connected to SERVER."
  (progv (list (find-symbol "*BUFFER-PACKAGE*" server) (find-symbol "*BUFFER-READTABLE*" server))
      (list *package* *readtable*)
    (funcall function)))

(addition inspect-in-editor)
(defun inspect-in-editor (object)
  "Show OBJECT in the inspector of the connected editor, SLIME or SLY. Any thread may call this
function. Return nothing. Signals MISUSE if no editor is connected."
  (let ((server (editor-server)))
    (unless server
      (reject-use "No editor is connected. In Emacs, M-x slime-connect or sly-connect connects ~
                   Emacs to a server that was started in this Lisp. INSPECT and DESCRIBE work ~
                   without an editor."))
    (call-as-in-buffer server (lambda ()
                                (funcall (find-symbol "INSPECT-IN-EMACS" server) object))))
  (values))

;;; INSPECT, Lisp's own, shows slots as they print. Those of a map would fill many screens.

(defun inspect-briefly (inspect object)
  "Call INSPECT, the function of Common Lisp, with OBJECT, and abridge long arrays and lists."
  (let ((*print-length* (or *print-length* 10))
        (*print-level* (or *print-level* 2))
        (*print-lines* (or *print-lines* 2)))
    (funcall inspect object)))

(wrap-function 'inspect
               (lambda (inspect object)
                 (if (describable-p object)
                     (inspect-briefly inspect object)
                     (funcall inspect object))))

;;; An editor may go while its debugger asks how something of ours goes on.

(defun own-connection-p (connection)
  (loop for server in '("SWANK" "SLYNK")
        for own = (and (find-package server) (find-symbol "*EMACS-CONNECTION*" server))
        thereis (and own (boundp own) (eq connection (symbol-value own)))))

(defun editor-gone-p ()
  "True if *DEBUGGER-HOOK* belongs to an editor's server to which no editor is connected."
  (and *debugger-hook*
       (not (editor-server))
       (loop for server in '("SWANK" "SLYNK")
             for name = (and (find-package server)
                             (find-symbol (format nil "~A-DEBUGGER-HOOK" server) server))
             thereis (and name
                          (fboundp name)
                          (member *debugger-hook* (list name (fdefinition name)))
                          t))))

(setf *editor-gone-p* 'editor-gone-p)

(defun note-editor-gone (connection)
  "CONNECTION is closed: end the inquiries that wait for an answer from this connection."
  (end-inquiries (lambda () (own-connection-p connection))))

(defun watch-editors (&rest ignored)
  "Make the editors' servers call NOTE-EDITOR-GONE when a connection is closed."
  (declare (ignore ignored))
  (dolist (server '("SWANK" "SLYNK"))
    (let ((hooks (and (find-package server) (find-symbol "*CONNECTION-CLOSED-HOOK*" server))))
      (when (and hooks (boundp hooks))
        (setf (global-value hooks) (adjoin 'note-editor-gone (global-value hooks)))))))

(add-listener *inquiry-hooks* watch-editors)
