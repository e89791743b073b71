"""Contact problem of rigid blocks: arrays in, arrays out."""
