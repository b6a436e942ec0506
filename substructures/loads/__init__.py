"""Loads of parts and of trees: one law a file, its documents, its forces and its potential (notation.md, section 7).

===========  =======================================================================================================
document     what a load is: a document of which a law is read, which adds its forces and its potential; the frames of
             documents, of parts and of trees
names        where loads are read and act: names in expressions, frames, coordinates; one class each for a part, a
             tree, and a part in its place in a tree
measures     distances and angles of two frames, which laws may name
pairs        what a force or a moment between two frames does to every coordinate
scope        numbers and expressions of documents
units        dimensions of their places
kinds        all types of loads, of parts and of trees
===========  =======================================================================================================

Every other file is a law (``vectors``: forces and torques); a new one is a file, and a line in :mod:`.kinds`.
"""
