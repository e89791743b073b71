"""The symmetric circular arch: generator, theory, exact statics, modes, answers."""
