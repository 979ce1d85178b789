"""A1 to A13: one part of the method at a time."""
from chapter import Chapter
from fresh_tables import biases
from inference import ratio_of
from results import canonical
from results import options as o
from tables import curves, finding, pool_title, table, with_interval

M, P = "multiscale", "multiscale:paper"
METRICS = {"mse": "the MSE", "relmse": "relMSE"}


def as_printed(method):
    """The same options in the preset `paper`."""
    name, brace, text = method.partition("{")
    return f"{name}:paper{brace}{text}"


def sampling(variants, statements, column="mse", above=0, of_paper=()):
    """Tables of sampler variants, raw and filtered, and whether the statements came out, at budgets above `above`; of the preset `paper`
    where it was run, and `of_paper` of that preset alone."""
    def body(m):
        r = m.results
        more = [s for s in r.samplers if s != "uniform" and s not in map(canonical, variants)]
        blocks = [curves(r, pool, column, methods=[(v, f) for f in r.filters for v in (*variants, *more)]) for pool in r.pools]
        budgets = [b for b in r.budgets if b > above]
        said = [finding(f"{text}, {f}", r, (a, f), (b, f), budgets=budgets) for text, a, b in statements for f in r.filters]
        said += [finding(f"preset paper: {text.replace('the default reading', 'fractional')}, {f}", r, (as_printed(a), f), (as_printed(b), f), budgets=budgets)
                 for text, a, b in statements for f in r.filters if canonical(as_printed(a)) in more and canonical(as_printed(b)) in more]
        said += [finding(f"preset paper: {text}, {f}", r, (a, f), (b, f), budgets=budgets) for text, a, b in of_paper for f in r.filters]
        return [*blocks, "\n".join(said), f"The statements are about {METRICS[column]}."]
    return body


def filtering(statements):
    """Tables of filter variants over uniform and multiscale samples. Each statement ends with its metric."""
    def body(m):
        r = m.results
        said = [finding(f"{text}, {s} samples", r, (s, a), (s, b), "relmse" if text.endswith(" relMSE") else "mse")
                for text, a, b in statements for s in r.samplers]
        return [*(curves(r, pool, column) for pool in r.pools for column in ("relmse",)), "\n".join(said)]
    return body


def size_rule(m):
    r = m.results
    rule = lambda v, f, s: o("directional", f"size_variance={v},size_factor={f},size_smooth={s}")  # noqa: E731
    ours = rule("coarse_var", "const(0.5)", "opens_only")
    said = [finding(f"{text}, {s} samples, relMSE", r, (s, ours), (s, b), "relmse")
            for text, b in (("the default is below contrast in eq 9", rule("contrast", "const(0.5)", "opens_only")),
                            ("the default is below the literal factor", rule("coarse_var", "literal", "opens_only")),
                            ("the default is below the clamped factor", rule("coarse_var", "literal_clamped", "opens_only")),
                            ("the default is below votes that also close", rule("coarse_var", "const(0.5)", "on")),
                            ("the default is below no vote", rule("coarse_var", "const(0.5)", "off")))
            for s in r.samplers]
    printed = lambda v, f: ("multiscale:paper", o("directional:paper", f"size_variance={v},size_factor={f}"))  # noqa: E731
    said += [finding(f"preset paper: {text}", r, a, b, "relmse") for text, a, b in (
        ("the variance of the coarse mean is below the contrast of eq 6",
         printed("coarse_var", "literal"), printed("contrast", "literal")),
        ("the factor of eq 9 is below its reciprocal, which is what it stands for in Rousselle's criterion",
         printed("contrast", "literal"), printed("contrast", "inverse")))]
    return [*(curves(r, pool, "relmse", methods=[(M, f) for f in r.filters]) for pool in r.pools), "\n".join(said),
            "The statements are about relMSE."]


def pool_size(m):
    r = m.results
    rows, shares = [], []
    for sampler in r.samplers:
        row, share = [sampler], [sampler]
        for pool in r.pools:
            cell = (pool, sampler, "box", 16)
            row.append(with_interval(r.ratio("mse", pool, 16, (sampler, "box"), ("uniform", "box"))))
            values = r.values("saturated_share", *cell)
            share.append(f"{100 * sum(values) / len(values):.1f} %" if values else "–")
        rows.append(row)
        shares.append(share)
    header = ["samples per pixel recorded", *(p.rsplit("_n")[-1] for p in r.pools)]
    return ["Scene S at 16 samples per pixel, MSE relative to uniform:\n\n" + table(header, rows),
            "Share of the pixels that ran out of samples:\n\n" + table(header, shares)]


