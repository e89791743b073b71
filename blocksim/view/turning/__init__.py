"""A page in which blocks can be turned around: a model, and the viewer of models in it."""

from blocksim.view.turning.page import turning_page as turning_page
