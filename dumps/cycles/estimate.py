"""What a recording will be and what it will cost, from a few passes of it."""
import statistics

import bpy

from dumps.cycles.batches import batch_plan
from dumps.cycles.passes import channel_names, describe_channels
from dumps.cycles.reference import BATCHES
from dumps.cycles.scene import find_needs
from dumps.recording.progress import duration, size
from dumps.recording.reference_need import reference_hint


def dry_run(recorder, options):
    """Needs of the scene and the price of the recording, from three passes and one batch."""
    seconds = [recorder.render_pass(i)[1]["seconds"] for i in range(3)]
    per_pass = statistics.median(seconds[1:])
    per_batch = recorder.render_reference(0)[1]["seconds"] if recorder.batches else 0.0
    pixels = recorder.width * recorder.height
    planes = len(channel_names(recorder.plan))
    needs = ", ".join("%s: %s" % (k.replace("_", " "), "yes" if v else "no")
                      for k, v in find_needs(recorder.scene).items())
    kept = min(recorder.batches, BATCHES) if options.auto else recorder.batches
    folder_bytes = 4 * pixels * (planes * options.samples + 3 * kept)
    stored = sum(2 if c["dtype"] == "f16" else 4 for c in describe_channels(recorder.plan))
    dump_bytes = pixels * (stored * options.samples + (24 if recorder.batches else 0))
    rest = per_pass * options.samples + per_batch * recorder.batches
    spp, batches = batch_plan(options.reference // 4)
    lines = [
        "scene %s, camera %s, %dx%d, Cycles %s" % (recorder.identity["name"], recorder.camera.data.name,
                                                   recorder.width, recorder.height,
                                                   bpy.app.version_string),
        "needs %s" % needs,
        "channels %s" % " ".join(channel_names(recorder.plan)),
        "passes %d at %.3g s, reference %d batches of %d spp at %.3g s" % (
            options.samples, per_pass, recorder.batches, recorder.batch_spp, per_batch),
        "estimate %s (%.2f minutes), folder %s, recording at most %s" % (
            duration(seconds[0] + rest), (seconds[0] + rest) / 60, size(folder_bytes),
            size(dump_bytes)),
        *reference_hint(options.samples, options.reference, per_pass * options.samples, per_batch * recorder.batches,
                        smaller=spp * batches, auto=options.auto)]     # a quarter that splits into equal batches
    if options.plan:
        from dumps.recording.plan_layers import unread  # which an older Blender's Python cannot read
        lines.append(unread(options.plan, list(recorder.plan)) or "the methods of %s read all layers" % options.plan)
    return "\n".join(lines)
