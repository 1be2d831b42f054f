;;;; reading-images.lisp -- images in grey from files of either format.

(in-package :ars-magna.floors)

(defun read-image (file limit mode)
  "Return the image in FILE, of at most LIMIT pixels, for MODE: PGM or PNG, whatever FILE is called.
Signals UNUSABLE-FLOOR."
  (let ((tape (make-tape file (read-octets file limit))))
    (cond ((png-begins-p tape) (read-png tape limit mode))
          ((pgm-kind tape) (read-pgm tape limit))
          (t (reject-image tape "the image is no PGM file, P2 or P5, and no PNG file by its first ~
                                 bytes; save it as one, as with: ~A" *conversion*)))))
