;;;; trying.lisp -- the trials of a check, one after the other until their number decides.

(in-package :ars-magna.fiveam)

(defstruct (rate-check (:conc-name check-)
                       (:constructor make-check (experiment condition subject at-least trials
                                                 level workers))
                       (:copier nil))
  "Whether trials of CONDITION, of EXPERIMENT, succeed AT-LEAST so often."
  (experiment nil :read-only t)
  (condition nil :read-only t)
  ;; What its author wrote, or NIL if the experiment was there already.
  (subject nil :type (or null subject) :read-only t)
  (at-least 0d0 :type double-float :read-only t)
  ;; How many there are at most.
  (trials 0 :type integer :read-only t)
  (level 0d0 :type double-float :read-only t)
  (workers 1 :type integer :read-only t)
  ;; What came of those that counted, the latest first, and what that says.
  (results '() :type list)
  (successes 0 :type integer)
  (verdict nil :type symbol))

(defun success-p (result) (string= "success" (result-outcome result)))

(defun count-result (check result)
  "Count RESULT, of the next trial of CHECK. Return the verdict, or NIL."
  (push result (check-results check))
  (when (success-p result) (incf (check-successes check)))
  (setf (check-verdict check)
        (verdict (check-successes check) (length (check-results check)) (check-trials check)
                 (check-at-least check) (check-level check))))

(defun try (check trial stopping-p)
  (call-in-silence
   (lambda () (run-guarded (check-experiment check) (check-condition check) trial stopping-p))))

;; Which trials count is decided in their order, whoever runs them.
(defun try-some (check first last)
  "Return what comes of the trials of CHECK from FIRST to LAST, in order."
  (let ((results (make-array (- last first -1))) (workers (check-workers check)) (stopped nil))
    (call-by-workers (lambda (worker)
                       (loop for trial from (+ first worker -1) to last by workers
                             until stopped
                             do (setf (aref results (- trial first))
                                         (try check trial (lambda () stopped)))))
                     workers :stop (lambda () (setf stopped t)))
    (coerce results 'list)))

(defun some-more (check first)
  "Return what comes of some trials of CHECK from FIRST on, in order."
  (if (= 1 (check-workers check))
      (list (try check first (constantly t)))
      (try-some check first (min (check-trials check)
                                 (+ first (max first (* 8 (check-workers check))))))))

(defun run-check (check)
  "Run trials of CHECK until they decide. Return CHECK."
  (loop for first = (1+ (length (check-results check)))
        until (loop for result in (some-more check first)
                      thereis (count-result check result)))
  check)
