;;;; repair.lisp -- making it right who hears of fluents, after a change of that was left halfway.

(in-package :ars-magna.rpl.fluents)

(export '(repair-fluents))

;;; The lists of fluents may be in any state. So the fluents that somebody watches are found from
;;; the watchers, which are known; what the fluents remember of each other is dropped and made anew.

(defun reachable-fluents (watchers)
  "Return the fluents that WATCHERS watch, and those that depend on these or that these depend on."
  (let ((seen (make-hash-table :test 'eq)) (fluents '()))
    (labels ((visit (fluent)
               (unless (gethash fluent seen)
                 (setf (gethash fluent seen) t)
                 (push fluent fluents)
                 (when (derived-p fluent)
                   (dolist (source (derived-sources fluent))
                     (when (fluent-p source) (visit source))))
                 (loop for link = (fluent-first-link fluent) then (link-next link)
                       repeat 1000000
                       while link do (visit (link-dependent link))))))
      (mapc (lambda (watcher) (visit (watcher-fluent watcher))) watchers))
    (nreverse fluents)))

(defun listed-watchers (fluent)
  "Return the watchers that are in the list of FLUENT, each once."
  (let ((seen '()))
    (loop for watcher = (fluent-first-watcher fluent) then (watcher-next watcher)
          until (or (null watcher) (member watcher seen :test #'eq))
          do (push watcher seen))
    (nreverse seen)))

(defun forget-all (fluent)
  (setf (fluent-first-watcher fluent) nil
        (fluent-last-watcher fluent) nil
        (fluent-first-link fluent) nil
        (fluent-last-link fluent) nil)
  (when (derived-p fluent)
    (setf (derived-users fluent) 0
          (derived-links fluent) '()
          (derived-queued fluent) nil
          (derived-successor fluent) nil)))

(defun forget-backlog (home)
  (let ((backlog (home-backlog home)))
    (fill (backlog-heads backlog) nil)
    (fill (backlog-tails backlog) nil)
    (setf (backlog-highest backlog) 0)))

(defun acquire-in-any-case (fluent)
  "Note one more user of FLUENT. If its function aborts, that is an error of FLUENT."
  (restart-case (acquire fluent)
    (abort ()
      :report "Let the fluent be in error."
      (when (derived-p fluent)
        (setf (derived-trouble fluent)
              (make-condition 'simple-error
                              :format-control "The function of ~A was aborted."
                              :format-arguments (list (fluent-text fluent))))))))

(defun repair-fluents (home watchers unwanted-p)
  "Let WATCHERS, and those in the lists of their fluents for which UNWANTED-P is false, hear what
they are to in HOME."
  (let* ((fluents (reachable-fluents watchers))
         (listed (remove-if unwanted-p (mapcan #'listed-watchers fluents)))
         (all (append listed (set-difference watchers listed))))
    (forget-backlog home)
    (mapc #'forget-all fluents)
    (dolist (watcher all)
      (setf (watcher-previous watcher) nil
            (watcher-next watcher) nil)
      (acquire-in-any-case (watcher-fluent watcher))
      (join-watchers watcher))))
