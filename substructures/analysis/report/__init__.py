"""A model told in words and formulas: what depends on what, what is conserved, how large terms are.

==============  ====================================================================================================
statements      ``metric_statements``, ``christoffel_statements``, ``force_statements``, ``symmetry_statements``
sizes           which share of an element the terms of its textbook form have over sampled states
report          ``report``: all of it, with coordinates, symbols, sources
text, latex     ``text_report``, ``latex_report``: as text, and as a document that plain LaTeX compiles
page            ``page_report``: as a page of XHTML with MathML and the picture
==============  ====================================================================================================
"""
