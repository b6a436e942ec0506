"""The report as text."""

from __future__ import annotations

from substructures.analysis.report.report import (
    QUANTITIES,
    SECTIONS,
    Printed,
    Report,
    percent,
    some_terms,
    told_sizes,
)
from substructures.analysis.report.statements import MARK, Statement
from substructures.printers.render import LIMIT
from substructures.printers.text import Text


def text_report(found: Report, limit: int = LIMIT) -> str:
    """Statements, sizes of terms, and the formulas. Raises TooLarge."""
    heading = found.heading
    lines = [heading.title or heading.name, "=" * len(heading.title or heading.name), ""]
    lines += [*filter(None, [heading.description]), *heading.notes]
    for about, title in SECTIONS.items():
        lines += ["", title, *(f"* {_told(each)}" for each in found.statements if each.about == about)]
    printed = {name: found.printed(name, Text, limit) for name in QUANTITIES if name in found.shown}
    lines += ["", "Sizes of terms", *_sizes(found, printed["metric"])]
    for name, p in printed.items():
        lines += ["", QUANTITIES[name], *([p.reason] if p.reason else []), p.language.render(p.listing, name).rstrip()]
    lines += ["", "Sources"]
    lines += [
        f"* {s.instance}: {s.title or s.name}. {s.source} {f'({s.license})' if s.license else ''}".rstrip()
        for s in found.sources
    ]
    return "\n".join(lines) + "\n"


def _told(each: Statement) -> str:
    """A statement and what tells more."""
    return f"{each.text} More: {each.request}" if each.request else each.text


def _sizes(found: Report, metric: Printed) -> list[str]:
    """The terms of the elements of g, largest first, with their shares."""
    sizes, reason = found.sizes(metric)
    if not sizes:
        return [f"Not told: {reason or 'all elements are one term'}."]
    lines, terms = [told_sizes(found).replace(MARK, "")], metric.terms
    for each in sizes:
        shown, rest = some_terms(each)
        lines.append(f"* g[{','.join(str(i + 1) for i in each.index)}]")
        if terms is not None:
            lines += [f"    {percent(t.share)}{' (small)' if t.is_small else ''}: {terms.text(t.term)}" for t in shown]
        lines += [f"    {rest}"] if rest else []
    return lines
