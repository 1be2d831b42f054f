;;;; facts.lisp -- what people want to know of maps, kickers, place types, attributes and things.

(in-package :ars-magna.world)

(define-facts (map map)
  "Size" (format nil "~D x ~D metres" (map-width map) (map-height map))
  "Walls of" (listed (coerce (remove nil (map-substance-types map)) 'list))
  "Things to start with" (listed (mapcar #'recipe-name (map-things map)))
  "Place types" (listed (remove-duplicates
                             (loop for number across (map-places map)
                                   unless (zerop number)
                                     collect (place-type-name
                                              (aref (map-place-types map) number))))))

(define-facts (kicker kicker)
  "Chance in a tick" (kicker-prob kicker)
  "Only when its test holds" (and (kicker-test kicker) "yes"))

(define-facts (place-type type)
  "Rank" (place-type-rank type)
  "Told by" (if (place-type-checker type)
                "a checker"
                (format nil "~R matcher~:P" (length (place-type-rules type))))
  "Chance that a search finds it where it is not" (place-type-confusion type)
  "Can be designated" (if (place-type-invisible-p type) "no" "yes"))

(define-facts (attribute attribute)
  "Values" (if (eq :numeric (attribute-kind attribute))
               "numbers"
               (listed (attribute-domain attribute)))
  "Chance of a right reading" (and (eq :discrete (attribute-kind attribute))
                                   (attribute-success attribute))
  "Standard deviation of readings" (and (eq :numeric (attribute-kind attribute))
                                        (format nil "~A, far away at most ~A times that"
                                                (attribute-base attribute)
                                                (attribute-max-mult attribute)))
  "Chance of being sensed unasked" (attribute-noticed attribute)
  "Sensed more often when these are asked for" (listed (attribute-supporters attribute)))

(define-facts (substance substance)
  "Parameter" (substance-%parameter substance))

(define-facts (thing thing)
  "Where" (let ((location (thing-location thing)))
            (cond ((null location) "nowhere")
                  ((eq location :floor)
                   (format nil "(~,2F,~,2F)" (thing-x thing) (thing-y thing)))
                  (t (thing-holders-text thing))))
  "Attributes" (thing-attributes thing)
  "Contents" (listed (thing-contents thing))
  "Kickers" (listed (mapcar #'attachment-name (thing-kickers thing))))
