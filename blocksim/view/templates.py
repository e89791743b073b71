"""Where pages are made of templates: the one place that knows Jinja2."""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, StrictUndefined

from blocksim.common.words import printed


def environment_of(package: str, folder: str = "", *, lstrip: bool = False) -> Environment:
    """Return templates of a package, which escape what they are given."""
    environment = Environment(
        loader=PackageLoader(package, folder),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=printed,
        trim_blocks=True,
        lstrip_blocks=lstrip,
    )
    # JSON has no infinity; modes keep the order of the paper.
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False}
    return environment
