"""Which inertial parameters a motion depends on, and their values from measurements.

===============  =====================================================================================================
module           what is there
===============  =====================================================================================================
base_parameters  ``base_parameters``: the combinations of inertial parameters that inverse dynamics depends on, exactly
grouped          ``grouped_model``: the equations of motion in symbols for these, with their definitions
fit              ``excitation`` and ``identify``: how well a motion shows them, and their values from measured motions
on_closures      ``Loops``: which combinations of parameters closed motions tell
on_constraints   ``Rolled``: the same with velocity constraints
findings         what these find
consistent       ``consistent_inertia``: inertia of every body that belongs to a distribution of mass
new_versions     parts with this inertia, as a library stores them
===============  =====================================================================================================
"""
