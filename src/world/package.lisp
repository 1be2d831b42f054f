;;;; package.lisp -- the world layer: maps, places, things and what moves them.

(defpackage :ars-magna.world
  (:documentation "The fixed grid (maps, place types, substances) and what changes in it
(worlds, things, kickers). Manual 2.1, 3.3 and 5.1 to 5.4.")
  (:use :cl :ars-magna.base)
  (:shadow #:map)
  (:import-from :ars-magna.nisp #:matchvar-p)
  ;; clauses
  (:export #:number-pair-p #:check-options #:check-name #:call-for-value)
  ;; attributes
  (:export #:attribute #:attribute-p #:defattribute #:define-attribute #:find-attribute
           #:all-attributes #:attribute-of #:built-in-attribute-p #:attribute-key
           #:attribute-name #:attribute-kind #:attribute-domain
           #:attribute-success #:attribute-base #:attribute-max-mult #:attribute-noticed
           #:attribute-supporters #:numeric
           #:red #:green #:blue #:violet #:lightred #:lightgreen #:lightblue #:lightviolet)
  ;; asked values
  (:export #:asking-form-p #:range-p #:value-limits #:discrete-p #:in-domain-p
           #:can-be-false-p #:asks-range-p)
  ;; substances
  (:export #:substance #:substance-p #:defsubstance #:define-substance #:find-substance
           #:all-substances #:substance-name #:substance-parameter #:substance-value-type
           #:substance-value-parameter
           #:wood #:metal #:bricks #:slate #:stone #:plaster #:glass #:cloth #:paper #:plastic)
  ;; draw functions
  (:export #:drawing-code)
  ;; map
  (:export #:map #:map-p #:map-name #:map-width #:map-height #:map-frame #:map-flags
           #:map-parameters #:map-substances #:map-substance-types #:map-places #:map-directions
           #:map-place-types #:map-least-parameter #:map-greatest-parameter #:map-enclosed
           #:map-things
           #:map-resident-world #:map-resident #:map-attribute-names #:map-package #:map-replaced
           #:map-form
           #:map-index #:point-index #:find-map #:all-maps #:map-cell #:wall-at-p
           #:+wall+ #:+obsmove+ #:+obsview+ #:+occupied+ #:+opaque+
           #:cell #:cell-p #:cell-map #:cell-x #:cell-y #:cell-filled? #:cell-type
           #:cell-substance-type #:cell-substance-parameter #:cell-occupancy-window
           #:place #:make-place #:place-p #:place-cell #:place-canonical-dir
           #:place-directions)
  ;; grid walk
  (:export #:walk-grid #:cell-number #:grid-size #:+endless+ #:+no-limit+)
  ;; place types
  (:export #:place-type #:place-type-p #:place-type-name #:place-type-rank
           #:place-type-confusion #:place-type-invisible-p #:place-type-graphics
           #:def-place-type #:define-place-type #:find-place-type #:all-place-types
           #:place-type-index #:doorway #:convex #:concave #:beak)
  (:export #:*place-types* #:*attributes* #:*substances* #:*kickers* #:*maps*)
  ;; map clauses
  (:export #:define-map-clause #:*map-clauses* #:map-clause-kinds
           #:all-clause-kinds #:clause-kind-name #:clause-kind-usage)
  ;; defmap
  (:export #:defmap #:define-map #:rebuild-map)
  ;; access
  (:export #:change-world #:changing #:writing #:writing-p #:world-writer)
  ;; location
  (:export #:location-contents #:location-position #:location-world #:location-closed-p
           #:location-full-p #:location-name #:location-words #:remaining-capacity)
  ;; thing
  (:export #:thing #:thing-p #:thing-name #:thing-serial #:thing-world #:thing-location
           #:thing-x #:thing-y #:thing-attributes #:thing-contents #:thing-kickers
           #:thing-alive-p #:thing-position #:thing-outermost #:thing-holders-text
           #:thing-total-weight
           #:thing-obsmove-p #:thing-obsview-p #:thing-closed-p #:thing-size #:thing-weight
           #:thing-capacity #:thing-substance-p #:thing-substance-parameter #:value-like)
  ;; reading-attributes, setting-attributes
  (:export #:get-attribute #:set-attribute #:change-attribute)
  ;; world
  (:export #:world #:world-p #:world-map #:world-seed #:world-flags #:do-cell #:cell-things
           #:world-rank-count #:thing-of-rank #:world-thing-list #:world-robots #:world-timeline
           #:world-dice #:world-dice-set #:world-move-watchers #:world-settled-p
           #:*world* #:current-world #:make-world #:reset-world #:seed-world #:world-has-kickers-p
           #:some-kicker #:kicker-test #:kicker-body
           #:things-at
           #:find-thing #:find-things #:do-things #:world-live-count)
  ;; forking
  (:export #:octets-of-copy)
  ;; recipes
  (:export #:doubt-idle-kickers #:recipe #:make-recipe)
  ;; placing
  (:export #:note-unknown-substance)
  (:export #:place-thing #:move-thing #:destroy-thing #:new-thing #:make-new-thing
           #:destroyed-thing #:tell-if-in-wall)
  ;; saying
  (:export #:first-time-p #:said-p #:note-looked-after #:looked-after-p
           #:warn-once #:doubt-angle)
  ;; undeclared
  (:export #:note-strange-name #:warn-of-slips)
  ;; kickers
  (:export #:kicker #:kicker-p #:kicker-name #:kicker-prob #:defkicker #:define-kicker #:find-kicker
           #:all-kickers #:set-kicker #:put-kicker #:call-put-kicker #:run-kicker
           #:run-kickers #:kick-thing
           #:find-attachment #:detached-kicker
           #:attachment #:attachment-kicker #:attachment-thing #:self)
  ;; soundness
  (:export #:check-world #:world-invariant-violations
           #:world-kicker-generation #:*kicker-generation*))
