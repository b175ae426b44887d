"""One run: equal steps, steps that land on impacts, or the engine's own; and who looks on."""
