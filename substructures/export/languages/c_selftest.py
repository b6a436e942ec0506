"""The self-test of functions in C: a program that compares with reference values."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from substructures.export.exported import Exported
from substructures.export.reference import Reference
from substructures.expr.operations import flat


def selftest(exported: Exported, header: str, reference: Sequence[Reference]) -> list[str]:
    """A program that ends with 1 where a value is not the reference's."""
    real, f, wider = exported.real, "", 1.0
    if exported.precision == "single":
        f, wider = "f", 1e5
    lines = [
        f'#include "{header}"',
        "",
        "#include <math.h>",
        "#include <stddef.h>",
        "#include <stdio.h>",
        "",
    ]
    checks = [check for each in reference for check in each.checks]
    lines += _DIFFERS if checks else ()
    lines += [line.replace("REAL", real) for line in _SUM] if any(check.is_sum for check in checks) else []
    for each in reference:
        lines += ["", f"static int test_{each.number}(void)", "{", "    int wrong = 0;"]
        names = []
        for symbol, values in each.arguments.items():
            plain = ", ".join(f"{x!r}{f}" for x in values) or "0"
            one = (
                f"const {real} t = {values[0]!r}{f};"
                if symbol == "t"
                else f"static const {real} {symbol}[] = {{{plain}}};"
            )
            lines.append(f"    {one}")
            names.append(symbol)
        for k, shape in enumerate(each.shapes):
            lines.append(f"    static {real} y{k}[{max(1, prod(shape))}];")
            names.append(f"y{k}")
        lines.append(f"    {each.called}({', '.join(names)});")
        for check in each.checks:
            y, size = f"y{check.output}", prod(each.shapes[check.output])
            found = f"sum({y}, {size})" if check.is_sum else f"{y}[{flat(check.index, each.shapes[check.output])}]"
            lines.append(f'    wrong |= differs({found}, {check.value!r}, {wider * check.limit!r}, "{each.called}");')
        lines += ["    return wrong;", "}"]
    lines += ["", "int main(void)", "{", "    int wrong = 0;"]
    lines += [f"    wrong |= test_{each.number}();" for each in reference]
    return [*lines, '    if (!wrong) puts("ok");', "    return wrong;", "}", ""]


_DIFFERS = (
    "static int differs(double found, double expected, double limit, const char *what)",
    "{",
    "    if (fabs(found - expected) <= limit) return 0;",
    '    printf("%s: %.17g for %.17g\\n", what, found, expected);',
    "    return 1;",
    "}",
    "",
)
_SUM = (
    "static double sum(const REAL *values, size_t count)",
    "{",
    "    double total = 0.0;",
    "    size_t i;",
    "    for (i = 0; i < count; ++i) total += values[i];",
    "    return total;",
    "}",
)
