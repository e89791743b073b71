"""The referee: scenes of which the answer is proved, and what engines say of them."""
