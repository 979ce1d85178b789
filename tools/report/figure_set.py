"""All figures and tables of one evaluation: what is chosen, drawn, written and said."""

from pathlib import Path

from tools.report.aggregate import Described, aggregate
from tools.report.draw_curves import draw
from tools.report.failure import USAGE, Failure
from tools.report.figure_captions import comparison_caption, curves_caption, environment, table_caption
from tools.report.figure_comparison import Block, Shown, draw_comparison
from tools.report.figure_folder import FigureFolder
from tools.report.figure_methods import baseline_of, choose_methods, is_command, left_out_text, own_methods
from tools.report.figure_tables import curves_csv, latex_tables, markdown_table
from tools.report.figure_text import significant
from tools.report.figure_windows import asked_windows
from tools.report.file_names import file_name_of, numbered
from tools.report.metric_names import metric_name
from tools.report.number_text import samples_text
from tools.report.pixel_data import evaluated
from tools.report.result_images import find_images
from tools.report.results_table import bracketed_threads, choose_metric, read_results
from tools.report.statistics_file import best_is_alone, interval_of, read_statistics
from tools.report.summary import name_of
from tools.report.vocabulary import read_manifest

MOST_ROWS = {1: 3, 2: 6}  # recordings of a figure of that many columns


class FigureSet:
    def __init__(self, options):
        self.options = options
        self.table = read_results(options.folder / "results.csv")
        self.metric = choose_metric(options.metric, self.table)
        self.statistics = read_statistics(options.folder)
        if not self.statistics.metrics():
            raise Failure(f"{options.folder}: no result to draw: results.csv says why")
        if self.metric not in self.statistics.metrics():
            raise Failure(f"--metric: methods are ranked by {', '.join(self.statistics.metrics())}, not by {self.metric}", USAGE)
        combinations = aggregate(self.table, self.statistics)
        self.labels = self.statistics.labels()
        manifest = read_manifest(options.folder)
        found = find_images(options.folder, combinations, evaluated(manifest, self.statistics))
        Described(manifest).mark(combinations, self.statistics)
        self.images = {combinations[entry.combination].key: entry.paths for entry in found}
        ranked = self.statistics.of_metric(self.metric)
        self.budget = options.spp or self.statistics.largest_budget(self.metric)
        self.conditions = [c for c in ranked if c["spp"] == self.budget]
        if not self.conditions:
            budgets = ", ".join(f"{b:g}" for b in sorted({c["spp"] for c in ranked}))
            raise Failure(f"--spp: no results at {self.budget:g} samples per pixel; there are {budgets}", USAGE)
        self._choose()

    def _choose(self):
        options = self.options
        for name in options.recording:
            if name not in self.labels.values():
                raise Failure(f"--recording: no {name}; there are {', '.join(self.labels.values())}", USAGE)
        self.crops = asked_windows(options.crops, list(self.labels.values()))
        self.baseline = baseline_of(self.statistics.of_metric(self.metric))
        self.own = own_methods(self.statistics.results, frozenset(filter(None, options.built_in.split(","))))
        self.chosen = choose_methods(options.method, self.conditions, self.own)
        self.left_out = left_out_text(self.chosen, self.conditions)

    def write(self):
        with FigureFolder(self.options.output, self.options.force) as folder:
            captions = self._comparisons(folder)
            compared = len(captions)
            curves = self._curves(folder)
            captions += curves
            lines = [line for caption in captions for line in caption]
            folder.text("captions.tex", "\n".join(["% needs \\usepackage{graphicx}", "", *lines]))
            caption = table_caption(self.statistics, self.metric, self.labels, self.baseline)
            folder.text("table.tex", latex_tables(self.statistics, self.metric, self.labels, self.baseline, caption))
            folder.text("table.md", markdown_table(self.statistics, self.metric, self.labels, self.baseline))
        return (f"{self.options.output}: {compared} comparison{'' if compared == 1 else 's'} at {self.budget:g} spp, {'curves, ' if any(curves) else ''}"
                f"captions and tables of {metric_name(self.metric)}" + self.left_out
                + ("" if compared else "; no pictures in the folder, so no comparison")
                + ("" if any(curves) else "; no mean above zero, so no curves") + self.statistics.warning())

    def _comparisons(self, folder):
        """Captions of one figure for each recording and number of threads, and of those with several as rows."""
        names = numbered({(c["dump"], c["threads"]): f"comparison_{file_name_of(self._label(c))}" for c in self.conditions})
        shown = [c for c in self.conditions if not self.options.recording or self.labels[c["dump"]] in self.options.recording]
        blocks = [(c, block) for c, block in ((c, self._block(c)) for c in shown) if block]
        captions = [self._comparison(folder, names[c["dump"], c["threads"]], [(c, block)]) for c, block in blocks]
        if len(blocks) > 1:
            most = MOST_ROWS[self.options.column or 2]
            for start in range(0, len(blocks), most):
                name = "comparison" + (f"-{start // most + 1}" if start else "")
                captions.append(self._comparison(folder, name, blocks[start:start + most]))
        return captions

    def _label(self, condition):
        """Its recording; where numbers of threads are swept over, they too."""
        swept = len({c["threads"] for c in self.conditions}) > 1
        return self.labels[condition["dump"]] + (bracketed_threads(condition["threads"]) if swept else "")

    def _block(self, condition):
        """The pictures of one recording; None where there are none to compare."""
        entries = {name_of(entry): entry for entry in condition["ranking"]}
        alone = best_is_alone(condition)
        panels = {}
        for place, method in enumerate(self.chosen):
            entry = entries.get(method)
            paths = self.images.get((condition["dump"], condition["spp"], entry["sampler"], entry["filter"])) if entry else None
            if not paths:
                continue
            value = interval_of(entry["value"])
            lines = [significant(value.mean) if value.mean == value.mean else "not known"]
            if value.low == value.low and value.high == value.high:
                lines.append(f"[{significant(value.low)}, {significant(value.high)}]")
            panels[place] = Shown(method, lines, alone and entry is condition["ranking"][0], paths)
        label = self.labels[condition["dump"]]
        return Block(self._label(condition), panels, self.crops.get(label) or self.crops.get("")) if panels else None

    def _comparison(self, folder, name, rows):
        conditions, blocks = [c for c, _ in rows], [block for _, block in rows]
        column = self.options.column or 2
        head = f"{self.statistics.metric_text(self.metric)} at {samples_text(self.budget)}"
        if any(len(s.lines) > 1 for block in blocks for s in block.methods.values()):
            head += ", with 95 % intervals"
        draw_comparison(blocks, self.chosen, head, folder.pictures(name), column, self.options.font)
        caption = comparison_caption(self.statistics, self.metric, conditions, blocks, [block.label for block in blocks])
        return environment([name], caption, column)

    def _curves(self, folder):
        source = folder.text("curves.csv", curves_csv(self.statistics, self.metric, self.labels, self.chosen))
        for script, name in (("draw_curves.py", "curves.py"), *((name, name) for name in ("figure_text.py", "metric_names.py"))):
            text = Path(__file__).with_name(script).read_text(encoding="utf-8")
            folder.text(name, text.replace("from tools.report.", "from "))  # beside each other, without the package
        pages = []

        def place(after):
            pages.append("curves" + after)
            return folder.pictures(pages[-1])

        column = self.options.column or (1 if len(self.labels) == 1 else 2)
        draw(source, place, column, self.options.font)
        shared = any(row.get("timing") == "shared" for row in self.table.rows)
        run = {name_of(r) for r in self.statistics.results if any(is_command(r.get(k, "")) for k in ("sampler_name", "filter_name"))}
        commands = [name for name in self.chosen if name in run]
        captions = []
        for over_time in (False, True):
            files = [page for page in pages if page.startswith("curves_time") == over_time]
            caption = curves_caption(self.statistics, self.metric, self.chosen, over_time, shared, commands)
            captions.append(environment(files, caption, column))
        return captions
