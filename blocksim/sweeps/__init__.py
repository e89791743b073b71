"""Many arches or other structures: a design of cases for any executor; rows survive a kill."""
