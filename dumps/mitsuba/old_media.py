"""Participating media of Mitsuba 0.x in the terms of Mitsuba 3; part of old_format.py."""
import xml.etree.ElementTree as ElementTree


def numbers(text):
    return [float(part) for part in text.replace(",", " ").split()]


def medium(element, note, lost):
    """sigmaA + sigmaS -> sigma_t and albedo; densityMultiplier -> scale; density -> sigma_t."""
    by_name = {child.get("name"): child for child in element}
    if "material" in by_name:
        lost.append("preset medium %s" % by_name["material"].get("value"))
    if "densityMultiplier" in by_name:
        by_name["densityMultiplier"].set("name", "scale")
        note("medium densityMultiplier taken as scale")
    if "density" in by_name:
        by_name["density"].set("name", "sigma_t")
        note("medium density taken as sigma_t")
    for name in ("method", "stepSize"):                          # how 0.6 walked through it; Mitsuba 3 knows one way
        if name in by_name:
            element.remove(by_name[name])
    for volume in element.iter("volume"):
        if volume.get("type") == "gridvolume" and volume.find("*[@name='toWorld']") is None:
            ElementTree.SubElement(volume, "boolean", name="use_grid_bbox", value="true")
            note("grid volume placed by the box in its file, as Mitsuba 0.6 did")
    if "sigmaA" in by_name and "sigmaS" in by_name:
        _coefficients(element, by_name["sigmaA"], by_name["sigmaS"], note, lost)
    _large_coefficients(element, note)


def _large_coefficients(element, note):
    """Mitsuba 3 takes colours up to 1 there: the rest goes into the scale."""
    by_name = {child.get("name"): child for child in element}
    total = by_name.get("sigma_t", by_name.get("sigmaT"))
    try:
        values = numbers(total.get("value", "")) if total is not None and total.tag == "rgb" else []
        scale = numbers(by_name["scale"].get("value"))[0] if "scale" in by_name else 1.0
    except ValueError:
        return                                                   # a parameter: Mitsuba says what it does not like
    if values and max(values) > 1:
        total.set("value", ", ".join("%.9g" % (v / max(values)) for v in values))
        if "scale" not in by_name:
            by_name["scale"] = ElementTree.SubElement(element, "float", name="scale")
        by_name["scale"].set("value", "%.9g" % (scale * max(values)))
        note("medium sigma_t above 1 written with a scale")


def boundary(shape, note):
    """A shape that holds a medium and has no material was open in Mitsuba 0.6; Mitsuba 3 would make it a diffuse wall."""
    sides = ("interior", "exterior")
    holds = any(child.tag in ("medium", "ref") and child.get("name") in sides for child in shape)
    if holds and not any(child.tag == "bsdf" or child.tag == "ref" and child.get("name") not in sides for child in shape):
        ElementTree.SubElement(shape, "bsdf", type="null")
        note("a shape that holds a medium and has no material taken as open (bsdf null)")


def _coefficients(element, absorption, scattering, note, lost):
    try:
        a, s = (numbers(child.get("value", "")) for child in (absorption, scattering))
        a, s = (values * 3 if len(values) == 1 else values for values in (a, s))
        if len(a) != 3 or len(s) != 3:
            raise ValueError
    except ValueError:                                           # measured spectra, or a parameter
        lost.append("sigmaA and sigmaS of a medium that are not plain numbers")
        return
    total = [x + y for x, y in zip(a, s)]
    for child, name, values in ((absorption, "sigma_t", total),
                                (scattering, "albedo", [y / t if t else 0 for y, t in zip(s, total)])):
        child.tag = "rgb"
        child.attrib = {"name": name, "value": ", ".join("%.9g" % v for v in values)}
    note("medium sigmaA and sigmaS written as sigma_t and albedo")
