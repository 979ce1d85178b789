"""Cuts the recording of the package, spool/example.spool, out of dumps/cornell_box.spool.

A window of 64 x 64 pixels and the first 16 of the 32 samples of each, which are exchangeable. Run in the tree with
PYTHONPATH=formats/python.
"""
import spool

LEFT, TOP, SIZE, SAMPLES = 66, 92, 64, 16

source = spool.open("dumps/cornell_box.spool")
window = slice(TOP, TOP + SIZE), slice(LEFT, LEFT + SIZE)
layers = {name: source.read(name)[window][:, :, :SAMPLES] for name, layer in source.layers.items() if layer.scope == "sample"}
pixels = {name: source.pixel(name)[window] for name, layer in source.layers.items() if layer.scope == "pixel"}
kept = {key: source.meta[key] for key in ("renderer", "scene", "mode", "independent", "cost_per_sample")}
spool.write("tools/python/spool/example.spool", **layers, **pixels, sample_order="exchangeable", compress=True, force=True,
            meta={**kept, "cut_of": f"cornell_box.spool, x {LEFT}, y {TOP}, the first {SAMPLES} samples"})
