"""SymPy in and out: formulas as SymPy expressions, expressions as texts of documents, mechanisms of sympy.physics.

===========  =======================================================================================================
module       what is there
===========  =======================================================================================================
expressions  ``to_sympy``: quantities of models, outputs of parts and programs as exact matrices and arrays
texts        ``from_sympy``: an expression as the text that definitions, loads and inputs take
equations    ``symbolic_system``, ``linearizer``: the equations of a model for users of sympy.physics.mechanics
systems      ``tree_of_system``: a System of rigid bodies on joints of one degree of freedom as a tree
===========  =======================================================================================================

SymPy: A. Meurer et al., SymPy: symbolic computing in Python, PeerJ Computer Science 3 (2017) e103.
"""
