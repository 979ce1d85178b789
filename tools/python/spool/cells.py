"""What a notebook shows of recordings, selections, reconstructions and results: HTML without a script, light or dark."""
from __future__ import annotations

import html
import os

import numpy as np

from . import _core
from .images import Image, figure, image_array

_MOST_SIDE = 320  # pixels of a thumbnail
_MOST_BYTES = 1 << 28  # of samples that are averaged for a thumbnail
_MOST_ROWS = 60
_CELL = "padding: .2em .7em; text-align: left; vertical-align: top; white-space: "
_TINTS = {"better": "rgba(38, 128, 214, .28)", "worse": "rgba(240, 120, 20, .3)", "holds": "rgba(38, 128, 214, .28)",
          "reversed": "rgba(240, 120, 20, .3)", "mixed": "rgba(240, 200, 20, .3)", "FAILS": "rgba(240, 120, 20, .3)"}


def recording_html(recording, facts: list, reference) -> str:
    """`facts`: rows of `spool info`; its claims behind a fold. The picture is the reference, else the mean of the samples."""
    claims = [text for what, text in facts if what == "claim"]
    rows = "".join(_row(what, _verdict(text) if what == "verified" else html.escape(text))
                   for what, text in facts if what != "claim")
    fold = "".join(f"<li>{_verdict(claim)}</li>" for claim in claims[:_MOST_ROWS])
    fold = f"<details><summary>{len(claims)} claims about the samples</summary><ul>{fold}</ul></details>" if claims else ""
    return _beside(_thumbnail(recording, reference), f"<table>{rows}</table>{fold}")


def name_of(recording) -> str:
    """Of a file without its folder."""
    return os.path.splitext(os.path.basename(recording.source.name))[0]


def density_html(selection) -> str:
    counts = np.ascontiguousarray(selection.counts, np.int64)
    log = selection.log
    rows = {"samples": f"{log['spent']} of a budget of {log['budget']}", "of a piece": f"{counts.min()} to {counts.max()}",
            "at first": log["initial"], "given evenly at the end": log["uniform_remainder"],
            "pieces that ran out of samples": log["saturated_pieces"], "seconds": f"{log['seconds']:.3g}"}
    picture = figure(_core.density_png(counts, _MOST_SIDE), html.escape(name_of(selection.recording)))
    return _beside(picture, f"<table>{''.join(_row(what, html.escape(str(text))) for what, text in rows.items())}</table>")


def reconstruction_html(made) -> str:
    has = [name for name in ("variance", "level", "dominant_direction") if getattr(made, name) is not None]
    rows = {"seconds": f"{made.seconds:.3g}", "also": ", ".join(has) or "nothing", "notes": "; ".join(made.notes) or "none"}
    return made.image.view(Image)._repr_html_() + f"<table>{''.join(_row(what, html.escape(text)) for what, text in rows.items())}</table>"


def results_html(rows: list, statistics: dict) -> str:
    """Claims, then the methods of each recording and budget; every number and verdict is one of statistics.json."""
    failed = sum(bool(row.get("error")) for row in rows)
    parts = [f"<p>{len(rows)} results" + (f", {_tinted(f'{failed} failed', 'worse')}" if failed else "") + "</p>"]
    parts += [f"<ul>{''.join(_claim(claim) for claim in statistics['claims'][:_MOST_ROWS])}</ul>"] if statistics.get("claims") else []
    conditions = [c for c in statistics["conditions"] if c["metric"] == "relmse"] or statistics["conditions"]
    if any(condition.get("biased") for condition in conditions):
        parts.append(f"<p>{_tinted('Biased: judged by the samples that the images were made of.', 'worse')}</p>")
    lines = [_ranked(condition, entry, i == 0) for condition in conditions for i, entry in enumerate(condition["ranking"])]
    if not lines:
        lines = [_alone(entry) for entry in statistics["results"]]
    metric = conditions[0]["metric"] if conditions else "relmse"
    names = ("recording", "spp", "method", metric, f"x {statistics.get('baseline', 'uniform + box')}", "", "energy")
    head = "".join(f'<th style="{_CELL}nowrap">{html.escape(name)}</th>' for name in names)
    parts.append(f'<div style="overflow-x: auto"><table><thead><tr>{head}</tr></thead><tbody>{"".join(lines[:_MOST_ROWS])}</tbody></table></div>')
    if len(lines) > _MOST_ROWS:
        parts.append(f"<p>{len(lines) - _MOST_ROWS} more rows: <code>.means</code>, or <code>spool report</code></p>")
    about = max((c["about"] for c in conditions if c.get("about")), key=lambda said: said.get("shared") or 0.0, default={"text": ""})["text"]
    parts.append(f"<p><small>Mean [95 % interval], best first. Methods that share a letter are not separated. "
                 f"Intervals are about {html.escape(about) or 'these replicates'}.</small></p>")
    return "".join(parts)


