"""The site builds without a warning: every link and anchor of every page leads somewhere, and every page of the menu is there."""
import os
import re
import subprocess
from pathlib import Path

import pytest

TREE = Path(__file__).resolve().parents[2]
VENV = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "spool/docs-venv/bin"


@pytest.fixture(scope="module")
def site():
    assert (VENV / "mkdocs").is_file(), "no MkDocs: tools/dev.sh setup docs"
    done = subprocess.run([TREE / "tools/dev.sh", "docs"], cwd=TREE, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return TREE / "build/docs/site"


def test_it_opens_from_a_folder_with_search_and_nothing_of_the_network(site):
    start = (site / "index.html").read_text(encoding="utf-8")
    assert "search/search_index.js" in start or (site / "search/search_index.js").is_file()
    fetched = re.findall(r'<(?:script|link|img)[^>]+(?:src|href)="(https?://[^"]+)"', start)
    assert [url for url in fetched if "canonical" not in url] == []


def test_the_headers_are_in_it(site):
    assert "load_recording" in (site / "reference/load__recording_8h.html").read_text(encoding="utf-8")
    text = (site / "reference/load__recording_8h.html").read_text(encoding="utf-8")
    assert "The file stays mapped while the recording lives" in text


def test_every_page_of_docs_is_in_it(site):
    missing = [page.name for page in (TREE / "docs").glob("*.md")
               if not (site / "docs" / page.with_suffix(".html").name).is_file() and page.name != "README.md"]
    assert missing == []


@pytest.mark.parametrize("right, wrong", [("(own_metric.md)", "(own_metrik.html)"), ("sampling-costs)", "sampling-kosts)")])
def test_a_dead_link_or_anchor_stops_the_build(site, right, wrong):
    page = site.parent / "pages/docs/tutorial.md"
    text = page.read_text(encoding="utf-8")
    assert right in text
    page.write_text(text.replace(right, wrong), encoding="utf-8")
    done = subprocess.run([VENV / "python", "-m", "mkdocs", "build", "--strict", "-f", TREE / "tools/docs/mkdocs.yml", "-d", site.parent / "wrong"],
                          capture_output=True, text=True, check=False)
    page.write_text(text, encoding="utf-8")
    assert done.returncode != 0 and wrong.strip("()") in done.stdout + done.stderr


def test_pictures_of_the_pages_are_in_it(site):
    assert (site / "docs/images/method/density.png").is_file() and (site / "docs/results/experiments/e3_samplers_over_budget_claims.csv").is_file()
    assert "multiscale is below uniform in MSE" in (site / "docs/results/claims.html").read_text(encoding="utf-8")
    curves = (site / "docs/results/curves.html").read_text(encoding="utf-8")
    drawn = re.findall(r'src="(curves/[^"]+\.svg)"', curves)
    cells = re.findall(r'href="(cells/[^"]+\.csv)"', curves)
    assert len(drawn) > 10 and len(cells) > 40 and all((site / "docs/results" / file).is_file() for file in drawn + cells)
