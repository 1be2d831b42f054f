;;;; films.lisp -- runs as pages for a browser, and as pictures with what happened where.

(in-package :ars-magna.tests)
(in-suite display)

(defun split-by (mark text)
  "Return the parts of TEXT that stand apart by MARK."
  (loop with start = 0
        for end = (search mark text :start2 start)
        collect (subseq text start end)
        while end
        do (setf start (+ end (length mark)))))

(defun between (start end text)
  "Return what stands in TEXT between START and the next END."
  (let ((from (+ (search start text) (length start))))
    (subseq text from (search end text :start2 from))))

(defun film-of (robot act &rest options)
  "Return the text of a film of the run of ROBOT in which ACT is called with it."
  (funcall act robot)
  (with-scratch-file (file "html")
    (apply #'display:save-animation nil file options)
    (uiop:read-file-string file)))

;;; What the script in a film makes of its data.

(defun unquoted (text)
  "Return what TEXT, in a string of JavaScript's as films have it, stands for."
  (with-output-to-string (out)
    (loop with place = 0
          while (< place (length text))
          do (destructuring-bind (char length)
                 (cond ((char/= #\\ (char text place)) (list (char text place) 1))
                       ((char= #\u (char text (1+ place)))
                        (list (code-char (parse-integer text :start (+ place 2) :end (+ place 6)
                                                             :radix 16))
                              6))
                       (t (list (if (char= #\n (char text (1+ place)))
                                    #\Newline
                                    (char text (1+ place)))
                                2)))
               (write-char char out)
               (incf place length)))))

(defun numbers-in (text)
  (mapcar #'parse-integer (remove "" (split-by "," text) :test #'string=)))

(defun with-changes (frame changes)
  "Return a copy of FRAME with CHANGES: place, number, place, number ...."
  (let ((frame (copy-seq frame)))
    (loop for (place number) on changes by #'cddr do (setf (aref frame place) number))
    frame))

(defun frames-shown (film)
  "Return the frames of FILM, each as the text that a browser draws."
  (let ((lines (map 'vector #'unquoted
                    (split-by "\",\"" (between "\"lines\":[\"" (format nil "\"],~%") film))))
        (frame #()))
    (loop for part in (rest (split-by "{" (between "\"frames\":[" (format nil "],~%") film)))
          for numbers = (numbers-in (between "[" "]" part))
          do (setf frame (if (search "\"all\"" part)
                             (coerce numbers 'vector)
                             (with-changes frame numbers)))
          collect (format nil "~{~A~}" (map 'list (lambda (number) (aref lines number)) frame)))))

(test film.shows-in-each-frame-what-a-picture-would
  (in-studio (robot)
    (let* ((texts '())
           (look (lambda (simulation)
                   (when (zerop (mod (run:simulation-tick simulation) 5))
                     (push (display::movers-text
                            (display:take-snapshot (run:simulation-world simulation))
                            '(:wedges) t 12)
                           texts)))))
      (run:add-observer look (time:current-simulation))
      (let ((film (film-of robot #'journal-of-a-drive :every 5 :layers '(:wedges) :scale 12)))
        (is (mentions-p film "\"ticks\":[5,10,15,20]"))
        (is (equal (reverse texts) (frames-shown film)))
        (is (mentions-p film (first (last texts))))))))

;;; Moments.

(defun ungrasp-nothing (robot)
  (command:hand-ungrasp (robot:robot-hand robot 0))
  (run:run-ticks 20))

(test film.marks-moments
  (in-studio (robot)
    (let ((film (film-of robot #'ungrasp-nothing
                         :every 4 :moments '((9 "</script><b>odd \"words\" & more") (3 "early")))))
      (is (not (mentions-p film "</script><b>"))
          "Words of a user's do not end the script.")
      (is (mentions-p film "\\u003C/script>\\u003Cb>odd \\\"words\\\" & more"))
      (is (mentions-p film "&lt;/script&gt;&lt;b&gt;odd"))
      ;; The frames are of ticks 4, 8, 12 ....
      (is (equal '("0" "0" "2")
                 (mapcar (lambda (part) (subseq part 0 1)) (rest (split-by "\"frame\":" film)))))
      (is (= 3 (length (rest (split-by "<li>" film))))))))

(test moments.are-what-came-of-commands
  (in-studio (robot)
    (ungrasp-nothing robot)
    (let ((moments (display:journal-moments nil)))
      (is (= 1 (length moments)))
      (is (eq :failure (display:moment-kind (first moments))))
      (is (mentions-p (display:moment-text (first moments)) "hand-ungrasp: Hand 0 is not"))
      (is (= (robot:robot-x robot) (display:moment-x (first moments)))))))

(test moments.tell-of-what-is-fetched
  (run:with-simulation (ars-worlds:dot :seed 1 :journal t)
    (ars-worlds:run-errand ars-worlds:dot '((:color red)) #'list)
    (run:run-ticks 500)
    (let ((kinds (mapcar #'display:moment-kind (display:journal-moments nil))))
      (is (member :stow (member :grasp kinds)))
      (is (not (member :plan kinds))))))

(test films.refuse-what-they-cannot-show
  (in-studio (robot)
    (let ((journal (journal-of-a-drive robot)))
      (dolist (moments '(7 (7) ((:x "word")) ((1 2)) ((1 "a") . 2)))
        (signals base:wrong-argument
          (display:save-animation journal "run.html" :moments moments)))
      (signals base:wrong-argument (display:save-animation journal "no-such-place/run.html"))
      (loop for (file series words) in '(("run.gif" nil ".html or .svg")
                                         ("run" nil ".html or .svg")
                                         ("run.gif" t ".svg or .png"))
            do (is-true (search words
                                (handler-case (display:save-animation journal file :series series)
                                  (base:wrong-argument (condition) (text-of condition))))))
      (signals base:wrong-argument (display:save-animation journal "run.html" :series t))
      (signals base:wrong-argument (ars:save-run-picture "run.gif" :journal journal))
      (signals base:wrong-argument (ars:save-run-picture "run.svg" :journal journal :title 7)))
    (signals base:misuse
      (run:with-simulation (ars-worlds:dot :journal nil) (ars:save-run-picture "run.svg")))))

(test run-picture.numbers-moments-where-they-were
  (in-studio (robot)
    (journal-of-a-drive robot)
    (with-scratch-file (file "svg")
      (ars:save-run-picture file :title "A drive & more"
                                 :moments (list (display:make-moment 3 :note "here" 2 2)
                                                (display:make-moment 4 :note "there" 2.1 2)
                                                (display:make-moment 9 :note "far" 6 6)))
      (let ((text (uiop:read-file-string file)))
        (dolist (part '("A drive &amp; more" ">1-2</text>" ">3</text>" "tick 4: there"))
          (is (mentions-p text part)))))))
