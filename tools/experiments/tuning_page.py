"""docs/tuning.md: the candidates, the choices, and where the target is met and missed."""
from tables import number, pool_title, table, with_interval
from tuning_choice import ENERGY_BAND, ENERGY_WEIGHT, Scores, average
from tuning_gain import gain, gain_text, pooled
from tuning_pools import ALONE, APART_ANALYTIC, APART_RECORDED, CHOOSING, RECORDED, SECOND
from tuning_verdict import MET, MISSED, NOISE, RIVALS, energy_parts, reasons, verdict

HEAD = f"""# Tuning of `robust`

Generated from what `spool evaluate` measured; no figure is typed:

    tools/dev.sh tune                 candidates, choices, judgement and this page; what is done is not done again
    tools/dev.sh tune --write-only    only this page

It runs `spool evaluate tools/plans/tuning.toml -o build/tuning/candidates`, chooses, and writes and runs a plan in
`build/tuning/judged` for each pool. Images are judged by independent references, differences taken within replicates.

Most of this page is about pictures of 64 x 64 pixels. What recordings of full size choose, each left out in turn, and why the defaults
stay, is said at its end: [At full size](#at-full-size).

**The question:** which options should `multiscale` + `directional` have, and does the answer hold on a picture that
took no part in it? **The target**, on each pool at 4, 8 and 16 samples per pixel: relMSE at or below that of
{', '.join(' + '.join(r) for r in RIVALS)}; energy ratio within {ENERGY_BAND[0]} .. {ENERGY_BAND[1]}.

**The rule of choice.** The score of a candidate on a pool is the mean over budgets and replicates of ln(relMSE / relMSE of today's
defaults), plus {ENERGY_WEIGHT:g} times the distance of its energy ratio from the band: 1 % of energy outside counts as
{ENERGY_WEIGHT:g} % of relMSE. On several pools it is the mean of theirs. Level with the best is what lies within one
standard error of the paired difference over replicates; of those the candidate that changes the fewest
defaults is taken, then the one with the lower score, then the first of the plan.

**Who chooses.** {', '.join(CHOOSING)}: one recording per scene. Each is left out in turn: the other four choose, and
the choice is judged on it. {' and '.join(f'{p} (a second recording of {s})' for p, s in SECOND.items())} are judged by
the choice that left their scene out. **Kept apart**, outside every choice: {', '.join(APART_RECORDED)}, scene S with and
without fireflies, and the stress pools. What leaving out cannot undo: the list of candidates was written, and the defaults
were found, by people who had seen results on these pools; scene S is where the first prototypes were tuned. All pools that
choose are 64 x 64 pixels."""

MARKS = {MET: "met", NOISE: "*missed within the noise*", MISSED: "**missed**"}


def options_text(candidate):
    said = [f"{o}={v}" for o, v in candidate.sampler], [f"{o}={v}" for o, v in candidate.filter]
    parts = [f"{name}: `{', '.join(options)}`" for name, options in zip(("sampler", "filter"), said) if options]
    return "; ".join(parts) or "the defaults"


def varied(candidates, part):
    """Each option that differs from its default in some candidate, with its values."""
    values = {}
    for candidate in candidates:
        for option, value in getattr(candidate, part):
            values.setdefault(option, {})[value] = None
    return ", ".join(f"`{option}` {', '.join(seen)}" for option, seen in values.items()) or "none"


def candidates_section(scores):
    lines = [f"{len(scores.candidates)} settings (`tools/plans/tuning.toml`), the defaults among them. Other than by default were:",
             f"- sampler: {varied(scores.candidates, 'sampler')}\n- filter: {varied(scores.candidates, 'filter')}"]
    if scores.incomplete:
        lines.append(f"{len(scores.incomplete)} more failed on some pool and took no part.")
    return ["## Candidates", *lines]


def choices_section(scores, left_out, from_all, judged, chosen, defaults, budgets):
    gains = {p: gain(judged, p, chosen[p], defaults, budgets) for p in CHOOSING if p in chosen}
    rows = [[pool_title(p), options_text(c.candidate), str(c.tied), number(c.score), number(c.default_score),
             *([gain_text(gains[p])[0], gain_text(gain(judged, p, chosen[p], defaults, budgets, "mse"))[0]] if p in gains
               else ["not judged yet"] * 2)]
            for p, c in left_out.items()]
    rows.append(["*none: from all five*", options_text(from_all.candidate), str(from_all.tied), number(from_all.score),
                 number(from_all.default_score), "–", "–"])
    blocks = ["## The choices", table(["left out", "choice of the other pools", "level with the best", "score", "score of the defaults",
                                      "relMSE on the pool left out, against the defaults (95 %)", "MSE"], rows)]
    outcome, sign = gain_text(pooled(gains.values()))
    same = from_all.candidate.changes == 0
    blocks.append(f"**Today's defaults {'are' if same else 'are not'} the choice from all five pools"
                  + ("" if same else f", which is: {options_text(from_all.candidate)}") + ".** "
                  + f"On pools left out, what the others chose changes relMSE by {outcome} against the defaults, geometric mean over "
                  + f"pools and budgets: {'lower' if sign > 0 else 'higher' if sign < 0 else 'not different'} beyond the noise of the samples."
                  + " The interval is over replicates, not over scenes.")
    blocks.append(energies(judged, chosen, defaults, budgets))
    if not same and any(p in chosen for p in (*APART_RECORDED, *APART_ANALYTIC)):
        apart = {p: gain(judged, p, chosen[p], defaults, budgets) for p in (*APART_RECORDED, *APART_ANALYTIC) if p in chosen}
        blocks += ["The choice from all five against the defaults, on pools kept apart:",
                   table(["pool", "relMSE (95 %)"], [*([pool_title(p), gain_text(g)[0]] for p, g in apart.items()),
                                                     ["*geometric mean*", gain_text(pooled(apart.values()))[0]]])]
        if gain_text(pooled(apart.values()))[1] < 0 < sign:
            blocks.append("**What was chosen helps on the recordings left out and harms on the pools kept apart:** the choice is "
                          "fitted to what the five recordings have in common, not to pictures at large.")
    return blocks


