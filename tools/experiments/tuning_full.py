"""The part of docs/tuning.md about recordings of full size: which options they choose, each left out, and what that does elsewhere.

The candidates are those of tools/plans/tuning_full.toml, measured recording by recording and kept as the experiments are (measured.py).
"""
from results import Results
from tables import number, pool_title, table, with_interval
from tuning_choice import Candidate, Scores, average
from tuning_gain import gain, gain_text, percent, pooled
from tuning_verdict import RIVALS, verdict

PLAN = "tuning_full"
# Of each scene one chooses. Kept apart: pictures by others of kinds that no scene of ours has, fireflies, and scene S.
CHOOSING = ("chess_256", "balls_256", "table_256", "mist_256", "cornell_box_picture", "torus", "caustic_mitsuba_256")
APART = ("thin_lens", "matpreview", "fireflies_256", "scene_s", "scene_s_fireflies")
BUDGETS = (4, 16)
DEFAULTS = ("multiscale", "directional")
AT_TARGET = ("multiscale{update=epoch}", "directional", 8)  # the defaults in the plans of E9 and E10
TITLE = "## At full size"
NO_CHOICE = "Choosing with one left out needs three recordings that choose: nothing is concluded yet, and the defaults stay."


def options_of(label):
    """((option, value), ...) of a method's label: the plan names an option only where it differs from the default. A preset is one change."""
    name, _, text = label.partition("{")
    preset = (("preset", name.partition(":")[2]),) if ":" in name else ()
    return preset + tuple(tuple(part.split("=", 1)) for part in text.removesuffix("}").split(",") if part)


def methods_of(results):
    """{Candidate: its method}"""
    pairs = [(s, f) for s in results.samplers for f in results.filters]
    return {Candidate(options_of(s), options_of(f), place): (s, f) for place, (s, f) in enumerate(pairs)}


def cells_of(results, methods, pools):
    """{Candidate: {pool: [(relMSE, energy, relMSE of the defaults) of each budget]}}"""
    return {candidate: {p: [(results.values("relmse", p, *method, b), results.values("energy_ratio", p, *method, b),
                             results.values("relmse", p, *DEFAULTS, b)) for b in BUDGETS] for p in pools}
            for candidate, method in methods.items()}


def time_of(results, pools, method):
    """CPU time of sampling and filtering over that of the defaults, all recordings and budgets together; 1 where it was not kept."""
    own, theirs = (sum(sum(results.values(column, p, *m, b)) for column in ("cpu_sampling", "cpu_filtering") for p in pools for b in BUDGETS)
                   for m in (method, DEFAULTS))
    return own / theirs if own and theirs else 1.0


def said(candidate):
    parts = [f"{name}: `{', '.join(f'{o}={v}' for o, v in options)}`"
             for name, options in (("sampler", candidate.sampler), ("filter", candidate.filter)) if options]
    return "; ".join(parts) or "the defaults"


def energy(results, pools, method):
    """Mean distance from 1, over recordings and budgets."""
    return average([abs(1 - results.figure("energy_ratio", p, *method, b).mean) for p in pools for b in BUDGETS])


def gains_of(results, pools, method):
    """Of each recording, both budgets together: those of tuning_gain.gain."""
    return [gain(results, p, method, DEFAULTS, BUDGETS) for p in pools]


def left_out_rows(results, scores, methods, pools):
    rows, gains = [], []
    for pool, choice in scores.leave_one_out(pools).items():
        method = methods[choice.candidate]
        gains += gains_of(results, [pool], method)
        rows.append([pool_title(pool), said(choice.candidate), str(choice.tied), gain_text(gains[-1])[0],
                     f"{energy(results, [pool], method):.3f}", f"{energy(results, [pool], DEFAULTS):.3f}"])
    return rows, gains


def apart_rows(results, pools, method):
    gains = gains_of(results, pools, method)
    return [[pool_title(p), gain_text(g)[0], f"{energy(results, [p], method):.3f}", f"{energy(results, [p], DEFAULTS):.3f}"]
            for p, g in zip(pools, gains)], gains


def ratio_rows(results, scores, methods, choosing, apart, spp):
    """relMSE of each candidate over that of the defaults at this budget, recording by recording."""
    return [[said(candidate), number(scores.score(candidate, choosing)),
             *(with_interval(results.ratio("relmse", p, spp, methods[candidate], DEFAULTS)) if candidate.changes else "1" for p in (*choosing, *apart))]
            for candidate in sorted(scores.candidates, key=lambda c: scores.score(c, choosing))]


def alone_on_both(results, methods, choosing, apart):
    """In words: single options that lower the error on both sets; nothing is left to judge them by."""
    found = []
    for candidate, method in methods.items():
        gains = [gain_text(pooled(gains_of(results, pools, method))) for pools in (choosing, apart) if pools]
        if candidate.changes == 1 and len(gains) == 2 and all(better > 0 for _, better in gains):
            found.append(f"{said(candidate)} ({gains[0][0].split(' (')[0]} and {gains[1][0].split(' (')[0]}, in {time_of(results, (*choosing, *apart), method):.1f} times the time)")
    return ("By themselves these lower relMSE on both sets beyond the noise of the samples: " + "; ".join(found) + ". They are picked here by the very recordings "
            "that would have to judge them, and were not what the rule chose: candidates for the next choice, on recordings that nobody has seen "
            "([decision 154](decisions/0154-defaults-at-full-size.md)).") if found else ""


