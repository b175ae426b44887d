"""From poses to rotation, impacts, outcome and history: the same eyes for every engine."""
