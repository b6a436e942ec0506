"""Ensembles: motions of one model from many starts, with many parameters, each integrated and judged by itself."""
