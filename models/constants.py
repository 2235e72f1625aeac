"""Constants that Python and C, or several packages, share.

The C sources read them as `constants.h`, which is generated from this file.
"""

# The rotor
SAME_PLACE = 1e-9  # of the shaft's length: places this near to each other are one
SHAFT_SYMMETRIC = 1e-6  # of the largest compliance: measured ones are given with few digits
SHAFT_SINGULAR = 1e-13  # pivot of the scaled compliance: below it rounding makes the stiffness
TAYLOR_TERMS = 16  # 0.5^16/17! is far below rounding
TURN_ROUNDING = 2.4492935982947064e-16  # 2 pi minus its floating-point value
SPAN = 0.8  # m, between the supports of a rotor, by default
SPACING = 0.1  # m, between the stations of a shaft, by default
STEEL_20_MM = 1.6e3  # N m^2, E I of a steel shaft of 20 mm
DEFAULT_UNBALANCE = 2.0e-4  # kg m

# The weights
TURN_PER_SUBSTEP = 0.15  # rad of weight motion: the error of a step is then below 1e-6
MAX_SUBSTEPS = 1_000_000  # in a step
TRACK_SLACK = 1e-12  # relative: a full track may be a rounding too full

# Model exchange
FIRST_DERIVATIVE = 2_000_000  # value reference of the first state's: above all that a layout has
FIRST_INDICATOR = 3_000_000  # and of the first event indicator's
NOMINAL_DISPLACEMENT = 1e-4  # m; of a machine of some kilograms at some hundred radians per second
NOMINAL_VELOCITY = 1e-2  # m/s
NOMINAL_ANGULAR_VELOCITY = 1e2  # rad/s

# The machine in one piece
STIFF_RATE = 40.0  # over the rotor's speed: fastest rate of a machine whose steps may be collocated
DEFAULT_TOLERANCE = 1e-4  # of the motion: no picture shows it
SERIES_SHARE = 1e-3  # of a run's tolerance: what a step by series may err
FEWEST_LOOKS = 32  # per revolution: the vibration misses 0.5 % of a peak between them
