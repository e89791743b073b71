"""The questions, asked of any problem, and the methods that can answer them."""

from blocksim.ask.bracket import Bracket as Bracket
from blocksim.ask.bracket import bracket as bracket
from blocksim.ask.check import Check as Check
from blocksim.ask.check import check as check
from blocksim.ask.families import Family as Family
from blocksim.ask.families import family_of as family_of
from blocksim.ask.simulate import simulate as simulate
