"""Curves and drivers that would move what the recorder has set: they are evaluated again in every render."""


def curves_of(owner):
    """Every curve and driver at work on a data block: of its action, of the strips of its NLA tracks, and its drivers, muted ones too:
    Blender 4.5 has seen them move what they drive."""
    data = owner.animation_data
    if not data:
        return []
    actions = [data.action] + [strip.action for track in data.nla_tracks for strip in _flat(track.strips)]
    return [curve for action in actions if action for curve in action_curves(action) if not curve.mute] + list(data.drivers)


def _flat(strips):
    """Meta strips hold others."""
    return [inner for strip in strips for inner in [strip, *_flat(getattr(strip, "strips", ()))]]


def action_curves(action):
    """From 4.4 on: layers of strips, a bag of curves for each animated thing."""
    layered = [curve for layer in getattr(action, "layers", ()) for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves]
    return layered or list(getattr(action, "fcurves", ()))


def mute(owner, is_set):
    """Takes the effect from what moves a property whose path is_set() says the recorder sets. Returns those paths."""
    found = [curve for curve in curves_of(owner) if is_set(curve.data_path)] if owner else []
    paths = [curve.data_path for curve in found]
    drivers = owner.animation_data.drivers if found else ()
    for curve in found:
        curve.mute = True
    for driver in [curve for curve in drivers if curve.data_path in paths]:
        drivers.remove(driver)
    if found:
        owner.update_tag()
    return paths
