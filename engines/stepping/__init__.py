"""When to step: fixed steps, steps that land on impacts, and the base's motion meanwhile."""
