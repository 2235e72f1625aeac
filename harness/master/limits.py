"""Limits of the coupling of separate units, and of what is said about their runs."""

# The loop of rotor and balancers
WEAK_LOOP = 0.1  # gain: one corrector pass then leaves 1 % of the prediction's error
START_TOLERANCE = 1e-12  # of the largest force: start values are as exact as the units
START_ROUNDING = 1e-13  # of the largest force, times the gain: what the loop makes of rounding
START_ITERATIONS = 20  # the map is affine in values and in slopes; Newton needs two or three
LOOP_SINGULAR = 1e-12  # |1 - eigenvalue| below which a loop counts as one of gain 1
SLOW_CONVERGENCE = 0.1  # reduction of a residual per pass above which the Jacobian is refined
CONVERGED_FORCES = 1e-10  # residual of the forces relative to the largest force so far
BRIEF_FOR_LOOP = 0.1  # of a step: in a shorter one forces answer as without a step
CLOSED = 1e-15  # residual of a step over a jump, as long as passes reduce it
GAIN_ROUNDING = 1e-12  # per loop gain: what rounding leaves of a residual
MAX_PASSES = 30  # quasi-Newton needs two to six; more means it does not converge
JACOBIAN_CHANGE = 1e-3  # of the largest force: a disturbance that shows the loop's Jacobian
LOOSE_RESIDUAL = 1e-3  # of the force: fixed passes that leave more than this are reported
JUMP_PARTS = 8  # at a gain of 1/13, the largest of a stable cubic exchange, 1e-9 is left
FORCE_ROUNDING = 1e-14  # of the largest force there can be: what sums leave of cancelling parts

# Lengths of steps
FEWEST_CHOSEN = 8  # steps per revolution with a tolerance, until all rests: a record shows one
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
