"""A model told in words and formulas: what depends on what, what is conserved, how large terms are.

==============  ====================================================================================================
statements      ``metric_statements``, ``christoffel_statements``, ``force_statements``, ``symmetry_statements``
rest            ``rest_statements``: positions of rest, whether they are stable and why, vibrations beside them
influence       ``influence_statements``: which parameters move frequencies, metric and potential most
omission        ``omission_statements``: which parameters may be zero, and how wrong energy and forces are then
singular        ``singular_statements``: where the metric is singular, and which rates move no mass
sizes           which share of an element the terms of its textbook form have over sampled states
report          ``report``: all of it, with coordinates, symbols, sources
text, latex     ``text_report``, ``latex_report``: as text, and as a document that plain LaTeX compiles
page            ``page_report``: as a page of XHTML with MathML and the picture
==============  ====================================================================================================
"""
