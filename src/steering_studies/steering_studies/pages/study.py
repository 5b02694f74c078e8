"""The page of a study: answer, tables, figures, notes."""

from __future__ import annotations

from steering_bringup.pages import Page, folded, paragraph, table
from steering_studies.beyond.study import Answer, Study

LONG = 15
"""Rows beyond which a table comes last, folded."""


def study_page(study: Study, answer: Answer) -> Page:
    """Return the page."""
    page = Page(
        title=study.name.replace("_", " ").capitalize(),
        subtitle=study.question,
        lead=answer.sentence,
        footer="This page needs no network.",
    )
    short = [made for made in answer.tables if len(made.rows) <= LONG]
    for made in short:
        page.add(table(made.head, made.rows))
    for figure in answer.figures:
        page.add(figure)
    for made in answer.tables:
        if made not in short:
            page.add(folded(f"{made.head[0]}: {len(made.rows)}", table(made.head, made.rows)))
    for note in answer.notes:
        page.add(paragraph(note, "note"))
    return page
