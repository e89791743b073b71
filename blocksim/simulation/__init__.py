"""What an engine shows of blocks: held at rest, let go, recorded, and a verdict."""
