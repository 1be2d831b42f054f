;;;; ars-magna.asd -- the systems and the order in which their layers load.

(defsystem "ars-magna"
  :description "An abstract robot simulator for people who build reactive planners."
  :version "1.0.0"
  :license "MIT"
  :depends-on ("alexandria" "bordeaux-threads" "named-readtables")
  :serial t
  :components
  ((:module "src/base" :serial t
    :components ((:file "package") (:file "policy") (:file "conditions")
                 (:file "threads") (:file "dice") (:file "names")
                 (:file "messages") (:file "user-code")
                 (:file "parameters") (:file "physics") (:file "digest"))))
  :in-order-to ((test-op (test-op "ars-magna/tests"))))
