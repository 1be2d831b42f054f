;;;; abuse.lisp -- nothing that users or files say breaks the simulator, or makes data run.

(in-package :ars-magna.tests)

(def-suite* abuse :in ars-magna)