def energies(judged, chosen, defaults, budgets):
    def middle(methods):
        return average([abs(1 - judged.figure("energy_ratio", p, *methods[p], b).mean) for p in CHOOSING if p in chosen for b in budgets])
    return (f"Energy, mean distance from 1 over the five pools, left out, and budgets: {middle(chosen):.3f}; "
            f"the defaults {middle({p: defaults for p in CHOOSING}):.3f}; "
            + "; ".join(f"{' + '.join(r)} {middle({p: r for p in CHOOSING}):.3f}" for r in RIVALS) + ".")


def leaders_section(scores, count=10):
    unchanged = next((c for c in scores.candidates if c.changes == 0), None)
    ranked = sorted(scores.candidates, key=lambda c: (scores.score(c, CHOOSING), c.place))
    rows = []
    for candidate in [*ranked[:count], *([unchanged] if unchanged and unchanged not in ranked[:count] else [])]:
        difference, error = scores.difference(candidate, ranked[0], CHOOSING)
        rows.append([str(ranked.index(candidate) + 1), options_text(candidate), number(scores.score(candidate, CHOOSING)),
                     f"{difference:.3f} ± {error:.3f}"])
    blocks = ["## The best on all five pools", "A difference of 0.01 is 1 % of relMSE. These had their say: their scores flatter them.",
              table(["rank", "options", "score", "above the first"], rows)]
    others = []
    for weight in (0.0, 5.0):
        choice = Scores(scores.cells, CHOOSING, weight).choose(CHOOSING)
        others.append(f"with weight {weight:g} of the energy: {options_text(choice.candidate)}")
    return [*blocks, f"The weight {ENERGY_WEIGHT:g} of the energy is a decision, not a measurement. The choice from all five "
            + "; ".join(others) + "."]


def target_table(judged, pools, methods, budgets):
    rows = []
    for pool in pools:
        for spp in budgets:
            ours = judged.figure("relmse", pool, *methods[pool], spp)
            if ours.mean != ours.mean:
                continue
            said = verdict(judged, pool, spp, *methods[pool])
            cells = []
            for rival, word in zip(RIVALS, said.rivals):
                ratio = with_interval(judged.ratio("relmse", pool, spp, methods[pool], rival))
                cells.append({MISSED: f"**{ratio}**", NOISE: f"*{ratio}*"}.get(word, ratio))
            energy = with_interval(judged.figure("energy_ratio", pool, *methods[pool], spp))
            cells.append({MISSED: f"**{energy}**", NOISE: f"*{energy}*"}.get(said.energy, energy))
            missed = (["relMSE"] if set(said.rivals) & {MISSED, NOISE} else []) + (["energy"] if said.energy in (MISSED, NOISE) else [])
            rows.append([pool_title(pool), f"{spp:g}", with_interval(ours), *cells,
                         MARKS.get(said.word, said.word) + (f" ({', '.join(missed)})" if missed else "")])
    return table(["pool", "spp", "relMSE", *(f"relMSE / {' + '.join(r)}" for r in RIVALS), "energy", "target"], rows)


def tally(judged, pools, methods, budgets):
    """'relMSE 20 of 24 met, ...' """
    found = [verdict(judged, p, b, *methods[p]) for p in pools for b in budgets]
    error = [all(w == MET for w in v.rivals) for v in found]
    beyond = [MISSED in v.rivals for v in found]
    energy = [v.energy == MET for v in found]
    both = [v.word == MET for v in found]
    return (f"relMSE is met in {sum(error)} of {len(found)} cells and missed beyond the noise in {sum(beyond)}; energy is met in "
            f"{sum(energy)}; both in {sum(both)}")


def rival_energy(judged, pools, budgets):
    methods = [(r, sum(verdict(judged, p, b, *r).energy == MET for p in pools for b in budgets)) for r in RIVALS]
    return "The rivals keep the energy in " + ", ".join(f"{n} ({' + '.join(r)})" for r, n in methods) + f" of {len(pools) * len(budgets)}."


