"""The map explorer: the mode map and its arches in one page that computes in the browser."""

from blocksim.view.explorer.page import explorer_page as explorer_page
from blocksim.view.explorer.results import read_results as read_results