def _claim(claim):
    found = ", ".join(f"{count} {verdict}" for verdict, count in claim.get("counts", {}).items())
    words = claim.get("text") or f"{claim['better']} is better than {claim['than']}"
    return (f"<li>{_tinted(claim['verdict'], claim['verdict'])} {html.escape(words)} "
            f"<small>({html.escape(claim['better'])} against {html.escape(claim['than'])}, {html.escape(claim['metric'])}: {html.escape(found)})</small></li>")


def _ranked(condition, entry, first):
    verdict = entry.get("against_baseline", "")
    letters = f"withheld: {entry['withheld']}" if entry.get("withheld") else f"{entry.get('letters', '')} {verdict}"
    letters += "" if entry.get("compared", True) or "not compared" in letters else " not compared"
    letters += "".join(f" (about {count:.0f} {what} would decide)" for what, count in (entry.get("would_decide") or {}).items())
    energy = _numbers(entry.get("energy")) + (" (loses)" if "loses_energy" in entry else "")
    return _line(condition["dump"] if first else None, condition["spp"] if first else None, entry,
                 _numbers(entry.get("value")), _numbers(entry.get("ratio"), _ratio), letters, energy, verdict)


def _alone(entry):
    """Where nothing is ranked."""
    quantities = entry["quantities"]
    return _line(entry["dump"], entry["spp"], entry, _numbers(quantities.get("relmse")), "", "", _numbers(quantities.get("energy_ratio")), "")


def _line(dump, spp, entry, value, ratio, letters, energy, verdict):
    name = "" if dump is None else os.path.splitext(os.path.basename(dump))[0]
    cells = [name, "" if spp is None else f"{spp:g}", f"{entry['sampler']} + {entry['filter']}", value, ratio, letters, energy]
    tint = f"; background: {_TINTS[verdict]}" if verdict in _TINTS else ""
    return "<tr>" + "".join(f'<td style="{_CELL}nowrap{tint if i in (4, 5) else ""}">{html.escape(text)}</td>' for i, text in enumerate(cells)) + "</tr>"


def _number(value, digits=4):
    return f"{value:.{digits}g}"


def _ratio(value):
    """In more digits where a ratio that is not 1 would read 1: it would not agree with the verdict beside it."""
    return next((text for text in (_number(value, digits) for digits in range(4, 6)) if text != "1" or value == 1), _number(value, 6))


def _numbers(interval, number=_number):
    """"0.0260 [0.0240, 0.0281]" of [mean, low, high] or [mean]."""
    texts = ["not known" if value is None else number(float(value)) for value in interval or []]
    return f"{texts[0]} [{texts[1]}, {texts[2]}]" if len(texts) == 3 and texts[1] != "not known" else "".join(texts[:1])


def _verdict(text):
    return _tinted(text, "FAILS" if "FAILS" in text else "holds" if text.startswith("yes") or " holds:" in text else "")


def _tinted(text, verdict):
    tint = f' style="background: {_TINTS[verdict]}; padding: 0 .3em"' if verdict in _TINTS else ""
    return f"<span{tint}>{html.escape(text)}</span>"


def _row(what, text):
    return f'<tr><th style="{_CELL}nowrap">{html.escape(what)}</th><td style="{_CELL}normal; overflow-wrap: anywhere">{text}</td></tr>'


def _thumbnail(recording, reference):
    if reference is not None:
        image, caption = image_array(np.asarray(reference, np.float64), "reference"), "reference"
    elif recording.width * recording.height * recording.spp * 12 <= _MOST_BYTES:
        from .steps import reconstruct  # which needs this file
        image, caption = reconstruct(recording, None, "box"), "mean of the samples"
    else:
        return ""
    return figure(_core.tone_mapped_png(np.ascontiguousarray(image, np.float64), None, _MOST_SIDE), caption)


def _beside(picture, facts):
    return f'<div style="display: flex; flex-wrap: wrap; gap: 1em; align-items: flex-start">{picture}<div style="flex: 1 1 20em; min-width: 0; overflow-x: auto">{facts}</div></div>'
