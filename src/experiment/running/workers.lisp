;;;; workers.lisp -- several threads at one thing: the one door to lparallel.

(in-package :ars-magna.experiment)

(export '(call-by-workers))

(addition processors)
(defun processors ()
  "Return how many processors this machine lets us use, 1 if that cannot be told."
  (let ((text (nth-value 1 (run-command "nproc" '() :output :string))))
    (max 1 (or (and text (parse-integer text :junk-allowed t)) 1))))

(defun trouble-of (function)
  (handler-case (progn (funcall function) nil)
    ((or error storage-condition) (condition) condition)))

(defun await-result (channel left)
  "Take a result from CHANNEL if there is one soon. Return how many are LEFT then, and the result."
  (multiple-value-bind (trouble there-p) (lparallel:try-receive-result channel :timeout 0.2)
    (values (if there-p (1- left) left) trouble)))

(defconstant +patience+ 10
  "For how many fifths of a second threads that are to end may go on with what they do.")

(defun end-workers (channel left)
  "Let LEFT threads end that have not answered by CHANNEL, or end them."
  (loop repeat +patience+
        while (plusp left)
        do (setf left (await-result channel left)))
  (handler-bind ((warning #'muffle-warning))
    (when (plusp left) (lparallel:kill-tasks :default))
    (lparallel:end-kernel :wait t)))

(defun call-by-workers (function count &key (pulse (constantly nil)) (stop (constantly nil)))
  "Call FUNCTION in each of COUNT threads, with its number from 1, and wait until all have returned.
PULSE, a function, is called here now and then. If this is left, STOP is called, which should let
them return; those that do not are ended. What FUNCTION signals is signalled here."
  (let* ((lparallel:*kernel* (lparallel:make-kernel
                              count :name "trials"
                              ;; Threads that are ended would say so.
                              :bindings `((*standard-output* . ,*nowhere*)
                                          (*error-output* . ,*nowhere*))))
         (channel (lparallel:make-channel))
         (left count))
    (unwind-protect
         (progn
           (loop for number from 1 to count
                 do (let ((number number))
                      (lparallel:submit-task
                       channel
                       (lambda () (trouble-of (lambda () (funcall function number)))))))
           (loop with trouble
                 while (plusp left)
                 do (setf (values left trouble) (await-result channel left))
                    (when trouble (error trouble))
                    (funcall pulse)))
      (funcall stop)
      (end-workers channel left))))
