"""Constants of the equations and the coupling that Python and C share.

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
MAX_ITERATIONS = 12  # the fixed point of a substep gains about two digits an iteration
SUBSTEP_CONVERGED = 1e-14  # relative to the size of the change over the substep
MAX_SUBSTEPS = 1_000_000  # in a step
FAR_ANGLE = 1e4  # rad: beyond, whole turns are taken off while a step is computed
TRACK_SLACK = 1e-12  # relative: a full track may be a rounding too full

# The loop of rotor and balancers
FEWEST_CHOSEN = 8  # steps per revolution with a tolerance, until all rests: a record shows one
WEAK_LOOP = 0.1  # gain: one corrector pass then leaves 1 % of the prediction's error
START_TOLERANCE = 1e-12  # of the largest force: start values are as exact as the units
START_ROUNDING = 1e-13  # of the largest force, times the gain: what the loop makes of rounding
START_ITERATIONS = 20  # the map is affine in values and in slopes; Newton needs two or three
LOOP_SINGULAR = 1e-12  # |1 - eigenvalue| below which a loop counts as one of gain 1
SLOW_CONVERGENCE = 0.1  # reduction of a residual per pass above which the Jacobian is refined
CONVERGED_FORCES = 1e-10  # residual of the forces relative to the largest force so far
GAIN_ROUNDING = 1e-12  # per loop gain: what rounding leaves of a residual
MAX_PASSES = 30  # quasi-Newton needs two to six; more means it does not converge
JACOBIAN_CHANGE = 1e-3  # of the largest force: a disturbance that shows the loop's Jacobian
LOOSE_RESIDUAL = 1e-3  # of the force: fixed passes that leave more than this are reported
JUMP_PARTS = 8  # at a gain of 1/13, the largest of a stable cubic exchange, 1e-9 is left
FORCE_ROUNDING = 1e-14  # of the largest force there can be: what sums leave of cancelling parts

# Lengths of steps
DEFAULT_STEPS = 40  # per revolution: 1e-6 on the two-ball scene with cubic signals
FEWEST_STEPS = 4  # per revolution: fewer do not resolve one
BEYOND_LONGEST_STEP = 1.01  # times the longest step of a motion; steps at rest are twice as long
BRIEF_STEP = 1e-6  # of a communication step: one across an event, taken whole
FULL_BRIEF_TOLERANCE = 1e-4  # tolerance below which brief steps are shorter,
SMALLEST_BRIEF_SHARE = 0.1  # and by how much at most
STEEP_FORCE_CHANGE = 0.2  # of the force: a step over which its first slope makes more is divided
FIRST_CHANGE = 0.05  # of the force: what it may change by that slope over the first part
MOST_HALVINGS = 60  # a force that rises from exactly zero has no size to compare with
KINK_STEP = 1e-6  # of a step: it errs by less than 1e-7, and rounding does not spoil the slopes

# Whether steps resolve the motion
STATED_ERROR = 0.01  # of the motion: a run states an estimated error from here on

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
