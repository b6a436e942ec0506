"""Which way to the numbers of a tree is the quickest: coupling its parts, interpreting its formulas, compiling them.

Measured by ``benchmarks.first_answer`` (AMD Zen 3, one thread), for metric and forces of 6 + 6 and of 34 dof:

==============  ==================================================================================================
kernel          about 40 us for every operation, once; then 0.2 to 2 us a state
interpreter     1.4 us for every operation and call, and 3 to 5 ns for every operation and state; needs the coupled
                formulas (20 to 200 ms when they are not there)
parts           2 to 8 ms a call and 8 to 25 us a state; needs kernels of the parts and nothing of the tree. For one
                state, over floats, 1.2 to 3.4 times as fast as the interpreter; for batches about as fast
==============  ==================================================================================================

Both ways without a kernel grow with the same numbers, operations and states, as compiling does with operations alone.
So where compiling pays off depends on the number of states only: from about 10^4 on, whatever the tree.
"""

from __future__ import annotations

from enum import StrEnum

#: from this many states on compiling first is quicker
AT_ONCE = 8192


class Way(StrEnum):
    """How numbers are found."""

    PARTS = "parts"
    INTERPRETER = "interpreter"
    KERNEL = "kernel"


def quickest(states: int, coupled: bool, warm: bool) -> Way:
    """The way for this many states of a tree without a kernel of its own.

    ``coupled``: its formulas are there; ``warm``: the kernels of its parts are.
    """
    if states >= AT_ONCE:
        return Way.KERNEL
    if coupled and not (warm and states == 1):
        return Way.INTERPRETER
    return Way.PARTS