def one_option_rows(results, methods, choice, choosing, apart):
    """Candidates that change one option, and the choice: gains on both sets, energy, time, and the recording and budget where they are worst."""
    rows = []
    for candidate, method in methods.items():
        if candidate.changes != 1 and candidate != choice:
            continue
        gains = [gains_of(results, pools, method) for pools in (choosing, apart)]
        worst = max(((average(gain(results, p, method, DEFAULTS, [b])), p, b) for p in (*choosing, *apart) for b in BUDGETS))
        rows.append([said(candidate), *(gain_text(pooled(g))[0] if g else "–" for g in gains), gain_text([average(g) for of_set in gains for g in of_set])[0],
                     *(f"{energy(results, pools, method):.3f}" if pools else "–" for pools in (choosing, apart)),
                     f"{time_of(results, (*choosing, *apart), method):.2f}", f"{percent(worst[0])} ({pool_title(worst[1])}, {worst[2]:g} spp)"])
    return rows


def outcome(choice, left_gains, apart_gains):
    """What the figures ask for, in words."""
    if choice.candidate.changes == 0:
        return "**Today's defaults are the choice of all of them: nothing changes.**"
    inside, scenes = gain_text(pooled(left_gains)), gain_text([average(g) for g in left_gains])
    text = (f"Those that choose, all together, choose {said(choice.candidate)}. On recordings left out, what the others chose changes relMSE by {inside[0]}; that interval "
            f"is the noise of the samples. As a statement about other scenes, from {len(left_gains)} of them, it is {scenes[0]}")
    if not apart_gains:
        return text + "."
    outside, each = gain_text(pooled(apart_gains)), sorted(average(g) for g in apart_gains)
    text += f". On those kept apart their choice changes it by {outside[0]}, from {percent(each[0])} to {percent(each[-1])}. "
    if inside[1] <= 0 or outside[1] <= 0:
        return text + "**It does not help on both beyond the noise of the samples: the defaults stay.**"
    if scenes[1] <= 0:
        return text + "**It helps on both beyond the noise of the samples, but not on enough scenes to say so of others: the defaults stay.**"
    return text + "**All three are below 0: the defaults should change.**"


def target_rows(results):
    """Whether the defaults meet the target of this page against each rival, and in energy, recording by recording."""
    sampler, filter_name, spp = AT_TARGET
    for pool in results.pools:  # the rivals of a recording are one family, known when all were asked for
        verdict(results, pool, spp, sampler, filter_name)
    results.judge_asked()
    found = {p: verdict(results, p, spp, sampler, filter_name) for p in results.pools}
    return [[pool_title(p), *v.rivals, f"{results.figure('energy_ratio', p, sampler, filter_name, spp).mean:.3f} ({v.energy})"] for p, v in found.items()]


def section(sources, missing, with_rivals=()):
    """The part as text; sources: files of measured.py; with_rivals: those that hold the rivals of the target."""
    results = Results(sources)
    choosing, apart = ([p for p in names if p in results.pools] for names in (CHOOSING, APART))
    measured_on = (f"Choosing: {', '.join(map(pool_title, choosing)) or 'none yet'}. Kept apart: {', '.join(map(pool_title, apart)) or 'none yet'}.") + (
        f" Not measured yet: {', '.join(map(pool_title, missing))}." if missing else "")
    head = [TITLE, "Generated by `tools/dev.sh tune --full` from what was measured on any machine "
            f"(`docs/results/experiments_full/measured/{PLAN}`); the candidates are those of `tools/plans/{PLAN}.toml`, at "
            f"{' and '.join(f'{b:g}' for b in BUDGETS)} samples per pixel, and the rule of choice is the one above, energy included.", measured_on]
    if not choosing:
        return "\n\n".join([*head, NO_CHOICE]) + "\n"
    everywhere, methods = (*choosing, *apart), methods_of(results)
    scores = Scores(cells_of(results, methods, choosing), choosing)
    each = [block for b in BUDGETS for block in (
        f"Each candidate at {b} samples per pixel, relMSE over that of the defaults; score on those that choose (-0.01 is 1 %):",
        table(["options", "score", *map(pool_title, everywhere)], ratio_rows(results, scores, methods, choosing, apart, b)))]
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
    blocks += [f"One option at a time, and the choice of all; both budgets together. The interval of \"on other scenes\" is over recordings, those that choose and those kept apart together. Energy is its distance from 1 (the defaults: {energy(results, choosing, DEFAULTS):.3f}"
               f"{f', {energy(results, apart, DEFAULTS):.3f}' if apart else ''}), time the CPU time over that of the defaults:",
               table(["one option", "relMSE on those that choose", "on those kept apart", "on other scenes", "energy", "energy, kept apart", "time", "worst relMSE"],
                     one_option_rows(results, methods, choice.candidate, choosing, apart)),
               alone_on_both(results, methods, choosing, apart)]
    if with_rivals:
        blocks += [f"**The target** of this page at {AT_TARGET[-1]} samples per pixel, on the recordings of E9 and E10 ([experiments_full.md](experiments_full.md)), with today's defaults:",
                   table(["target on", *(f"relMSE at or below {' + '.join(r)}" for r in RIVALS), "energy ratio within 0.97 .. 1.03"], target_rows(Results(with_rivals)))]
    return "\n\n".join(filter(None, [*blocks, *each])) + "\n"
