;;;; thinking.lisp -- how much time thinking costs: nothing, ticks that are counted, or its own.

(in-package :ars-magna.time)

(export '(check-thinking thinking-modes-text thinking-mode-p timeline-thinking
          set-timeline-thinking give-threads thinking-charged-p thinking-budget))

;;; The manual (1.2) keeps simulated time and thinking time apart. Who wants to know what thinking
;;; is worth has to tie them together again, and so that every machine does it alike. So a run has a
;;; thinking mode: :FREE, the world waits; :CHARGED, what says what it costs takes that many ticks,
;;; and with (:CHARGED :BUDGET steps) so do the steps of plans; :REAL, plans think in a thread of
;;; their own while a clock goes on. What thinking costs decides how a run goes on. Whether it has a
;;; thread only decides what is asked of the run, and that is in the journal.

(defun thinking-charge (mode)
  "Return what thinking costs in MODE: NIL for no ticks, or a plist; and whether MODE is one."
  (cond ((member mode '(:free :real)) (values nil t))
        ((member mode '(:charged (:charged)) :test #'cl:equal) (values '(:charged t) t))
        ((and (typep mode '(cons (eql :charged) (cons (eql :budget) (cons t null))))
              (whole-p (third mode) 1))
         (values (list :charged t :budget (third mode)) t))))

(defun thinking-mode-p (mode)
  "True if MODE says how much time thinking costs."
  (nth-value 1 (thinking-charge mode)))

(defun thinking-modes-text ()
  "Return in words which thinking modes there are."
  (format nil ":FREE, :REAL, :CHARGED, or (:CHARGED :BUDGET steps) with the steps of plans in a ~
               tick, a whole number from 1 to 1e9"))

(defun check-thinking (operator mode)
  "Signal WRONG-ARGUMENT by OPERATOR unless MODE is a thinking mode."
  (unless (thinking-mode-p mode)
    (reject-argument operator 'thinking mode (thinking-modes-text))))

(defun timeline-thinking (timeline)
  "Return the thinking mode of TIMELINE."
  (let ((budget (thinking-budget timeline)))
    (cond (budget (list :charged :budget budget))
          ((thinking-charged-p timeline) :charged)
          ((timeline-real-p timeline) :real)
          (t :free))))

(defun set-timeline-thinking (timeline mode)
  "Let thinking in TIMELINE cost from now on what MODE, a thinking mode, says."
  (setf (timeline-charge timeline) (thinking-charge mode)
        (timeline-real-p timeline) (eq mode :real)))

(defun give-threads (timeline real)
  "Let plans of TIMELINE have a thread of their own if REAL is true and thinking is not charged
for."
  (setf (timeline-real-p timeline) (and real (not (timeline-charge timeline)))))

(defun thinking-charged-p (timeline)
  "True if thoughts in TIMELINE that say what they cost take ticks."
  (and (timeline-charge timeline) t))

(defun thinking-budget (timeline)
  "Return how many steps plans in TIMELINE may take in a tick, or NIL for as many as they need."
  (getf (timeline-charge timeline) :budget))
