;;;; saving.lisp -- the timeline of plans, and the tree of their tasks, as files.

(in-package :ars-magna.rpl-pictures)

(defun trace-bars (runner)
  "Return the bars of the trace of RUNNER. Signals MISUSE if there is none."
  (let ((trace (plan-trace runner)))
    (cond ((null trace)
           (reject-use "No trace was kept of these plans. Set *trace-plans* to true before ~
                        they start, or at the prompt type TRACE-PLANS ON."))
          ((bars trace (plan-runner-tick runner)))
          (t (reject-use "No plan has run here.")))))

(defun plan-package (bars)
  "Return the package in which the first plan of BARS was written, as far as that is known."
  (let ((name (some #'bar-name bars)))
    (or (and (symbolp name) (symbol-package name))
        *package*)))

(defun timeline-svg (bars most in-color title scale)
  (let ((*package* (plan-package bars)))
    (with-output-to-string (stream)
      (with-svg (canvas stream :color-p in-color :zoom scale)
        (with-canvas (canvas)
          (draw-timeline canvas bars most title))))))

(addition save-plan-timeline)
(define-with-keywords save-plan-timeline
    (file &key runner (most 1000) (in-color t) title (scale 1))
  "Save a picture of the plans that have run in FILE, replacing it: SVG or, where the program
rsvg-convert is installed, PNG, as its name ends. Each task is a bar over ticks, below the one that
it is part of, with what it waited for, the commands that it issued while these were under way, and
how it ended; turns of a loop share a row. RUNNER is the plan runner, by default the one in use,
which must have kept a trace: see *TRACE-PLANS*. At most MOST rows are drawn. IN-COLOR is false for
a picture in black and white. TITLE, a string, stands above instead of the ticks. SCALE, from 1 to
10, is how many times as large as usual the whole is, text and all. On a page of a paper, 174 mm
wide, pictures are readable that are 820 pixels wide or less; that much 70 ticks are, about. Return
the file's truename. Signals WRONG-ARGUMENT and MISUSE."
  (check-argument save-plan-timeline title (typep title '(or null string)) "a string or NIL")
  (check-argument save-plan-timeline scale (and (finite-p scale) (<= 1 scale 10))
                  "a number from 1 to 10, how many times as large as usual the picture is")
  (check-argument save-plan-timeline most (whole-p most 1 1000000) "an integer from 1 to 1000000")
  (let ((kind (picture-kind 'save-plan-timeline file))
        (bars (call-with-plans-in-use
               (lambda (in-use) (trace-bars (or runner in-use (runner-to-see)))))))
    (save-svg (timeline-svg bars most in-color title scale) file kind)))

(defun tree-svg (image)
  (with-output-to-string (stream)
    (with-svg (canvas stream)
      (with-canvas (canvas) (values 640 (draw-task-tree canvas image))))))

(addition save-plan-tree)
(define-with-keywords save-plan-tree
    (file &key runner (most 300))
  "Save a picture of the tasks of the plans under way in FILE, replacing it: SVG or, where the
program rsvg-convert is installed, PNG, as its name ends. Each task stands below the one that it is
part of, with a mark for how it is, what it is at, and what it waits for. RUNNER is the plan runner,
by default the one in use. At most MOST tasks are drawn, the others counted. Return the file's
truename. Signals WRONG-ARGUMENT, and MISUSE where no plans have run."
  (check-argument save-plan-tree most (whole-p most 1 1000000) "an integer from 1 to 1000000")
  (let ((kind (picture-kind 'save-plan-tree file))
        (image (call-with-plans-in-use
                (lambda (in-use)
                  (image-of-tasks (or runner in-use (runner-to-see)) :most most)))))
    (save-svg (tree-svg image) file kind)))
