"""The look of the page."""

STYLE = (
    "body{margin:0;color:#1b2530;background:#f6f7f9;"
    "font:15px/1.5 'Segoe UI',system-ui,-apple-system,Arial,sans-serif}"
    "header,main{max-width:960px;margin:auto;padding:16px 24px}"
    "header{border-left:6px solid #d58a00;background:#fff}header.good{border-color:#2e7d4f}"
    "h1{font-size:24px;margin:6px 0}h2{font-size:18px;margin:30px 0 6px}.lead{font-size:17px}"
    ".more{color:#5b6876}.wide{overflow-x:auto}"
    "table{border-collapse:collapse;background:#fff;width:100%}"
    "th,td{border-bottom:1px solid #e6eaef;padding:5px 9px;text-align:left;vertical-align:top}"
    "th{color:#5b6876;font-weight:600}.n{text-align:right;white-space:nowrap}"
    "figure{margin:12px 0;background:#fff;padding:6px}svg{display:block;width:100%}"
    "svg .g{stroke:#e6eaef;fill:none}svg .c{fill:none;stroke-width:1.3}"
    "svg text{font-size:12px;fill:#5b6876}svg text.t{font-size:13px;fill:#1b2530}"
    "svg text.m{text-anchor:middle}svg text.e{text-anchor:end}"
    "dt{font-weight:600}dd{margin:0 0 6px 0}code{overflow-wrap:anywhere}"
    "@media print{body{background:#fff}figure{break-inside:avoid}}"
)
