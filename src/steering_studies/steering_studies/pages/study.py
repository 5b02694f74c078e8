"""The page of a study: answer, tables, figures."""

from __future__ import annotations

from steering_bringup.pages import Page, paragraph, table
from steering_studies.beyond.study import Answer, Study


def study_page(study: Study, answer: Answer) -> Page:
    """Return the page."""
    page = Page(
        title=study.name.replace("_", " ").capitalize(),
        subtitle=study.question,
        lead=answer.sentence,
        footer="This page needs no network.",
    )
    for made in answer.tables:
        page.add(table(made.head, made.rows))
    for figure in answer.figures:
        page.add(figure)
    for note in answer.notes:
        page.add(paragraph(note, "note"))
    return page
