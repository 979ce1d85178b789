"""Colours of Mitsuba 0.x as linear <rgb> of Mitsuba 3; part of old_format.py."""
import functools
import re
import xml.etree.ElementTree as ElementTree

import numpy as np

from dumps.mitsuba.old_media import numbers

WAVELENGTHS = np.arange(360, 831.0)                   # those of the CIE's table
XYZ_TO_RGB = np.array([[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]])
UNBOUNDED = ("eta", "k", "sigmaA", "sigmaS", "sigmaT")           # properties of a material that are no reflectances


def hex_colour(text):
    """#rrggbb -> three numbers in [0, 1], as written."""
    digits = text.lstrip("#").removeprefix("0x")
    return [int(digits[i:i + 2], 16) / 255 for i in (0, 2, 4)]


def linear(value):
    """IEC 61966-2-1."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


@functools.cache                                      # a second of small kernels in a wavefront variant
def observer():
    import mitsuba as mi
    return np.array([np.ravel(mi.cie1931_xyz(float(wavelength))) for wavelength in WAVELENGTHS], np.float64)


def measured_colour(pairs):
    """[(nanometres, value)] -> linear Rec.709 as Mitsuba 0.6 took it (Spectrum::fromContinuousSpectrum): zero beyond both ends,
    seen by the CIE observer of 1931, equal energy as white, and no channel below zero."""
    at, value = (np.array(column) for column in zip(*pairs))
    beyond = (at[-1] - at[0]) / (len(at) - 1)                    # within the mean distance of two values (zeroExtend)
    if value[0]:
        at, value = np.insert(at, 0, at[0] - beyond), np.insert(value, 0, 0)
    if value[-1]:
        at, value = np.append(at, at[-1] + beyond), np.append(value, 0)
    seen = np.interp(WAVELENGTHS, at, value, left=0, right=0) @ observer() / observer()[:, 1].sum()
    return np.maximum(XYZ_TO_RGB @ seen, 0).tolist()


def colours(parent, element, note):
    value = element.get("value", "")
    if element.tag in ("rgb", "srgb", "spectrum"):
        element.attrib.pop("intent", None)                       # has no meaning for a 0.6 that renders colours
    if element.tag in ("rgb", "srgb") and not value.startswith("$"):
        try:
            colour = hex_colour(value) if value.startswith("#") else numbers(value)
        except ValueError:
            return                                               # Mitsuba says what is wrong with it
        if element.tag == "srgb":
            colour = [linear(c) for c in colour]
            note("<srgb> made linear <rgb>")
        elif value.startswith("#"):
            note("<rgb> in hexadecimal written as numbers, linear as Mitsuba 0.6 took them")
        _write(element, colour)
    elif element.tag == "spectrum":
        _spectrum(parent, element, value, note)
    elif element.tag == "blackbody":
        kelvin, scale = element.get("temperature", "").rstrip("kK "), element.get("scale")
        element.tag = "spectrum"
        ElementTree.SubElement(element, "float", name="temperature", value=kelvin)
        for key in ("temperature", "scale"):
            element.attrib.pop(key, None)
        element.set("type", "blackbody")
        note("<blackbody> made a spectrum plugin%s" % (": its scale %s is dropped, Mitsuba 3 has none" % scale
                                                      if scale not in (None, "1", "1.0") else ""))


def _spectrum(parent, element, value, note):
    import mitsuba as mi
    if element.get("filename"):
        note("<spectrum> of the file %s made a colour by the rule of Mitsuba 3, which is not that of 0.6" % element.get("filename"))
    parts = re.split(r"[,\s]+", value.strip())
    if len(parts) == 1 and value and ":" not in value:
        if parent.tag == "emitter":
            # 0.6 without spectra took one number for grey; Mitsuba 3 for equal energy, which is pink (2.4 : 1.9 : 1.8)
            element.tag = "rgb"
            note("<spectrum> of one number in an emitter taken as grey, as Mitsuba 0.6 did")
        return
    try:
        values = [tuple(float(number) for number in part.split(":")) for part in parts]
    except ValueError:
        return                                                   # a parameter, or Mitsuba says what is wrong with it
    if {len(one) for one in values} == {1} and len(values) == 3:
        _reflectance(parent, element, [one for one, in values], note)
        note("<spectrum> of three numbers taken as linear <rgb>, as Mitsuba 0.6 did")
    elif {len(one) for one in values} == {2} and len(values) > 1:
        if mi.is_spectral:
            note("measured <spectrum> kept: Mitsuba 0.6 made it a colour unless it was built for spectra")
            return
        _reflectance(parent, element, measured_colour(values), note)
        note("measured <spectrum> made the linear <rgb> that Mitsuba 0.6 made of it")


def _reflectance(parent, element, colour, note):
    """What a material reflects is kept below 1, as 0.6 kept it (BSDF::ensureEnergyConservation); Mitsuba 3 refuses it."""
    largest = max(colour)
    if largest > 1 and parent.tag in ("bsdf", "texture") and element.get("name") not in UNBOUNDED:
        note("%s above 1 scaled to 0.99, as Mitsuba 0.6 did" % element.get("name"))
        colour = [c * 0.99 / largest for c in colour]
    _write(element, colour)


def _write(element, colour):
    element.tag = "rgb"
    element.set("value", ", ".join("%.9g" % c for c in colour))
