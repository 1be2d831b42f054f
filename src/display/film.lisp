;;;; film.lisp -- a run as a page for a browser, to play, stop and search for moments.

(in-package :ars-magna.display)

;;; The page needs no other file. Its terrain is drawn once, what moves for each frame. Each line of
;;; SVG is stored once: from frame to frame few of them change.

;; Read when this file is loaded, so that a saved program contains them.
(defun film-source-text (name)
  (file-text (asdf:system-relative-pathname "ars-magna" (format nil "src/display/~A" name))))

(defparameter *film-script* (film-source-text "film.js") "The program in a film.")
(defparameter *film-style* (film-source-text "film.css") "How a film looks.")

;;; Frames.

(defstruct (reel (:constructor make-reel ()) (:copier nil))
  "The frames of a film, as lines of SVG. NUMBERS is a table from the text of each line to its
number. FRAMES, the latest first, are vectors of line numbers."
  (numbers (make-hash-table :test 'cl:equal) :type hash-table :read-only t)
  (frames '() :type list))

(defun lines-with-newlines (text)
  (loop for start = 0 then (1+ end)
        for end = (position #\Newline text :start start)
        while end collect (subseq text start (1+ end))))

(defun add-frame (text reel)
  (let ((numbers (reel-numbers reel)))
    (flet ((number-of (line)
             (or (gethash line numbers)
                 (setf (gethash line numbers) (hash-table-count numbers)))))
      (push (cl:map 'vector #'number-of (lines-with-newlines text)) (reel-frames reel)))))

(defun reel-lines (reel)
  (let ((lines (make-array (hash-table-count (reel-numbers reel)))))
    (maphash (lambda (line number) (setf (aref lines number) line)) (reel-numbers reel))
    lines))

(defun frame-differences (frame before)
  "FRAME and BEFORE have the same length. Return index number ... of the lines that differ."
  (loop for number across frame
        for old across before
        for place from 0
        unless (eql number old) append (list place number)))

;;; The data of a film, in JSON, which is also JavaScript.

(defun write-array (writer items out)
  "Write the sequence ITEMS to OUT as a JSON array. The function WRITER writes an item to a stream."
  (write-char #\[ out)
  (let ((first-p t))
    (cl:map nil (lambda (item)
                  (unless (shiftf first-p nil) (write-char #\, out))
                  (funcall writer item out))
            items))
  (write-char #\] out))

(defun write-quoted (text out)
  (write-json-string text out :in-page t))

(defun write-frames (frames out)
  "Write FRAMES to OUT in order. A frame with as many lines as the previous frame is written as the
differences from it. Other frames are written whole."
  (let ((before nil))
    (flet ((write-frame (frame out)
             (cond ((and before (= (length frame) (length before)))
                    (write-string "{\"changes\":" out)
                    (write-array #'write-number (frame-differences frame before) out))
                   (t (write-string "{\"all\":" out)
                      (write-array #'write-number frame out)))
             (write-char #\} out)
             (setf before frame)))
      (write-array #'write-frame frames out))))

(defun frame-number-at (tick ticks)
  "Return the number of the first frame at or after TICK. TICKS are the ticks of all frames."
  (or (position-if (lambda (shown) (>= shown tick)) ticks)
      (1- (length ticks))))

(defun write-moment (moment ticks robots out)
  (format out "{\"tick\":~A,\"frame\":~D,\"kind\":\"~(~A~)\",\"text\":"
          (number-text (moment-tick moment)) (frame-number-at (moment-tick moment) ticks)
          (moment-kind moment))
  (write-quoted (moment-description moment robots) out)
  (write-char #\} out))

(defun write-film-data (reel ticks rate moments robots out)
  (write-string "var FILM = {\"rate\":" out)
  (write-number rate out)
  (write-string ",\"ticks\":" out)
  (write-array #'write-number ticks out)
  (format out ",~%\"lines\":")
  (write-array #'write-quoted (reel-lines reel) out)
  (format out ",~%\"frames\":")
  (write-frames (reverse (reel-frames reel)) out)
  (format out ",~%\"moments\":")
  (write-array (lambda (moment out) (write-moment moment ticks robots out)) moments out)
  (format out "};~%"))

;;; The page. The picture fills the room between title and controls, beside two foldable lists.

(defun write-controls (out)
  (format out "<footer><div id=\"timeline\"><div id=\"marks\"></div>~
               <input id=\"slider\" type=\"range\" min=\"0\" value=\"0\" aria-label=\"Frame\"></div>
<div id=\"controls\">
<button id=\"back\" title=\"One frame back\">&lt;</button>
<button id=\"play\">Play</button>
<button id=\"on\" title=\"One frame on\">&gt;</button>
<label>Speed <select id=\"speed\">~{<option value=\"~A\"~A>~A</option>~}</select></label>
<output id=\"tick\"></output>
<span id=\"help\"><kbd>space</kbd> plays and stops, arrows step, <kbd>Home</kbd> and
<kbd>End</kbd> go to the first and last frame, <kbd>+</kbd> and <kbd>-</kbd> change the speed</span>
</div></footer>~%"
          (loop for (value text) in '(("0.25" "a quarter") ("0.5" "half") ("1" "as made")
                                      ("2" "twice") ("4" "4 times") ("10" "10 times"))
                append (list value (if (string= value "1") " selected" "") text))))

(defun write-sidebar (legend moments robots out)
  "Write the part of the page beside the picture: the list of MOMENTS, and LEGEND, a text of HTML
list items. If ROBOTS, a list of names, has several, name the robots of MOMENTS."
  (format out "<aside>~%<details~:[ hidden~;~] open><summary>What happened</summary>~%~
               <ol id=\"moments\">~%" moments)
  (dolist (moment moments)
    (format out "<li><button><i class=\"~(~A~)\"></i>tick ~A: " (moment-kind moment)
            (number-text (moment-tick moment)))
    (write-escaped-text (moment-description moment robots) out)
    (format out "</button></li>~%"))
  (format out "</ol>~%</details>~%<details~:[~; hidden~] open><summary>Legend</summary>~%~
               <ul id=\"legend\">~%~A</ul></details>~%</aside>~%"
          (string= "" legend) legend))

(defun write-film (out title picture last-picture legend reel ticks rate moments robots)
  "Write the page of a film with TITLE to OUT. PICTURE is an SVG document of the first frame. Other
frames replace its group `movers'. LAST-PICTURE, an SVG document of the last frame, is for browsers
without scripts. LEGEND has HTML list items. If ROBOTS, a list of names, has several, name the
robots of MOMENTS."
  (format out "<!DOCTYPE html>~%<html lang=\"en\"><head><meta charset=\"utf-8\">~%")
  (format out "<meta name=\"viewport\" content=\"width=device-width\">~%<title>")
  (write-escaped-text title out)
  (format out "</title>~%<style>~%~A</style></head><body>~%<h1>" *film-style*)
  (write-escaped-text title out)
  (format out "</h1>~%<noscript><p>Enable scripts in your browser to play this film. Below are ~
               its first and its last frame.</p></noscript>~%")
  (format out "<main><div id=\"stage\">~%~A<noscript>~%~A</noscript></div>~%" picture last-picture)
  (write-sidebar legend moments robots out)
  (format out "</main>~%")
  (write-controls out)
  (format out "<script>~%")
  (write-film-data reel ticks rate moments robots out)
  (format out "</script>~%<script>~%~A</script>~%</body></html>~%" *film-script*))

;;; Making a film. Its legend stands beside the picture, so that the picture can be large. It lists
;;; what any of the frames shows.

(defun movers-svg (snapshot layers in-color scale)
  (with-output-to-string (out)
    (let ((canvas (make-instance 'svg-canvas :stream out :color-p in-color)))
      (with-canvas (canvas :scale scale) (draw-movers canvas snapshot layers)))))

(defun whole-frame-svg (snapshot movers layers in-color scale)
  "Return SVG with the map of SNAPSHOT, LAYERS, and above them the SVG MOVERS in a group `movers'."
  (with-output-to-string (out)
    (with-svg (canvas out :color-p in-color)
      (with-canvas (canvas :scale scale)
        (draw-framed canvas snapshot layers
                     (lambda ()
                       (draw-terrain canvas (snapshot-map snapshot) :layers layers)
                       (write-svg canvas "<g id=\"movers\">
" movers "</g>
")))))))

(defun film-title (journal ticks)
  (format nil "~A, tick~P ~D~@[ to ~D~]" (title-of-journal journal)
          (length ticks) (first ticks) (and (rest ticks) (first (last ticks)))))

(defstruct (film-cast (:constructor make-film-cast (opening)) (:copier nil))
  "The contents of a film, for its legend. OPENING is its first snapshot. THINGS is a table from
things to images. ROBOTS are images of robots. LINES are entries for lines, the latest first."
  (opening nil :type snapshot :read-only t)
  (robots '() :type list)
  (things (make-hash-table :test #'eq) :type hash-table :read-only t)
  (lines '() :type list))

(defun add-film-contents (snapshot layers contents)
  (let ((things (film-cast-things contents)))
    (loop for image across (snapshot-things snapshot)
          do (unless (gethash (thing-image-thing image) things)
               (setf (gethash (thing-image-thing image) things) image)))
    (dolist (image (snapshot-robots snapshot))
      (pushnew image (film-cast-robots contents) :key #'robot-image-position))
    (dolist (entry (line-entries snapshot layers))
      (pushnew entry (film-cast-lines contents) :key #'entry-text :test #'string=))))

(defun film-legend-entries (contents layers)
  (let ((opening (film-cast-opening contents))
        (things (hash-table-values (film-cast-things contents))))
    (legend-entries (make-snapshot :map (snapshot-map opening) :part (snapshot-part opening)
                                   :robots (sort (copy-list (film-cast-robots contents)) #'<
                                                 :key #'robot-image-position)
                                   :things (sort (coerce things 'simple-vector)
                                                 #'< :key #'image-serial))
                    layers :lines (reverse (film-cast-lines contents)))))

(defun film-legend-html (contents layers in-color)
  "Return the legend of a film with CONTENTS as a text of HTML list items."
  (with-output-to-string (out)
    (let ((canvas (make-instance 'svg-canvas :stream out :color-p in-color)))
      (with-canvas (canvas)
        (dolist (entry (film-legend-entries contents layers))
          (format out "<li")
          (when (entry-whole entry)
            (format out " title=\"")
            (write-escaped-text (entry-whole entry) out)
            (format out "\""))
          (format out "><svg width=\"20\" height=\"18\" viewBox=\"0 0 20 18\">~%")
          (funcall (entry-sample entry) canvas 10 9)
          (format out "</svg> ")
          (write-escaped-text (entry-text entry) out)
          (format out "</li>~%"))))))

(defun record-film (journal every from until watch part layers in-color scale)
  "Replay JOURNAL and record a film of the ticks FROM to UNTIL. Call WATCH with the simulation after
each tick. Return five values: the reel, the ticks of its frames, SVGs of the first and last frames,
and the contents."
  (let ((reel (make-reel)) (ticks '()) (contents nil) (first nil) (last nil)
        ;; The legend and the title of a page are HTML.
        (shown (set-difference layers '(:legend :title))))
    (call-with-frames (lambda (snapshot)
                        (unless contents
                          ;; The page magnifies the picture as far as there is room: a larger
                          ;; scale would only make its text small.
                          (setf contents (make-film-cast snapshot)
                                scale (min (suitable-scale scale snapshot shown)
                                           (fitting-scale snapshot shown))))
                        (add-film-contents snapshot layers contents)
                        (setf last (movers-svg snapshot shown in-color scale)
                              first (or first last))
                        (push (snapshot-tick snapshot) ticks)
                        (add-frame last reel))
                      journal (frame-step journal every until from) until
                      :from from :part part :watch watch)
    (flet ((still (movers)
             (whole-frame-svg (film-cast-opening contents) movers shown in-color scale)))
      (values reel (reverse ticks) (still first) (still last) contents))))

(defun moments-from (tick moments)
  (remove-if (lambda (moment) (< (moment-tick moment) tick)) moments))

(defun film-text (journal moments
                  &key every from until rate kinds layers in-color scale title part)
  "Return the HTML page of a film of JOURNAL. MOMENTS are added to the moments found in the run."
  (multiple-value-bind (watch seen) (make-moments-watcher)
    (multiple-value-bind (reel ticks first last contents)
        (record-film journal every from until watch part layers in-color scale)
      (with-output-to-string (out)
        (write-film out (or title (film-title journal ticks)) first last
                    (if (member :legend layers) (film-legend-html contents layers in-color) "")
                    reel ticks rate
                    (moments-from
                     from
                     (sort-moments
                      (append (moments-of-kinds kinds (append (funcall seen)
                                                              (moments-in-remarks journal until)))
                              moments)))
                    (and (rest (snapshot-robots (film-cast-opening contents)))
                         (journal-robot-names journal)))))))
