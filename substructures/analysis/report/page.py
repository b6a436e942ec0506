"""The report as a page of XHTML: formulas in MathML, the picture in SVG; nothing is loaded or run."""

from __future__ import annotations

import re
from collections.abc import Iterable
from xml.sax.saxutils import escape

from substructures.analysis.report.report import (
    CONCLUSIONS,
    QUANTITIES,
    SECTIONS,
    Printed,
    Report,
    percent,
    some_terms,
    told_sizes,
)
from substructures.analysis.report.statements import MARK
from substructures.analysis.report.words import DERIVATION, REFERENCE
from substructures.printers.mathml import MathML
from substructures.printers.mathml_names import named
from substructures.printers.names import latex_names, latex_of
from substructures.printers.render import LIMIT

#: what scrolls sideways by itself where the screen is narrow, with the keyboard, too
WIDE = '<div class="wide" tabindex="0" role="group">'
FOLDED = 8  # steps of formulas that are shown at once
MATH = "http://www.w3.org/1998/Math/MathML"
_PAGE = """<?xml version="1.0" encoding="utf-8"?>
<html xmlns="http://www.w3.org/1999/xhtml" lang="en"><head><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta name="color-scheme" content="light dark"/><style>
body {{ max-width: 60em; margin: 2em auto; padding: 0 1em; font-family: sans-serif; line-height: 1.5; color: #1c2228; }}
h1, h2, h3 {{ line-height: 1.2; }} h2 {{ margin-top: 2em; border-bottom: 1px solid #ccd; }}
svg {{ max-width: 28em; display: block; margin: auto; }} table {{ border-collapse: collapse; }}
th {{ text-align: left; border-bottom: 1px solid #889; }} td, th {{ padding: 0.1em 1.2em 0.1em 0; }}
p, li {{ overflow-wrap: anywhere; }} math {{ font-size: 1.08em; }} .formulas p {{ line-height: 2; }}
.formulas p {{ padding-left: 2em; text-indent: -2em; }} .formulas h2 {{ display: none; }}
.share {{ white-space: nowrap; font-variant-numeric: tabular-nums; }}
.small {{ color: #667; }} @media (prefers-color-scheme: dark) {{ body {{ color: #e3e6e9; background: #14171a; }}
.small {{ color: #9aa5af; }} a {{ color: #7db9f2; }} }} nav ul {{ columns: 16em; padding-left: 1.2em; }}
summary {{ cursor: pointer; }} .formulas {{ content-visibility: auto; contain-intrinsic-size: auto 20em; }}
.wide {{ overflow-x: auto; overflow-y: hidden; }}
</style></head><body><main>
{body}
</main></body></html>
"""


def page_report(found: Report, svg: str = "", limit: int = LIMIT) -> str:
    """Title, picture (SVG as it is drawn here), coordinates, symbols, derivation, formulas, statements, sizes,
    sources. Raises TooLarge.
    """
    heading = found.heading
    title = heading.title or heading.name
    top = [f"<h1>{_e(title)}</h1>", *(f"<p>{_e(x)}</p>" for x in (heading.description, *heading.notes) if x), svg]
    lines = [*_headed("Coordinates"), *_coordinates(found), *_headed("Symbols"), *_symbols(found)]
    lines += [*_headed("Derivation"), "<details><summary>From the kinematics to the equations of motion</summary>"]
    for words, _, equation in DERIVATION:
        lines += [f"<p>{_named(words)}</p>", f'{WIDE}<math xmlns="{MATH}" display="block">{equation}</math></div>']
    lines.append("</details>")
    printed = {name: found.printed(name, MathML, limit) for name in QUANTITIES if name in found.shown}
    for name, each in printed.items():
        lines += [*_headed(QUANTITIES[name]), *(f"<p>{_e(x)}.</p>" for x in each.said)]
        lines += [f'{WIDE}<div class="formulas">', *_formulas(each), "</div></div>", *_statements(found, name)]
    for about in CONCLUSIONS:
        lines += _statements(found, about)
    lines += _sizes(found, printed["metric"])
    lines += [*_headed("Sources"), "<ul>"]
    lines += [f"<li>{_e(f'{s.instance}: {s.title or s.name}. {s.source} {s.license}')}</li>" for s in found.sources]
    lines += [f"<li>{_e(REFERENCE)}.</li></ul>"]
    return _PAGE.format(title=_e(title), body="\n".join([*top, *_contents(lines), *lines]))


def _headed(text: str) -> list[str]:
    """A heading that can be linked to."""
    return [f'<h2 id="{re.sub("[^a-z]+", "-", text.lower())}">{_e(text)}</h2>']


