"""The page itself: one HTML file with everything in it."""

from __future__ import annotations

import html
import json
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path

from steering_bringup.errors import BenchError
from steering_bringup.pages.figure import Figure

# The browser itself refuses whatever the page might want to load from elsewhere.
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; font-src data:"
)


@dataclass
class Page:
    """Collects parts in the order in which they are to be read."""

    title: str
    lead: str = ""
    good: bool | None = None
    subtitle: str = ""
    footer: str = ""
    _parts: list[str] = field(default_factory=list, repr=False)
    _figures: dict[str, Figure] = field(default_factory=dict, repr=False)

    def add(self, part: str | Figure) -> None:
        """Add HTML (from `parts`) or a figure."""
        if isinstance(part, Figure):
            identifier = f"figure-{len(self._figures) + 1}"
            self._figures[identifier] = part
            part = part.render(identifier)
        self._parts.append(part)

    def heading(self, text: str, explanation: str = "") -> None:
        """Start a part of the page."""
        self._parts.append(f"<h2>{html.escape(text)}</h2>")
        if explanation:
            self._parts.append(f"<p class='explanation'>{html.escape(explanation)}</p>")

    def render(self) -> str:
        """The whole file. Nothing in it is loaded from anywhere else."""
        data = {name: figure.data() for name, figure in self._figures.items()}
        # A "<" in a text could end the script element or open a comment in it.
        figures = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
        kind = {True: "good", False: "bad", None: "neutral"}[self.good]
        return "".join(
            [
                "<!doctype html><html lang='en'><head><meta charset='utf-8'>",
                f"<meta http-equiv='Content-Security-Policy' content=\"{POLICY}\">",
                "<meta name='viewport' content='width=device-width, initial-scale=1'>",
                f"<title>{html.escape(self.title)}</title>",
                "<link rel='icon' href='data:,'>",
                f"<style>{_template('report.css')}</style></head><body>",
                f"<header class='{kind}'><div class='inside'><h1>{html.escape(self.title)}</h1>",
                f"<p class='subtitle'>{html.escape(self.subtitle)}</p>",
                f"<p class='lead'>{html.escape(self.lead)}</p></div></header><main>",
                *self._parts,
                f"</main><footer>{html.escape(self.footer)}</footer>",
                f"<script>{_plot_library()}</script>" if data else "",
                f"<script>const FIGURES={figures};{_template('report.js')}</script>",
                "</body></html>",
            ]
        )

    def write(self, path: str | Path) -> Path:
        """Write the file; BenchError naming the path if that fails."""
        path = Path(path)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(self.render(), encoding="utf-8", errors="replace")
        except OSError as error:
            raise BenchError(f"page '{path}' cannot be written: {error.strerror}") from error
        return path


def _template(name: str) -> str:
    return (files("steering_bringup") / "templates" / name).read_text(encoding="utf-8")


def _plot_library() -> str:
    text = (files("plotly") / "package_data" / "plotly.min.js").read_text(encoding="utf-8")
    return text.replace("</script", "<\\/script")
