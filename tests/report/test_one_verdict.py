"""One verdict: the terminal, the report's sentences, tables, ranks and charts say of every pair what statistics.json says.

The methods of two plans of the tree, on small recordings. Then the file is changed at random: what follows it prints,
what does not computes on its own.
"""
import html
import json
import os
import random
import re
import subprocess
import tomllib
from pathlib import Path

import pytest

from tools.report.report import main
from tools.report.statistics_file import hide_crowded_letters

PROGRAM = os.environ.get("SPOOL_PROGRAM", "spool")
PLANS = Path(__file__).resolve().parents[2] / "tools" / "plans"
BASELINE = "uniform + box"
AGAINST = {"better": "worse than", "worse": "better than", "undecided": "not separated from", "identical": "identical to",
           "not compared": "not compared with"}
CLAIMS = ['[[claim]]', 'text = "<the> method lowers MSE"', 'better = "multiscale + directional"', 'than = "uniform + box"', 'metric = "mse"',
          '[[claim]]', 'better = "uniform + box"', 'than = "multiscale + box"', 'spp = 4', 'below = 0.1']


def run(*arguments, codes=(0,)):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=1800)
    assert done.returncode in codes, done.stderr
    return done.stdout


def entries(plan, kind):
    names = [f'{kind}s = {json.dumps(plan[kind + "s"])}']
    tables = ["\n".join([f"[[{kind}]]", *(f"{k} = {json.dumps(v)}" for k, v in table.items())])
              for table in plan.get(kind, [])]
    return names, tables


