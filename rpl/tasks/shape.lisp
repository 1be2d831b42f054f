;;;; shape.lisp -- what arguments a plan or function takes, and whether some fit.

(in-package :ars-magna.rpl.tasks)

(export '(shape-of shape-text keyword-slip misfit))

(define-record (shape (:constructor make-shape (least most fixed keys open)))
  "How many arguments something takes, LEAST to MOST."
  (least 0 fixnum)
  (most most-positive-fixnum fixnum)
  (fixed 0 fixnum "how many of the arguments are no keywords" :export)
  (keys :none (or list (eql :none))
        "the list of the keywords, or :NONE if there is no &KEY" :export)
  (open nil t "true if other keywords do as well"))

(defun keyword-of (parameter)
  "Return the keyword that PARAMETER, after &KEY in a lambda list or a function type, goes by."
  (let ((name (if (consp parameter) (first parameter) parameter)))
    (cond ((consp name) (first name))
          (t (make-keyword name)))))

(defun shape-of (lambda-list)
  "Return the shape that LAMBDA-LIST, an ordinary one or that of a function type, means."
  (let ((mode nil) (least 0) (optional 0) (keys '()) (seen '()))
    (dolist (parameter lambda-list)
      (cond ((member parameter lambda-list-keywords)
             (setf mode parameter)
             (push parameter seen))
            (t (case mode
                 ((nil) (incf least))
                 (&optional (incf optional))
                 (&key (push (keyword-of parameter) keys))))))
    (make-shape least
                (if (intersection '(&rest &key &body) seen) most-positive-fixnum (+ least optional))
                (+ least optional)
                (if (member '&key seen) (nreverse keys) :none)
                (member '&allow-other-keys seen))))

(defun shape-text (lambda-list)
  "Return LAMBDA-LIST as people write it."
  (printing-words ()
    (let ((*print-case* :downcase) (*print-pretty* nil))
      (format nil "~:A" lambda-list))))

(defun keyword-slip (shape rest &key (wrong-p #'keywordp))
  "Return in words the keyword among REST, arguments or forms after the others, that is none of
SHAPE's, or NIL. Those that WRONG-P is not true of may be keywords yet."
  (unless (or (shape-open shape)
              (loop for (key value) on rest by #'cddr
                    thereis (and (eq key :allow-other-keys) value)))
    (loop for (key) on rest by #'cddr
          when (and (funcall wrong-p key)
                    (not (member key (list* :allow-other-keys (shape-keys shape)))))
            return (format nil "~(~S~)~@[ (did you mean ~(~S~)?)~]"
                           key (and (keywordp key) (nearest-name key (shape-keys shape)))))))

(defun misfit (shape arguments &key (wrong-p #'keywordp))
  "Return in words what it is of ARGUMENTS, or the forms for them, that SHAPE does not take; NIL if
they may fit. WRONG-P is as for KEYWORD-SLIP."
  (let* ((count (length arguments))
         (rest (nthcdr (shape-fixed shape) arguments)))
    (cond ((not (<= (shape-least shape) count (shape-most shape)))
           (format nil "~D argument~:P" count))
          ((eq :none (shape-keys shape)) nil)
          ((oddp (length rest)) "a keyword without a value")
          (t (keyword-slip shape rest :wrong-p wrong-p)))))
