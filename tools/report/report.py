"""One HTML file from the folder that `spool evaluate` wrote: sentences, charts, table, images.

usage: run.py report DIR -o report.html [--metric relmse] [--max-image-mb 40] [--vocabulary FILE]
                 [--title TEXT] [--force]
Needs Python 3.9 and numpy; everything the page needs is in the page. Errors are one line on stderr;
exit codes are those of spool: 1 data unusable, 2 wrong use, 3 input or output failed.
"""

import argparse
from pathlib import Path

from tools.report.aggregate import Described, aggregate
from tools.report.failure import IO, USAGE, Failure, guarded
from tools.report.number_text import count_text
from tools.report.page import build_page
from tools.report.pixel_data import evaluated, pixel_answers
from tools.report.report_data import OWN_MEANINGS, quantity_names, report_data
from tools.report.result_images import find_images, first_results, pack_images, with_flip_maps
from tools.report.results_table import choose_metric, read_results
from tools.report.sections import quantities_html, run_html, summary_html
from tools.report.statistics_file import read_statistics
from tools.report.statistics_section import statistics_html
from tools.report.summary import summarise
from tools.report.vocabulary import read_manifest, read_vocabulary
from tools.report.whole_file import write_whole


def main(arguments=None):
    return guarded(lambda: make_report(parse(arguments)))


def parse(arguments):
    parser = argparse.ArgumentParser(prog="spool report", description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path, help="what spool evaluate -o DIR wrote")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--metric", default="", help="what the summary compares (relmse)")
    parser.add_argument("--max-image-mb", type=float, default=40.0,
                        help="megabytes of images; beyond, crops and links to the EXRs (40)")
    parser.add_argument("--vocabulary", type=Path, help="meanings of columns as JSON")
    parser.add_argument("--program", default="", help="the program spool, asked for samples of single pixels and FLIP maps")
    parser.add_argument("--title", default="")
    parser.add_argument("--served", action="store_true", help="for spool view: the page asks the program that serves it")
    parser.add_argument("--force", action="store_true", help="replace the report")
    return parser.parse_args(arguments)


def make_report(options):
    if not options.served and options.output.exists() and not options.force:
        raise Failure(f"{options.output}: exists: choose another name or give --force", USAGE)
    if not options.max_image_mb >= 0.0:
        raise Failure(f"--max-image-mb: {options.max_image_mb} is no size", USAGE)
    table = read_results(options.folder / "results.csv")
    metric = choose_metric(options.metric, table)
    vocabulary, manifest = read_vocabulary(options.vocabulary), read_manifest(options.folder)
    statistics = read_statistics(options.folder)
    combinations = aggregate(table, statistics)
    labels = statistics.labels()
    all_found = find_images(options.folder, combinations, evaluated(manifest, statistics))
    found = with_flip_maps(first_results(all_found, combinations, statistics, metric), options.program)
    images = pack_images(found, options.output.resolve().parent, options.max_image_mb)
    if options.served:  # every pixel answers, and no file but the page is served
        images = images._replace(sets=[entry._replace(links={}) for entry in images.sets])
    pixels = {} if options.served else pixel_answers(options.program, found, combinations, manifest, vocabulary)
    described = Described(manifest)
    described.mark(combinations, statistics)
    names = quantity_names(combinations, table.metrics)
    title = options.title or f"Spool report: {', '.join(list(labels.values())[:4])}"
    biased = BIASED if statistics.biased else ""
    ranks = statistics_html(statistics, labels, metric)
    sections = [
        ("summary", "Results",
         biased + summary_html(summarise(combinations, statistics, metric, labels), statistics, metric, statistics.largest_budget(metric))
         + described.note()),
        ("charts", "Error, time and budget", biased + '<div id="chart-area"></div>'),
        *([("statistics", "Ranks and differences", biased + ranks)] if ranks else []),
        ("table", "All results",
         biased + described.note() + '<div id="table-area"></div>'
         + quantities_html(names, vocabulary, OWN_MEANINGS)),
        ("images", "Images", biased + (LIVE if options.served else "") + images_html(images, len(all_found))),
        ("run", "The run", run_html(manifest, combinations, labels, vocabulary)),
    ]
    data = report_data(combinations, statistics, table.metrics, metric, labels, vocabulary, images, pixels)
    if options.served:
        return build_page(title, sections, {**data, "live": True}, images.packed, served=True)
    try:
        write_whole(options.output, build_page(title, sections, data, images.packed))
    except OSError as error:
        raise Failure(f"{options.output}: {error.strerror}: choose another place", IO) from error
    size = options.output.stat().st_size / 1e6
    return (f"{options.output}: {size:.1f} MB, {count_text(len(table.rows), 'result')}, {count_text(len(images.packed), 'image')} "
            f"({images.bytes / 1e6:.1f} MB)" + statistics.warning())


BIASED = ('<p class="warning biased">BIASED: judged by the samples that the images were made of. Every error is too small, '
          "and by a different factor for each method. Do not compare methods by it.</p>")


LIVE = '<p><a href="live">Other budgets and methods</a></p>'


def images_html(images, written):
    if not images.sets:
        return "<p>No images were written by the evaluation (--no-pictures, or results that failed).</p>"
    notes = []
    if written > len(images.sets):
        notes.append(f"The baseline and the first methods of each recording and budget, {len(images.sets)} of {written} results; "
                     "the images of the others are EXR files beside results.csv, and spool view shows them.")
    if images.crops:
        notes.append("Images are cut to the window with the largest error to keep the page small.")
    if images.left_out:
        notes.append(f"{images.left_out} of {len(images.sets)} results have links to their EXR files "
                     "only: raise --max-image-mb to embed them.")
    return "".join(f"<p>{note}</p>" for note in notes) + '<div id="image-area"></div>'
