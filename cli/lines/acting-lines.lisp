;;;; acting-lines.lisp -- GO-TO and MANIPULATE: lines that issue several commands.

(in-package :ars-magna.cli)

(defun warn-of-cancelled-drive (point simulation)
  "Queue a warning that the robot no longer goes to POINT, because a rewind replaced SIMULATION."
  (let ((*message-queue* (simulation-messages (latest-successor simulation))))
    (warning-set (format nil "go-to: The run was rewound on the way to ~A, so the robot no ~
                              longer goes there. Type the line again to send it there."
                         point))))

(defun report-failed-way (control point &rest arguments)
  (error-set (make-verdict (format nil "go-to: ~?" control (cons point arguments)))))

(defun report-arrival (err robot point)
  "Queue a message about the end of ROBOT's drive to POINT, a text. ERR is an error code, or NIL."
  (case err
    ((nil) (message-set (format nil "go-to: Robot is near ~A, by its odometer" point)))
    (:no-way (report-failed-way "There is no way to ~A for ~A" point robot))
    (:gave-up (report-failed-way "Obstacles on the way to ~A stopped ~A too often" point robot))
    (t (report-failed-way "Interrupted on the way to ~A" point))))

(define-line "GO-TO" (session (x metres "metres from the left") (y metres "metres from the top"))
    (:moving)
    "Let the robot find its way to X, Y, through doorways and round obstacles."
  (let ((job (make-job :name "GO-TO" :verdict-p t))
        (simulation (current-simulation))
        (point (format nil "~A ~A" (plain-number-text x) (plain-number-text y)))
        (account (session-account session)))
    (let ((own (asker-for account)) (*asker* (asker-for account :text "GO-TO")))
      (robot-go-to (session-robot) x y
                   (lambda (err robot)
                     (let ((*asker* own) (*request-origin* own)
                           (*reported-robot* (robot-name robot)))
                       (if (eq simulation (latest-successor simulation))
                           (report-arrival err robot point)
                           (warn-of-cancelled-drive point simulation)))
                     (end-job job err))))
    (push job (session-jobs session))))

;;;; MANIPULATE

;;; The methods determine what is typed: a designator's number for each object; then the number of
;;; the acting part, 0 if left out, or nothing if the robot acts; then other arguments.

(defun part-variable-p (by)
  "True if BY, a parameter (variable type) of a method, takes a part of the robot."
  (and (second by) (part-type-p (type-keyword (second by)))))

(defun method-usage (name method)
  (multiple-value-bind (objects by others) (method-signature method)
    (format nil "~(~A~{ ~A~}~@[ [~A]~]~{ ~A~}~)" name objects
            (and (part-variable-p by) (first by))
            (mapcar #'first others))))

(defun manipulation-usages (manipulation &optional (usage #'method-usage))
  "Return a list of different texts: the ways to type MANIPULATION after the word MANIPULATE. USAGE
is a function like METHOD-USAGE, which returns the text for a method."
  (remove-duplicates (loop for method in (manipulation-methods manipulation)
                           collect (funcall usage (manipulation-name manipulation) method))
                     :test #'string=))

(defun resolve-manipulation (name)
  (or (find-manipulation name nil)
      (reject-unknown-name "manipulation" name (mapcar #'manipulation-name (all-manipulations))
                   "MANIPULATE lists all.")))

(defun method-arguments (method data robot)
  "Return METHOD's arguments for ROBOT from DATA, the typed values; NIL if their number is wrong."
  (multiple-value-bind (objects by others) (method-signature method)
    (let* ((count (length objects))
           (extra (- (length data) count (length others))))
      (when (or (zerop extra) (and (= 1 extra) (part-variable-p by)))
        (append (loop for number in (subseq data 0 count)
                      collect (designator-numbered number robot))
                ;; The part that acts, the first if its number is left out, or the robot.
                (list (if (part-variable-p by)
                          (read-argument (type-keyword (second by))
                                         (if (= 1 extra) (nth count data) 0) robot)
                          robot))
                (nthcdr (+ count extra) data))))))

(defun start-manipulation (session manipulation data)
  (let ((robot (session-robot)) (job (make-job)))
    (apply #'run-manipulation (manipulation-name manipulation)
           (append (or (some (lambda (method) (method-arguments method data robot))
                             (manipulation-methods manipulation))
                       (reject-line "Usage: ~{MANIPULATE ~A~^ or ~}. Give numbers for objects ~
                                     and parts." (manipulation-usages manipulation)))
                   (list (lambda (code value)
                           (declare (ignore value))
                           (end-job job code)))))
    (push job (session-jobs session))))

(define-argument-choices :manipulation (mapcar #'manipulation-name (all-manipulations)))

(define-line "MANIPULATE" (session (name :manipulation "a manipulation" :optional)
                                   (args :rest "numbers of designators, then of the hand"
                                          :optional))
    (:manipulating)
    "List the manipulations, or carry out the manipulation NAME. ARGS are the numbers of the
designators that denote its objects, then the number of the hand or other part."
  (cond (name (start-manipulation session (resolve-manipulation name)
                                  (read-typed-data (or args "") (find-line-command "MANIPULATE"))))
        ((all-manipulations)
         (dolist (manipulation (all-manipulations))
           (format t "~{  ~A~%~}" (manipulation-usages manipulation))))
        (t (format t "No manipulation is defined. DEFMANIPULATION defines one.~%"))))
