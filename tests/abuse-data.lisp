;;;; abuse-data.lisp -- damaged journals, caches and lines of the prompt.

(in-package :ars-magna.tests)

;;; Journals. Anything but the end is damaged: a long idle run is not an error.

(defvar *abused-journal* nil "The data of a journal, once recorded.")

(defun abused-journal ()
  (or *abused-journal*
      (setf *abused-journal* (run::journal-data (recorded-ride)))))

(defun data-text (data)
  "Return DATA as they stand in a file, or as Lisp prints them if they could not."
  (if (run::unprintable-in data)
      (let ((*print-circle* t) (*print-pretty* nil)) (prin1-to-string data))
      (run::datum-text data)))

(define-abuse journal-entries (data)
    (let* ((data (abused-journal))
           (which (if (base:chance .2 dice) 0 (base:roll-index (1- (length data)) dice))))
      (append (subseq data 0 which)
              (list (form-mutant (nth which data) dice :keep (if (zerop which) 2 0)))
              (last data)))
  (with-temporary-file (file)
    (put-octets (octets-of (format nil "~{~A~%~}" (sealed-lines (mapcar #'data-text data)))) file)
    (run:replay file)))

(define-abuse journal-texts (texts)
    (let* ((texts (mapcar #'run::datum-text (abused-journal)))
           (which (base:roll-index (1- (length texts)) dice)))
      (append (subseq texts 0 which)
              (list (text-mutant (nth which texts) dice))
              (last texts)))
  (with-temporary-file (file)
    (put-octets (octets-of (format nil "~{~A~%~}" (sealed-lines texts))) file)
    (run:replay file)))

(defun octets-of (text)
  (sb-ext:string-to-octets text :external-format '(:utf-8 :replacement #\?)))

(defun put-octets (octets file)
  (alexandria:write-byte-vector-into-file (coerce octets '(vector (unsigned-byte 8))) file
                                          :if-exists :supersede))

(define-abuse journal-octets (octets)
    (let ((octets (octets-of (format nil ";;;; A journal.~%~{~A~%~}"
                                     (sealed-lines (mapcar #'run::datum-text (abused-journal)))))))
      (loop repeat (one-of dice 1 1 3) do (setf octets (octets-mutant octets dice)))
      octets)
  (with-temporary-file (file)
    (put-octets octets file)
    (run:replay file)))

;;; Caches. Those whose sums are right may hold another map; it has to be one.

(defparameter *cached-map*
  '(world:defmap abuse-cached (12 9 :cache "CACHE")
    (rect (0 0) (12 9) bricks 1 10 20 30) (wall (5 1) (5 5) slate 20) (wall (7 4) (9 4) wood 3)))

(defun cached-octets (file)
  "Return the octets of the cache of *CACHED-MAP* in FILE, which gets one."
  (uiop:delete-file-if-exists file)
  (eval (subst (namestring file) "CACHE" *cached-map* :test #'equal))
  (coerce (alexandria:read-file-into-byte-vector file) '(simple-array (unsigned-byte 8) (*))))

(defun load-cached (octets file)
  "Define *CACHED-MAP* where FILE, its cache, has become OCTETS; explore it."
  (put-octets octets file)
  (eval (subst (namestring file) "CACHE" *cached-map* :test #'equal))
  (explore (newest-map)))

(define-abuse cache-octets (seed)
    (base:roll-index 1000000000 dice)
  (with-temporary-file (file)
    (load-cached (octets-mutant (cached-octets file) (base:make-dice seed)) file)))

(defun forged-words (words dice)
  "Return WORDS of a cache, some of them replaced, with the right sum."
  (let ((copy (copy-seq words)))
    (loop repeat (one-of dice 1 1 4)
          do (setf (aref copy (+ 2 (base:roll-index (- (length copy) 2) dice)))
                   (one-of dice 0 (1- (expt 2 64)) (base:roll-index 1000000000 dice)
                           (ash #x7FF 52) (ash 1 31) (ash 1 32) (ash 255 32)
                           (+ 107 (ash 1 32)) (+ 50 (ash 1 32)))))
    (setf (aref copy (1- world::+cache-header-size+)) (world::words-checksum copy))
    copy))

(define-abuse cache-words (seed)
    (base:roll-index 1000000000 dice)
  (with-temporary-file (file)
    (cached-octets file)
    (let ((words (forged-words (world::read-words file 1000000) (base:make-dice seed))))
      (world::write-words words file)
      (eval (subst (namestring file) "CACHE" *cached-map* :test #'equal))
      (explore (newest-map)))))

;;; Lines.

(defparameter *good-lines*
  '("obj-desig 0 local ((:size 5))" "cam-track 0 0" "cam-insert-desig 0" "hand-grasp 0 0" "turn 0.5"
    "go-forward 5" "obj-desig 1 non-local ((:color lightred))" "status" "map 8" "things" "pos 10 10"
    "angle 1.5" "rate 20" "seed 5" "params motion-noise* 0.3" "params" "plan patrol ((3 4)) :x"
    "plan" "plans" "stop-plan 1" "help turn" "repeat 2 turn 0.1" "alias tl turn 0.3" "tl"
    "cameras" "hands" "bins" "world hall" "robot butler" "robot" "step 3" "pause" "resume"
    "place-desig 0 convex" "storage-bin-open 0" "hand-insert-desig 0 0" "display" "world"
    "camera-turn 0 1" "set-speed 2" "about-face" "grasp-check 0" "view 1" "replay nowhere"
    "(robot-turn butler 1 nil)" "eval (+ 1 2)" "; a comment" "menu-hand" "" "goto-desig 1"
    "all-objs 0 non-local ((:size 1 2) (:weight 0 3))" "follow-wall" "manipulate open 0 0"))

(defun lisp-line-p (line)
  (let ((start (find #\Space line :test-not #'char=)))
    (or (eql start #\()
        (search "eval" line :test #'char-equal)
        (search "repeat" line :test #'char-equal)
        (search "alias" line :test #'char-equal))))

(defun typed-lines (lines)
  "Type LINES in a session of their own. Return what it writes, and the number of errors."
  (type-lines lines :batch t))

(define-abuse lines (lines)
    (loop repeat 3
          collect (remove #\Newline (text-mutant (base:roll-element *good-lines* dice) dice)))
  (multiple-value-bind (written errors) (typed-lines lines)
    (let ((lisp (some #'lisp-line-p lines)))
      (when lisp (setf *sprung* 0))
      (let ((worst (find-if (lambda (line)
                              (and (search "*ERROR*" line)
                                   (some (lambda (words) (search words line)) *words-of-lisp*)))
                            written)))
        (when (and worst (not lisp)) (base:reject-use "~A" worst)))
      (when (plusp errors) (base:reject-use "~D errors" errors)))))
