;;;; workers.lisp -- several threads at one thing: the one door to lparallel.

(in-package :ars-magna.experiment)

(addition processors)
(defun processors ()
  "Return how many processors this machine lets us use, 1 if that cannot be told."
  (let ((text (nth-value 1 (run-command "nproc" '() :output :string))))
    (max 1 (or (and text (parse-integer text :junk-allowed t)) 1))))

(defun await-all (channel count pulse)
  "Take COUNT results from CHANNEL, calling PULSE, a function, now and then meanwhile."
  (loop with left = count
        while (plusp left)
        do (multiple-value-bind (value there-p)
               (lparallel:try-receive-result channel :timeout 0.2)
             (declare (ignore value))
             (when there-p (decf left))
             (funcall pulse))))

(defun call-by-workers (function count pulse)
  "Call FUNCTION in each of COUNT threads, with its number from 1, and wait until all have returned.
PULSE, a function, is called here now and then. If this is left, the threads are left too, whatever
they do. What FUNCTION signals is signalled here."
  (let* ((lparallel:*kernel* (lparallel:make-kernel
                              count :name "trials"
                              ;; It would tell users that threads are left.
                              :bindings `((*standard-output* . ,*nowhere*)
                                          (*error-output* . ,*nowhere*))))
         (channel (lparallel:make-channel))
         (done nil))
    (unwind-protect
         (progn
           (loop for number from 1 to count
                 do (let ((number number))
                      (lparallel:submit-task channel (lambda () (funcall function number)))))
           (await-all channel count pulse)
           (setf done t))
      (unless done (lparallel:kill-tasks :default))
      (lparallel:end-kernel :wait t))))
