;;;; cli-libraries.lisp -- a saved core is rebuilt when SBCL or its libraries have changed.

(in-package :ars-magna.tests)

(def-suite* cli-libraries :in ars-magna)

;;; These test the list beside a core, which the shell checks at each start: see library_state in
;;; cli/setup.sh and list-libraries in cli/build.lisp. Building cores here would take too long.

(defparameter *changing-libraries*
  "root=$(mktemp -d)/'a b'
   mkdir -p \"$root/tree/deep/.git\" \"$root/flat/deep\"
   list=$root/core.list
   printf '%s\\n' \"file $root/one.lisp\" 'name /lib.asd' 'name /source-registry.conf' \\
          \"tree $root/tree\" \"directory $root/flat\" \"tree $root/none\" >\"$list\"
   echo 1 >\"$root/one.lisp\"
   . \"$1\"
   unset CL_SOURCE_REGISTRY
   look() {
       now=$(library_state \"$list\")
       [ \"$now\" = \"$known\" ] && echo \"same: $1\" || echo \"other: $1\"
       known=$now
   }
   known=$(library_state \"$list\")
   look 'nothing'
   touch -d 2001-01-01 \"$root/one.lisp\";         look 'an older file'
   touch \"$root/tree/deep/.git/lib.asd\";         look 'an asd that ASDF does not see'
   touch \"$root/tree/deep/mine.asd\";             look 'an asd of another name'
   touch \"$root/flat/deep/lib.asd\";              look 'an asd deeper than ASDF looks'
   touch \"$root/tree/deep/lib.asd\";              look 'a second asd of the name'
   mkdir -p \"$root/none\"
   ln -s \"$root/flat/deep\" \"$root/none/link\";    look 'an asd behind a link'
   touch \"$root/flat/lib.asd\";                   look 'an asd in a directory'
   mkdir \"$root/tree/source-registry.conf.d\"
   touch \"$root/tree/source-registry.conf.d/50-mine.conf\";  look 'a configuration'
   rm \"$root/one.lisp\";                          look 'no file'
   CL_SOURCE_REGISTRY=/elsewhere:;               look 'a variable'
   rm -r \"$(dirname \"$root\")\""
  "A script that prints for each change whether the libraries then count as others.")

(test libraries.that-have-changed-are-noticed
  (is (equal '("same: nothing" "other: an older file" "same: an asd that ASDF does not see"
               "same: an asd of another name" "same: an asd deeper than ASDF looks"
               "other: a second asd of the name" "other: an asd behind a link"
               "other: an asd in a directory" "other: a configuration" "other: no file"
               "other: a variable")
             (lines-of (nth-value 1 (base:run-command
                                     "sh" (list "-c" *changing-libraries* "sh"
                                                (base:native-name (project-file "cli/setup.sh")))
                                     :output :string))))))

(test libraries.of-a-core-are-listed-with-the-places-where-others-may-be-found
  (let ((lines (lines-of (printed-in-child
                          "alexandria" "(ars-magna.build::write-library-list *standard-output*)"))))
    (flet ((line-p (start end)
             (is-true (some (lambda (line)
                              (and (begins-with-p start line) (ends-with-p end line)))
                            lines)
                      "~A...~A" start end)))
      (line-p "file /" "/alexandria.asd")
      (line-p "file /" "/package.lisp")
      (line-p "file /" (file-namestring *plain-core*))
      (line-p "name /alexandria.asd" "")
      (line-p "tree /" "/common-lisp/")
      (line-p "directory /" "/systems/"))
    (is (notany (lambda (line) (mentions-p line "ars-magna.asd")) lines))))

;;; Versions of CLX that do not work are refused before McCLIM is compiled.

(defun clx-made-like (version &rest files)
  "Return an ASDF system like CLX of VERSION, with FILES."
  (let ((system (make-instance 'asdf:system :name "clx" :version version
                                            :pathname #p"/usr/share/clx/"
                                            :source-file #p"/usr/share/clx/clx.asd")))
    (setf (slot-value system 'asdf/component:children)
          (mapcar (lambda (file) (make-instance 'asdf:cl-source-file :name file :parent system))
                  files))
    (asdf/component:compute-children-by-name system)
    system))

(test clx.that-misreads-answers-is-known
  "CLX 0.7.5 on SBCL 2.4.7 or newer, as on Debian 13. Some of 0.7.5 have what 0.7.6 has."
  (let ((old (clx-made-like "0.7.5" "dependent")))
    (dolist (version '("2.2.9.debian" "2.4.6"))
      (is (null (ars-magna.clx:clx-trouble old version))))
    (dolist (version '("2.4.7" "2.5.2.debian" "2.6.4.debian" "2.10.0"))
      (let ((text (ars-magna.clx:clx-trouble old version)))
        (is-true (has-words-p text "CLX 0.7.5 in /usr/share/clx/" version "CLX 0.7.6 or newer"
                              "git clone" "~/common-lisp/clx")
                 "~A" text)))
    (is (null (ars-magna.clx:clx-trouble (clx-made-like "0.7.5" "dependent" "common") "2.5.2")))
    (is (null (ars-magna.clx:clx-trouble nil "2.5.2")))))
