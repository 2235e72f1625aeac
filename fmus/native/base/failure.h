/* What a function of the core could not do, as numbers; the words are made in failure_words.c. */
#ifndef AUTOBALANCER_FAILURE_H
#define AUTOBALANCER_FAILURE_H

/* The comment of a code gives the Python exception it stands for and what `value` and `where` hold. */
enum {
    FINE = 0,
    /* ValueError of the parameters; `value[0]` is the value refused */
    FAILURE_FLOAT_RADIUS,      /* float_radius; value[1]: chamber_radius */
    FAILURE_POLAR_INERTIA,     /* polar_inertia; value[1]: twice the inertia */
    FAILURE_STATIONS,          /* stations: at least two, each beyond the last */
    FAILURE_SUPPORTS,          /* supports value[0], value[1]; where: number of stations */
    FAILURE_UNBALANCE_PLACE,   /* unbalances: position, not on the shaft */
    FAILURE_COMPLIANCE,        /* compliance: must be finite and symmetric */
    FAILURE_NOT_ELASTIC,       /* compliance: must be positive definite */
    FAILURE_CANNOT_BEND,       /* internal_damping of a shaft with discs at its supports only */
    FAILURE_NOT_CARRIED,       /* gravity: the supports have no stiffness */
    FAILURE_WEIGHT_RADIUS,     /* weight_radius; value[1]: track radius; value[2]: largest */
    FAILURE_RESTITUTION,       /* restitution: must be within 0 to 1 */
    FAILURE_MOBILITY,          /* track_mobility; value[1]: 1/(N m), which it must stay below */
    FAILURE_NO_ROOM,           /* weights of unequal radii that fill the track */
    FAILURE_RIGID_SLIDERS,     /* two rigid sliders at one support and axis */
    FAILURE_SPIN,              /* der(acceleration): must be 0 */
    FAILURE_CHARACTERISTIC,    /* points of a motor; where: the first that does not ascend */
    FAILURE_OVERLAP,           /* value[0]: overlap, value[1]: angle neighbours need [rad] */
    /* OverflowError and LinAlgError of the rotor's matrices */
    FAILURE_MATRICES,          /* the rotor's matrices are not finite */
    FAILURE_SINGULAR,          /* a matrix is singular */
    /* ArithmeticError of the rotor */
    FAILURE_STRETCHES,         /* value: step, time reached; where: largest number */
    /* ArithmeticError of the weights */
    FAILURE_ANGLES,            /* the weights' angles are not finite */
    FAILURE_SUBSTEPS,          /* value: substeps, step, acceleration, largest rate */
    FAILURE_NOT_CONVERGED,     /* value: step, angle, rate, acceleration */
    FAILURE_SLIDE,             /* the same for a sliding group */
    FAILURE_IMPACT,            /* where: pairs that touch; value: largest opening speed */
    FAILURE_EVENTS,            /* value: step, time reached; where: largest number */
    /* ArithmeticError of the motor */
    FAILURE_MOTOR,             /* value: speed [rad/s]; it or the torque is not finite */
    FAILURE_CROSSINGS          /* value: step, speed of the point crossed again and again */
};

typedef struct {
    int code;
    int where;
    double value[4];
} Failure;

/* Write a failure and return its code, so that a caller can return what this returns. */
int fail(Failure *failure, int code, int where, double first, double second, double third,
         double fourth);

#endif
