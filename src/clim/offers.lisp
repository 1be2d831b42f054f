;;;; offers.lisp -- the menu of the right button: lines for the prompt, by what was clicked.

(in-package :ars-magna.clim)

;;; An offer is (title line): its title in the menu, and the line that goes to the window's prompt
;;; when it is chosen, as if typed; so the transcript shows it. A third element, if any, is a
;;; function to call with the window before.

(defgeneric offers (subject window)
  (:documentation "Return the context menu for SUBJECT, an object that WINDOW shows: a list of
(title line), where LINE is the prompt line to run.")
  (:method (subject window)
    (declare (ignore subject window))
    '()))

(defun coordinate-text (number)
  "Return NUMBER, rounded to hundredths, as a text that the prompt can read."
  (format nil "~,2F" number))

(defun go-there-offer (x y)
  (list "Go there" (format nil "go-to ~A ~A" (coordinate-text x) (coordinate-text y))))

(defun camera-offers (window title line &rest arguments)
  "Return a list with a menu entry (title line) for each camera of the robot of WINDOW. TITLE is a
format string for the camera's number, and LINE is one for the number and ARGUMENTS."
  (loop for camera in (robot-image-cameras (window-robot window))
        for index = (camera-image-index camera)
        collect (list (format nil title index)
                      (apply #'format nil line index arguments))))

;;; Looking into.

(defun inspection-offers (form)
  "Return entries to describe the value of FORM, a string, and to inspect it in a connected editor."
  (cons (list "Describe its Lisp object" (format nil "(describe ~A)" form))
        (and (editor-server)
             (list (list "Inspect in the editor" (format nil "(inspect-in-editor ~A)" form))))))

;;; Things.

(defun find-thing-form-text (image)
  (format nil "(find-thing ~S)" (subject-title image)))

(defun designator-numbers-of (image window)
  (loop for designator in (robot-image-designators (window-robot window))
        when (equal (subject-key image) (subject-key (designator-image-denotation designator)))
          collect (designator-image-number designator)))

(defun color-text (image)
  "Return the colour of the thing of IMAGE as the prompt can read it; NIL if there is none."
  (let ((color (and (typep image 'thing-image)
                    (assoc :color (thing-image-attributes image)))))
    (and color (text-as-typed (second color)))))

(defun appearance-text (image)
  "Return the looks of IMAGE's thing as a specification that the prompt can read."
  (format nil "(~@[(:color ~A)~])" (color-text image)))

(defun next-to-robot-p (image window)
  "True if the thing of IMAGE is on the floor, or a robot's body, within reach of WINDOW's robot."
  (let ((robot (find (shown-robot-name window) (simulation-robots (window-simulation window))
                     :key #'robot-name)))
    (and robot
         (or (body-p (thing-image-thing image)) (on-floor-p image window))
         (within-reach-p robot (thing-image-x image) (thing-image-y image)))))

(defun search-offers (image window)
  "Return the menu entries to search for things that look like the thing of IMAGE. They search next
to the robot if that thing is there, and farther away otherwise."
  (if (next-to-robot-p image window)
      (camera-offers window "Look for things like it next to the robot, with camera ~D"
                     "obj-desig ~D local ~A" (appearance-text image))
      (camera-offers window "Look for things like it with camera ~D"
                     "obj-desig ~D non-local ~A" (appearance-text image))))

(defun cameras-tracking (numbers window)
  "Return the indices of the cameras that track a designator whose number is in the list NUMBERS."
  (loop for camera in (robot-image-cameras (window-robot window))
        for track = (camera-image-track camera)
        when (and track (member (designator-image-number track) numbers))
          collect (camera-image-index camera)))

(defun tracking-offers (number camera image)
  "Return menu entries to track designator NUMBER with the camera of index CAMERA. The second entry,
to compare looks, is only for a thing with a colour; IMAGE is its image."
  (cons (list (format nil "Track designator ~D with camera ~D" number camera)
              (format nil "cam-track ~D ~D" camera number))
        (when (color-text image)
          (list (list (format nil "Track it with camera ~D as long as it looks ~A" camera
                              (color-text image))
                      (format nil "cam-track-matching ~D ~D ~A" camera number
                              (appearance-text image)))))))

(defun start-tracking-offers (numbers image window)
  "Return menu entries to start tracking the designators with NUMBERS, with each camera that does
not track them. IMAGE is the image of the thing that they denote; for a place, something else."
  (loop for number in numbers
        append (loop for camera in (robot-image-cameras (window-robot window))
                     for index = (camera-image-index camera)
                     unless (member index (cameras-tracking (list number) window))
                       append (tracking-offers number index image))))

(defun approach-offer (camera)
  (list (format nil "Approach it, guided by camera ~D" camera) (format nil "goto-desig ~D" camera)))

(defun approach-and-grasp-offers (camera window)
  (cons (approach-offer camera)
        (loop for hand in (robot-image-hands (window-robot window))
              for index = (hand-image-index hand)
              unless (hand-image-contents hand)
                collect (list (format nil "Grasp it with hand ~D" index)
                              (format nil "hand-grasp ~D ~D" index camera)))))

(defun end-tracking-offer (camera)
  (list (format nil "Stop tracking it with camera ~D" camera) (format nil "cam-untrack ~D" camera)))

(defun tracked-thing-offers (numbers window &key held-p)
  "Return the menu entries for the cameras that track a thing. NUMBERS are those of its designators.
If the robot itself holds the thing (HELD-P), leave out approaching and grasping."
  (loop for camera in (cameras-tracking numbers window)
        unless held-p append (approach-and-grasp-offers camera window)
        collect (end-tracking-offer camera)))

;;; What is held.

(defun hand-image-holding (image window)
  "Return the image of the hand with which the robot of WINDOW holds the thing of IMAGE, or NIL."
  (find-if (lambda (hand)
             (and (hand-image-contents hand)
                  (same-subject-p image (hand-image-contents hand))))
           (robot-image-hands (window-robot window))))

(defun insertion-offers (hands bins title)
  "Return entries to put HANDS into open BINS. TITLE is a format string for the two numbers."
  (loop for hand in hands
        append (loop for bin in bins
                     unless (or (bin-image-closed-p bin) (hand-image-location hand))
                       collect (list (format nil title (hand-image-index hand)
                                             (bin-image-index bin))
                                     (format nil "hand-insert-bin ~D ~D" (hand-image-index hand)
                                             (bin-image-index bin))))))

(defun release-offers (hand window)
  (let ((index (hand-image-index hand)))
    (append (list (list (format nil "Let go of it with hand ~D" index)
                        (format nil "hand-ungrasp ~D" index)))
            (when (hand-image-location hand)
              (list (list (format nil "Take hand ~D, which holds it, out of its container" index)
                          (format nil "hand-remove ~D" index))))
            (insertion-offers (list hand) (robot-image-bins (window-robot window))
                              "Put hand ~D, which holds it, into storage bin ~D"))))

(defun held-thing-offers (image window)
  "Return the menu entries for the thing of IMAGE if WINDOW's robot holds it or has it in a bin."
  (let* ((robot (window-robot window))
         (hand (hand-image-holding image window))
         (bin (find-if (lambda (bin) (member image (bin-image-contents bin) :test #'same-subject-p))
                       (robot-image-bins robot))))
    (cond (hand (release-offers hand window))
          (bin (append (offers bin window)
                       (insertion-offers (remove-if #'hand-image-contents (robot-image-hands robot))
                                         (list bin) "Put hand ~D into storage bin ~D"))))))

(defun on-floor-p (image window)
  (find (thing-image-thing image) (snapshot-things (window-snapshot window))
        :key #'thing-image-thing))

(defun thing-offers (image window)
  (let ((numbers (designator-numbers-of image window)))
    (append (when (on-floor-p image window)
              (list (go-there-offer (thing-image-x image) (thing-image-y image))))
            (held-thing-offers image window)
            (search-offers image window)
            (start-tracking-offers numbers image window)
            (tracked-thing-offers numbers window :held-p (hand-image-holding image window))
            (inspection-offers (find-thing-form-text image)))))

(defmethod offers ((image thing-image) window)
  (let ((thing (thing-image-thing image)))
    (if (body-p thing)
        (offers (snapshot-robot (window-snapshot window) (robot-name (body-robot thing))) window)
        (thing-offers image window))))

;;; Designators and parts.

(defmethod offers ((image designator-image) window)
  (let ((numbers (list (designator-image-number image)))
        (thing (designator-image-denotation image)))
    (append (start-tracking-offers numbers thing window)
            (tracked-thing-offers numbers window
                                  :held-p (and (typep thing 'thing-image)
                                                (hand-image-holding thing window))))))

(defmethod offers ((image camera-image) window)
  (declare (ignore window))
  (let ((index (camera-image-index image)))
    (append (list (list "Take a view" (format nil "cam-view ~D" index))
                  (list "Look ahead" (format nil "cam-align-robot ~D" index))
                  (list "List things in view" (format nil "all-obj-desig ~D non-local ()" index)))
            (when (camera-image-track image)
              (list (list "Stop tracking" (format nil "cam-untrack ~D" index)))))))

(defmethod offers ((image hand-image) window)
  (declare (ignore window))
  (let ((index (hand-image-index image)))
    (append (list (list "Check whether it holds anything" (format nil "hand-grasp-check ~D" index)))
            (when (hand-image-contents image)
              (list (list "Let go" (format nil "hand-ungrasp ~D" index)))))))

(defmethod offers ((image bin-image) window)
  (declare (ignore window))
  (let ((index (bin-image-index image)))
    (list (if (bin-image-closed-p image)
              (list "Open" (format nil "bin-open ~D" index))
              (list "Close" (format nil "bin-close ~D" index))))))

;;; Robots and cells.

(defun body-offers (body window)
  "Return the menu entries for BODY, the image of another robot's body, as a thing to see."
  (let ((numbers (designator-numbers-of body window)))
    (append (search-offers body window)
            (start-tracking-offers numbers body window)
            (loop for camera in (cameras-tracking numbers window)
                  collect (approach-offer camera)
                  collect (end-tracking-offer camera)))))

(defmethod offers ((image robot-image) window)
  (let ((form (format nil "(find-robot '~A)" (text-as-typed (robot-image-name image)))))
    (append (if (shown-robot-p window image)
                '(("Show its status" "status") ("Stop" "stop") ("Turn about" "about-face")
                  ("Show at what place it is" "place"))
                (cons (list "Command this robot"
                            (format nil "robot ~(~A~)" (robot-image-label image)))
                      (and (robot-image-body image)
                           (body-offers (robot-image-body image) window))))
            (inspection-offers form))))

(defmethod offers ((cell cell) window)
  (declare (ignore window))
  (let ((x (+ (cell-x cell) 1/2)) (y (+ (cell-y cell) 1/2)))
    (unless (cell-filled? cell)
      (list (go-there-offer x y)
            (list "Put the robot here"
                  (format nil "pos ~A ~A" (coordinate-text x) (coordinate-text y)))))))

;;; As a menu.

(defun offer-row (window title line &optional before)
  (make-row title
            :more line
            :action (lambda ()
                      (when before (funcall before window))
                      (run-line-at-prompt (window-conversation window) line)
                      ;; If you continue typing, you mean the next line.
                      (focus-and-repaint (pane-named window 'interactor)))))

(defun subject-heading (subject)
  (if (typep subject 'cell)
      (format nil "Cell ~D, ~D" (cell-x subject) (cell-y subject))
      (subject-title subject)))

(defun offer-rows (window subject)
  (append (list (make-row (subject-heading subject))
                (make-row "Describe it"
                          :action (lambda () (describe-in-transcript window subject))))
          (loop for offer in (offers subject window)
                collect (apply #'offer-row window offer))))

(defun rows-for-other-subjects (window subjects x y)
  "Return rows for all SUBJECTS but the first. Each row opens its subject's menu at X, Y of WINDOW."
  (loop for rest on (rest subjects)
        collect (let ((turned (append rest (ldiff subjects rest))))
                  (make-row (format nil "Also here: ~A" (subject-heading (first turned)))
                            :action (lambda ()
                                      (select-subject window (first turned))
                                      (open-offers-menu window turned x y))))))

(defun open-offers-menu (window subjects x y)
  "Open the context menu of the first of SUBJECTS, with rows for the others, at X, Y of WINDOW."
  (open-popup window
              (append (offer-rows window (first subjects))
                      (rows-for-other-subjects window subjects x y))
              x y))
