"""Many questions, held against the truth and against time."""
