"""Which pools choose, which are left out with one of them, and which are kept apart from choosing."""

# One recording per scene. Each is left out in turn.
CHOOSING = ["balls", "caustic", "chess", "mist", "table"]

# Second recordings of a scene: judged by the choice that left that scene out.
SECOND = {"caustic_mitsuba": "caustic", "chess_sequence": "chess"}

# Never part of any choice.
APART_RECORDED = ["fireflies"]
APART_ANALYTIC = ["scene_s", "scene_s_fireflies", "stress_slanted_edge", "stress_soft_shadow", "stress_streaks",
                  "stress_fine_checker", "stress_fireflies"]
# Each change of the choice is looked at alone on these. _128: the same scene with twice the pixels a side: does a choice
# hold where everything is twice as many pixels wide?
LARGER = ["scene_s_128", "scene_s_fireflies_128"]
ALONE = ["fireflies", "scene_s", "scene_s_128", "scene_s_fireflies", "scene_s_fireflies_128"]
APART = APART_RECORDED + APART_ANALYTIC

RECORDED = ["balls", "caustic", "caustic_mitsuba", "chess", "chess_sequence", "fireflies", "mist", "table"]


def recording(pool):
    """Its file, from the top of the tree."""
    return f"tools/plans/pools/{pool}.spool" if pool in (*APART_ANALYTIC, *LARGER) else f"dumps/tiny/{pool}.spool"
