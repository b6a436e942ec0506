"""Sweeps: many combinations of parts and numbers of one tree, evaluated as parameter sets of few programs.

:mod:`.document` is what is asked for, :mod:`.plan` numbers its rows, :mod:`.shapes` couples each shape of tree once,
:mod:`.columns` and :mod:`.conditions` are what a row is worth and whether it fits, :mod:`.front` which rows nothing
beats, :mod:`.block` puts them together for a range of rows.
"""