@pytest.fixture(scope="module", params=["quick", "methods"])
def evaluated(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    plan = tomllib.loads((PLANS / f"{request.param}.toml").read_text())
    scenes = ["scene_s", "fireflies"][:2 if request.param == "quick" else 1]
    for scene in scenes:
        run("synth", scene, "--size", "16", "--samples", "32", "--seed", "3", "-o", folder / f"{scene}.spool", "-q")
    lists, tables = zip(*(entries(plan, kind) for kind in ("sampler", "filter")))
    text = "\n".join([f"recordings = {json.dumps([f'{scene}.spool' for scene in scenes])}", f"spp = {[4, 8][:len(scenes)]}",
                      "replicates = 8", "pictures = false", *sum(lists, []), *sum(tables, []), "[metrics]",
                      'perceptual = "none"', *CLAIMS])
    (folder / "plan.toml").write_text(text)
    # 1: a few pairs of methods do not go together, which the table says.
    assert run("evaluate", folder / "plan.toml", "-o", folder / "results", "-q", codes=(0, 1)) == ""
    table = run("evaluate", "--statistics-only", folder / "results")
    return folder / "results", table


def read(folder):
    return json.loads((folder / "statistics.json").read_text())


def name_of(entry):
    return f"{entry['sampler']} + {entry['filter']}"


def stem(entry):
    return Path(entry["dump"]).stem


def plain(markup):
    return html.unescape(re.sub(r"<[^>]*>", "", markup)).replace(" [R]", "")


def letters_of(text):
    return set(re.findall(r"[a-z]\d*", text))


def test_letters_say_every_pair(evaluated):
    told, alike = 0, 0
    for condition in read(evaluated[0])["conditions"]:
        for a, b, _, _, _, p, verdict in condition.get("pairs", []):
            first, second = condition["ranking"][a], condition["ranking"][b]
            shared = bool(letters_of(first["letters"]) & letters_of(second["letters"]))
            assert shared == (verdict in ("undecided", "identical")), (name_of(first), name_of(second))
            assert (verdict in ("better", "worse")) == (p < 0.05)
            told, alike = told + (not shared), alike + shared
            # What the words against the best and the baseline say is the same again.
            if a == 0:
                assert second["against_best"] == {"better": "worse", "worse": "better"}.get(verdict, verdict)
            for mine, other, said in ((first, second, verdict),
                                      (second, first, {"better": "worse", "worse": "better"}.get(verdict, verdict))):
                if name_of(other) == BASELINE:
                    assert mine["against_baseline"] == said
    assert told > 20 and alike > 20


def test_the_terminal_says_it(evaluated):
    folder, table = evaluated
    place, shown = None, {}
    for line in table.splitlines():
        if match := re.fullmatch(r"(\S+), ([\d.]+) samples per pixel", line):
            place = match[1], float(match[2])
        elif place and line.startswith("  "):
            method, *_, said = re.split(r"  +", line.strip())
            shown[(*place, method.replace(" [R]", ""))] = said
    checked = 0
    for condition in read(folder)["conditions"]:
        if condition["metric"] != "relmse":
            continue
        for entry in condition["ranking"]:
            withheld = {"withheld", "baseline_withheld"} & set(entry)
            words = "(baseline)" if name_of(entry) == BASELINE else "no verdict" if withheld else entry["against_baseline"]
            found = shown.get((stem(condition), condition["spp"], name_of(entry)))
            if found is not None:  # very long tables are cut
                assert found == words
                checked += 1
    assert checked >= 10
    answer, kept = json.loads(run("evaluate", "--statistics-only", folder, "--json")), read(folder)
    listed = answer["results"]
    assert answer["claims"] == kept["claims"] and answer["baseline"] == kept["baseline"]
    assert [about["text"] for about in answer["about"]] == [c["about"]["text"] for c in kept["conditions"] if "pairs" in c]
    for condition in kept["conditions"]:
        for entry in condition["ranking"]:
            if condition["metric"] in ("mse", "relmse"):
                one = next(x for x in listed if (x["dump"], x["spp"], name_of(x)) ==
                           (condition["dump"], condition["spp"], name_of(entry)))
                ranks = one["ranks"][condition["metric"]]
                assert ranks["letters"] == entry["letters"]
                assert ranks.get("against_baseline") == entry.get("against_baseline")
                assert [ranks.get(why) for why in ("withheld", "baseline_withheld")] == [entry.get(why) for why in ("withheld", "baseline_withheld")]


def test_claims_are_the_same_everywhere(evaluated):
    folder, table = evaluated
    claims = read(folder)["claims"]
    assert len(claims) == 2 and claims[0]["text"] == "<the> method lowers MSE" and not any("after_results" in c for c in claims)
    shown = re.findall(r"^claim: (.*): ([a-z ]+)$", table, re.M)
    assert shown == [(c["text"], c["verdict"]) for c in claims]
    places = [re.fullmatch(r"  (\S+) ([\d.]+) spp: ([a-z ]+?)( [\d.]+ \[.*\])?", line) for line in table.split("\n\n")[0].splitlines()
              if line.startswith("  ")]
    assert [(m[1], float(m[2]), m[3]) for m in places] == [(stem(p), p["spp"], p["verdict"]) for c in claims for p in c["places"]]
    found = json.loads(run("compare", folder, folder, "--json"))["claims"]
    assert found == [{"text": c["text"], "before": c["verdict"], "after": c["verdict"]} for c in claims]
    assert f"claim: {claims[1]['text']}: {claims[1]['verdict']}\n" in run("compare", folder, folder)


def check_claims(text, claims):
    blocks = re.findall(r'<details class="claim [^"]*"><summary><b>([^<]*)</b> (.*?) <small>.*?<tbody>(.*?)</tbody>', text, re.S)
    assert [(verdict, plain(words)) for verdict, words, _ in blocks] == [(c["verdict"], c["text"]) for c in claims]
    for (_, _, body), claim in zip(blocks, claims):
        rows = [[plain(cell) for cell in re.findall("<t[dh][^>]*>(.*?)</t[dh]>", row)] for row in re.findall("<tr>(.*?)</tr>", body)]
        assert [(r[0], float(r[1]), r[3]) for r in rows] == [
            (stem(p), p["spp"], p["verdict"] + (f": {p['withheld']}" if "withheld" in p else "")) for p in claim["places"]]


def check_report(folder, page):
    """Every surface of the page against the file that lies in the folder."""
    assert main([str(folder), "-o", str(page), "--force"]) == 0
    text = page.read_text(encoding="utf-8")
    data = json.loads(text.split('id="report-data">')[1].split("</script>")[0])
    statistics = read(folder)
    for condition in statistics["conditions"]:
        hide_crowded_letters(condition["ranking"])
    conditions = [c for c in statistics["conditions"] if c["metric"] == "relmse"]
    check_claims(text, statistics["claims"])
    charted = {(data["dumps"][c["dump"]], c["spp"],
                f"{data['samplers'][c['sampler']]} + {data['filters'][c['filter']]}".replace(" [R]", "")): c["ranks"]
               for c in data["combinations"]}
    for condition in statistics["conditions"]:
        for entry in condition["ranking"]:
            found = charted[stem(condition), condition["spp"], name_of(entry)][condition["metric"]]
            assert found == [entry["letters"], entry.get("against_baseline", "")]
    blocks = re.findall(r"<details[^>]*><summary>([^<]*) at ([\d.]+) spp.*?<tbody>(.*?)</tbody>",
                        text.split("<h3>Ranks</h3>")[1], re.S)
    assert len(blocks) == len(conditions)
    for (name, spp, body), condition in zip(blocks, conditions):
        assert (name, float(spp)) == (stem(condition), condition["spp"])
        for row, entry in zip(re.findall("<tr>(.*?)</tr>", body), condition["ranking"]):
            letters, method, _, _, against, _ = re.findall("<t[dh][^>]*>(.*?)</t[dh]>", row)
            assert plain(method.split("<small>")[0]) == name_of(entry)
            withheld = f"no verdict: {entry['withheld']}" if "withheld" in entry else ""
            assert plain(letters) == (withheld or entry["letters"] or ("" if entry["compared"] else "not compared"))
            assert plain(against.split("<small>")[0]) == entry.get("against_baseline", "")
            more = [f"about {count:.2g} {unit}" for unit, count in entry.get("would_decide", {}).items()]
            assert plain(against).count("would decide") == len(more)
            assert ("loses" in method) == ("loses_energy" in entry)
    check_sentences(plain(text.split('id="charts"')[0]), conditions)
    check_table(text, statistics)


def check_sentences(text, conditions):
    for condition in conditions:
        where = f"{stem(condition)} at {condition['spp']:g} spp: "
        best, rest = condition["ranking"][0], condition["ranking"][1:]
        # A result that failed there is told before, in the same words.
        sentence = next(s for s in text.split(where)[1:] if s.startswith(name_of(best))).split(" spp: ")[0]
        said = {}
        for entry in rest:
            said.setdefault(entry.get("against_best", "not compared"), []).append(entry)
        alone = any(e["compared"] for e in rest) and all(
            e["against_best"] == "worse" if e["compared"] else e["value"][0] >= best["value"][0] for e in rest)
        assert ("has the lowest error" in sentence) == alone
        for word, entries in said.items():
            if alone and word == "worse":
                continue
            clause = next(part for part in sentence.split("; ") if part.startswith(AGAINST[word]))
            for entry in entries if len(entries) <= 6 else entries[:5]:
                assert name_of(entry) in clause
            assert len(entries) <= 6 or f"{len(entries) - 5} more" in clause
        assert ("times the error of" in sentence) == (best.get("against_baseline") == "better")


def check_table(text, statistics):
    found = re.search('<table class="verdicts">(.*?)</table>', text, re.S).group(1)
    budgets = [float(b) for b in re.findall(r'scope="col">([\d.]+) spp', found)]
    for row in re.findall("<tr>(<th scope=\"row\">.*?)</tr>", found):
        method = plain(re.search("<th[^>]*>(.*?)</th>", row).group(1))
        for spp, (kind, cell) in zip(budgets, re.findall(r'<td class="(\w+)">(.*?)</td>', row)):
            said = [e["against_baseline"] for c in statistics["conditions"] if (c["metric"], c["spp"]) == ("relmse", spp)
                    for e in c["ranking"] if name_of(e) == method]
            assert len(said) == len(statistics["scenes"])
            assert re.search("<small>(.*)</small>", cell)[1] == (", ".join(
                f"{said.count(word)} {word}" for word in AGAINST if word in said) if len(said) > 1 else said[0])
            assert kind == (said[0] if set(said) in ({"better"}, {"worse"}) else "undecided")


def test_the_report_says_it(evaluated, tmp_path, assets_cache):
    check_report(evaluated[0], tmp_path / "page.html")


@pytest.mark.parametrize("seed", [1, 2])
def test_the_report_says_it_whatever_it_is(evaluated, tmp_path, assets_cache, seed):
    """Verdicts at random: a report that computed one would contradict the file."""
    draw = random.Random(seed)
    data = read(evaluated[0])
    for condition in data["conditions"]:
        for entry in condition["ranking"]:
            entry["letters"] = draw.choice(["a", "b", "ab", "c"])
            for key in ("against_best", "against_baseline"):
                if key in entry:
                    entry[key] = draw.choice([*AGAINST])
        for entry in condition["ranking"][len(condition["ranking"]) - draw.randrange(3):]:  # the last two, at most
            entry.update(compared=False, letters="", withheld="few pixels")
            entry.pop("against_best", None)
    for claim in data["claims"]:
        claim["verdict"] = draw.choice(["holds", "reversed", "mixed"])
        for place in claim["places"]:
            place["verdict"] = draw.choice(["holds", "reversed", "undecided"])
    folder = tmp_path / "changed"
    folder.mkdir()
    for name in ("results.csv", "manifest.json"):
        (folder / name).write_bytes((evaluated[0] / name).read_bytes())
    (folder / "statistics.json").write_text(json.dumps(data))
    check_report(folder, tmp_path / "page.html")


def test_compare_decides_as_the_ranking_does(tmp_path):
    """A change of an option between two folders, and the two settings in one plan: the same pair, the same figures."""
    run("synth", "scene_s", "--size", "16", "--samples", "64", "--seed", "3", "-o", tmp_path / "s.spool", "-q")

    def evaluate(name, values, spp):
        (tmp_path / f"{name}.toml").write_text(
            f'recordings = "s.spool"\nspp = {spp}\nreplicates = 8\npictures = false\nfilters = "gaussian"\n'
            f'[[sampler]]\nname = "multiscale"\ninit_spp = {values}\n')
        run("evaluate", tmp_path / f"{name}.toml", "-o", tmp_path / name, "-q")
    for spp in (4, 8):
        evaluate(f"two{spp}", "[2]", spp)
        evaluate(f"three{spp}", "[3]", spp)
        evaluate(f"both{spp}", "[2, 3]", spp)
        pair = next(c for c in read(tmp_path / f"both{spp}")["conditions"] if c["metric"] == "relmse")
        a, b, ratio, low, high, p, verdict = pair["pairs"][0]
        done = subprocess.run([PROGRAM, "compare", tmp_path / f"two{spp}", tmp_path / f"three{spp}", "--match", "name",
                               "--json"], capture_output=True, text=True)
        change = json.loads(done.stdout)["comparisons"][0]
        if "init_spp=2" in pair["ranking"][a]["sampler"]:  # compare tells the second against the first
            ratio, low, high = 1 / ratio, 1 / high, 1 / low
            verdict = {"better": "worse", "worse": "better"}.get(verdict, verdict)
        assert change["verdict"] == verdict and change["paired"]
        assert [change["ratio"], change["low"], change["high"], change["p_holm"]] == pytest.approx([ratio, low, high, p])
        assert (done.returncode == 1) == (verdict == "worse")


def test_no_page_is_written_with_statistics_of_its_own():
    """Quantiles, roots and standard errors are the library's; Python and JavaScript only print."""
    own = re.compile(r"\bsqrt\b|lgamma|\berf|T_QUANTILE|quantile\(|stdev|variance\(|scipy|import statistics\b|jackknife")
    tools = PLANS.parent
    for path in [*tools.glob("report/*.py"), *tools.glob("report/*.js"), *tools.glob("study/*.py")]:
        if path.name not in ("result_images.py", "figure_windows.py", "figure_comparison.py"):  # of images: quantiles, windows, contrasts
            found = own.search(path.read_text())
            assert not found, f"{path.name}: {found.group(0)}"
