"""How it is shown: style, panels, diagrams, films."""
