"""The commands of `autobalancer`, a file each; its function `command` calls a method of a scene."""

NAMES = (
    *("check", "build", "run", "speeds", "map", "balance", "rotor", "design", "scatter"),
    *(
        "capture",
        "race",
        "motions",
        "fit",
        "drag",
        "bearing",
        "precision",
        "show",
        "report",
        "new",
        "cite",
        "stress",
        "manual",
    ),
)  # in the order of the help