def references(m):
    kinds = {plan.removeprefix("a11_reference_"): r for plan, r in m.by_plan.items()}
    truth = kinds["independent"]
    blocks = []
    for pool in truth.pools:
        rows = []
        for sampler in truth.samplers:
            for f in truth.filters:
                cell = ("mse", pool, sampler, f, 16)
                rows.append([f"{sampler} + {f}", with_interval(truth.figure(*cell)),
                             *(with_interval(ratio_of(r.values(*cell), truth.values(*cell)))
                               for kind, r in kinds.items() if kind != "independent")])
        blocks.append(f"{pool_title(pool)}, MSE at 16 samples per pixel, and what each reference makes of it:\n\n"
                      + table(["method", "independent", *(f"{k} / independent" for k in kinds if k != "independent")], rows))
    found = {}
    for kind, r in kinds.items():
        values = [ratio_of(r.values("mse", p, s, f, 16), truth.values("mse", p, s, f, 16)).mean
                  for p in truth.pools for s in truth.samplers for f in truth.filters]
        values = [v for v in values if v == v]
        found[kind] = f"{min(values):.2f} to {max(values):.2f}"
    uniform = ratio_of(kinds["pool"].values("mse", "scene_s", "uniform", "box", 16),
                    truth.values("mse", "scene_s", "uniform", "box", 16))
    blocks.append("- Expected for fixed counts and no filter when judged by a pool of n samples: 1 - 16/n, which is 0.75 for 64 and "
                  f"0.94 for 256. Scene S, uniform, box: {with_interval(uniform)}.\n"
                  f"- Over all methods and pools the ratio to the true error goes from {found['pool']} when judged by the pool, "
                  f"{found['holdout']} by samples held out, {found['leave_selected_out']} by samples not selected. "
                  "The pool shares its noise with the image: that is a bias, and differs from method to method. The other two share none; "
                  "their own noise can be as large as the error.")
    return blocks


def reconstruction_alone(m):
    r = m.results
    said = [finding(f"{shown}directional is below {f} in relMSE", r, ("uniform", ours), ("uniform", f), "relmse")
            for shown, ours in (("", "directional"), ("preset paper: ", "directional:paper")) for f in ("gaussian", "greedy_selection", "nl_means")]
    coarse = o("directional:paper", "size_variance=coarse_var")
    if coarse in r.filters:
        said.append(finding("preset paper: with S the variance of the coarse mean it is below the preset as it is in relMSE", r,
                            ("uniform", coarse), ("uniform", "directional:paper"), "relmse"))
    return [*(curves(r, pool, column) for pool in r.pools for column in ("mse", "relmse")),
            *biases(r, r.budgets[0], [("uniform", f) for f in r.filters if f != "oracle_scale" and "{" not in f]), "\n".join(said)]


def paper_tiles(m):
    r = m.results
    whole, printed = o(P, "tile=0"), "directional:paper"
    said = [finding(f"preset paper: without tiles is below tiles of 64 in {c}, {f}", r, (whole, f), (P, f), c.lower())
            for c in ("MSE", "relMSE") for f in ("box", printed)]
    said += [finding(f"preset paper, {shown}: is below uniform sampling in {c}, {f}", r, (s, f), ("uniform", "box"), c.lower())
             for c in ("MSE", "relMSE") for f in ("box", printed) for shown, s in (("tiles of 64", P), ("without tiles", whole))]
    return [*(curves(r, pool, column) for pool in r.pools for column in ("mse", "relmse")), "\n".join(said)]


def alpha(a):
    return o(M, f"alpha={a}")


