;;;; editors.lisp -- what inspectors show of our objects: SLIME's, SLY's and Lisp's own.

(in-package :ars-magna.faces)

;;; Their servers, SWANK and SLYNK, ask a generic function of the same name for the contents of an
;;; object's window: a list of strings, (:value object) for what can be looked into, and (:newline).

(defparameter *servers* '("SWANK/BACKEND" "SWANK-BACKEND" "SLYNK-BACKEND")
  "The packages in which the function may be.")

(defun inspectors ()
  "Return the symbols of the generic functions that the inspectors of the servers that are loaded
ask. Two of the names may be those of one package."
  (remove-duplicates
   (loop for server in *servers*
         for symbol = (and (find-package server) (find-symbol "EMACS-INSPECT" server))
         when (and symbol (fboundp symbol)) collect symbol)))

(defun joined-p (inspector)
  "True if the generic function INSPECTOR asks us already."
  (find-method (fdefinition inspector) '(:around) (list (find-class 'structure-object)) nil))

(defun fact-line (label text)
  (list (format nil "~A: ~A" label text) '(:newline)))

(defun slot-line (name value text)
  (list (format nil "  ~(~22A~) " name) (list :value value) (format nil "~@[  ~A~]" text)
        '(:newline)))

(defun window-of (object)
  "Return what an inspector is to show of OBJECT: what people want to know of it, then its slots."
  (append (list (prin1-to-string object) '(:newline))
          (loop for (label text) in (facts object) append (fact-line label text))
          (loop for (title . slots) in (slots-to-show object)
                append (list* (format nil "~A:" title) '(:newline)
                              (loop for slot in slots append (apply #'slot-line slot))))))

(defun known-object-p (object)
  "True if there is more to say of OBJECT than what its slots are called."
  (and (or (kind-of object) (facts object)) t))

(addition join-editors)
(defun join-editors ()
  "Let the inspectors of SLIME and SLY, as far as their servers SWANK and SLYNK are loaded, show
robots, things, maps and the like as DESCRIBE does, with what their slots mean. That is done when
the simulator is loaded; say it again where a server was loaded later. Return the packages of those
that were found."
  (loop for inspector in (inspectors)
        collect (package-name (symbol-package inspector))
        unless (joined-p inspector)
          do (eval `(defmethod ,inspector :around ((object structure-object))
                      (if (known-object-p object) (window-of object) (call-next-method))))))

(join-editors)

;;; The inspector of an editor, asked from here. Who asks may be no thread of the server's, such as
;;; that of a window, in which what the server binds for its own is unbound.

(defun serves-editor-p (server)
  "True if an editor is connected to the server in the package called SERVER."
  (let* ((package (find-package server))
         (own (and package (find-symbol "*EMACS-CONNECTION*" package)))
         (default (and package (find-symbol "DEFAULT-CONNECTION" package))))
    (or (and own (boundp own) (symbol-value own) t)
        (and default (fboundp default) (funcall default) t))))

(defun editor-server ()
  "Return the name of the package of the server that an editor is connected to, or NIL."
  (find-if #'serves-editor-p '("SWANK" "SLYNK")))

(defun call-as-in-buffer (server function)
  "Call FUNCTION as from a buffer of the editor that is connected to SERVER."
  (progv (list (find-symbol "*BUFFER-PACKAGE*" server) (find-symbol "*BUFFER-READTABLE*" server))
      (list *package* *readtable*)
    (funcall function)))

(addition inspect-in-editor)
(defun inspect-in-editor (object)
  "Show OBJECT in the inspector of the editor, SLIME or SLY, that is connected; any thread may say
so. Return nothing. Signals MISUSE where no editor is."
  (let ((server (editor-server)))
    (unless server
      (reject-use "No editor is connected. In Emacs, M-x slime-connect or sly-connect connects it ~
                   to a server that has been started here. INSPECT and DESCRIBE need none."))
    (call-as-in-buffer server (lambda ()
                                (funcall (find-symbol "INSPECT-IN-EMACS" server) object))))
  (values))

;;; INSPECT, Lisp's own, shows slots as they print. Those of a map would fill many screens.

(defun inspect-briefly (inspect object)
  "Call INSPECT, Lisp's function, with OBJECT, and let it show long arrays and lists in part."
  (let ((*print-length* (or *print-length* 10))
        (*print-level* (or *print-level* 2))
        (*print-lines* (or *print-lines* 2)))
    (funcall inspect object)))

(wrap-function 'inspect
               (lambda (inspect object)
                 (if (known-object-p object)
                     (inspect-briefly inspect object)
                     (funcall inspect object))))

;;; An editor may go while its debugger asks how something of ours goes on.

(defun own-connection-p (connection)
  "True if what this thread does is for CONNECTION, of an editor."
  (loop for server in '("SWANK" "SLYNK")
        for own = (and (find-package server) (find-symbol "*EMACS-CONNECTION*" server))
        thereis (and own (boundp own) (eq connection (symbol-value own)))))

(defun editor-gone-p ()
  "True if *DEBUGGER-HOOK* is that of a server to which no editor is connected."
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
  "Let those threads go on otherwise that wait for an answer by CONNECTION, which is closed."
  (end-inquiries (lambda () (own-connection-p connection))))

(defun watch-editors (&rest ignored)
  "See to it that we are told when a connection of an editor is closed."
  (declare (ignore ignored))
  (dolist (server '("SWANK" "SLYNK"))
    (let ((hooks (and (find-package server) (find-symbol "*CONNECTION-CLOSED-HOOK*" server))))
      (when (and hooks (boundp hooks))
        (setf (global-value hooks) (adjoin 'note-editor-gone (global-value hooks)))))))

(attend *inquiry-hooks* watch-editors)
