"""One experiment of docs/experiments.md: its plans, what the paper says, and how its figures are shown."""
from dataclasses import dataclass
from typing import Callable


@dataclass
class Chapter:
    id: str
    title: str
    plans: list            # names in tools/plans, without .toml
    paper: str             # what the paper reports, or why the question is asked
    body: Callable         # Material -> list of Markdown blocks
    density: bool = False  # also measure the density of the plan's samplers
    apart: str = ""        # what cannot be replayed on our pools, and why
    optional: tuple = ()   # further plans, shown when they were run
    stand_in: str = ""     # a plan with the same methods, whose results are shown while its own were not made
    apart_at_full: str | None = None  # instead of `apart` on recordings of full size

    def head(self):
        """Its heading, and what is asked of it."""
        numbered = f"{self.id}: " if self.id[0] in "EA" else ""
        return [f"## {numbered}{self.title}", f"*{'The paper says' if self.id[0] == 'E' else 'Asked'}:* {self.paper}"]

    def apart_full(self):
        return self.apart if self.apart_at_full is None else self.apart_at_full


@dataclass
class Material:
    """What a chapter is written from."""
    results: object        # Results of its plans
    density: dict          # {(pool, sampler, spp): {measure: [one per replicate]}}
    by_plan: dict          # {plan: Results}
    every_cell: str = ""   # where every figure is to be found
