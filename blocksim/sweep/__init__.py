"""Many arches: a design of cases, asked of any executor, with rows that survive a kill."""

from blocksim.sweep.case import Case as Case
from blocksim.sweep.case import Questions as Questions
from blocksim.sweep.design import Design as Design
from blocksim.sweep.design import load_design as load_design
from blocksim.sweep.run import Summary as Summary
from blocksim.sweep.run import sweep as sweep
from blocksim.sweep.shards import read_rows as read_rows
from blocksim.sweep.table import write_parquet as write_parquet
