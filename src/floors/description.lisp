;;;; description.lisp -- the YAML file of a floor: it names the image and says how to read it.

(in-package :ars-magna.floors)

;;; The keys and what they mean are those of ROS's map_server (wiki.ros.org/map_server) and of
;;; nav2_map_server after it. All but mode are required. Other keys are ignored, with a warning if
;;; they resemble one of these.

(defconstant +most-description-octets+ 65536 "The largest size of a floor's description, in bytes.")

(defstruct (description (:copier nil))
  "A floor: its IMAGE, a pathname; RESOLUTION, a pixel's width in metres; ORIGIN, the lower left
corner in metres and the counterclockwise rotation in radians; NEGATED-P, true if white is occupied;
the probabilities above which a pixel is OCCUPIED and below which it is FREE; and the MODE."
  (file nil :type pathname :read-only t)
  (image nil :type pathname :read-only t)
  (resolution 1 :type rational :read-only t)
  (origin '(0 0 0) :type list :read-only t)
  (negated-p nil :type boolean :read-only t)
  (occupied 13/20 :type rational :read-only t)
  (free 49/250 :type rational :read-only t)
  (mode :trinary :type (member :trinary :scale :raw) :read-only t))

(defparameter *example-lines*
  '(("image" . "floor.pgm") ("resolution" . "0.05") ("origin" . "[0.0, 0.0, 0.0]")
    ("negate" . "0") ("occupied_thresh" . "0.65") ("free_thresh" . "0.196"))
  "The required keys of a description, each with an example of a value.")

