;;;; base-doors.lisp -- the interface to SBCL and the operating system.

(in-package :ars-magna.tests)

(in-suite base)

(test floats.have-bits-and-back
  (is (= #x3FF0000000000000 (base:double-to-bits 1d0)))
  (is (= (ash 1 63) (base:double-to-bits -0d0)))
  (dolist (number (list 0d0 -0d0 1.37d0 -2.5d-300 pi least-positive-double-float
                        most-negative-double-float))
    (is (eql number (base:bits-to-double (base:double-to-bits number))))))

(test paths.know-the-home-directory
  (let ((home (user-homedir-pathname)))
    (is (equal home (base:path-of-name "~")))
    (is (equal (merge-pathnames "x.svg" home) (base:path-of-name "~/x.svg")))
    (is (equal (merge-pathnames "results/" home) (base:path-of-name "~/results" :directory t)))
    (is (string= "a~b" (base:native-name (base:path-of-name "a~b"))))))

(test files.that-cannot-be-written-are-told-of-in-a-sentence
  (handler-case (base:overwrite-file (lambda (out) (write-string "x" out))
                                     (base:native-path "/no/such/directory/x") "the picture")
    (base:misuse (condition)
      (is (string= (format nil "The picture cannot be written to /no/such/directory/x: there is ~
                                no such directory. An existing file is unchanged; give the name of ~
                                a file that you may write.")
                   (princ-to-string condition))))
    (:no-error (path) (is (null path)))))

(test files.whose-names-stand-for-many-are-refused-for-that
  "Also those that Lisp cannot take for a pathname."
  (dolist (name '("a*b" "no/such/x?" "a[b" "a?[b"))
    (handler-case (base:overwrite-file (lambda (out) (write-string "x" out)) name "the picture")
      (base:misuse (condition)
        (is (search (format nil "written to ~A: its name has wildcards; in a Lisp string" name)
                    (princ-to-string condition))))
      (:no-error (path) (is (null path))))))

(test files.that-the-system-refuses-are-told-of-without-its-own-names
  "A file that is made for a while, and a stream, are nothing that a user knows."
  (flet ((reason (function)
           (handler-case (progn (funcall function) nil)
             (error (trouble) (base:write-failure-text trouble)))))
    (is (string= "no file can be made in that directory"
                 (reason (lambda () (open "/proc/self/x-tmp" :direction :output)))))
    (flet ((fill-device ()
             (with-open-file (out "/dev/full" :direction :output :if-exists :append)
               (write-string "x" out))))
      (is (string= "no space left on device" (reason #'fill-device)))
      (handler-case (fill-device)
        (error (trouble)
          (is (string= "The file /dev/full cannot be written: no space left on device."
                       (base:text-of-condition trouble))))))))

(test files.that-the-system-does-not-let-be-read-are-told-of-without-streams
  (handler-case (with-open-file (in "/proc/self/mem") (read-line in))
    (error (trouble)
      (is (search "/mem cannot be read: input/output error." (base:text-of-condition trouble))))))

(test coordinates.that-are-not-0-are-not-written-as-0
  (loop for (number text) in '((0 "0.0") (-0d0 "-0.0") (-1d-5 "-1.0e-5") (1/100000 "1.0e-5")
                               (4.9d-5 "4.9e-5") (5d-5 "0.0001") (1d-4 "0.0001") (23.2 "23.2")
                               (-3 "-3.0"))
        do (is (string= text (basics::coordinate-text number)))))

(test errors.show-control-characters
  "What a terminal would obey, of a file or typed. Tabs and line ends stay."
  (let ((text (coerce '(#\Esc #\[ #\m #\Rubout #\Tab #\Newline #\Return #\a) 'string))
        (shown (format nil "^[[m?~C~%^Ma" #\Tab)))
    (is (search shown (princ-to-string (make-condition 'base:misuse :text text))))
    (is (search shown (base:text-of-condition (make-condition 'simple-error
                                                              :format-control text))))
    (is (string= "X" (base:text-of-condition (make-condition 'simple-error
                                                             :format-control "X"))))))

(defun exit-in-thread ()
  "Return what is said, a string, when another thread would end this Lisp."
  (let ((said nil))
    (base:join-thread (base:start-thread
                       (lambda ()
                         (handler-case (uiop:quit 5)
                           (base:misuse (condition) (setf said (princ-to-string condition)))))
                       "exiting"))
    said))

(test exits.are-refused-in-all-threads
  (unwind-protect (progn (base:refuse-exits "EXIT? ~A. QUIT.")
                         (is (equal "EXIT? ~A. QUIT." (exit-in-thread)))
                         (is (equal "other" (handler-case
                                                (base:call-refusing-exits #'sb-ext:exit "other")
                                              (base:misuse (condition)
                                                (princ-to-string condition))))))
    (base:refuse-exits nil)))

(defvar *bound* :at-top "For GLOBALS.ARE-BENEATH-BINDINGS.")

(test globals.are-beneath-bindings
  (let ((*bound* :here))
    (is (eq :at-top (base:global-value '*bound*)))
    (setf (base:global-value '*bound*) :changed)
    (is (eq :here *bound*)))
  (is (eq :changed *bound*))
  (setf *bound* :at-top))

(defstruct shared
  (count 0 :type base:atomic-count)
  (list '() :type list))

(test atomic.swaps-only-what-is-there
  (let ((shared (make-shared :list '(1))) (list (list 2)))
    (is (equal '(0 1) (base:atomic-push 0 (shared-list shared))))
    (is-false (base:swap-if-eq (shared-list shared) nil list))
    (is-true (base:swap-if-eq (shared-list shared) (shared-list shared) list))
    (is (eq list (base:compare-and-swap (shared-list shared) list '())))
    (is (null (shared-list shared)))))

(test atomic.loses-no-count-between-threads
  (let ((shared (make-shared)))
    (mapc #'base:join-thread
          (loop repeat 4
                collect (base:start-thread (lambda ()
                                             (loop repeat 1000
                                                   do (base:atomic-incf (shared-count shared))
                                                      (base:atomic-push 1 (shared-list shared)))
                                             (base:atomic-decf (shared-count shared) 10))
                                           "counting")))
    (is (= 3960 (shared-count shared)))
    (is (= 4000 (length (shared-list shared))))))

(test files.take-the-place-of-others
  (uiop:with-temporary-file (:pathname old)
    (let ((new (base:native-path (format nil "~A [new]*" (base:native-name old)))))
      (with-open-file (out new :direction :output) (write-string "new" out))
      (is-true (base:regular-file-p new))
      (base:replace-file old new)
      (is (string= "new" (base:read-file-into-string old)))
      (is (null (base:existing-path new)))
      (signals error (base:replace-file old new))
      (signals error (base:regular-file-p new))))
  (is-false (base:regular-file-p (uiop:temporary-directory))))

(test commands.run-and-answer
  (is (equal '(0 "two words") (multiple-value-list
                               (with-input-from-string (in "two words")
                                 (base:run-command "cat" '() :input in :output :string)))))
  (is (= 1 (base:run-command "false" '())))
  (is (null (base:run-command "no-such-program" '("-x"))))
  (is (null (base:environment-value "ARS_MAGNA_NO_SUCH_VARIABLE"))))

(test forms.are-seen-through-commas
  (is (equal '(f x) (base:form-behind-comma (first (last (second '`(a ,(f x))))))))
  (is (null (base:form-behind-comma '(f x)))))

(test forms.are-evaluated-either-way
  (is (compiled-function-p (base:evaluate-form '(lambda () 1) :compile t)))
  (is (not (compiled-function-p (base:evaluate-form '(lambda () 1))))))

(test files.without-use-are-refused-in-words
  (loop for (name . words) in '(("" . "no name") ("/no/such/file" . "no such file")
                                ("/tmp/" . "a directory") ("/tmp/a*.jrn" . "wildcards"))
        do (is (search words (base:unusable-file-text name)))
           (signals run:damaged-journal (run:read-journal name))))

(test files.with-illegible-names-are-not-written
  (signals error
    (base:call-replacing-file
     #'princ (base:native-path (format nil "/tmp/a~C" (code-char #xFFFD))))))

(defun write-word (file)
  (base:overwrite-file (lambda (out) (write-string "word" out)) file "the word"))

(test files.with-write-protection-are-not-replaced
  "Also by the superuser, who may write any."
  (call-in-directory
   (lambda (directory)
     (let ((file (merge-pathnames "word.txt" directory)))
       (write-word file)
       (sb-posix:chmod file #o444)
       (handler-case (write-word file)
         (base:misuse (trouble)
           (is (search "it is write-protected. An existing file is unchanged; give the name"
                       (princ-to-string trouble))))
         (:no-error (path) (is (null path))))
       (sb-posix:chmod file #o644)
       (is-true (write-word file))))))

(test files.keep-their-permissions-when-written-anew
  (call-in-directory
   (lambda (directory)
     (let ((file (merge-pathnames "word.txt" directory)))
       (flet ((mode () (logand #o777 (sb-posix:stat-mode (sb-posix:stat file)))))
         (write-word file)
         (dolist (mode '(#o600 #o664 #o640))
           (sb-posix:chmod file mode)
           (write-word file)
           (is (= mode (mode)))))))))

(test files.that-were-never-finished-are-removed-at-the-next-save
  "But not those of processes that still run, nor of other machines, nor others."
  (call-in-directory
   (lambda (directory)
     (let* ((host (machine-instance)) (dead 999999999)
            (mine (format nil "ars-magna-~A-~D-TMP1" host (base:process-id)))
            (others (list mine (format nil "ars-magna-~A-" host)
                          (format nil "ars-magna-x~A-~D-TMP1" host dead) "ars-magna-1")))
       (dolist (name (cons (format nil "ars-magna-~A-~D-TMPX" host dead) others))
         (write-octets #(1) (merge-pathnames name directory)))
       (write-word (merge-pathnames "word.txt" directory))
       (is (equal (sort (cons "word.txt" others) #'string<)
                  (sort (mapcar #'file-namestring (uiop:directory-files directory))
                        #'string<)))))))

(test arguments.of-readers-are-checked
  (flet ((refused-p (name &rest arguments)
           (typep (nth-value 1 (ignore-errors (apply name arguments))) 'base:wrong-argument)))
    (is (refused-p 'world:things-at 5 1 1))
    (is (refused-p 'robot:find-designator 0.5 0))
    (is (refused-p 'run:run-until 't :simulation nil))
    (is (refused-p 'base:undefine 'kicker '(1 2)))))

(test directories.are-new-to-one-only
  "Though others remove them meanwhile."
  (uiop:with-temporary-file (:pathname place)
    (let ((path (uiop:ensure-directory-pathname (format nil "~A-new" place))) (troubles '()))
      (flet ((make-and-remove ()
               (handler-case (loop repeat 2000
                                   do (when (base:make-missing-directory path)
                                        (uiop:delete-empty-directory path)))
                 (error (condition) (push (princ-to-string condition) troubles)))))
        (mapc #'base:join-thread
              (loop repeat 2 collect (base:start-thread #'make-and-remove "directories")))
        (is (null troubles) "~A" (first troubles))
        (is-true (base:make-missing-directory path))
        (is-false (base:make-missing-directory path))
        (uiop:delete-empty-directory path)))))

(test room.is-there-when-it-was-made
  (let ((octets (floor (sb-ext:bytes-consed-between-gcs) 2)))
    (base:collect-garbage-early octets)
    (let ((collections (host:collection-epoch))
          (made (loop repeat (floor octets 200000) collect (make-string 25000))))
      (is (plusp (length made)))
      (is (eq collections (host:collection-epoch))))))

;;; Who waits leaves the terminal to a debugger. What SBCL says of that goes nowhere.

(defun nowhere ()
  (make-two-way-stream (make-concatenated-stream) (make-broadcast-stream)))

(test waiting.leaves-the-terminal-to-who-needs-it
  (let* ((left (base:make-semaphore "left")) (*query-io* (nowhere))
         (thread (base:start-thread (lambda ()
                                      (let ((*query-io* (nowhere)))
                                        (host:take-foreground)
                                        (sb-thread:release-foreground)
                                        (base:signal-semaphore left)))
                                    "needs the terminal")))
    (is-true (base:wait-while-serving left 60))
    (base:join-thread thread)
    (is-false (base:wait-while-serving left 0.01))))

(test relative-names.begin-at-one-place-for-the-system-and-for-lisp
  (call-in-directory
   (lambda (directory)
     (let ((*default-pathname-defaults* directory))
       (is (equal directory (base:base-directory)))
       (base:make-directories #p"a/b/")
       (is-true (uiop:directory-exists-p (merge-pathnames "a/b/" directory)))
       (is-true (base:make-missing-directory #p"a/c/"))
       (let ((file (base:path-of-name "a/b/words.txt")))
         (base:overwrite-file (lambda (out) (write-string "some words" out)) file "the text")
         (is (null (base:unusable-file-text file)))
         (is (string= "some words" (base:file-text file)))
         (base:truncate-file file 4)
         (is (string= "some" (base:file-text file)))
         (base:replace-file (base:path-of-name "a/c/other") file))
       (is-true (base:existing-path (merge-pathnames "a/c/other" directory)))))))
