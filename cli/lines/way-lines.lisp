;;;; way-lines.lisp -- GO-TO: to a point of the map.

(in-package :ars-magna.cli)

(defun tell-rewound (point simulation)
  "Queue a message that the way to POINT, a text, is given up, as another run goes on in the place
of SIMULATION."
  (let ((*message-queue* (simulation-messages (latest simulation))))
    (warning-set (format nil "go-to: The run was rewound on the way to ~A, and the robot goes ~
                              there no more. Say it again if it is to."
                         point))))

(defun tell-failed-way (control point &rest arguments)
  (error-set (make-verdict (format nil "go-to: ~?" control (cons point arguments)))))

(defun tell-arrival (err robot point)
  "Queue a message about ROBOT, which was to go to POINT, a text: ERR is an error code, or NIL."
  (case err
    ((nil) (message-set (format nil "go-to: Robot is near ~A, as it believes" point)))
    (:no-way (tell-failed-way "There is no way to ~A for ~A" point robot))
    (:gave-up (tell-failed-way "Something was in the way to ~A too often for ~A" point robot))
    (t (tell-failed-way "Interrupted on the way to ~A" point))))

(define-line "GO-TO" (session (x metres "metres from the left") (y metres "metres from the top"))
    (:moving)
    "Let the robot find its way to X, Y, through doorways and round obstacles."
  (let ((errand (make-errand :name "GO-TO" :verdict-p t))
        (simulation (current-simulation))
        (point (format nil "~A ~A" (amount-text x) (amount-text y)))
        (account (session-account session)))
    (let ((own (asker-for account)) (*asker* (asker-for account :text "GO-TO")))
      (robot-go-to (session-robot) x y
                   (lambda (err robot)
                     (let ((*asker* own) (*told-of* own))
                       (if (eq simulation (latest simulation))
                           (tell-arrival err robot point)
                           (tell-rewound point simulation)))
                     (end-errand errand err))))
    (push errand (session-errands session))))