(defun required-entry (file key entries)
  "Return the entry for KEY in ENTRIES. Signals UNUSABLE-FLOOR if there is no such entry."
  (or (find-entry key entries)
      (let ((slip (nearest-name key (set-difference (mapcar #'entry-key entries)
                                                    (mapcar #'car *example-lines*)
                                                    :test #'string=))))
        (reject-floor file nil "there is no line with the key ~A~@[ (did you mean ~A?)~]; add a ~
                                line such as ~A: ~A"
                      key slip key (cdr (assoc key *example-lines* :test #'string=))))))

(defun reject-entry (file entry expected)
  (reject-floor file (entry-line entry) "~A is ~:[~A~;[~{~A~^, ~}]~]; give ~A"
                (entry-key entry) (consp (entry-value entry))
                (if (equal "" (entry-value entry)) "empty" (entry-value entry))
                expected))

(defun number-in-entry (file entry least most expected)
  (let ((number (and (stringp (entry-value entry)) (read-decimal (entry-value entry)))))
    (unless (and number (<= least number most)) (reject-entry file entry expected))
    number))

(defun resolution-in (file entry)
  "Return the width of a pixel in metres, from ENTRY. Signals UNUSABLE-FLOOR if out of range."
  (let* ((expected "how many metres a pixel is wide, more than 1e-9 and at most 1e9")
         (number (number-in-entry file entry 0 1000000000 expected)))
    (unless (< 1d-9 (double number)) (reject-entry file entry expected))
    number))

(defun threshold-in (file entry)
  (number-in-entry file entry 0 1 "a probability from 0 to 1"))

(defun origin-in (file entry)
  (let ((numbers (and (consp (entry-value entry)) (mapcar #'read-decimal (entry-value entry)))))
    (unless (and (= 3 (length numbers))
                 (every (lambda (number) (and number (sane-number-p number))) numbers))
      (reject-entry file entry
                    "a list [x, y, yaw] of numbers from -1e9 to 1e9, metres and radians"))
    numbers))

(defun boolean-in (file entry)
  (let ((value (entry-value entry)))
    (cond ((member value '("0" "false") :test #'equalp) nil)
          ((member value '("1" "true") :test #'equalp) t)
          (t (reject-entry file entry
                           "0 if black pixels are occupied, or 1 if white pixels are")))))

(defun mode-in (file entry)
  (cond ((null entry) :trinary)
        ((find (entry-value entry) '(:trinary :scale :raw)
               :test (lambda (value mode) (and (stringp value) (string-equal value mode)))))
        (t (reject-entry file entry "trinary, scale or raw"))))

(defun image-path (file entry)
  "Return the pathname of the image that ENTRY of FILE names relative to FILE. It may be missing."
  (let ((name (entry-value entry)))
    (unless (and (stringp name) (string/= "" name))
      (reject-entry file entry "the name of the image, such as floor.pgm"))
    (merge-pathnames (resolve-file-name name) (uiop:pathname-directory-pathname file))))

(defun readable-image-path (file entry)
  "Return the pathname of the image that ENTRY of FILE names. Signals UNUSABLE-FLOOR."
  (let* ((image (image-path file entry)) (trouble (unusable-file-text image)))
    (when trouble
      (reject-floor file (entry-line entry) "the image ~A cannot be read: ~A. Put the image ~
                                             there, or correct the line"
                    (file-name-text image) trouble))
    image))

(defun warn-of-key (file entry)
  "Warn if the key of ENTRY, a line of FILE, is unknown and resembles a known key."
  (let* ((known (cons "mode" (mapcar #'car *example-lines*))) (key (entry-key entry))
         (like (unless (member key known :test #'string=)
                 (find-if (lambda (other) (or (string-equal key other) (misspelling-p key other)))
                          known))))
    (when like
      (warn-of-definition "~A, line ~D: the key ~A is unknown and ignored; did you mean ~A?"
                          (native-name file) (entry-line entry) key like))))

(defun description-from (file entries)
  (flet ((entry (key) (required-entry file key entries)))
    (dolist (line *example-lines*) (entry (car line)))
    (dolist (entry entries) (warn-of-key file entry))
    (let ((free (threshold-in file (entry "free_thresh")))
          (occupied (threshold-in file (entry "occupied_thresh"))))
      (when (< occupied free)
        (reject-floor file (entry-line (entry "free_thresh"))
                      "free_thresh, ~A, is above occupied_thresh, ~A; exchange the two values: map ~
                       savers write 0.196 and 0.65" 
                      (decimal-notation free) (decimal-notation occupied)))
      (make-description
       :file file
       :resolution (resolution-in file (entry "resolution"))
       :origin (origin-in file (entry "origin"))
       :negated-p (boolean-in file (entry "negate"))
       :free free :occupied occupied
       :mode (mode-in file (find-entry "mode" entries))
       :image (readable-image-path file (entry "image"))))))

(note-kind-of-file :floor "image:" "it is the description of a map; (import-map FILE) reads it")

;; PGM in text and in octets, and PNG.
(dolist (beginning '("P2" "P5" #.(map 'string #'code-char '(137 80))))
  (note-kind-of-file :image beginning
                     "it is an image; (import-map FILE) reads the .yaml that names it"))

(defun check-description-file (file)
  "Signal UNUSABLE-FLOOR if FILE, by its size or its first bytes, is no description."
  (check-readable file)
  (let ((advice (advice-on-file file :floor)))
    (when advice (reject-floor file nil "~A" advice)))
  (let ((size (file-size file)))
    (when (< +most-description-octets+ size)
      (reject-floor file nil "the file has ~D bytes, and the description of a floor has at most ~
                              ~D; give the .yaml file that names the image"
                    size +most-description-octets+))))

(defun read-description-text (file)
  "Return the text in FILE. Signals UNUSABLE-FLOOR if it cannot be read."
  (handler-case (file-text file)
    (illegible-file (condition)
      (reject-floor file (illegible-file-line condition)
                    "the file has bytes that are not UTF-8. Save the file in UTF-8"))
    (stream-error () (reject-floor file nil "the system forbids reading it; give another file"))
    (error (condition) (reject-floor file nil "~A" (one-line-text condition)))))

(defun read-description (name)
  "Return the description in the file NAME, a string or pathname. Signals UNUSABLE-FLOOR."
  (let ((file (resolve-file-name name)))
    (check-description-file file)
    (let ((file (truename file)))
      (description-from file (read-entries file (read-description-text file))))))