def _contents(lines: Iterable[str]) -> list[str]:
    """Links to the headings."""
    found = filter(None, (re.fullmatch(r'<h2 id="([a-z-]+)">(.*)</h2>', line) for line in lines))
    items = [f'<li><a href="#{each[1]}">{each[2]}</a></li>' for each in found]
    return ['<nav aria-label="Contents"><ul>', *items, "</ul></nav>"]


def _e(text: str) -> str:
    """Text that is no markup, without what XML cannot hold."""
    return escape("".join(c if c.isprintable() or c in "\n\t" else "\ufffd" for c in text))


def _named(text: str) -> str:
    """Words with names of quantities between marks."""
    return "".join(_math(named(latex_of(x))) if n % 2 else _e(x) for n, x in enumerate(text.split(MARK)))


def _math(inner: str) -> str:
    return f'<math xmlns="{MATH}"><mrow>{inner}</mrow></math>'


def _formulas(each: Printed) -> list[str]:
    if not isinstance(each.language, MathML):
        raise TypeError("MathML is expected")
    steps, elements = each.language.steps(each.listing), each.language.elements(each.listing)
    if len(steps) > FOLDED:
        steps = [f"<details><summary>{len(steps)} steps, with which it is written</summary>", *steps, "</details>"]
    return [*steps, *elements]


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    """A table of cells that are markup."""
    found = ["".join(f"<td>{cell}</td>" for cell in row) for row in rows]
    top = "".join(f"<th>{_e(each)}</th>" for each in head)
    body = [f"<tr>{row}</tr>" for row in found]
    return [f"{WIDE}<table><thead><tr>{top}</tr></thead><tbody>", *body, "</tbody></table></div>"]


def _coordinates(found: Report) -> list[str]:
    written = latex_names(each.called for each in found.coordinates)
    rows = []
    for latex, each in zip(written, found.coordinates, strict=True):
        ends = [f"{x:.4g}" if x is not None else "..." for x in (each.low, each.high)]
        limits = "" if each.low is each.high is None else f"{ends[0]} to {ends[1]}"
        rows.append((_name(latex, each.called), _e(each.name), each.joint, each.unit, limits))
    return _table(("symbol", "name", "joint", "unit", "limits"), rows)


def _symbols(found: Report) -> list[str]:
    written = latex_names(each.called for each in found.symbols)
    rows = []
    for latex, each in zip(written, found.symbols, strict=True):
        value = "" if each.value is None else f"{each.value:.6g}"
        cells = _e(each.name), each.kind, _unit(each.unit), value, _e(each.description)
        rows.append((_name(latex, each.called), *cells))
    return _table(("symbol", "name", "kind", "unit", "value", "meaning"), rows)


def _unit(text: str) -> str:
    """A unit: kg m^2 with a raised 2, for kg*m^2."""
    return re.sub(r"\^(-?[0-9]+)", r"<sup>\1</sup>", _e(text)).replace("*", "\u00a0")


def _name(latex: str, called: str) -> str:
    return _math(f"<mtext>{_e(called)}</mtext>" if latex.startswith(r"\mathtt") else named(latex))


def _statements(found: Report, about: str) -> list[str]:
    said = [
        f"<li>{_named(each.marked)}{f' More: <code>{_e(each.request)}</code>' if each.request else ''}</li>"
        for each in found.statements
        if each.about == about
    ]
    return [f"<h3>{_e(SECTIONS[about])}</h3><ul>", *said, "</ul>"] if said else []


def _sizes(found: Report, metric: Printed) -> list[str]:
    sizes, reason = found.sizes(metric)
    lines = _headed("Sizes of the terms of the mass matrix")
    if not sizes or metric.terms is None:
        return [*lines, f"<p>Not told: {_e(reason or 'all elements are one term')}.</p>"]
    lines.append(f"<p>{_named(told_sizes(found))}</p>")
    for each in sizes:
        shown, rest = some_terms(each)
        index = ",".join(str(i + 1) for i in each.index)
        lines.append(f"<h3>{_math(f'<msub><mi>g</mi><mn>{index}</mn></msub>')}</h3>")
        rows = []
        for t in shown:
            share = f'<span class="share">{_e(percent(t.share))}{" (small)" if t.is_small else ""}</span>'
            rows.append((share, metric.language.finished(metric.terms.text(t.term))))
        lines += _table(("largest share", "term"), rows)
        lines += [f'<p class="small">{_e(rest)}.</p>'] if rest else []
    return lines
