"""The self-test of the module of WebAssembly: a program for Node."""

from __future__ import annotations

import json

from substructures.export.exported import Exported
from substructures.export.reference import reference

_CHECK = """
let wrong = false;
function check(found, expected, limit, what) {
    if (Math.abs(found - expected) <= limit) return;
    console.log(what, found, "for", expected);
    wrong = true;
}
const sum = (values) => values.reduce((a, b) => a + b, 0);
const made = await load();
"""


def selftest(exported: Exported) -> str:
    """It ends with 1 where a value is not the reference's."""
    lines = [f'import {{ load }} from "./{exported.name}.mjs";', _CHECK]
    for each in reference(exported):
        given = [json.dumps(values[0] if s == "t" else list(values)) for s, values in each.arguments.items()]
        names = list(exported.functions[each.number].program.outputs)
        lines += ["{", f"    const y = made.{each.called}({', '.join(given)});"]
        for check in each.checks:
            place = 0
            for i, size in zip(check.index, each.shapes[check.output], strict=False):
                place = place * size + i
            y = f"y[{json.dumps(names[check.output])}]" if len(names) > 1 else "y"
            found = f"sum({y})" if check.is_sum else f"{y}[{place}]"
            lines.append(f"    check({found}, {check.value!r}, {check.limit!r}, {json.dumps(each.called)});")
        lines.append("}")
    return "\n".join([*lines, 'if (wrong) process.exit(1); else console.log("ok");', ""])
