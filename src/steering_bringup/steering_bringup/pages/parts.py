"""Small pieces of HTML: key numbers, tables, folded parts. All text is escaped."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Card:
    """A key number. good: True or False colours it; None leaves it neutral."""

    title: str
    value: str
    unit: str = ""
    remark: str = ""
    good: bool | None = None


def cards(items: Iterable[Card]) -> str:
    """A row of key numbers."""
    return f"<div class='cards'>{''.join(_card(item) for item in items)}</div>"


def _card(item: Card) -> str:
    kind = {True: " good", False: " bad", None: ""}[item.good]
    unit = f" <span class='unit'>{html.escape(item.unit)}</span>" if item.unit else ""
    return (
        f"<div class='card{kind}'><div class='card-title'>{html.escape(item.title)}</div>"
        f"<div class='card-value'>{html.escape(item.value)}{unit}</div>"
        f"<div class='card-remark'>{html.escape(item.remark)}</div></div>"
    )


def table(head: Sequence[str], rows: Iterable[Sequence[str]], left_columns: int = 1) -> str:
    """A table; the first `left_columns` are text, the others are numbers set to the right."""

    def line(cells: Sequence[str], tag: str) -> str:
        return "".join(
            f"<{tag} class='{'text' if k < left_columns else 'number'}'>{html.escape(c)}</{tag}>"
            for k, c in enumerate(cells)
        )

    body = "".join(f"<tr>{line(row, 'td')}</tr>" for row in rows)
    return (
        f"<div class='scroll'><table><thead><tr>{line(head, 'th')}</tr></thead>"
        f"<tbody>{body}</tbody></table></div>"
    )


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph of plain text."""
    name = f" class='{kind}'" if kind else ""
    return f"<p{name}>{html.escape(text)}</p>"


def folded(title: str, content: str) -> str:
    """Content that opens on a click; `content` is HTML."""
    return f"<details><summary>{html.escape(title)}</summary>{content}</details>"
