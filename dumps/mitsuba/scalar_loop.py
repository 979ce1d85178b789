"""The same records without LLVM: a Python loop over samples in a scalar variant, one thread, 24 times slower a sample.

Scalar and wavefront variants draw different numbers from one seed, so the variant is part of a recording.
"""
import drjit as dr
import numpy as np

from dumps.mitsuba.channels import has_instances, material_flags, no_diffuse_answer, past_lamps
from dumps.mitsuba.seeds import spread


class ScalarLoop:
    def __init__(self, mi, recordable, samples_per_pixel):
        self.mi, self.of = mi, recordable
        self.width, self.height = (int(v) for v in recordable.sensor.film().crop_size())
        self.differential_scale = samples_per_pixel ** -0.5
        self.features = mi.load_dict({"type": "aov", "aovs": "a:albedo,n:sh_normal,p:position,s:shape_index"})
        # By object: most scenes give their shapes no name. An object stands for one shape as long as it is held.
        self.shapes = recordable.scene.shapes()
        self.shape_index = {id(shape): index + 1 for index, shape in enumerate(self.shapes)}
        self.material_flags = material_flags(mi, recordable.scene)
        self.has_instances = has_instances(recordable.scene)
        self.to_camera = recordable.sensor.world_transform().inverse()

    def trace(self, count, seed, layers, rows=None):
        mi, of = self.mi, self.of
        first_row, end_row = rows or (0, self.height)
        widths = dict(radiance=3, direct=3, albedo=3, normal=3, depth=1, position=3, film=2, lens=2, time=1, shape=1)
        arrays = {name: np.zeros((end_row - first_row, self.width, count, widths[name]), np.float32) for name in layers}
        sampler = mi.load_dict({"type": "independent", "sample_count": count})
        medium = of.sensor.get_medium()
        need_features = any(name in layers for name in ("albedo", "normal", "depth", "position", "shape"))
        # One sequence for the whole chunk. A scalar seed has 32 bits: as many as there are chunks (seeds.py), far too few
        # for a sequence for each pixel of each chunk.
        sampler.seed(spread(seed))
        for y in range(end_row - first_row):
            for x in range(self.width):
                for s in range(count):
                    film = sampler.next_2d()
                    lens = sampler.next_2d() if of.has_lens else mi.Point2f(.5, .5)
                    moment = sampler.next_1d() if of.shutter_time > 0 else 0.0
                    time = of.shutter_open + moment * of.shutter_time
                    position = mi.Point2f((x + film[0]) / self.width, (first_row + y + film[1]) / self.height)
                    ray, weight = of.sensor.sample_ray_differential(time, 0.0, position, lens)
                    ray.scale_differential(self.differential_scale)
                    again = sampler.clone() if "direct" in arrays else None
                    arrays["radiance"][y, x, s] = weight * of.integrator.sample(of.scene, sampler, ray, medium)[0]
                    if again:
                        arrays["direct"][y, x, s] = weight * of.direct.sample(of.scene, again, ray, medium)[0]
                    for name, value in (("film", film), ("lens", mi.warp.square_to_uniform_disk_concentric(lens)),
                                        ("time", moment)):
                        if name in arrays:
                            arrays[name][y, x, s] = value
                    if need_features:
                        self._features(arrays, y, x, s, ray, sampler, medium)
        if "albedo" in arrays:
            np.clip(arrays["albedo"], 0, 1, out=arrays["albedo"])
        return arrays

    def _features(self, arrays, y, x, s, ray, sampler, medium):
        mi, of = self.mi, self.of
        ray = past_lamps(dr, of.scene, ray) if of.hides_lamps else ray
        values = self.features.sample(of.scene, sampler, ray, medium)[2]
        shape, flags = 0, self.material_flags[0]
        if self.has_instances:
            hit = of.scene.ray_intersect(ray)
            if hit.is_valid():
                shape = self.shape_index.get(id(hit.instance or hit.shape), 0)
                flags = int(hit.bsdf().flags())
        else:
            hit = of.scene.ray_intersect_preliminary(ray)
            shape = self.shape_index.get(id(hit.shape), 0) if hit.is_valid() else 0
            flags = self.material_flags[shape]
        albedo = values[0:3]
        if no_diffuse_answer(mi, flags, not any(albedo)):
            albedo = 1, 1, 1
        found = {"albedo": albedo, "normal": values[3:6], "position": values[6:9], "shape": shape,
                 "depth": (self.to_camera @ mi.Point3f(values[6], values[7], values[8]))[2] * of.depth_unit if shape else 0}
        for name, value in found.items():
            if name in arrays:
                arrays[name][y, x, s] = value
