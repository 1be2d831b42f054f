;;;; plots-text.lisp -- no text of a chart is cut, overlaps another, or is too small.

(in-package :ars-magna.tests)

(in-suite plots)

;;; Measured by the canvas's upper bounds for the width of text.

(defun text-box (element)
  "Return the box left, top, right, bottom, in which the text ELEMENT is."
  (let* ((x (chart-number "x" element)) (y (chart-number "y" element))
         (size (chart-number "font-size" element))
         (width (canvas:text-width (chart-words element) size
                                   (chart-attribute "font-weight" element)))
         (anchor (chart-attribute "text-anchor" element))
         (start (- x (cond ((string= "start" anchor) 0) ((string= "middle" anchor) (/ width 2))
                           (t width)))))
    (if (chart-attribute "transform" element)
        (list (- x (* 3/4 size)) (- y (- start x)  width) (+ x (* 1/5 size)) (+ y (- x start)))
        (list start (- y (* 3/4 size)) (+ start width) (+ y (* 1/5 size))))))

(defun boxes-overlap-p (one other)
  (destructuring-bind (left top right bottom) one
    (destructuring-bind (left-2 top-2 right-2 bottom-2) other
      (and (< left right-2) (< left-2 right) (< top bottom-2) (< top-2 bottom)))))

