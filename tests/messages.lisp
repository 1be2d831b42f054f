;;;; messages.lisp -- messages between robots: what arrives when, where and how often.

(in-package :ars-magna.tests)

(def-suite* messages :in ars-magna)

(world:defmap moor (40 20)
  (rect (0 0) (39 19) bricks 10))

(robot:defrobot heron (moor (5 5) 0))
(robot:defrobot snipe (moor (8 9) 0))
(robot:defrobot curlew (moor (25 5) 0))

(defmacro on-moor ((&rest options) &body body)
  "Run BODY with three robots, HERON, SNIPE and CURLEW, without noise."
  `(run:with-simulation ((heron snipe curlew) :clean t ,@options) ,@body))

(defun mail-of (robot) (mapcar #'first (robot:robot-messages robot)))

(defun send-and-pass (robot to message &optional (ticks 2))
  (command:robot-send robot to message)
  (run:run-ticks ticks))

(defun warnings-so-far ()
  "Take all messages of the run, and return the texts of the warnings."
  (mapcar #'base:message-text
          (remove :warning (base:take-messages) :key #'base:message-kind :test-not #'eq)))

(defun take-mail (robot) (multiple-value-list (robot:next-message robot)))

;;; What arrives, and when.

(test message.arrives-in-the-tick-after-it-was-sent
  (on-moor ()
    (command:robot-send heron snipe '(come (3 4)))
    (run:run-ticks 1)
    (is (equal '() (robot:robot-messages snipe)))
    (run:run-ticks 1)
    (is (equal '(((come (3 4)) heron 1)) (robot:robot-messages snipe)))
    (is (equal '((come (3 4)) heron 1) (take-mail snipe)))
    (is (equal '(nil) (take-mail snipe)))))

(test message.takes-the-delay-of-the-radio
  (loop for (delay quantum ticks) in '((0 1 1) (1 1 1) (7 1 7) (7 2 4))
        do (on-moor (:parameters `((base:radio-delay* ,delay) (base:tick-quantum* ,quantum)))
             (send-and-pass heron snipe :go ticks)
             (is (null (mail-of snipe)))
             (run:run-ticks 1)
             (is (equal '(:go) (mail-of snipe)) "delay ~D" delay))))

(test message.is-there-when-continuations-run
  (on-moor ()
    (let ((seen :none))
      (command:robot-send heron snipe :go)
      (run:run-ticks 1)
      (command:robot-turn curlew 1/10
                          (lambda (&rest results)
                            (declare (ignore results))
                            (setf seen (list (mail-of snipe) (run:simulation-tick)))))
      (setf base:robot-turn-delay* 1)
      (run:run-ticks 1)
      (is (equal '((:go) 2) seen)))))

(test message.of-every-kind-of-datum-arrives
  (on-moor ()
    (loop for datum in (list 7 1/3 1.5 2.5d0 'word :word nil "text" #\a '(1 (2 "b")) #(1 (a) #(2)))
          do (send-and-pass heron snipe datum)
             (is (equalp (list datum 'heron (1- (run:simulation-tick))) (take-mail snipe))))))

(test message.is-a-copy
  (on-moor ()
    (let ((datum (list 1 (list 2) (vector 3) (copy-seq "four"))))
      (command:robot-send heron :all datum)
      (setf (first (second datum)) :changed
            (svref (third datum) 0) :changed
            (char (fourth datum) 0) #\X)
      (run:run-ticks 2)
      (let ((taken (robot:next-message snipe)))
        (is (equalp '(1 (2) #(3) "four") taken))
        (setf (first (second taken)) :changed)
        (setf (first (first (first (robot:robot-messages curlew)))) :changed)
        (is (equalp '(1 (2) #(3) "four") (robot:next-message curlew)))))))

(test message.to-all-reaches-all-others
  (on-moor ()
    (send-and-pass heron :all :go)
    (is (equal '(() (:go) (:go)) (mapcar #'mail-of (list heron snipe curlew)))))
  (run:with-simulation (heron)
    (is (equal '(nil) (answer-of 'command:robot-send heron :all :go)))
    (run:run-ticks 5)
    (is (run:idle-p))))

(test message.can-be-sent-by-name
  (on-moor ()
    (dolist (name (list snipe 'snipe "snipe" :snipe "ARS-MAGNA.TESTS::SNIPE"))
      (send-and-pass heron name :go))
    (is (equal '(:go :go :go :go :go) (mail-of snipe)))
    (is (null (mail-of curlew)))))

(test messages.cross-in-one-tick
  (on-moor ()
    (command:robot-send heron snipe 1)
    (command:robot-send snipe heron 2)
    (run:run-ticks 2)
    (is (equal '((2 snipe 1)) (robot:robot-messages heron)))
    (is (equal '((1 heron 1)) (robot:robot-messages snipe)))))

(defun first-in-turn (tick)
  "Return the name of HERON or SNIPE, whoever acts first in TICK."
  (let ((salt (robot:turn-salt world:*world* tick)))
    (if (< (time::turn-of-resource heron salt) (time::turn-of-resource snipe salt))
        'heron
        'snipe)))

(test messages.of-one-tick-arrive-by-the-turns-of-their-senders
  (on-moor (:seed 3)
    (let ((firsts '()))
      (loop repeat 60
            do (command:robot-send heron curlew 'heron)
               (command:robot-send snipe curlew 'snipe)
               (run:run-ticks 2)
               (push (robot:next-message curlew) firsts)
               (is (eq (first firsts) (first-in-turn (1- (run:simulation-tick)))))
               (robot:next-message curlew))
      (is (< 15 (count 'heron firsts) 45)))))

;;; The radio, and nothing else.

(test robot-send.occupies-the-radio-alone
  (on-moor ()
    (let ((codes '()))
      (flet ((note (err robot) (declare (ignore robot)) (push err codes)))
        (command:robot-go-forward heron 3 #'note)
        (run:run-ticks 2)
        (command:robot-send heron snipe 1 #'note)
        (is (eq 'command:robot-go-forward (command:under-way heron)))
        (run:run-ticks 20)
        (is (equal '(nil nil) codes))
        (is (< 7 (robot:robot-x heron)))))))

(test robot-send.interrupts-an-older-one-in-the-same-tick
  (on-moor ()
    (let ((codes '()))
      (command:robot-send heron snipe 1 (lambda (err robot) (push (list err robot) codes)))
      (command:robot-send heron curlew 2)
      (run:run-ticks 2)
      (is (equal (list (list :interrupt heron)) codes))
      (is (equal '(() (2)) (mapcar #'mail-of (list snipe curlew)))))))

(test robot-send.warns-of-two-in-a-tick
  (on-moor ()
    (command:robot-send heron snipe 1)
    (command:robot-send heron snipe 2)
    (is (search "robot-send does nothing: robot-send was issued before a tick had passed"
                (format nil "~{~A~}" (warnings-so-far))))))

;;; Range and noise.

(test range.is-that-of-the-moment-of-sending
  (on-moor (:parameters '((base:radio-range* 5)))
    (send-and-pass heron :all 1)
    (is (equal '((1) ()) (mapcar #'mail-of (list snipe curlew))))
    (robot:place-robot curlew 8 5 0)
    (send-and-pass heron curlew 2 1)
    (robot:place-robot curlew 30 5 0)
    (run:run-ticks 1)
    (is (equal '(2) (mail-of curlew)))
    (setf base:radio-range* nil)
    (send-and-pass heron curlew 3)
    (is (equal '(2 3) (mail-of curlew)))))

(defun arrivals-among (count seed &rest parameters)
  "Return how many of COUNT messages arrive intact, and how many are garbled."
  (run:with-simulation ((heron snipe) :seed seed
                        :parameters (list* '(base:mailbox-size* 10000) parameters))
    (loop repeat count do (send-and-pass heron snipe :go 1))
    (run:run-ticks 1)
    (values (count :go (mail-of snipe)) (count :garbled (mail-of snipe)))))

(test noise.follows-its-binomial-law
  (loop for (loss garbling) in '((1/10 0) (0 1/4) (3/10 1/2))
        for seed from 11
        do (multiple-value-bind (intact garbled)
               (arrivals-among 3000 seed `(base:prob-lose-message* ,loss)
                               `(base:prob-garble-message* ,garbling))
             (let ((garbled-part (* (- 1 loss) garbling)))
               (is (within-binomial-p (+ intact garbled) 3000 (- 1 loss)))
               (is (within-binomial-p garbled 3000 garbled-part))))))

(test noise.is-absent-by-default-and-in-a-clean-simulation
  (is (equal '(500 0) (multiple-value-list (arrivals-among 500 1))))
  (run:with-simulation ((heron snipe))
    (setf base:prob-lose-message* 1)
    (base:clean-simulation)
    (send-and-pass heron snipe :go)
    (base:dirty-simulation)
    (send-and-pass heron snipe :lost)
    (is (equal '(:go) (mail-of snipe)))))

(test noise.of-one-receiver-does-not-depend-on-others
  (flet ((mail (robots)
           (run:with-simulation (robots :seed 5
                                        :parameters '((base:prob-lose-message* 1/2)
                                                      (base:prob-garble-message* 1/2)))
             (loop for n below 40 do (send-and-pass (robot:find-robot 'heron) :all n 1))
             (run:run-ticks 1)
             (mail-of (robot:find-robot 'snipe)))))
    (let ((mail (mail '(heron snipe))))
      (is (< 10 (length mail) 30))
      (is (equal mail (mail '(curlew snipe heron)))))))

(test noise.depends-on-the-seed
  (is (/= (arrivals-among 300 1 '(base:prob-lose-message* 1/2))
          (arrivals-among 300 2 '(base:prob-lose-message* 1/2)))))

;;; The mailbox.

(test mailbox.drops-the-oldest-with-a-count-and-one-warning
  (on-moor (:parameters '((base:mailbox-size* 3)))
    (loop for n from 1 to 5 do (send-and-pass heron snipe n 1))
    (run:run-ticks 1)
    (is (equal '(3 4 5) (mail-of snipe)))
    (is (= 2 (robot:robot-dropped-messages snipe)))
    (is (= 1 (count-if (lambda (text) (search "The mailbox of SNIPE is full" text))
                       (warnings-so-far))))
    (setf base:mailbox-size* 1)
    (send-and-pass heron snipe 6)
    (is (equal '(6) (mail-of snipe)))
    (is (= 5 (robot:robot-dropped-messages snipe)))))

;;; Refusals.

(defun send-refusal (to message)
  (text-of-error (lambda () (command:robot-send heron to message))))

(test robot-send.refuses-recipients-with-a-remedy
  (on-moor ()
    (flet ((is-refused (text to) (is (search text (send-refusal to 1)) "~A" (send-refusal to 1))))
      (is-refused "another robot than the sender: curlew, snipe, or :all" heron)
      (is-refused "another robot than the sender: " 'heron)
      (is-refused "There is no robot in this run called stork" 'stork)
      (is-refused "another robot of the run, its name, or :all" 7)
      (is-refused "another robot of the run, its name, or :all" nil)
      (run:with-simulation (curlew)
        (is (search "belongs to another run" (send-refusal curlew 1))))))
  (run:with-simulation (heron)
    (is (search "this run has only one" (send-refusal heron 1)))))

(test robot-send.refuses-what-is-no-plain-data
  (on-moor ()
    (let ((circle (list 1)))
      (setf (cdr circle) circle)
      (dolist (datum (list heron #'car (list 1 heron) '(1 . 2) (make-hash-table) (make-symbol "X")
                           (make-list 10001) (make-string 10001 :initial-element #\a) circle
                           (expt 10 2000) sb-ext:double-float-positive-infinity
                           (make-array 2 :element-type 'double-float)
                           (reduce (lambda (a b) (declare (ignore b)) (list a)) (make-list 60))))
        (is (search "plain data" (text-of-error
                                  (lambda ()
                                    (let ((*print-circle* t))
                                      (command:robot-send heron snipe datum)))))))
      (run:run-ticks 3)
      (is (null (mail-of snipe))))))

(test next-message.wants-a-robot
  (dolist (function '(robot:next-message robot:robot-messages robot:robot-dropped-messages))
    (is (search "a robot" (text-of-error (lambda () (funcall function :heron)))))))
