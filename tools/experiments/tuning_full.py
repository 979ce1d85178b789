"""The part of docs/tuning.md about recordings of full size: which options they choose, each left out, and what that does elsewhere.

The candidates are those of tools/plans/tuning_full.toml, measured recording by recording and kept as the experiments are (measured.py).
"""
from results import Results
from tables import number, pool_title, table, with_interval
from tuning_choice import Candidate, Scores, average
from tuning_gain import gain, gain_text, pooled

PLAN = "tuning_full"
# Of each scene one chooses. Kept apart: pictures by others of kinds that no scene of ours has, fireflies, and scene S.
CHOOSING = ("chess_256", "balls_256", "table_256", "mist_256", "cornell_box_picture", "torus", "caustic_mitsuba_256")
APART = ("thin_lens", "matpreview", "fireflies_256", "scene_s", "scene_s_fireflies")
BUDGETS = (4, 16)
DEFAULTS = ("multiscale", "directional")
TITLE = "## At full size"
NO_CHOICE = "Choosing with one left out needs three recordings that choose: nothing is concluded yet, and the defaults stay."


def options_of(label):
    """((option, value), ...) of a method's label: the plan names an option only where it differs from the default. A preset is one change."""
    name, _, text = label.partition("{")
    preset = (("preset", name.partition(":")[2]),) if ":" in name else ()
    return preset + tuple(tuple(part.split("=", 1)) for part in text.removesuffix("}").split(",") if part)


def candidates(results, pools):
    """{Candidate: {pool: [(relMSE, energy, relMSE of the defaults) of each budget]}}, and each candidate's method."""
    cells, methods = {}, {}
    for s in results.samplers:
        for f in results.filters:
            candidate = Candidate(options_of(s), options_of(f), len(cells))
            methods[candidate] = (s, f)
            cells[candidate] = {p: [(results.values("relmse", p, s, f, b), results.values("energy_ratio", p, s, f, b),
                                     results.values("relmse", p, *DEFAULTS, b)) for b in BUDGETS] for p in pools}
    return cells, methods


def said(candidate):
    parts = [f"{name}: `{', '.join(f'{o}={v}' for o, v in options)}`"
             for name, options in (("sampler", candidate.sampler), ("filter", candidate.filter)) if options]
    return "; ".join(parts) or "the defaults"


def energy(results, pools, method):
    """Mean distance from 1, over recordings and budgets."""
    return average([abs(1 - results.figure("energy_ratio", p, *method, b).mean) for p in pools for b in BUDGETS])


def left_out_rows(results, scores, methods, pools):
    rows, gains = [], []
    for pool, choice in scores.leave_one_out(pools).items():
        method = methods[choice.candidate]
        gains.append(gain(results, pool, method, DEFAULTS, BUDGETS))
        rows.append([pool_title(pool), said(choice.candidate), str(choice.tied), gain_text(gains[-1])[0],
                     f"{energy(results, [pool], method):.3f}", f"{energy(results, [pool], DEFAULTS):.3f}"])
    return rows, gains


def apart_rows(results, pools, method):
    gains = [gain(results, p, method, DEFAULTS, BUDGETS) for p in pools]
    return [[pool_title(p), gain_text(g)[0], f"{energy(results, [p], method):.3f}", f"{energy(results, [p], DEFAULTS):.3f}"]
            for p, g in zip(pools, gains)], gains


def alone_rows(results, scores, methods, choosing, apart):
    """relMSE of each candidate over that of the defaults at the larger budget, recording by recording."""
    rows = []
    for candidate in sorted(scores.candidates, key=lambda c: scores.score(c, choosing)):
        if candidate.changes:
            rows.append([said(candidate), number(scores.score(candidate, choosing)), *(
                with_interval(results.ratio("relmse", p, BUDGETS[-1], methods[candidate], DEFAULTS)) for p in (*choosing, *apart))])
    return rows


def outcome(choice, left_gains, apart_gains):
    """What the figures ask for, in words."""
    if choice.candidate.changes == 0:
        return "**Today's defaults are the choice of all of them: nothing changes.**"
    inside = gain_text(pooled(left_gains))
    text = f"All of them together choose {said(choice.candidate)}. On recordings left out, what the others chose changes relMSE by {inside[0]}"
    if not apart_gains:
        return text + "."
    outside = gain_text(pooled(apart_gains))
    return text + (f"; on those kept apart their choice changes it by {outside[0]}. " + (
        "**Both are below 0 beyond the noise of the samples: the defaults should change.**" if inside[1] > 0 and outside[1] > 0 else
        "**It does not help on both beyond the noise of the samples: the defaults stay.**"))


def section(sources, missing):
    """The part as text; sources: files of measured.py."""
    results = Results(sources)
    choosing, apart = ([p for p in names if p in results.pools] for names in (CHOOSING, APART))
    measured_on = f"Measured on {', '.join(map(pool_title, results.pools)) or 'nothing yet'}." + (
        f" Not measured yet: {', '.join(map(pool_title, missing))}." if missing else "")
    head = [TITLE, "Generated by `tools/dev.sh tune --full` from what was measured on any machine "
            f"(`docs/results/experiments_full/measured/{PLAN}`); the candidates are those of `tools/plans/{PLAN}.toml`, at "
            f"{' and '.join(f'{b:g}' for b in BUDGETS)} samples per pixel, and the rule of choice is the one above, energy included.", measured_on]
    if not choosing:
        return "\n\n".join([*head, NO_CHOICE]) + "\n"
    cells, methods = candidates(results, choosing)
    scores = Scores(cells, choosing)
    each = [f"Each candidate at {BUDGETS[-1]} samples per pixel, relMSE over that of the defaults; score on those that choose (-0.01 is 1 %):",
            table(["options", "score", *map(pool_title, (*choosing, *apart))], alone_rows(results, scores, methods, choosing, apart))]
    if len(choosing) < 3:
        return "\n\n".join([*head, NO_CHOICE, *each]) + "\n"
    rows, left_gains = left_out_rows(results, scores, methods, choosing)
    choice = scores.choose(choosing)
    others, apart_gains = apart_rows(results, apart, methods[choice.candidate])
    blocks = [*head, outcome(choice, left_gains, apart_gains),
              table(["left out", "choice of the others", "level with the best", "relMSE on the one left out, against the defaults (95 %)",
                     "energy, distance from 1", "that of the defaults"], rows)]
    if others:
        blocks += ["The choice of all on recordings kept apart:",
                   table(["recording", "relMSE against the defaults (95 %)", "energy, distance from 1", "that of the defaults"], others)]
    return "\n\n".join([*blocks, *each]) + "\n"
