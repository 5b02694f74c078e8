"""The report as one HTML page that opens offline."""

from steering_diagnosis.pages.page import diagnosis_page, write_page

__all__ = ["diagnosis_page", "write_page"]
