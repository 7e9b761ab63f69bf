"""What filters say of themselves, and how consistent they are."""

from debrisest.quantity import RUN, TIME, ChiSquare, Quantity

QUANTITIES = {
    "covariance": Quantity(
        ("run", "covariance_time_s", "error_name", "error_column"), "", "covariance of the state"
    ),
    "nis": Quantity(
        *(TIME, "1", "normalised innovation squared; assess: per dimension", "1"),
        ChiSquare("nis_dof", white=True),
    ),
    "nis_dof": Quantity(TIME, "1", "measured components at the epoch"),
    "cost": Quantity(TIME, "1", "twice the negative log posterior density of the estimate"),
    "cost_of_truth": Quantity(TIME, "1", "the same of the truth, given the same measurements"),
    "rival_excess": Quantity(
        TIME, "1", "cost of the other solution above the estimate's; infinite: there is none"
    ),
    "cost_numbers": Quantity(RUN, "1", "numbers that it is the cost of, if not all errors"),
    "rejected": Quantity(
        TIME, "1", "components that the gate rejected at the epoch; assess: their share", "1"
    ),
    "validated": Quantity(TIME, "1", "unlabelled detections within the gates at the epoch"),
    "reopened": Quantity(RUN, "1", "times that the gate was reopened", "1"),
    "updates": Quantity(TIME, "1", "iterations of the update at the epoch"),
    "converged": Quantity(RUN, "1", "the last replay converged", "1"),
    "restarts": Quantity(RUN, "1", "restarts of the batch", "1"),
    "dropped": Quantity(RUN, "1", "landmarks that were given up", "1"),
    "doubt": Quantity(
        RUN, "1", "0 consistent, 1 errors may be larger than stated, 2 ambiguous, 3 lost", "1"
    ),
    "doubt_at": Quantity(
        TIME,
        "1",
        "the same of an epoch whose covariance was kept, by what is known at the end",
        "1",
    ),
    "doubtful": Quantity(RUN, "1", "the run does not call itself consistent", "1"),
    "silent_failure": Quantity(
        RUN, "1", "beyond five sigma at the end, and calls itself consistent", "1"
    ),
    "doubtful_at": Quantity(TIME, "1", "the run does not call its estimate consistent", "1"),
    "silent_failure_at": Quantity(
        TIME, "1", "the estimate is beyond five sigma, and the run calls it consistent", "1"
    ),
    "fit": Quantity(RUN, "1", "cost of the batch per degree of freedom", "1"),
    "repairs": Quantity(RUN, "1", "covariance repairs", "1"),
    "nees": Quantity(
        *(TIME, "1", "normalised error squared per dimension", "1"),
        ChiSquare("nees_dof", white=False),
    ),
    "square_half_way": Quantity(
        TIME, "1", "squared error of the motion in sigmas, half way from its first measurement"
    ),
    "deviation": Quantity(TIME, "1", "largest error of a single number over its sigma", "1"),
    "nees_dof": Quantity(TIME, "1", "errors that it counts, where the covariance was kept"),
    "w": Quantity(
        *(TIME, "1", "excess of the truth's cost over the estimate's per dimension", "1"),
        ChiSquare("w_dof", white=False, of_costs=True),
    ),
    "w_dof": Quantity(TIME, "1", "errors that it counts, where costs were kept"),
}