def misses(judged, pools, methods, budgets):
    rows = [[pool_title(pool), f"{spp:g}", *reason] for pool in pools for spp in budgets
            for reason in reasons(judged, pool, spp, methods[pool])]
    if not rows:
        return "None."
    return table(["pool", "spp", "rival", "verdict", "our relMSE / its", "its filter on our samples", "our filter on its samples",
                  "helps most to exchange", "our error in the worst 0.1 % of the pixels"], rows)


def energy_misses(judged, pools, methods, budgets):
    rows = [[pool_title(pool), f"{spp:g}", *energy_parts(judged, pool, spp, methods[pool])] for pool in pools for spp in budgets
            if verdict(judged, pool, spp, *methods[pool]).energy in (MISSED, NOISE)]
    if not rows:
        return "None."
    return table(["pool", "spp", "energy", "by the samples alone (box)", "by the filter", "energy of the filter on uniform samples"], rows)


def target_section(title, judged, pools, chosen, defaults, budgets):
    left, pools = [p for p in pools if p not in chosen], [p for p in pools if p in chosen]
    if not pools:
        return [f"## {title}", "**Not judged yet.**"]
    return [f"## {title}", f"**Not judged yet: {', '.join(left)}.**" if left else "", "Ratios with their 95 % intervals over paired replicates. **Bold**: missed beyond the noise; *italic*: the "
            "mean misses, within the noise.", target_table(judged, pools, chosen, budgets),
            f"With the choice: {tally(judged, pools, chosen, budgets)}. With today's defaults: "
            f"{tally(judged, pools, {p: defaults for p in pools}, budgets)}. {rival_energy(judged, pools, budgets)}",
            "Where relMSE is missed, and why: one part is exchanged for the rival's, the other kept.",
            misses(judged, pools, chosen, budgets), "Where energy is missed, and which of the two loses it:",
            energy_misses(judged, pools, chosen, budgets)]


def defaults_section(from_all, judged, pools, chosen, defaults, budgets):
    """What people get who set nothing, where that is not the choice."""
    pools = [p for p in pools if p in chosen]
    if from_all.candidate.changes == 0 or not pools:
        return []
    return ["## The target with today's defaults", target_table(judged, pools, {p: defaults for p in pools}, budgets)]


def single_section(scores):
    """What each option is worth alone, on each pool that chooses."""
    unchanged = next((c for c in scores.candidates if c.changes == 0), None)
    alone = [c for c in scores.candidates if c.changes == 1] if unchanged else []
    if not alone:
        return []
    def change(candidate, pools):
        return f"{scores.difference(candidate, unchanged, pools)[0]:+.3f}"
    alone.sort(key=lambda c: scores.difference(c, unchanged, CHOOSING)[0])
    return ["## One option at a time", "Score less that of the defaults; -0.01 is 1 % of relMSE gained.",
            table(["option", "all", *map(pool_title, CHOOSING)],
                  [[options_text(c), change(c, CHOOSING), *(change(c, [p]) for p in CHOOSING)] for c in alone])]


def alone_section(alone, settings, defaults):
    """Each change of the choice alone, and all together, on pools that chose nothing, two of them at two sizes."""
    rows = [[options_text(c), *(with_interval(alone.ratio("relmse", p, 8, m, defaults)) for p in ALONE)]
            for c, m in settings]
    def worse(methods):
        return any(alone.order("relmse", p, 8, methods, defaults) == 1 for p in ALONE)
    harmful, harmless = ([options_text(c) for c, m in settings if worse(m) == sign] for sign in (True, False))
    return ["## The choice, change by change, on pools kept apart", "relMSE relative to the defaults at 8 samples per pixel. With twice "
            "the pixels a side, what helps because details are few pixels wide helps no more. Scene S is grey: deciding by channel "
            "changes nothing there.", table(["options", *map(pool_title, ALONE)], rows),
            f"Above the defaults beyond the noise on some of these: {' / '.join(harmful) or 'none'}. On none: {' / '.join(harmless) or 'none'}."]


def page(scores, left_out, from_all, judged, chosen, defaults, budgets, alone=None):
    seen = [p for p in RECORDED if p not in APART_RECORDED]
    blocks = [HEAD, *choices_section(scores, left_out, from_all, judged, chosen, defaults, budgets),
              *target_section("The target on recorded pools, each left out of its choice", judged, seen, chosen, defaults, budgets),
              *target_section("The target on pools kept apart", judged, [*APART_RECORDED, *APART_ANALYTIC], chosen, defaults, budgets),
              *defaults_section(from_all, judged, [*seen, *APART_RECORDED, *APART_ANALYTIC], chosen, defaults, budgets),
              *(alone_section(*alone, defaults) if alone else ()),
              *candidates_section(scores), *single_section(scores), *leaders_section(scores)]
    return "\n\n".join(block for block in blocks if block) + "\n"
