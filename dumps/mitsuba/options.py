"""Command line of the recorder: plain values out, or one line and exit code 2."""
import argparse
import os

from dumps.mitsuba.channels import DEFAULT, LAYERS
from dumps.mitsuba.seeds import USER_LIMIT
from dumps.recording.command_line import Parser, pairs, take_shared
from dumps.recording.failure import usage_failure
from dumps.recording.recordings import check_name, names

EXIT_CODES = """exit codes: 0 recorded, 1 the scene cannot be recorded or its samples fail their tests, 2 wrong use,
3 the operating system or the renderer refused, or the run was stopped"""


def parse(arguments, about):
    parser = Parser(description=about, epilog=EXIT_CODES, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", help="an .xml scene, a .py file with scene(mi) -> dict, or cornell-box")
    parser.add_argument("-o", "--out", help="the .spool file to make")
    parser.add_argument("--size", help="WxH or N (default: the film's)")
    parser.add_argument("--samples", type=int, default=64, help="per pixel (64)")
    parser.add_argument("--recordings", type=int, default=1, metavar="N", help="make N recordings of samples / N each, NAME_1.spool ..., which "
                        "share the reference: `spool evaluate NAME_*.spool` judges them as a group (1)")
    parser.add_argument("--reference", default="0", metavar="SPP", help="samples of an independent reference (0: none); auto: as many as "
                        "it needs, in bands of rows, up to 16384, or to N with auto:N")
    parser.add_argument("--seed", type=int, default=1, help="0 .. 1023 (1)")
    parser.add_argument("--channels", help="%s; needed: lens and time where the scene has them; all (default %s)" %
                        (", ".join(LAYERS), DEFAULT))
    parser.add_argument("--half", action="store_true", help="a small file to hand on: radiance, and depth where its range allows, in 16 bits, no film positions "
                        "unless --channels names them")
    parser.add_argument("--integrator", help="plugin to use instead of the scene's, for instance path or volpath")
    parser.add_argument("--max-depth", type=int, help="of the integrator, the scene's or --integrator")
    parser.add_argument("-D", dest="defines", action="append", default=[], metavar="NAME=VALUE",
                        help="a parameter of the XML scene")
    parser.add_argument("--files", action="append", default=[], metavar="FOLDER",
                        help="where else the scene's meshes and textures may lie")
    parser.add_argument("--substitute", action="append", default=[], metavar="NAME=PLUGIN",
                        help="use PLUGIN where the scene names the plugin NAME, which Mitsuba 3 does not have")
    parser.add_argument("--scene-sha256", metavar="HASH", help="an error where the files of the scene have another hash")
    parser.add_argument("--allow-losses", action="store_true", help="record although a medium, or part of one, gets lost")
    parser.add_argument("--chunk-lanes", type=int, default=1 << 20, help="samples traced at once (1048576)")
    parser.add_argument("--block", type=int, default=16, help="samples in a block of the file (16)")
    parser.add_argument("--variant", help="Mitsuba variant (default: llvm_ad_rgb, scalar_rgb without LLVM)")
    parser.add_argument("--no-compress", action="store_true")
    parser.add_argument("--no-verify", action="store_true", help="do not test the samples and keep what was found")
    parser.add_argument("--force", action="store_true", help="replace an existing file")
    parser.add_argument("--dry-run", action="store_true", help="print what the scene needs and what it will cost")
    parser.add_argument("--plan", metavar="PLAN.toml", help="with --dry-run: name the layers no method of this plan reads")
    options = parser.parse_args(arguments)
    check(options)
    return options


def check(options):
    if not options.out and not options.dry_run:
        raise usage_failure("no output: give -o FILE.spool")
    if options.plan and not options.dry_run:
        raise usage_failure("--plan %s: applies to a --dry-run only: give both or neither" % options.plan)
    take_shared(options, 1)
    for name, low, high in (("samples", 1, 65536), ("seed", 0, USER_LIMIT - 1),
                            ("chunk_lanes", 1, 1 << 28), ("block", 1, 1024), ("max_depth", -1, 1 << 30)):
        value = getattr(options, name)
        if value is not None and not low <= value <= high:
            raise usage_failure("--%s %d is outside %d .. %d" % (name.replace("_", "-"), value, low, high))
    check_name(options.scene)
    check_name(options.out)
    begun = options.out and os.path.exists(os.path.join(options.out + ".recording", "named"))
    for path in names(options.out, options.recordings) if options.out and not options.force and not begun else ():
        if os.path.exists(path):
            raise usage_failure("%s: exists: choose another name or give --force" % path)
        if os.path.lexists(path + ".partial"):
            raise usage_failure("%s.partial: exists, another recording runs or was cut: recover or remove it" % path)
    if options.channels is None:
        options.channels = ",".join(name for name in DEFAULT.split(",") if name != "film" or not options.half)
    options.definitions = pairs("-D", options.defines)
