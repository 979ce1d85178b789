"""Puts a report together: one HTML file that needs nothing else and may load nothing else.

The policy allows the page's own scripts by their hashes and no connection; whatever a file name
holds, it arrives as text, and none of its marks turns the numbers beside it around.
"""

import base64
import hashlib
import json
from html import escape

from tools.report.assets import ASSETS, HERE, load_asset

VIEWER_SCRIPTS = ("image_codec.js", "picture_store.js", "colour_scales.js", "viewer.js", "viewer_panes.js",
                  "viewer_insets.js", "viewer_controls.js", "viewer_pointers.js", "pixel_panel.js")
OWN_SCRIPTS = ("charts.js", "export_buttons.js", "headline.js", "crop_strip.js", "result_table.js", *VIEWER_SCRIPTS,
               "footprint.js", "live.js")


WITHOUT_SCRIPTS = "Charts, table and images need JavaScript; the summary and the details of the run do not."


# As lib/core/visible_text.h: controls, marks of direction, separators of lines.
HIDDEN = {c: f"\\u{c:04x}" for r in ((0, 0x20), (0x7F, 0xA0), (0x61C, 0x61D), (0x200E, 0x2010), (0x2028, 0x202F), (0x2066, 0x206A),
                                     (0xFEFF, 0xFF00)) for c in range(*r)} | {ord(c): repr(c)[1:-1] for c in "\n\r\t"}
HIDDEN_IN_HTML = {c: shown for c, shown in HIDDEN.items() if chr(c) not in "\n\r\t"}


def visible(value):
    """What JSON holds, its texts with escapes for what they hide; names that are compared with the program's stay equal to them."""
    if isinstance(value, str):
        return value.translate(HIDDEN)
    if isinstance(value, dict):
        return {visible(key): visible(item) for key, item in value.items()}
    return [visible(item) for item in value] if isinstance(value, (list, tuple)) else value


def json_for_html(value):
    """No '<' survives, so that nothing in a string ends the element it stands in."""
    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def script_for_html(source):
    """JavaScript without the two texts that change how HTML reads a script element."""
    for text in ("</script", "</SCRIPT", "</Script"):
        source = source.replace(text, "<\\/" + text[2:])
    return source.replace("<!--", "<\\!--")


def build_page(title, sections, data, packed, served=False, viewer_only=False):
    """`sections`: [(id, heading, HTML)], in order. `served`: by spool view, which the page may ask. `viewer_only`: pictures,
    and no script of others."""
    scripts = [] if viewer_only else [script_for_html(load_asset(asset.script)) for asset in ASSETS]
    names = ("report_data.js", *(VIEWER_SCRIPTS if viewer_only else OWN_SCRIPTS), "page_start.js")
    own = "\n".join((HERE / name).read_text(encoding="utf-8") for name in names)
    scripts.append(script_for_html(f"(() => {{\n'use strict';\n{own}\n}})();"))
    hashes = " ".join(f"'sha256-{_hash(script)}'" for script in scripts)
    policy = (f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; "
              "img-src data: blob:; base-uri 'none'; form-action 'none'"
              + ("; connect-src 'self'" if served else ""))
    style = (HERE / "style.css").read_text(encoding="utf-8")
    links = "".join(f'<a href="#{id_}">{escape(heading)}</a>' for id_, heading, _ in sections if heading)
    body = "".join(f'<section id="{id_}">{f"<h2>{escape(heading)}</h2>" if heading else ""}{html}</section>\n'
                   for id_, heading, html in sections)
    title, body = visible(title), body.translate(HIDDEN_IN_HTML)
    images = "".join(f'<script type="text/plain" id="image-{i}">{image.text}</script>\n'
                     for i, image in enumerate(packed))
    tags = "".join(f"<script>{script}</script>\n" for script in scripts)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>{escape(title or 'Spool')}</title>\n<style>{style}</style>\n</head>\n<body>\n"
        + (f'<header><h1>{escape(title)}</h1><nav aria-label="Sections">{links}</nav></header>\n' if title else "") +
        f'<noscript><p class="warning">{WITHOUT_SCRIPTS if links else "Images need JavaScript."}</p></noscript>\n'
        f"<main>\n{body}</main>\n"
        f'<script type="application/json" id="report-data">{json_for_html(visible(data))}</script>\n'
        f"{images}{tags}</body>\n</html>\n")


def scrolled_table(kind, heads, rows, caption=""):
    """A table of this class ("": none) that scrolls by itself; `heads`, `caption` and `rows` are HTML."""
    named = f' class="{kind}"' if kind else ""
    head = "".join(f'<th scope="col">{text}</th>' for text in heads)
    return f'<div class="scroll" tabindex="0"><table{named}>{caption}<thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table></div>'


def _hash(script):
    return base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")


def licences_html():
    parts = [f"<h4>{escape(asset.name)}, from {escape(asset.source)}: MIT License</h4><pre>{escape(load_asset(asset.licence))}</pre>"
             for asset in ASSETS]
    return f'<details class="licences"><summary>Licences</summary>{"".join(parts)}</details>'
