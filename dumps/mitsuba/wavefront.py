"""The renderer's own sample loop in a wavefront variant: one lane is one camera sample.

The random numbers are drawn in the order in which Mitsuba's integrator draws them, so that the same seed
gives `mi.render`'s image to the last bits; film, lens and time are known exactly because they are drawn here.
"""
import numpy as np

from dumps.mitsuba.channels import has_instances, material_flags, no_diffuse_answer, past_lamps

# Of the albedo in spectral variants: sets of four wavelengths, evenly over what Mitsuba sees (360 .. 830 nm).
WAVELENGTH_SETS = 8


class Wavefront:
    def __init__(self, mi, dr, recordable, samples_per_pixel):
        self.mi, self.dr, self.of = mi, dr, recordable
        film = recordable.sensor.film()
        self.width, self.height = (int(v) for v in film.crop_size())
        self.differential_scale = samples_per_pixel ** -0.5  # the same for pool and reference
        self.features = mi.load_dict({"type": "aov", "aovs": "a:albedo,n:sh_normal,p:position,s:shape_index"})
        registered = np.array(dr.reinterpret_array(mi.UInt32, recordable.scene.shapes_dr()))
        table = np.zeros(int(registered.max()) + 1 if len(registered) else 1, np.uint32)
        table[registered] = 1 + np.arange(len(registered))  # pointer ids differ from run to run
        self.shape_table = mi.UInt32(table)
        self.material_flags = mi.UInt32(material_flags(mi, recordable.scene))
        self.has_instances = has_instances(recordable.scene)
        self.daylight = mi.load_dict({"type": "d65"}) if mi.is_spectral else None

    def trace(self, count, seed, layers, rows=None):
        """{layer: [y][x][s][c] float32 (shape: uint32)} of `count` samples of every pixel; rows: (first, end)."""
        first_row, end_row = rows or (0, self.height)
        out = self._lanes(count, seed, layers, first_row, end_row)
        lanes, arrays = self.width * (end_row - first_row) * count, {}
        for name, value in out.items():
            array = np.array(value)
            array = array.T if array.ndim == 2 else array[:, None]  # Dr.Jit gives [component][lane], and one lane where all are equal
            array = np.repeat(array, lanes, axis=0) if len(array) < lanes else array
            arrays[name] = array.reshape(end_row - first_row, self.width, count, -1)
        if "albedo" in arrays:
            # BSDFs without an albedo of their own answer with an estimate that exceeds 1.
            np.clip(arrays["albedo"], 0, 1, out=arrays["albedo"])
        return arrays

    def _lanes(self, count, seed, layers, first_row, end_row):
        mi, dr, of = self.mi, self.dr, self.of
        lanes = self.width * (end_row - first_row) * count
        sampler = mi.load_dict({"type": "independent", "sample_count": count})
        sampler.seed(seed, lanes)
        pixel = dr.arange(mi.UInt32, lanes) // dr.opaque(mi.UInt32, count)
        row = pixel // self.width
        corner = mi.Vector2f(mi.Float(pixel - row * self.width), mi.Float(row + dr.opaque(mi.UInt32, first_row)))
        film = sampler.next_2d()
        lens = sampler.next_2d() if of.has_lens else mi.Point2f(.5)
        # Kept as drawn: out of the time itself it would come rounded, up to 1.
        moment = sampler.next_1d() if of.shutter_time > 0 else mi.Float(0)
        time = of.shutter_open + moment * of.shutter_time
        wavelength = sampler.next_1d() if mi.is_spectral else mi.Float(0)
        ray, weight = of.sensor.sample_ray_differential(
            time, wavelength, (corner + film) / mi.ScalarVector2f(self.width, self.height), lens)
        ray.scale_differential(self.differential_scale)
        medium = of.sensor.get_medium()
        # A second walk with the same numbers, cut after one bounce: the direct part of the same path.
        again = sampler.clone() if "direct" in layers else None

        def rgb(spectrum):
            spectrum = mi.unpolarized_spectrum(weight * spectrum)
            return mi.spectrum_to_srgb(spectrum, ray.wavelengths) if mi.is_spectral else mi.Color3f(spectrum)

        out = {"radiance": rgb(of.integrator.sample(of.scene, sampler, ray, medium)[0])}
        if again:
            out["direct"] = rgb(of.direct.sample(of.scene, again, ray, medium)[0])
        drawn = {"film": film, "lens": mi.warp.square_to_uniform_disk_concentric(lens),
                 "time": moment}
        out.update((name, drawn[name]) for name in drawn if name in layers)
        if any(name in layers for name in ("albedo", "normal", "depth", "position", "shape")):
            ray = past_lamps(dr, of.scene, ray) if of.hides_lamps else ray
            values = self.features.sample(of.scene, sampler, ray, medium)[2]
            position = mi.Point3f(values[6], values[7], values[8])
            shape, flags = self._shape(ray, mi.UInt32(values[9]))
            albedo = self._white_balanced(ray) if mi.is_spectral and "albedo" in layers else mi.Color3f(values[0], values[1], values[2])
            view = of.sensor.world_transform().inverse() @ position
            found = {"albedo": dr.select(no_diffuse_answer(mi, flags, dr.all(albedo == 0)), 1, albedo),
                     "normal": mi.Vector3f(values[3], values[4], values[5]),
                     "depth": dr.select(shape > 0, view.z * of.depth_unit if of.depth_unit != 1 else view.z, 0), "position": position, "shape": shape}
            out.update((name, found[name]) for name in found if name in layers)
        dr.eval(out)
        return out

    def _white_balanced(self, ray):
        """Albedo where light has wavelengths: what a surface makes of daylight against what white would. Mitsuba's own answer is of the
        wavelengths of the sample alone, and tinted where the surface is grey."""
        mi, dr = self.mi, self.dr
        hit = self.of.scene.ray_intersect(ray)
        bsdf, seen, white = hit.bsdf(ray), mi.Color3f(0), mi.Color3f(0)
        step = (mi.MI_CIE_MAX - mi.MI_CIE_MIN) / (4 * WAVELENGTH_SETS)
        for first in range(WAVELENGTH_SETS):
            hit.wavelengths = type(ray.wavelengths)([mi.MI_CIE_MIN + step * (first + WAVELENGTH_SETS * i + 0.5) for i in range(4)])
            light = self.daylight.eval(hit)
            seen += mi.spectrum_to_srgb(mi.unpolarized_spectrum(bsdf.eval_diffuse_reflectance(hit, hit.is_valid())) * light, hit.wavelengths)
            white += mi.spectrum_to_srgb(light, hit.wavelengths)
        return dr.select(hit.is_valid(), seen / white, 0)

    def _shape(self, ray, found):
        """(1 + index in scene.shapes or 0, flags of the material there); found: Mitsuba's id of the shape."""
        mi, dr = self.mi, self.dr
        if not self.has_instances:
            shape = dr.gather(mi.UInt32, self.shape_table, found)
            return shape, dr.gather(mi.UInt32, self.material_flags, shape)
        # What an instance shows is no shape of the scene and has an id outside the table: one more ray finds the instance.
        hit = self.of.scene.ray_intersect(ray)
        owner = dr.select(hit.instance != None, dr.reinterpret_array(mi.UInt32, hit.instance),  # noqa: E711
                          dr.reinterpret_array(mi.UInt32, hit.shape))
        shape = dr.gather(mi.UInt32, self.shape_table, owner, hit.is_valid())
        return shape, dr.select(hit.is_valid(), hit.bsdf().flags(), int(mi.BSDFFlags.Diffuse))
