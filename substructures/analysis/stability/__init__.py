"""States of rest, steady motions, and what happens near them.

======================  ==============================================================================================
module                  what is there
======================  ==============================================================================================
equilibria              ``equilibria``: positions of rest of a model, each with its linearisation
equilibrium_search      how they are found, of trees and of closed loops: Newton's method from many starts
linearise               ``linearise``: M, D, K, F and A, B, C, D about states, for open trees
linearise_closed        the same for closed loops, in independent coordinates
linearise_constrained   with velocity constraints, about a motion: what is ignorable, steady motions, stability
linearisation_result    ``Linearisation`` and its kinds: what linearise gives
operating_point         what linearise is given, and what both of its ways share
vibrations              modes of M x'' + D x' + K x = 0, and what they say about stability
linear_system           the first-order system about one state: which modes inputs reach and outputs see
frequency_response      ``frequency_response``: G(i w), with the poles
regulator               ``regulator``: the linear quadratic regulator about an equilibrium
root_locus              ``root_locus``: eigenvalues of an equilibrium over a parameter
steady_motions          ``steady_motions``: cyclic coordinates at constant rates, all others still, with their stability
steady_conditions       what they are asked for: rates or momenta, and what varies
steady_balls            the same with ball joints, precessions included
steady_ball_search      how these are found and linearised
steady_search           how they are found, and what linearises them
steady_families         families of them over a parameter, a rate or a momentum, and their bifurcations
energy_integrals        stability by the energy at constant other first integrals (Routh, Lyapunov)
======================  ==============================================================================================

The same as formulas: :mod:`substructures.analysis.equations.perturbation`.
"""