CHAPTERS = [
    Chapter("A1", "Attenuation: off, and the readings of eq 7", ["a1_attenuation"],
            "Eqs 7 and 8 are missing from the printed text; without attenuation a prototype lost to uniform sampling.",
            sampling([o(M, f"A_update={u}") for u in ("fractional", "region", "any_touch", "accumulate", "none")],
                     [(f"the default reading is below '{u}'", o(M, "A_update=fractional"), o(M, f"A_update={u}"))
                      for u in ("region", "any_touch", "accumulate", "none")])),
    Chapter("A2", "The difference term of eq 5", ["a2_detail_term"], "Eq 5 adds |d|² to the contrast.",
            sampling([o(M, f"d_norm={d}") for d in ("absolute", "off", "relative")] + [o(M, "d_index=same_k")],
                     [("with |d|² is below without", o(M, "d_norm=absolute"), o(M, "d_norm=off")),
                      ("absolute is below relative", o(M, "d_norm=absolute"), o(M, "d_norm=relative"))])),
    Chapter("A3", "alpha of eq 7", ["a3_alpha"], "0.3 to 0.5.",
            sampling([alpha(a) for a in (0.3, 0.4, 0.5)],
                     [("0.3 is below 0.4", alpha(0.3), alpha(0.4)), ("0.5 is below 0.4", alpha(0.5), alpha(0.4))])),
    Chapter("A4", "Initial samples", ["a4_initial_samples"], "At least one.",
            sampling([o(M, f"init_spp={n}") for n in (1, 2, 4)],
                     [("2 is below 1", o(M, "init_spp=2"), o(M, "init_spp=1")),
                      ("4 is below 2", o(M, "init_spp=4"), o(M, "init_spp=2"))], above=4)),  # with 4 at first a budget of 4 is uniform
    Chapter("A5", "Epochs: many regions a step, or one", ["a5_epochs"], "One region at a time.",
            sampling([o(M, "update=exact")] + [o(M, f"epochs={n}") for n in (4, 16, 64, 256)],
                     [(f"one region a step is below {n} epochs", o(M, "update=exact"), o(M, f"epochs={n}"))
                      for n in (4, 16, 64, 256)],
                     of_paper=[("one region a step is below many", o(P, "update=exact"), o(P, "update=epoch"))])),
    Chapter("A6", "Size of the filter (eq 9)", ["a6_size_rule"],
            "The contrast of eq 6 stands for the variance, with the factor as printed.", size_rule),
    Chapter("A7", "Angle of a band and eq 12", ["a7_angle"], "Eq 12 has its weights exchanged in print.",
            filtering([("the tangent is below the normal, MSE", o("directional", "angle=tangent,eq12=corrected"),
                        o("directional", "angle=normal,eq12=corrected")),
                       ("eq 12 corrected is below eq 12 as printed, MSE", o("directional", "angle=tangent,eq12=corrected"),
                        o("directional", "angle=tangent,eq12=literal")),
                       ("preset paper: the tangent is below the normal, MSE",
                        o("directional:paper", "angle=tangent,eq12=corrected"),
                        o("directional:paper", "angle=normal,eq12=corrected"))])),
    Chapter("A8", "Filter bank: stages and sign filter", ["a8_filter_bank"], "Two or three stages.",
            filtering([("three stages are below one, MSE", o("directional", "anisotropy=bank,bank_levels=3,bank_taps=pkva12"),
                        o("directional", "anisotropy=bank,bank_levels=1,bank_taps=pkva12")),
                       ("three stages are below two, MSE", o("directional", "anisotropy=bank,bank_levels=3,bank_taps=pkva12"),
                        o("directional", "anisotropy=bank,bank_levels=2,bank_taps=pkva12")),
                       ("12 taps are below 6, MSE", o("directional", "anisotropy=bank,bank_levels=3,bank_taps=pkva12"),
                        o("directional", "anisotropy=bank,bank_levels=3,bank_taps=pkva6")),
                       ("the bank is below the structure tensor, MSE", o("directional", "anisotropy=bank,bank_levels=3,bank_taps=pkva12"),
                        o("directional", "anisotropy=structure_tensor")),
                       ("the bank is below the isotropic filter, MSE", o("directional", "anisotropy=bank,bank_levels=3,bank_taps=pkva12"),
                        o("directional", "anisotropy=none")),
                       *((f"the structure tensor, which is the default, is below the isotropic filter, {metric}", o("directional", "anisotropy=structure_tensor"),
                          o("directional", "anisotropy=none")) for metric in ("MSE", "relMSE"))])),
    Chapter("A9", "Weight of a sample", ["a9_weighting"], "Eq 10 weighs each sample by its distance.",
            filtering([*((f"each piece alike is below each sample alike, {metric}", o("directional", "weighting=per_piece,recon_granularity=piece"),
                          o("directional", "weighting=per_sample,recon_granularity=piece")) for metric in ("MSE", "relMSE")),
                       ("positions of samples are below centres of pieces, MSE",
                        o("directional", "weighting=per_sample,recon_granularity=sample"),
                        o("directional", "weighting=per_sample,recon_granularity=piece"))]),
            apart="Film positions are recorded per pass (chess) or not at all: `recon_granularity=sample` then differs "
                  "little or not."),
    Chapter("A10", "Size of the pool", ["a10_pool_size"],
            "What a replay loses when a pixel runs out of recorded samples.", pool_size),
    Chapter("A11", "What an image is judged by", [f"a11_reference_{k}" for k in
                                                  ("independent", "holdout", "leave_selected_out", "pool")],
            "Judging by the pool that the samples came from is common and biased.", references),
    Chapter("A12", "Filters alone: uniform samples", ["a12_reconstruction_alone"],
            "How much of the gain is the filter's.", reconstruction_alone, stand_in="methods"),
    Chapter("A13", "Tiles of the preset `paper`", ["a13_paper_tiles"],
            "The preset works in tiles of 64 pixels, each with its share of the budget: what of its error is theirs?", paper_tiles),
]
