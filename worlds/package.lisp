;;;; package.lisp -- the package of the shipped worlds, robots and plans.

(ars:define-user-package :ars-worlds
  (:documentation "Worlds to start with: maps, robots, prototypes, kickers, manipulations, plans,
  programs and experiments. All are user code, written as you would write your own.")
  ;; prototypes
  (:export #:table* #:desk* #:drawer* #:shelf* #:cupboard* #:cabinet* #:bed* #:sofa* #:chair*
           #:lamp* #:plant* #:door* #:box* #:crate* #:waste-basket* #:suitcase* #:bottle* #:cup*
           #:tin* #:ball* #:book* #:sheet* #:pen* #:key* #:toolbox* #:person*)
  ;; kickers, and helpers to write more
  (:export #:roll-away #:blow-about #:be-borrowed #:change-light #:print-page #:wander-about
           #:do-rounds
           #:user-dice #:random-step #:scale-step #:take-step #:approach)
  ;; manipulations; OPEN and CLOSE are Common Lisp's symbols
  (:export #:lock #:unlock #:switch-on #:switch-off)
  ;; worlds and their robots
  (:export #:watson #:robbie #:office #:marvin #:gofer #:hall #:porter #:tiny #:dot)
  ;; doorways
  (:export #:next-step)
  ;; plans: reckoning
  (:export #:reckoning #:here #:begin-reckoning #:reckon #:distance-left #:angle-towards
           #:point-ahead)
  ;; plans: moving
  (:export #:outcome #:driving-speed* #:turn-by #:drive-by #:turn-towards #:drive-towards
           #:stand-still
           #:feel-ahead #:look-for-places #:begin-track #:stop-track
           #:go-to-designated
           #:find-doorway #:in-doorway-p #:take-bearings #:pass-doorway #:widest-camera
           #:travel-to #:patrol-places)
  ;; plans: looking
  (:export #:look-for-things #:turn-camera #:scan-for-thing #:look-again #:confirm-thing
           #:approach-thing #:visit-things)
  ;; plans: handling
  (:export #:open-bin #:close-bin #:reach-into-bin #:draw-back #:let-go #:holding-p
           #:look-closely #:grasp-thing #:stow-thing #:take-thing #:look-into-bin
           #:withdraw-camera #:put-thing-down #:free-hand #:stowed-p)
  ;; plans: errands
  (:export #:find-and-take #:fetch-thing #:tidy-once #:tidy-room)
  ;; plans: locks
  (:export #:manipulation-outcome #:manipulate-thing #:visit-thing #:open-with-key)
  ;; trials
  (:export #:dice-for #:hide-thing #:make-restless #:near-p #:beside-p)
  ;; plans: searching
  (:export #:watson-lookouts* #:look-near-and-far #:look-round #:make-out #:find-from-here
           #:go-and-look #:travel-watching #:look-on-the-way #:search-by-chance #:search-nearest
           #:search-watchfully)
  ;; recognising
  (:export #:pixel-tolerance* #:recognition-threshold* #:*known-places* #:signature-match
           #:add-place #:learn-place #:recognise-place)
  ;; plans: recognising
  (:export #:take-signature #:take-round-signature #:*known-ways* #:explore-by-views
           #:return-by-views)
  ;; experiments
  (:export #:fetching-against-motion-noise #:fetching-against-blindness-and-kicks
           #:three-ways-of-searching #:recognising-places #:returning-by-views)
  ;; choosing
  (:export #:leave-trolleys #:forecasts* #:choose-way #:carry-messages #:choosing-by-rollouts)
  ;; an errand with continuations
  (:export #:run-errand)
  ;; a journey with continuations
  (:export #:robot-go-to))

(in-package :ars-worlds)

(defmacro document-variables (&rest documentation)
  "Set docstrings of variables. DOCUMENTATION has names of variables and docstrings, alternating."
  `(setf ,@(loop for (name text) on documentation by #'cddr
                 append `((documentation ',name 'variable) ,text))))
