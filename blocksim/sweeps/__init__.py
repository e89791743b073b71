"""Many arches or other structures: a design of cases for any executor; rows survive a kill."""

from blocksim.sweeps.case import Case as Case
from blocksim.sweeps.case import Questions as Questions
from blocksim.sweeps.case import SweepRow as SweepRow
from blocksim.sweeps.design import Design as Design
from blocksim.sweeps.load import load_design as load_design
from blocksim.sweeps.run import Summary as Summary
from blocksim.sweeps.run import sweep as sweep
from blocksim.sweeps.shards import read_rows as read_rows
from blocksim.sweeps.table import to_pandas as to_pandas
from blocksim.sweeps.table import write_csv as write_csv
from blocksim.sweeps.table import write_parquet as write_parquet
