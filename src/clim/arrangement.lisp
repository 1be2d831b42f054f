;;;; arrangement.lisp -- where each part of the window is, at any size.

(in-package :ars-magna.clim)

;;; Rows from top to bottom: menus, tool bar, displays, a splitter, the transcript, the line being
;;; typed, the status strip. In the row of displays the world is on the left, then a splitter and a
;;; column of sections, each a title with a display below it. If there is room, plans have a
;;; separate column before that, and a splitter. In a low window the column of sections continues
;;; beside the transcript, to have room for more lines. Nothing here depends on CLIM: a part is a
;;; name, a place is (name left top width height), in pixels.

(defconstant +title-height+ 17 "Height of the titles of displays, in pixels.")
(defconstant +menus-height+ 20 "Height of the bar of menus, in pixels.")
(defconstant +tool-bar-height+ 26 "Height of the tool bar, in pixels.")
(defconstant +status-strip-height+ 36 "Height of the status strip, in pixels.")
(defconstant +least-prompt-rows+ 2 "The least number of rows of the input line.")
(defconstant +least-prompt-height+ 36
  "Height of the input line when it has +LEAST-PROMPT-ROWS+ rows, in pixels.")
(defconstant +splitter-width+ 6 "Thickness of a splitter, in pixels.")
(defconstant +least-width-for-plan-column+ 1500
  "The least width, in pixels, of a window that shows plans in a separate column.")

(defconstant +low-window-height+ 700
  "The window height, in pixels, below which sections continue beside the transcript.")
(defconstant +section-top-margin+ 6
  "The distance from the top of a section to its first line, in pixels.")

(defconstant +section-bottom-margin+ 4 "The empty pixels below the last line of a section.")

(define-constant +sections+ '(state designators cameras hands bins plots plan parameters)
  :test #'equal
  :documentation "The displays in the column beside the world, from top to bottom.")

(define-constant +titled+
    '(world state designators cameras hands bins plots plan parameters transcript)
  :test #'equal
  :documentation "The parts of the window that have titles.")

