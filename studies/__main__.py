"""The command line: `rocking`, and `python -m studies`."""

from studies.kit import app

COMMANDS = {
    "advise": "The settings with which an engine rocks right in your scene.",
    "compare": "One block and one pulse or record through every source, side by side.",
    "blocks": "A list of blocks under records: which rock, which overturn, with what margin.",
    "animate": "A film of one block, as several sources move it.",
    "export": "A script of its own for one case, which needs the engine alone.",
    "sweep": "The paper's sensitivity analysis, figures 6 to 9.",
    "histories": "The paper's time histories, figures 2, 4 and 5.",
    "linearizations": "What in a linearization errs: onset, frequency or saddle.",
    "scenes": "Frames, sliding blocks and a floor that moves.",
    "validate": "Random cases that no setting was tuned on.",
    "precision": "Error against run time of every source.",
    "contact": "What each setting of an engine's contact costs and buys.",
    "restitution": "One strike: which coefficient of restitution each engine gives.",
    "stability": "Stiff and extreme cases: who stays finite and predicts the outcome.",
    "overturning": "Which pulses overturn a block: maps, and where models and engines are wrong.",
    "score": "One engine, yours perhaps: what it predicts, and whether it got worse.",
    "doctor": "What is installed, and whether it works.",
    "report": "Every study, and one page that shows what they found.",
    "readme": "The numbers in the README and its pages, from the published tables.",
}
"""Every command, in the order of the help, and what it is for."""


def run(arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    return app.run(COMMANDS, arguments)


def main() -> None:
    """Run the command that the arguments name, and exit."""
    app.main(COMMANDS)


if __name__ == "__main__":
    main()
