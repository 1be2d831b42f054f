;;;; agents.lisp -- the published agents of Tileworld, which know all open holes.

(in-package :ars-testbeds)
(in-readtable :nisp)

;;; The published agents. They plan again when they have arrived; after BOLDNESS steps, if not NIL;
;;; or because of a REACTION: :TARGET, the hole has gone; :NEARER, that, or a nearer hole opened;
;;; :ANY, that, or any hole opened.

(defun worth (hole) (/ (hole-score hole) (max 1 (steps-to hole))))

(defun best-hole (&optional (value #'worth))
  "Return the open hole with the highest VALUE, of equals the newest; NIL if none is open."
  (let ((best nil) (most nil))
    (dolist (hole *holes* best)
      (let ((worth (funcall value hole)))
        (when (or (null best) (> worth most)) (setf best hole most worth))))))

(defun newest () (let ((hole (first *holes*))) (if hole (thing-serial hole) 0)))

(defun react-p (reaction target seen)
  "True if an agent with REACTION gives up going to TARGET. SEEN is the last hole that it knew of."
  (flet ((new-p (hole) (< seen (thing-serial hole))))
    (and reaction
         (or (not (thing-alive-p target))
             (case reaction
               (:nearer (some (lambda (hole)
                                (and (new-p hole) (< (steps-to hole) (steps-to target))))
                              *holes*))
               (:any (some #'new-p *holes*)))))))

(defun go-committed (target left reaction seen then)
  "Go to TARGET, for LEFT steps if that is a number, or until REACTION; then call THEN."
  (if (or (eql 0 left) (zerop (steps-to target)) (react-p reaction target seen))
      (funcall then)
      (let ((seen (max seen (newest))))
        (step-towards target (lambda ()
                               (go-committed target (and left (1- left)) reaction seen then))))))

(defun decide (boldness reaction &optional (value #'worth))
  "Choose a hole by VALUE, plan, go there, and so on."
  (flet ((again () (decide boldness reaction value)))
    (let ((target (best-hole value)) (seen (newest)))
      (if target
          (plan-move (lambda () (go-committed target boldness reaction seen #'again)))
          (spend-steps 1 #'again)))))

(defun cautious () (decide 1 nil))
(defun cautious-target () (decide 1 :target))
(defun cautious-nearer () (decide 1 :nearer))
(defun cautious-any () (decide 1 :any))
(defun normal () (decide 4 nil))
(defun normal-target () (decide 4 :target))
(defun normal-nearer () (decide 4 :nearer))
(defun normal-any () (decide 4 :any))
(defun bold () (decide nil nil))
(defun bold-target () (decide nil :target))
(defun bold-nearer () (decide nil :nearer))
(defun bold-any () (decide nil :any))

(defun random-walk ()
  "Step in a random direction, again and again."
  (let ((dice (make-dice (world-seed *world*) (format nil "walk at ~D" (simulation-tick))))
        (x (robot-x tiler)) (y (robot-y tiler)))
    (take-a-step (loop for (direction dx dy) = (roll-element '((:north 0 -1) (:south 0 1)
                                                               (:east 1 0) (:west -1 0))
                                                             dice)
                       when (and (< 1 (+ x dx) 16) (< 1 (+ y dy) 16)) return direction)
                 #'random-walk)))

(defun naive () (decide nil nil (lambda (hole) (- (steps-to hole)))))

(defun adaptive (&optional target)
  "Plan again when the best hole, after planning, is worth more than what is left of the way."
  (let ((best (best-hole (lambda (hole) (/ (hole-score hole)
                                           (+ planning-time* (max 1 (steps-to hole))))))))
    (cond ((and target (thing-alive-p target)
                (>= (worth target)
                    (/ (hole-score best) (+ planning-time* (max 1 (steps-to best))))))
           (step-towards target (lambda () (adaptive target))))
          (best (plan-move (lambda () (adaptive-go best))))
          (t (spend-steps 1 #'adaptive)))))

(defun adaptive-go (target)
  (if (thing-alive-p target)
      (step-towards target (lambda () (adaptive target)))
      (adaptive)))
