"""Wrong lines that the tests must see: each is put into a copy, and the tests beside it run.

    python tests/mutations.py             all, about a quarter of an hour on 2 cores
    python tests/mutations.py legend      those whose name has that word

Tests marked `long` are left out, as in the usual run. A line that is no longer there is an
error: put another in its place.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent


class Mutation(NamedTuple):
    """A line, what is put in its place, and the tests that must fail."""

    name: str
    file: str
    line: str
    wrong: str
    tests: str


MUTATIONS = (
    Mutation(
        "sign in eq. (9)",
        "arch/theory/sliding.py",
        "rise = sine - thrust * lag_series(square)",
        "rise = sine + thrust * lag_series(square)",
        "test_theory_map.py test_map.py validation/test_cocchetti_rizzi_2024.py",
    ),
    Mutation(
        "half of eq. (9)",
        "arch/theory/sliding.py",
        "target = 2 * np.arctan(",
        "target = np.arctan(",
        "validation/test_cocchetti_rizzi_2024.py",
    ),
    Mutation(
        "stored rotational mode of other nodes",
        "arch/theory/rotation.py",
        "NODES = 36",
        "NODES = 35",
        "test_theory_arrays.py",
    ),
    Mutation(
        "sign of friction in the statics",
        "arch/limit/halfplanes.py",
        "rate = grip * cosine - sign * sine",
        "rate = grip * cosine + sign * sine",
        "test_limit.py",
    ),
    Mutation(
        "order of joints in a mode",
        "arch/modes.py",
        "key=lambda joint: (-joint.angle",
        "key=lambda joint: (joint.angle",
        "test_modes.py",
    ),
    Mutation(
        "inertia of the sector",
        "arch/circular.py",
        "(thick + factor**2 * _sine_deficit(half))",
        "(thick - factor**2 * _sine_deficit(half))",
        "test_arch.py",
    ),
    Mutation(
        "rise of an arch",
        "arch/dimensions.py",
        "math.sin(arch.half_angle / 2) ** 2",
        "math.sin(arch.half_angle / 2)",
        "test_dimensions.py",
    ),
    Mutation(
        "half keystones turn",
        "arch/reduction.py",
        "UNTURNED = 1e18",
        "UNTURNED = 1.0",
        "test_reduction.py",
    ),
    Mutation(
        "friction one way only",
        "limit/cones.py",
        "along[finite], -along[rough]",
        "along[finite], along[rough]",
        "test_programme.py",
    ),
    Mutation(
        "contacts pull",
        "limit/cones.py",
        "np.where(self.bounded > 0, 0.0, -math.inf)",
        "np.where(self.bounded > 0, -1.0, -math.inf)",
        "test_programme.py",
    ),
    Mutation(
        "forces at the other end of a joint",
        "limit/resultants.py",
        "share = forces[:, 1, 0] / safe",
        "share = forces[:, 0, 0] / safe",
        "test_carried.py test_margins.py",
    ),
    Mutation(
        "reactions the other way",
        "limit/resultants.py",
        "== SUPPORT, 1.0, -1.0)[:, None]",
        "== SUPPORT, -1.0, 1.0)[:, None]",
        "test_carried.py test_margins.py",
    ),
    Mutation(
        "table tilted the other way",
        "blocks/anyproblem.py",
        "cos * (self.gravity - still) + sin * self.across",
        "cos * (self.gravity - still) - sin * self.across",
        "test_structure.py test_structures_cli.py",
    ),
    Mutation(
        "overlap is taken",
        "blocks/polygons.py",
        "overlaps([shape.parts for shape in shapes], fixed, slack, 1):",
        "overlaps([shape.parts for shape in shapes], fixed, slack, 1)[1:]:",
        "test_polygons.py",
    ),
    Mutation(
        "velocity of the ground",
        "blocks/shaking.py",
        "(1 - math.cos(2 * math.pi * share)) / (2 * math.pi)",
        "(1 - math.cos(2 * math.pi * share)) / math.pi",
        "test_shaking.py",
    ),
    Mutation(
        "joints may close in a mechanism",
        "simulation/onset.py",
        "look.overlap(mechanism) < settings.closing and (",
        "True and (",
        "test_onset.py test_pymunk.py test_pybullet.py",
    ),
    Mutation(
        "what lacks friction falls",
        "simulation/onset.py",
        "if falls and rougher is not None and _may_hold(rougher, seen.mechanism):",
        "if False:",
        "test_capped_friction.py",
    ),
    Mutation(
        "a fall where rest was found is believed",
        "simulation/motion.py",
        "motion.overlap > OVERLAP or (rests and motion.verdict is Verdict.COLLAPSES)",
        "motion.overlap > OVERLAP",
        "test_motion.py",
    ),
    Mutation(
        "a changed recording is read",
        "simulation/recording.py",
        'if header.get("state_hash") != recording.state_hash:',
        "if False:",
        "test_recording.py",
    ),
    Mutation(
        "friction of a pair in pymunk",
        "engines/chipmunk.py",
        "math.sqrt(min(float(mu), FRICTION_CAP))",
        "min(float(mu), FRICTION_CAP)",
        "test_pymunk.py validation/test_simple_truths.py",
    ),
    Mutation(
        "one friction for all joints",
        "engines/stepping.py",
        "friction[held] = self._friction[self._keys[held]]",
        "",
        "test_direct_structures.py",
    ),
    Mutation(
        "friction a hundredth short", "engines/contact/coulomb.py",
        "return cls(np.broadcast_to(np.asarray(mu, dtype=np.float64), (joints,))[:, None])",
        "return cls(np.broadcast_to(0.99 * np.asarray(mu), (joints,))[:, None])",
        "test_pivoting.py",
    ),
    Mutation(
        "rest that steep friction hides", "engines/contact/solver.py",
        "<= AT_REST", "<= 0.0", "test_direct_structures.py",
    ),
    Mutation(
        "a programme given up by one method", "limit/linear.py",
        "for strategy in (DUAL, PRIMAL):", "for strategy in (DUAL,):", "test_random_truth.py",
    ),
    Mutation(
        "looks too few", "simulation/motion.py",
        "< EARLY * min(moved[-2:]) ** ahead", "< 9 * EARLY * min(moved[-2:]) ** ahead",
        "test_motion.py",
    ),
    Mutation(
        "motion where rest is possible", "engines/contact/solver.py",
        "central_path(step, cones, dilates=True)\n        first, steep",
        "central_path(step, cones, dilates=False)\n        first, steep", "test_pivoting.py",
    ),
    Mutation(
        "names of joints off by one",
        "blocks/joints.py",
        "return assembly.blocks[index].name or",
        "return assembly.blocks[index - 1].name or",
        "test_carried.py test_dimensions.py",
    ),
    Mutation(
        "undecided has another exit code",
        "cli/options.py",
        "Verdict.UNDECIDED: 3",
        "Verdict.UNDECIDED: 2",
        "test_cli.py",
    ),
    Mutation(
        "wrong input has another exit code", "cli/__init__.py", "WRONG_INPUT = 2",
        "WRONG_INPUT = 1", "test_cli.py",
    ),
    Mutation(
        "a full disk is wrong input", "cli/__init__.py", "MACHINE = 74", "MACHINE = 2",
        "test_writing.py",
    ),
    Mutation(
        "two writers share a name", "common/files.py", "{token_hex(8)}", "0",
        "test_writing.py",
    ),
    Mutation(
        "the folder is not synced", "common/files.py", "    _sync_folder(path.parent)\n", "",
        "test_writing.py",
    ),
    Mutation(
        "terminals obey titles", "cli/output.py", "[printable(line) for line in lines]",
        "list(lines)", "test_strange_text.py",
    ),
    Mutation(
        "pages hold what controls", "report/environment.py", "        finalize=printed,\n", "",
        "test_strange_text.py",
    ),
    Mutation(
        "sheets hold formulas", "common/sheets.py", 'f"\'{shown}" if asks else shown', "shown",
        "test_strange_text.py",
    ),
    Mutation(
        "titles are formulas of matplotlib", "view/drawing.py",
        'printable(text).replace("$", r"\\$")', "printable(text)", "test_strange_text.py",
    ),
    Mutation(
        "loads in newtons", "cli/road.py", "low, high, 1000 * weight", "low, high, weight",
        "test_road.py",
    ),
    Mutation(
        "scipy is loaded by every command", "arch/circular.py", "import math\n",
        "import math\nimport scipy.sparse\n", "test_start.py",
    ),
    Mutation(
        "legend of the map is lost", "view/mapfigure.py", "            _legend(figure, points)",
        "            pass", "test_mapfigure.py",
    ),
    Mutation(
        "legend of a film is lost", "view/film.py", "[*lines, *legend])]", "lines)]",
        "test_video.py test_structurefilm.py",
    ),
    Mutation(
        "an interrupt has another exit code", "common/interrupts.py", "SIGTERM: 143",
        "SIGTERM: 1", "test_interrupts.py test_processes.py",
    ),
    Mutation(
        "rows that are there are asked again", "sweeps/run.py",
        "if identity in self._done:", "if False:", "test_sweep.py",
    ),
    Mutation(
        "sizes have no low end", "common/checks.py",
        "return inside and value <= self.high and", "return value <= self.high and",
        "test_strange_input.py",
    ),
    Mutation(
        "arrays are taken at their word", "simulation/recording.py",
        "honest = min(shape, default=0) >= 0 and", "honest = True or",
        "test_strange_input.py",
    ),
    Mutation(
        "the search leaves its range", "ask/search.py",
        "lowest = max(eta, self._floor)", "lowest = eta",
        "test_bracket.py",
    ),
    Mutation(
        "old spaces wait for the collector", "engines/chipmunk.py",
        "weakref.finalize(self, _let_go, space)", "pass",
        "test_pymunk.py",
    ),
    Mutation(
        "a slash at the end is passed over", "cli/arguments.py",
        'if not self._folder and str(value).endswith("/"):', "if False:",
        "test_strange_input.py",
    ),
    Mutation(
        "names in a report are not escaped", "report/environment.py",
        "autoescape=select_autoescape(),", "autoescape=False,",
        "test_report.py test_report_browser.py",
    ),
    Mutation(
        "names in a notebook are not escaped", "notebook.py",
        "html.escape(printable(line)) for line", "line for line", "test_notebook.py",
    ),
    Mutation(
        "names of modes stay light in the dark", "report/templates/report.css",
        "34%, var(--card)", "34%, white", "test_report_browser.py",
    ),
    Mutation(
        "the slider of a report moves nothing", "report/templates/report.js",
        "show(Number(slider.value));", "", "test_report_browser.py",
    ),
    Mutation(
        "sign of the explorer's friction", "view/explorer/theory.js",
        "-(thrust * Math.sin(angle) - angle * Math.cos(angle))",
        "(thrust * Math.sin(angle) - angle * Math.cos(angle))",
        "explorer/test_explorer_theory.py",
    ),
    Mutation(
        "the explorer moves for who wants it still", "view/explorer/page.js",
        "let playing = !still.matches;", "let playing = true;",
        "explorer/test_explorer_page.py",
    ),
    Mutation(
        "levers of contacts where blocks start", "limit/starting.py",
        "turn = arm[..., 0] * ways[own, :, 1] - arm[..., 1] * ways[own, :, 0]",
        "turn = arm[..., 0] * ways[own, :, 1] + arm[..., 1] * ways[own, :, 0]",
        "test_starting.py",
    ),
    Mutation(
        "friction where blocks start", "limit/starting.py",
        "self._mu, joints = problem.friction,", "self._mu, joints = 0.9 * problem.friction,",
        "test_starting.py",
    ),
    Mutation(
        "hinges are at the other end", "blocks/joints.py", "if opening[0] < opening[1]:",
        "if opening[0] > opening[1]:", "test_joints.py test_video.py",
    ),
    Mutation(
        "live loads are dropped", "blocks/problem.py",
        "((1.0, self.dead), (self.load, self.live))", "((1.0, self.dead),)",
        "test_structure.py test_structures_cli.py",
    ),
    Mutation(
        "a sheet has another scale than it tells", "view/sheetlayout.py",
        "return self.scale / 1e3", "return self.scale / 1.01e3", "test_sheet.py",
    ),
    Mutation(
        "what errs more is on the front of the chart", "studies/chart.py",
        "point.error < best[-1].error", "point.error > best[-1].error",
        "test_work_precision.py",
    ),
    Mutation(
        "a time after the end is passed over", "view/film.py",
        "later = at > max(shown, round(shown, digits_of(shown)))", "later = False",
        "test_video.py",
    ),
    Mutation(
        "nobody is asked which name was meant", "common/errors.py",
        "if len(name) <= LONGEST else []", "if False else []", "test_names.py",
    ),
    Mutation(
        "forces do not say of which size they are", "report/problems.py",
        "    if maker is None or problem.has_size:\n", "    if True:\n",
        "test_dimensions.py",
    ),
    Mutation(
        "words on a sheet cover others", "view/sheetlayout.py",
        "            at = at + step", "            pass", "test_sheet.py",
    ),
    Mutation(
        "an arch of the paper has other voussoirs", "view/paperarches.py",
        "complementary(angles, arch.critical.eta, arch.mu)",
        "complementary(angles, 1.02 * arch.critical.eta, arch.mu)", "test_paper.py",
    ),
    Mutation(
        "the slope of a parabola", "kinds/parabolic.py", "np.ones_like(s), -2 * bend * s)",
        "np.ones_like(s), -bend * s)", "test_kinds.py",
    ),
    Mutation(
        "a joint is written without its own friction", "blocks/structure.py",
        "if joint.friction is not None:\n            entry", "if False:\n            entry",
        "test_structure.py",
    ),
    Mutation(
        "faces of a joint are written in another order", "blocks/structure.py",
        'entry["faces"] = joint.faces.tolist()', 'entry["faces"] = joint.faces[::-1].tolist()',
        "test_structure.py",
    ),
    Mutation(
        "millimetres are centimetres", "reading/dxf.py", '4: "mm", 5: "cm"',
        '4: "cm", 5: "mm"', "test_reading.py",
    ),
    Mutation(
        "only the ends of faces meet", "blocks/touching.py",
        "apart = np.abs(gaps).max(axis=0)",
        "apart = np.abs(gaps).min(axis=0)", "test_polygons.py",
    ),
    Mutation(
        "words of films are taken for half as wide", "view/canvas.py",
        "ismath=False)[0]", "ismath=False)[0] / 2", "test_video.py test_structurefilm.py",
    ),
    Mutation(
        "a shell completes what merely has the letters", "cli/app.py",
        "if name.startswith(incomplete)", "if incomplete in name", "test_start.py",
    ),
    Mutation(
        "commands are loaded to be completed", "cli/app.py",
        "CompletionItem(name, help=about)", "CompletionItem(name, help=_commands[name].help)",
        "test_start.py",
    ),
    Mutation(
        "what moves leaves the picture", "view/archfigure.py",
        "    axes.update_datalim(points)\n", "", "test_archfigure.py",
    ),
    Mutation(
        "a ratio of nothing is divided by", "kinds/circular.py", "if not least:",
        "if least is None:", "test_cli.py",
    ),
    Mutation(
        "a film stands still",
        "view/film.py",
        "if self._last is None or self._last[0] != seconds:",
        "if self._last is None:",
        "test_video.py",
    ),
)  # fmt: skip


def caught(mutation: Mutation, copy: Path) -> bool:
    """Put a wrong line into the copy, run the tests, and put the right one back."""
    file = copy / "blocksim" / mutation.file
    right = file.read_text(encoding="utf-8")
    if right.count(mutation.line) != 1:
        raise SystemExit(f"{mutation.file}: not once there: {mutation.line!r}")
    file.write_text(right.replace(mutation.line, mutation.wrong), encoding="utf-8")
    tests = [f"tests/{each}" for each in mutation.tests.split()]
    run = [sys.executable, "-m", "pytest", "-n", "0", "-x", *tests]
    # Those of the copy, not of an installed blocksim; what is compiled is kept beside it.
    where = {**os.environ, "PYTHONPATH": str(copy)}
    where.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run(run, cwd=copy, env=where, capture_output=True, check=False)
    file.write_text(right, encoding="utf-8")
    if done.returncode not in {0, 1}:
        raise SystemExit(done.stdout.decode())
    return done.returncode == 1


def main(word: str = "") -> int:
    """Try all whose name has a word, and return how many survived."""
    survived = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "blocksim"
        left = shutil.ignore_patterns(".*", "__pycache__", "out")
        shutil.copytree(ROOT, copy, ignore=left)
        for mutation in MUTATIONS:
            if word in mutation.name:
                seen = caught(mutation, copy)
                survived += not seen
                sys.stdout.write(f"{'caught' if seen else 'SURVIVED'}: {mutation.name}\n")
                sys.stdout.flush()
    return survived


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
