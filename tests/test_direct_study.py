"""The study of Coulomb friction runs, and its claim holds in small."""

import importlib.util
import sys
from pathlib import Path

STUDY = Path(__file__).parent.parent / "analysis" / "direct_coulomb.py"


def test_arches_with_an_equilibrium_do_not_move(tmp_path):
    spec = importlib.util.spec_from_file_location("analysis_direct_coulomb", STUDY)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    outcome = module.main(tmp_path, quick=True)
    assert outcome.cases == 2
    assert outcome.held == outcome.lowered == 0
    assert (tmp_path / "direct_coulomb.png").stat().st_size > 0