(defun trouble-in (chart)
  "Return what is wrong with the texts of CHART, a list."
  (let* ((page (first (chart-elements "svg" chart)))
         (width (chart-number "width" page)) (height (chart-number "height" page))
         (texts (chart-elements "text" chart)))
    (loop for (text . others) on texts
          for (box . other-boxes) on (mapcar #'text-box texts)
          unless (and (<= 0 (first box)) (<= 0 (second box)) (<= (third box) width)
                      (<= (fourth box) height))
            collect (list :cut (chart-words text))
          unless (<= 11 (chart-number "font-size" text))
            collect (list :small (chart-words text))
          append (loop for other in others
                       for other-box in other-boxes
                       when (boxes-overlap-p box other-box)
                         collect (list :overlap (chart-words text) (chart-words other))))))

(defparameter *long*
  "a name of many words, such as nobody should give to anything but somebody will give <&\">"
  "A long name of words.")

(defparameter *unbroken* (make-string 120 :initial-element #\W)
  "A long name without a place to break it.")

(defun series-of (count points &optional (name "series"))
  (loop for index below count
        collect (cons (format nil "~A ~D" name index)
                      (loop for x below points
                            collect (list x (+ index x) (+ index (* 1/2 x)) (+ index x x 1))))))

(defun words-of (count word)
  (list (cons nil (loop for index below count
                        collect (list (format nil "~A ~D" word index) index 0 40)))))

(defun wordy-options (words)
  (list :title words :subtitle words :x-label words))

(defun line-charts ()
  "Return charts of points that are hard to write on."
  (append
   (loop for count in '(0 1 2 12 40)
         append (loop for points in '(0 1 7 40)
                      collect (plots:line-chart (series-of count points))))
   (loop for words in (list *long* *unbroken* "" nil "Ωμέγα 試驗")
         collect (apply #'plots:line-chart (series-of 3 7 words) :y-label words
                        (wordy-options words))
         collect (apply #'plots:line-chart (series-of 30 7 words) :y-label words :width 300
                        :height 200 (wordy-options words)))
   (loop for count in '(1 3 8 40)
         append (loop for word in (list "w" "some word" *long* *unbroken*)
                      collect (plots:line-chart (words-of count word) :x-label "x")))
   (loop for size in '(1d-320 1d-300 1d-7 1 12345678 1d15 1d300)
         collect (plots:line-chart `(("a" (,size ,(- size)) (,(* 2 size) ,size) (,(* 7 size) 0))))
         collect (plots:line-chart `(("a" (,(+ 1 size) ,(+ 1000 size)) (1 1000)))))
   (loop for most in '(1.1 2 20 1000 1d12 1d300)
         collect (plots:line-chart `(("a" (1 1) (,most 2))) :log-x t))))

(defun other-charts ()
  "Return charts of other kinds that are hard to write on."
  (append
   (loop for words in (list "a" *long* *unbroken* nil)
         for times = (loop for n from 1 to 3000 collect (* 37 n))
         collect (apply #'plots:survival-chart
                        (loop repeat 5 collect `(,words :steps ((500 .5 .4 .6) (90000 .1 0 .2))
                                                        :censored (70000) :times ,times))
                        :y-label words (wordy-options words))
         collect (apply #'plots:difference-chart
                        `((,words .1 -.1 .2 ,words) (,words -1d-9 -1d9 1d9 ,words)
                          (,words nil nil nil ,words))
                        (wordy-options words))
         collect (apply #'plots:measure-chart
                        `((,words ,times 100 50 123456) (,words ()) (,words (5) 5))
                        (wordy-options words))
         collect (apply #'plots:measure-chart `((,words (1 10 100))) :log-x t :width 300
                        (wordy-options words)))
   (list (plots:survival-chart '((nil :steps ((1 0)))))
         (plots:survival-chart '((nil :times (0 0 0))))
         (plots:difference-chart '(("a" 0 0 0))))))

(test text.of-a-chart-neither-overlaps-nor-is-cut
  (let ((charts (append (line-charts) (other-charts))))
    (is (< 60 (length charts)))
    (loop for chart in charts
          for number from 0
          do (is (null (trouble-in chart)) "Chart ~D: ~S" number (first (trouble-in chart))))))

(test text.that-overlaps-or-is-cut-would-be-found
  (flet ((page (&rest texts)
           (with-output-to-string (stream)
             (canvas:with-svg (canvas stream)
               (canvas:with-canvas (canvas)
                 (loop for (x y text size) in texts
                       do (canvas:draw-words canvas canvas:draw-gcontext* x y text :size size)))
               (values 100 50)))))
    (is (null (trouble-in (page '(10 20 "one" 12) '(10 35 "two" 12)))))
    (is (equal '((:overlap "one" "two")) (trouble-in (page '(10 20 "one" 12) '(20 20 "two" 12)))))
    (is (equal '((:cut "one")) (trouble-in (page '(90 20 "one" 12)))))
    (is (equal '((:small "one")) (trouble-in (page '(10 20 "one" 9)))))))

(test text.is-written-whole
  (let ((texts (chart-texts (plots:line-chart (words-of 3 *long*) :title *unbroken*))))
    (is (string= *unbroken* (apply #'concatenate 'string
                                   (remove-if-not (lambda (text) (string= "" (remove #\W text)))
                                                  texts))))
    (is (search (remove #\Space *long*)
                (remove #\Space (apply #'concatenate 'string texts))))))

;;; The canvas below.

(test canvas.text-has-size-anchor-and-direction
  (flet ((text (&rest options)
           (first (drawing (canvas)
                    (apply #'canvas:draw-words canvas canvas:draw-gcontext* 10 20 "a<b" options)))))
    (is (string= (format nil "<text x=\"10\" y=\"20\" font-size=\"12\" text-anchor=\"start\" ~
                              fill=\"#000000\">a&lt;b</text>")
                 (text)))
    (is (search "font-size=\"15\" text-anchor=\"end\" font-weight=\"bold\""
                (text :size 15 :anchor :end :bold-p t)))
    (is (search "transform=\"rotate(-90,10,20)\"" (text :upward-p t))))
  (signals base:wrong-argument
    (drawing (canvas) (canvas:draw-words canvas canvas:draw-gcontext* 0 0 "a" :anchor :left))))

(defclass plain-canvas (canvas:canvas) ((strings :initform '() :accessor canvas-strings))
  (:documentation "A canvas that has one font, and hides what is below."))

(defmethod canvas:paint-string ((canvas plain-canvas) gcontext x y string)
  (declare (ignore gcontext))
  (push (list x y string) (canvas-strings canvas)))

(test canvas.with-one-font-writes-in-that
  (let ((canvas (make-instance 'plain-canvas)))
    (canvas:with-canvas (canvas)
      (canvas:with-opacity (canvas 1/2)
        (loop for anchor in '(:start :middle :end)
              do (canvas:draw-words canvas canvas:draw-gcontext* 100 20 "four"
                                    :anchor anchor :size 20 :upward-p t))))
    (is (equal '((100 20 "four") (86 20 "four") (72 20 "four"))
               (reverse (canvas-strings canvas))))))

(test canvas.dashes-are-as-long-as-the-context-says
  (flet ((line (&rest options)
           (first (drawing (canvas)
                    (canvas:with-gcontext (canvas:draw-gcontext* :line-style :dash
                                                                 :dashes (first options))
                      (canvas:draw-line canvas canvas:draw-gcontext* 0 0 9 0))))))
    (is (search "stroke-dasharray=\"4\"" (line)))
    (is (search "stroke-dasharray=\"9,3,2,3\"" (line '(9 3 2 3))))
    (is (search "stroke-dasharray=\"7\"" (line 7)))
    (dolist (dashes '(0 (3 0) (:long) 1.5))
      (signals base:wrong-argument (line dashes)))))

(test canvas.opacity-is-for-what-is-drawn-within
  (is (equal '("<g opacity=\"0.16\">" "</g>")
             (remove-if (lambda (line) (search "<rect" line))
                        (drawing (canvas)
                          (canvas:with-opacity (canvas 16/100)
                            (canvas:draw-rectangle canvas canvas:draw-gcontext* 0 0 1 1 t)))))))

(test words.of-vertical-lines-stand-evenly-about-their-place
  (loop for lines in '(("a") ("a" "b") ("a" "b" "c"))
        do (let ((places (loop for text in (drawing (canvas)
                                             (plots::draw-vertical-text-lines canvas 50 90 lines))
                               collect (chart-number "x" text))))
             (is (= (length lines) (length places)))
             (is (= (* 54 (length lines)) (reduce #'+ places)))
             (is (apply #'<= places)))))
