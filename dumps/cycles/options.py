"""Command line of the recorder: plain values out, or one line and exit code 2."""
import sys

from dumps.cycles.batches import batch_plan
from dumps.cycles.passes import CHANNELS, DEFAULT
from dumps.recording.command_line import Parser, take_shared
from dumps.recording.failure import usage_failure
from dumps.recording.recordings import check_name

MODES = {
    "iid": "independent samples, a new seed per pass (film position unknown)",
    "shift": "independent samples, a new seed per pass; all pixels share one known film position",
    "sequence": "consecutive samples of one low-discrepancy sequence, as the renderer works",
}
LARGEST = 65536
EXIT_CODES = "Exit codes: 0 done, 1 the scene cannot be recorded, 2 wrong use, 3 Blender or the system refused."


def script_arguments():
    """Blender keeps what follows `--` for the script; the bpy module leaves the command line alone."""
    arguments = sys.argv[1:]
    if "--" in arguments:
        return arguments[arguments.index("--") + 1:]
    return [] if any(a in ("-P", "--python", "-b", "--background") for a in arguments) else arguments


def parse_options(arguments):
    parser = Parser(prog="record.py", description="Record every sample of a Cycles rendering.", epilog=EXIT_CODES)
    parser.add_argument("--scene", help="a scene of dumps/scenes, or a .py file with build(find), which returns a scene")
    parser.add_argument("--files", action="append", default=[], metavar="FOLDER", help="where files of a .py scene lie, beside its own")
    parser.add_argument("--blend", help="a .blend file")
    parser.add_argument("-o", "--out", help="folder of the passes; an interrupted one is continued")
    parser.add_argument("--size", help="WxH or N (default: the scene's)")
    parser.add_argument("--samples", type=int, default=64, help="per pixel (64)")
    parser.add_argument("--recordings", type=int, default=1, metavar="N",
                        help="of dumps/record.sh: the samples become N recordings, which share the reference (1)")
    parser.add_argument("--first", type=int, default=0,
                        help="index of the first pass (0), to share a recording among machines")
    parser.add_argument("--mode", choices=MODES, default="iid",
                        help="; ".join("%s: %s" % m for m in MODES.items()))
    parser.add_argument("--seed", type=int, default=1, help="seed of the recording (1)")
    parser.add_argument("--reference", default="0", metavar="SPP", help="samples per pixel of an independent reference (0: none); "
                        "auto: as many as it needs, up to 16384, or to N with auto:N")
    parser.add_argument("--first-batch", type=int, default=0, help="first batch of the reference (0)")
    parser.add_argument("--channels", default=",".join(DEFAULT), help=", ".join(CHANNELS))
    parser.add_argument("--substitute", action="append", default=[], metavar="NAME=FILE",
                        help="use FILE where the scene names the file NAME")
    parser.add_argument("--packed", action="store_true",
                        help="of dumps/record.sh: the passes are in a recording already, only compare scene and settings")
    parser.add_argument("--fold", action="store_true", help="of dumps/record.sh: the reference comes first, and its batches become one file, "
                        "their mean and its variance, when it is whole")
    parser.add_argument("--camera", help="name of the camera object")
    parser.add_argument("--frame", type=int, help="frame of the animation")
    parser.add_argument("--threads", type=int, default=0, help="(0: all)")
    parser.add_argument("--pixels", choices=("auto", "engine", "file"), default="auto",
                        help="how pixels leave Blender; all give the same bits")
    parser.add_argument("--dry-run", action="store_true",
                        help="print what the scene needs and what a recording would cost")
    parser.add_argument("--plan", metavar="PLAN.toml", help="with --dry-run: say which layers no method of this plan reads")
    options = parser.parse_args(arguments)
    check_options(options)
    return options


def check_options(options):
    options.channels = [c for c in options.channels.split(",") if c]
    if not options.out and not options.dry_run:
        raise usage_failure("no folder for the passes: give -o FOLDER")
    if options.plan and not options.dry_run:
        raise usage_failure("--plan %s: only a dry run reads it: add --dry-run" % options.plan)
    if options.files and not (options.scene or "").endswith(".py"):
        raise usage_failure("--files %s: only a .py scene finds files there" % options.files[0])
    take_shared(options, 4)
    for name, low, high in (("samples", 1, LARGEST), ("first", 0, LARGEST - 1), ("seed", 0, 2**31 - 1),
                            ("first_batch", 0, 2**20), ("threads", 0, 1024)):
        value = getattr(options, name)
        if not low <= value <= high:
            raise usage_failure("--%s %d is out of range [%d, %d]" %
                                (name.replace("_", "-"), value, low, high))
    if options.first + options.samples > LARGEST:
        raise usage_failure("--first + --samples is more than %d" % LARGEST)
    for name in (options.scene, options.blend, options.out):
        check_name(name)
    if options.mode == "sequence" and options.recordings > 1:
        raise usage_failure("--recordings: the samples of a sequence belong together: use another --mode")
    if options.mode == "sequence" and options.first:
        raise usage_failure("--first: the samples of a sequence belong together, record all in one "
                            "folder")
    if options.auto and options.first_batch:
        raise usage_failure("--first-batch: machines that share a reference must know its length: give --reference a number")
    if options.reference > 1 and not options.auto and batch_plan(options.reference)[0] * batch_plan(
            options.reference)[1] != options.reference:
        raise usage_failure("--reference %d does not split into equal batches: use a multiple of %d" %
                            (options.reference, batch_plan(options.reference)[0]))
