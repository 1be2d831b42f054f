;;;; attaching.lisp -- putting kickers on things and taking them off (manual 5.3.1).

(in-package :ars-magna.world)

(export '(call-put-kicker find-attachment detached-kicker))

(defun find-attachment (thing name)
  "Return the kicker called NAME on THING, as attached, or NIL."
  (find name (thing-kickers thing) :key #'attachment-name :test #'same-name-p))

(defun detached-kicker (thing name)
  "Return what stands for a kicker called NAME that was on THING, as attached, and is no more."
  (let ((attachment (make-attachment (make-kicker name) thing)))
    (setf (attachment-alive-p attachment) nil)
    attachment))

(defun detach-kicker (thing name)
  (let ((attachment (find-attachment thing name)))
    (when attachment
      (setf (thing-kickers thing) (remove attachment (thing-kickers thing)))
      (leave-group attachment))))

(defun detach-all-kickers (thing)
  (mapc #'leave-group (thing-kickers thing))
  (setf (thing-kickers thing) '()))

(defun attach-kicker (thing kicker)
  "Put KICKER on THING instead of any other of its name. Return the attachment."
  (detach-kicker thing (kicker-name kicker))
  (setf (kicker-checked-p kicker) t)
  (let ((attachment (make-attachment kicker thing)))
    (setf (thing-kickers thing) (append (thing-kickers thing) (list attachment)))
    (when (and (thing-world thing) (thing-alive-p thing))
      (join-group attachment (thing-world thing)))
    attachment))

(public set-kicker)
(defun set-kicker (thing kicker-name)
  "Attach to THING the kicker called KICKER-NAME, a symbol, or given as itself (manual 5.3.1).
Signals WRONG-ARGUMENT and UNKNOWN-NAME. Return it as attached, what SELF is when it runs.
See reading 171."
  (check-argument set-kicker thing (thing-p thing) (argument-type-text 'thing thing))
  (let ((kicker (find-kicker kicker-name)))
    (changing ((world-of-living thing) set-kicker thing (kicker-name kicker))
      (attach-kicker thing kicker))))

(define-operator 'set-kicker '(thing name) #'set-kicker)

(defun call-put-kicker (thing name &key (prob 1) test body)
  "Do what PUT-KICKER says; without a BODY, remove the kicker NAME."
  (check-argument put-kicker thing (thing-p thing) (argument-type-text 'thing thing))
  (let ((kicker (and body (fill-kicker (make-kicker name) (title "put-kicker" name)
                                       prob test body))))
    (changing ((world-of-living thing) call-put-kicker thing name
                        :prob prob :test test :body body)
      (if kicker
          (attach-kicker thing kicker)
          (detach-kicker thing name)))))

(define-operator 'call-put-kicker '(thing name) #'call-put-kicker :rest 'datum)

(public put-kicker)
(define-user-macro put-kicker (name target &optional options &body body)
  "Define a kicker NAME for one thing alone, with options as for DEFKICKER, instead of any other of
that name on it; or, with an empty BODY, remove its kicker NAME, even a global one (manual
5.3.1). TARGET is (variable thing); the variable is bound to the thing in test and body. Return
the kicker as attached, if any."
  (let ((definition (title "put-kicker" name)))
    (check-name definition name "kicker")
    (unless (and (proper-list-p target) (= 2 (length target)))
      (reject-clause definition target "(variable thing)"))
    (destructuring-bind (variable thing) target
      (if (every #'null body)
          `(progn (call-put-kicker ,thing ',name) nil)
          `(call-put-kicker ,thing ',name
                            ,@(kicker-functions definition variable options body))))))
