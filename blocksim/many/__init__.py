"""Many arches or other structures: a design of cases for any executor; rows survive a kill."""

from blocksim.many.case import Case as Case
from blocksim.many.case import Questions as Questions
from blocksim.many.design import Design as Design
from blocksim.many.load import load_design as load_design
from blocksim.many.run import Summary as Summary
from blocksim.many.run import sweep as sweep
from blocksim.many.shards import read_rows as read_rows
from blocksim.many.table import write_csv as write_csv
from blocksim.many.table import write_parquet as write_parquet