(define-constant +tall-sections+ '(parameters plots plan)
  :test #'equal
  :documentation "The sections that mostly need more height than there is. The first that is open
gets half of the height or more.")

(define-constant +splitters+ '(side-splitter plan-splitter low-splitter)
  :test #'equal
  :documentation "The bars that the user can drag to resize the parts on either side.")

(defstruct preferences
  "The user's preferences for a window. LAYERS are the layers of its display of the world. COLOR-P
is true if this display has colours. DETAILS-WIDTH, PLAN-WIDTH and TRANSCRIPT-HEIGHT are in pixels;
NIL means a size that suits the window. FOLDED lists sections that show only their title, and UNSEEN
those of them that open by themselves when they have something to show. ABSENT lists sections that
take no room even for their title, as the parameters do while they are folded. PLAN-VIEW is the view
of plans. MAGNIFICATION is the number of screen pixels per window pixel, or NIL to suit the screen."
  (layers *window-layers* :type list)
  (color-p t)
  (details-width nil :type (or null real))
  (plan-width nil :type (or null real))
  (transcript-height nil :type (or null real))
  (folded '(designators cameras hands bins plan parameters) :type list)
  (unseen '(designators cameras hands bins plan) :type list)
  (absent '(plots) :type list)
  (plan-view :tree :type (member :tree :timeline))
  (magnification nil :type (or null (integer 1))))

(defun title-pane-name (section)
  (intern (format nil "~A-TITLE" (symbol-name section)) :ars-magna.clim))

(defun plan-column-p (preferences width)
  (and (>= width +least-width-for-plan-column+)
       (not (folded-p 'plan preferences))))

(defun folded-p (section preferences)
  (and (member section (preferences-folded preferences)) t))

(defun absent-sections (preferences)
  (append (preferences-absent preferences)
          (and (folded-p 'parameters preferences) '(parameters))))

(defun column-sections (preferences width)
  "Return the sections of the column in a window WIDTH pixels wide."
  (remove-if (lambda (section)
               (or (member section (absent-sections preferences))
                   (and (eq section 'plan) (plan-column-p preferences width))))
             +sections+))

(defun details-width (preferences width)
  "Return the width in pixels of the column of sections in a window WIDTH pixels wide."
  (let ((wanted (or (preferences-details-width preferences)
                    (clamp (floor (* 9 width) 20) 200 400))))
    (clamp (round wanted) 120 (max 120 (- width 160)))))

(defun plan-width (preferences width)
  "Return the width in pixels of the column of plans, or 0 if a window WIDTH pixels wide has none."
  (let ((details (details-width preferences width)))
    (if (plan-column-p preferences width)
        (clamp (round (or (preferences-plan-width preferences) (+ details 60)))
               120 (max 120 (- width details 160)))
        0)))

(defun transcript-height (preferences height)
  (let ((wanted (or (preferences-transcript-height preferences) (clamp (floor height 5) 80 260)))
        (fixed (+ +menus-height+ +tool-bar-height+ +splitter-width+ +least-prompt-height+
                  +status-strip-height+)))
    (clamp (round wanted) 40 (max 40 (- height fixed 120)))))

;;; Sections.

(defun divide-height (needs height)
  "Return lists (section pixels) that divide HEIGHT among the sections of NEEDS, lists (section
pixels). If HEIGHT is enough, each section gets what it needs, and the plan or the designators, if
they are open, get the rest. Otherwise each gets a fair share."
  (cond ((null needs) '())
        ((<= (reduce #'+ needs :key #'second) height) (add-unused-height needs height))
        (t (divide-scarce-height needs height))))

(defun divide-scarce-height (needs height)
  "Divide HEIGHT, which is less than NEEDS. The first of the tall sections gets what it needs, up
to half of HEIGHT, or more if the others leave more. The others get fair shares, at least a line."
  (let* ((tall (some (lambda (section) (find section needs :key #'first)) +tall-sections+))
         (others (remove tall needs)))
    (if (and tall others)
        (let ((share (min (second tall)
                          (max (min (floor height 2)
                                    (- height (* (height-of-whole-lines 0) (length others))))
                               (- height (reduce #'+ others :key #'second))))))
          (cons (list (first tall) share) (divide-height others (- height share))))
        (divide-height-fairly needs height))))

(defun height-of-whole-lines (height)
  "Return the height of the whole lines that fit in HEIGHT pixels, or of one line if none fits."
  (+ +section-top-margin+
     (* +line-height+ (max 1 (floor (- height +section-top-margin+) +line-height+)))))

(defun divide-height-fairly (needs height)
  "Divide HEIGHT, which is not enough for NEEDS. Sections that need less than an equal share get
what they need. The other sections get equally many whole lines."
  (let* ((fair (floor height (max 1 (length needs))))
         (small (remove-if (lambda (need) (> (second need) fair)) needs))
         (large (remove-if (lambda (need) (member need small)) needs)))
    (if (null small)
        (divide-lines needs fair height)
        (append small
                (divide-height-fairly large (- height (reduce #'+ small :key #'second)))))))

(defun divide-lines (needs fair height)
  "Divide HEIGHT among NEEDS. Each section gets as many whole lines as FAIR pixels hold. Remaining
lines go to the first sections, one each, and remaining pixels to the last."
  (let* ((share (min (height-of-whole-lines fair) (max 0 fair)))
         (rest (- height (* share (length needs)))))
    (loop for ((section) . more) on needs
          for extra = (cond ((null more) rest)
                            ((<= +line-height+ rest) +line-height+)
                            (t 0))
          do (decf rest extra)
          collect (list section (+ share extra)))))

(defun add-unused-height (shares height)
  "Return SHARES, lists (section pixels), with the unused pixels of HEIGHT added to the plan or else
the designators. If neither is there, nobody gets them."
  (let ((rest (- height (reduce #'+ shares :key #'second)))
        (receiver (or (find 'plan shares :key #'first) (find 'designators shares :key #'first))))
    (loop for share in shares
          collect (if (eq share receiver) (list (first share) (+ (second share) rest)) share))))

(defun section-and-title-places (section left top width height)
  "Return the places of the title of SECTION and of the display below it, HEIGHT pixels high."
  (list (list (title-pane-name section) left top width +title-height+)
        (list section left (+ top +title-height+) width (max 0 height))))

(defun section-column-places (sections needs folded left top width height)
  "Return the places of SECTIONS in a column. NEEDS returns the height of a section in pixels."
  (let* ((open (set-difference sections folded))
         (room (- height (* +title-height+ (length sections))))
         (shares (divide-height (loop for section in sections
                                      when (member section open)
                                        collect (list section (funcall needs section)))
                                room)))
    (loop for section in sections
          for own = (or (second (find section shares :key #'first)) 0)
          append (section-and-title-places section left top width own)
          do (incf top (+ +title-height+ own)))))

(defun absent-section-places (sections)
  (loop for section in sections append (section-and-title-places section 0 0 0 0)))

;;; The whole.

(defun plan-column-places (preferences width left top height down)
  "Return the places of the column of plans and of the splitter to its right. The column begins at
LEFT and is HEIGHT pixels high; the splitter is DOWN pixels high."
  (let ((plan (plan-width preferences width)))
    (if (plusp plan)
        (append (section-and-title-places 'plan left top plan (- height +title-height+))
                (list (list 'plan-splitter (+ left plan) top +splitter-width+ down)))
        (list (list 'plan-splitter left top 0 0)))))

(defun display-places (preferences needs width top height down)
  "Return the places of the displays. The world and the column of plans begin at TOP and are HEIGHT
pixels high. The column of sections is DOWN pixels high."
  (let* ((column (details-width preferences width))
         (own-p (plan-column-p preferences width))
         (plan (if own-p (+ (plan-width preferences width) +splitter-width+) 0))
         (world (- width column plan +splitter-width+))
         (left (+ world +splitter-width+)))
    (append (section-and-title-places 'world 0 top world (- height +title-height+))
            (list (list 'side-splitter world top +splitter-width+ (if own-p height down)))
            (plan-column-places preferences width left top height down)
            (section-column-places (column-sections preferences width) needs
                                   (preferences-folded preferences)
                                   (+ left plan) top column down)
            (absent-section-places (absent-sections preferences)))))

(defun transcript-places (width top bottom)
  "Return the places, from TOP to BOTTOM, of a splitter and the transcript below it."
  (let ((low (+ top +splitter-width+)))
    (cons (list 'low-splitter 0 top width +splitter-width+)
          (section-and-title-places 'transcript 0 low width (- bottom low +title-height+)))))

(defun prompt-height (rows transcript)
  "Return the height in pixels of an input line with ROWS rows. Additional rows take their height
from the transcript, TRANSCRIPT pixels high, but the transcript keeps at least 40 pixels."
  (clamp (+ +least-prompt-height+ (* +line-height+ (- rows +least-prompt-rows+)))
         +least-prompt-height+
         (max +least-prompt-height+ (+ +least-prompt-height+ (- transcript +title-height+ 40)))))

(defun compute-places (preferences needs width height &optional (rows +least-prompt-rows+))
  "Return the places of all parts of a window of WIDTH x HEIGHT pixels with the layout PREFERENCES.
NEEDS is a function from a section to the height that it needs, in pixels. The input line has ROWS
rows; additional rows take room from the transcript."
  (let* ((top (+ +menus-height+ +tool-bar-height+))
         (strip (- height +status-strip-height+))
         (transcript (transcript-height preferences height))
         (typed (prompt-height rows transcript))
         (prompt (- strip typed))
         (splitter (- strip +least-prompt-height+ transcript +splitter-width+))
         (down-p (< height +low-window-height+))
         (column (+ (details-width preferences width) +splitter-width+)))
    (append (list (list 'menus 0 0 width +menus-height+)
                  (list 'bar 0 +menus-height+ width +tool-bar-height+))
            (display-places preferences needs width top (- splitter top)
                            (- (if down-p prompt splitter) top))
            (transcript-places (if down-p (- width column) width) splitter prompt)
            (list (list 'interactor 0 prompt width typed)
                  (list 'strip 0 strip width +status-strip-height+)))))
