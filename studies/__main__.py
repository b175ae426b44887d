"""The command line: `rocking`, and `python -m studies`."""

from studies.kit import app

GROUPS = {
    "Ask": {
        "compare": "One block and one pulse or record: every source side by side.",
        "blocks": "A list of blocks under records: which slide, rock or overturn, and the margin.",
        "advise": "The settings with which an engine rocks right in your scene.",
        "export": "A script of one case that needs the engine alone.",
        "animate": "A film of one block, as several sources move it.",
        "score": "One engine, yours perhaps: what it predicts, and whether it got worse.",
        "report": "Every study, and one page of what they found.",
        "doctor": "What is installed, and whether it works.",
    },
    "Studies": {
        "sweep": "The paper's sensitivity analysis, figures 6 to 9.",
        "histories": "The paper's time histories, figures 2, 4 and 5.",
        "linearizations": "Where a linearization errs: onset, frequency or saddle.",
        "validate": "Random cases that no setting was tuned on.",
        "precision": "Error against run time of every source.",
        "batch": "The paper's cases as a batch on a GPU: cases a second at an error.",
        "contact": "What each contact setting of an engine costs and gains.",
        "restitution": "One impact: the coefficient of restitution that each engine gives.",
        "stability": "Stiff and extreme cases: which sources stay finite and right.",
        "overturning": "Which pulses overturn a block: maps, and where sources are wrong.",
        "scenes": "Frames, sliding blocks and a floor that moves.",
        "experiments": "Rocks on a shake table and tossed cubes: who predicts what they did.",
    },
    "Maintain": {
        "help": "The options that all studies share.",
        "readme": "Write the README and its pages from the published tables.",
    },
}
"""Every command, in the order of the help, and its purpose."""
COMMANDS = [name for group in GROUPS.values() for name in group]


def run(arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    return app.run(GROUPS, arguments)


def main() -> None:
    """Run the command that the arguments name, and exit."""
    app.main(GROUPS)


if __name__ == "__main__":
    main()
