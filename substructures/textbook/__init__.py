"""Formulas as a person writes them: collected, factored, cancelled, in a fixed order; one function, one form.

An element of an output is a rational function of parameters, velocities, and cosines and sines of angles. Its form
follows from the function alone, never from how it was computed:

1. :mod:`~substructures.textbook.field` cancels rational functions, in tangents of half angles over the rationals;
2. :mod:`~substructures.textbook.harmonics` finds the shortest products of powers of cosines and sines, or sums of
   angles, of what every monomial of parameters is multiplied by;
3. :mod:`~substructures.textbook.collect` gathers parameters: masses by what they are multiplied with;
4. :mod:`~substructures.textbook.layout` puts both together, and :mod:`~substructures.textbook.quotients` factors what
   is divided (:mod:`~substructures.textbook.contents`), with numbers as they were given
   (:mod:`~substructures.textbook.scales`), leaves determinants as products but for one term
   (:mod:`~substructures.textbook.products`), and multiplies forces, not their terms
   (:mod:`~substructures.textbook.forces`);
5. :mod:`~substructures.textbook.springs` finds squares of lengths that are stretched, and their forces;
6. :mod:`~substructures.textbook.tidy` takes common factors out of short sums;
7. :mod:`~substructures.textbook.reading` does it for all outputs of a program.

A form equals the stored formula wherever both have values: common factors of numerator and denominator are gone.
"""

from __future__ import annotations

from substructures.textbook.forms import Sum, Term, Trig
from substructures.textbook.reading import AT_ONCE, LIMITS, Limits, Reading, read

__all__ = ["AT_ONCE", "LIMITS", "Limits", "Reading", "Sum", "Term", "Trig", "read"]
