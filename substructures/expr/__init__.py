"""Scalar expressions: a hash-consed graph, programs, parser, evaluators. Knows no mechanics."""
